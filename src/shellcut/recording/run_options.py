"""Options of a run: its output files, checkpoints and restart."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, TypedDict

from shellcut.arguments import Option, checked


@checked
@dataclass(frozen=True, kw_only=True)
class RunOptions:
    """Options of :class:`Recorder` and of ``Case.run``, under the same names."""

    n_row: Annotated[int, Option("", "rows of history.csv over the run", least=1)] = 1900
    n_frame: Annotated[int, Option("", "frames of the result file over the run", least=1)] = 100
    n_snapshot: Annotated[
        int, Option("", "pictures of the film over the run; 0 for none", least=0)
    ] = 5
    curves: Annotated[
        bool, Option("", "draw the curves of the run when it ends, if Matplotlib is there")
    ] = True

    progress: bool = True
    """Whether to show progress on standard error, and to log a status line every 5 %."""

    log: Callable[[str], None] | None = None
    """Function that also receives each line shown."""

    checkpoint_every: Annotated[
        float | None,
        Option(
            "s",
            "wall time between two checkpoints, the first one at the start",
            least=0,
            unset="one when the run ends or is interrupted, unless a step failed",
        ),
    ] = 60.0

    resume: bool = False
    """Resume from the checkpoint in the folder, with a simulation newly built from the same inputs;
    the files are appended to. Rows, frames and pictures keep their original intervals."""

    force: bool = False
    """Run a model that a check refuses, where that can make sense."""

    replace: bool = True
    """Whether the files of an earlier run in the folder may be removed."""


class RunArguments(TypedDict, total=False):
    """The fields of :class:`RunOptions` as arguments by name, for type checkers."""

    n_row: int
    n_frame: int
    n_snapshot: int
    curves: bool
    progress: bool
    log: Callable[[str], None] | None
    checkpoint_every: float | None
    resume: bool
    force: bool
    replace: bool
