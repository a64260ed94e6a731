"""The error of model files: all problems at once, each with its place."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from dis import opmap
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .model import Model


@dataclass(frozen=True)
class Problem:
    """One problem."""

    place: str
    """``file:line``, or the setting that overrides the file."""
    text: str

    def __str__(self) -> str:
        return f"{self.place}: {self.text}"


class ModelFileError(ValueError):
    """The model file is wrong; the message lists every problem, one per line.

    Attributes
    ----------
    problems : tuple of Problem
    partial : Model or None
        The valid part: a model without the sections that have problems.

    Examples
    --------
    >>> from shellcut import read_model
    >>> read_model("opening", {"tool.teehs": 6, "motion.pitch": "3 MPa"})
    Traceback (most recent call last):
    ...
    shellcut.model_file.errors.ModelFileError: ...unknown key [tool].teehs; did you mean teeth?...
    """

    def __init__(self, problems: Sequence[Problem]) -> None:
        self.problems = tuple(problems)
        self.partial: Model | None = None
        super().__init__("\n".join(str(problem) for problem in problems))


def is_refusal(problem: BaseException) -> bool:
    """Whether an error is shellcut's own word on a value, raised by a ``raise`` of its sources.

    Any other is raised inside a library and says nothing of the user's file.
    """
    trace = problem.__traceback__
    while trace is not None and trace.tb_next is not None:
        trace = trace.tb_next
    if trace is None:
        return False
    package = str(trace.tb_frame.f_globals.get("__name__")).partition(".")[0]
    raised = trace.tb_frame.f_code.co_code[trace.tb_lasti] == opmap["RAISE_VARARGS"]
    return package == "shellcut" and raised
