"""What a run leaves in its folder, and how it goes on: the options of a run, in one place."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class RunOptions:
    """Options of :class:`Recorder` and of ``Case.run``, given there by these names.

    Raises
    ------
    ValueError
        If a wall time is negative.
    """

    n_row: int = 1900
    """Rows of ``history.csv`` over the run."""

    n_frame: int = 100
    """Frames of the result file over the run."""

    n_snapshot: int = 5
    """Pictures of the film over the run; 0 for none."""

    progress: bool = True
    """Whether to show on standard error how far the run is, with a line of figures every 5 %."""

    pvd: bool = False
    """Whether to write the frames as PVD + VTU too, for ParaView before 5.12; that takes some eight
    times as long as the result file."""

    log: Callable[[str], None] | None = None
    """Also given each line that is shown."""

    checkpoint_every: float | None = 60.0
    """Wall time between two checkpoints [s], the first one at the start; None makes one only when
    the run ends or is interrupted. One is always made then, unless the run died within a step."""

    resume: bool = False
    """Go on from the checkpoint in the folder, with a simulation just built from the same inputs;
    the files are appended to. Rows, frames and pictures keep the intervals they began with."""

    force: bool = False
    """Run what a check of the model refuses, where that can make sense."""

    replace: bool = True
    """Whether the files of an earlier run in the folder may be removed."""

    def __post_init__(self) -> None:
        if self.checkpoint_every is not None and not self.checkpoint_every >= 0:
            raise ValueError(
                f"checkpoint_every must be a wall time in s, or None, got {self.checkpoint_every!r}"
            )
