"""A case: a simulation and when it ends."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass

from shellcut.imprinting import ImprintResult
from shellcut.recorder import Recorder
from shellcut.simulation import Simulation


@dataclass(frozen=True)
class Case:
    """A simulation that is ready to run.

    Attributes
    ----------
    name : str
        Stem of the result file and title of the pictures.
    simulation : Simulation
        At t = 0.
    duration : float
        End of the run [s].
    imprint : ImprintResult or None
        What putting the blade's path into the mesh did; None where it was not asked for.
    """

    name: str
    simulation: Simulation
    duration: float
    imprint: ImprintResult | None = None

    def run(
        self,
        folder: str | os.PathLike[str],
        *,
        n_row: int = 1900,
        n_frame: int = 100,
        n_snapshot: int = 5,
        progress: bool = True,
        log: Callable[[str], None] | None = None,
    ) -> None:
        """Run to the end and leave everything in ``folder``, see :class:`Recorder`."""
        recorder = Recorder(
            self.simulation,
            folder,
            until=self.duration,
            name=self.name,
            n_row=n_row,
            n_frame=n_frame,
            n_snapshot=n_snapshot,
            progress=progress,
            log=log,
        )
        self.simulation.run(self.duration, [recorder])
