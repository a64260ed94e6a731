"""A case: a simulation and when it ends."""

from __future__ import annotations

import logging
import os
from collections.abc import Callable
from dataclasses import dataclass

from shellcut.hooks import Hook, StopWhen
from shellcut.imprinting import ImprintResult
from shellcut.interruption import Interruption
from shellcut.recorder import Recorder, RunEnded
from shellcut.simulation import Simulation

_log = logging.getLogger(__name__)


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
        pvd: bool = False,
        log: Callable[[str], None] | None = None,
        checkpoint_every: float | None = 60.0,
        resume: bool = False,
    ) -> None:
        """Run to the end and leave everything in ``folder``, see :class:`Recorder`.

        Ctrl-C (SIGINT) and SIGTERM end the run after the step it is in: the files are closed, a
        checkpoint is written, and a line says where it stopped. Then the signal takes its usual
        effect: Ctrl-C raises KeyboardInterrupt, SIGTERM ends the process. A second one does so at
        once, and leaves what there was.

        Parameters
        ----------
        folder : path
            Where to.
        n_row, n_frame, n_snapshot, progress, pvd, log, checkpoint_every
            As :class:`Recorder`.
        resume : bool
            Go on with the run in ``folder``, on a case just built from the same inputs; a run that
            has ended is left as it is, and a line says so.

        Raises
        ------
        KeyboardInterrupt
            After Ctrl-C.
        UnstableStep
            If the solution blows up; the files are closed, the last good checkpoint is kept.
        FileNotFoundError, CheckpointError
            If there is nothing to resume, or it is another model's.
        ValueError
            If the simulation has been run already; nothing in the folder has been touched.
        """
        if self.simulation.state.step:
            raise ValueError(
                f"a case is run once, this one is at step {self.simulation.state.step}: build it "
                "again, and run it anew or with resume=True"
            )
        try:
            recorder = Recorder(
                self.simulation,
                folder,
                until=self.duration,
                name=self.name,
                n_row=n_row,
                n_frame=n_frame,
                n_snapshot=n_snapshot,
                progress=progress,
                pvd=pvd,
                log=log,
                checkpoint_every=checkpoint_every,
                resume=resume,
            )
        except RunEnded as ended:
            _log.warning("%s; nothing was changed", ended)
            return
        with Interruption() as interruption:
            hooks: list[Hook] = [recorder, StopWhen(lambda: interruption.requested)]
            self.simulation.run(self.duration, hooks)
        if interruption.requested and self.simulation.state.time < self.duration:
            _log.warning(
                "%s stopped at %s; to go on, resume from the checkpoint in %s",
                self.name,
                recorder.place(),
                recorder.folder,
            )
        interruption.deliver()
