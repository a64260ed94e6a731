"""Options of a run: its output files, checkpoints and restart."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from shellcut.arguments import checked


@checked
@dataclass(frozen=True, kw_only=True)
class RunOptions:
    """Options of :class:`Recorder` and of ``Case.run``, under the same names.

    Raises
    ------
    ValueError
        If a wall time is negative, or a count.
    """

    n_row: int = 1900
    """Rows of ``history.csv`` over the run."""

    n_frame: int = 100
    """Frames of the result file over the run."""

    n_snapshot: int = 5
    """Pictures of the film over the run; 0 for none."""

    curves: bool = True
    """Whether to draw the curves when the run ends, if Matplotlib is there."""

    progress: bool = True
    """Whether to show progress on standard error, with a status line every 5 %."""

    log: Callable[[str], None] | None = None
    """Function that also receives each line shown."""

    checkpoint_every: float | None = 60.0
    """Wall time between two checkpoints [s], the first one at the start; None writes one only when
    the run ends or is interrupted. The end always writes one, unless a step failed."""

    resume: bool = False
    """Resume from the checkpoint in the folder, with a simulation newly built from the same inputs;
    the files are appended to. Rows, frames and pictures keep their original intervals."""

    force: bool = False
    """Run a model that a check refuses, where that can make sense."""

    replace: bool = True
    """Whether the files of an earlier run in the folder may be removed."""

    def __post_init__(self) -> None:
        for name, least in (("n_row", 1), ("n_frame", 1), ("n_snapshot", 0)):
            if not (value := getattr(self, name)) >= least:
                raise ValueError(f"{name} must be a count of {least} or more, got {value!r}")
        if self.checkpoint_every is not None and not self.checkpoint_every >= 0:
            raise ValueError(
                f"checkpoint_every must be a wall time in s, or None, got {self.checkpoint_every!r}"
            )
