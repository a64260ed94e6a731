"""One run of a study, in its own folder: begun, continued or found done. Workers call it."""

from __future__ import annotations

import contextlib
import json
import logging
import multiprocessing
import time
import traceback
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

from shellcut.child_process import ABANDONED
from shellcut.files.folder_lock import FolderInUse
from shellcut.files.regular_file import read_regular
from shellcut.files.run_folder import CHECKPOINT, LOG, SUMMARY, USED
from shellcut.files.whole_file import write_text
from shellcut.model_file import Model, ModelFileError
from shellcut.model_file.reader import model_of_text
from shellcut.models.case import Case
from shellcut.recording.recorder import Recorder
from shellcut.recording.run_log import RunLog
from shellcut.results.verdict import doubts_in
from shellcut.simulation.hooks import StopWhen
from shellcut.simulation.instability import UnstableStep

STOP = "stop"
"""A file of this name in the study's folder stops all runs after their step."""

_LOOK_EVERY = 1.0  # s between two looks for that file
_PATIENCE = 1.0  # s between two tries at a folder in use

Status = Literal["done", "failed", "stopped"]

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Task:
    """What a worker needs: texts and paths only, so that it can be sent to any machine."""

    number: int
    """Of the run in the study."""
    folder: str
    """Of the run; the worker must see the same file system."""
    model: str
    """Text of the model file with every default filled in."""


@dataclass(frozen=True)
class Outcome:
    """How a run ended."""

    status: Status
    reason: str = ""
    """Of a failure, in one line."""
    figures: Mapping[str, Any] = field(default_factory=dict)
    """Of ``summary.json``, and ``doubts``, their number."""
    seconds: float = 0.0
    """That this call took [s]; 0 for a run that was found done."""

    @classmethod
    def done(cls, summary: Mapping[str, Any], seconds: float = 0.0) -> Outcome:
        """Return the outcome of a run that is done."""
        figures = {**summary, "doubts": len(doubts_in(summary))}
        return cls("done", figures=figures, seconds=seconds)

    @property
    def doubts(self) -> tuple[str, ...]:
        """What its verdict distrusts, a sentence each."""
        return doubts_in(self.figures)


def run_one(task: Task) -> Outcome:
    """Do a run, or continue it from its checkpoint; a failure is an outcome, not an error."""
    began = time.perf_counter()
    folder = Path(task.folder)
    stops = _Stops(folder.parent.parent)
    try:
        while True:
            if found := outcome_in(folder):
                return found
            try:
                figures = _run(task, folder, StopWhen(stops))
                break
            except FolderInUse:  # by a run of the same inputs, or a worker that was given up
                if stops():
                    return Outcome("stopped")
                time.sleep(_PATIENCE)
    except KeyboardInterrupt:
        return Outcome("stopped")
    except (UnstableStep, OSError, ValueError, MemoryError) as error:
        return Outcome("failed", _one_line(error), seconds=time.perf_counter() - began)
    except Exception as error:  # a fault of the library must not end the study either
        # Not in the folder, where no run may have begun.
        beside = folder.with_suffix(".error")
        with contextlib.suppress(OSError):
            write_text(beside, traceback.format_exc())
        reason = f"{type(error).__name__}: {_one_line(error)} (traceback in {beside.name})"
        return Outcome("failed", reason, seconds=time.perf_counter() - began)
    seconds = time.perf_counter() - began
    if figures is None:
        return Outcome("stopped", seconds=seconds)
    return Outcome.done(figures, seconds)


def outcome_in(folder: Path) -> Outcome | None:
    """Return the outcome of a run whose summary has all of its time done, None without one.

    The folder has the name of the run's inputs.
    """
    try:
        figures = json.loads(read_regular(folder / SUMMARY))
        return Outcome.done(figures) if figures["share_done"] >= 1.0 else None
    except (OSError, ValueError, KeyError, TypeError):  # none, or another file
        return None


class _Stops:
    """Whether the study is to stop: somebody has said so, or its process is gone."""

    def __init__(self, study: Path) -> None:
        self._file, self._parent = study / STOP, multiprocessing.parent_process()
        self._looked, self._found = 0.0, False

    def __call__(self) -> bool:
        if time.monotonic() - self._looked > _LOOK_EVERY:
            self._looked = time.monotonic()
            alone = self._parent is not None and not self._parent.is_alive()
            self._found = alone or ABANDONED.is_set() or self._file.exists()
        return self._found


def _run(task: Task, folder: Path, stop: StopWhen) -> Mapping[str, Any] | None:
    """Run to the end and return the values, or None if the run was stopped."""
    folder.mkdir(parents=True, exist_ok=True)
    # The folder is named by the inputs, so a checkpoint there is of this run, though its text may
    # differ in what changes no result, such as the number of threads.
    resume = (folder / CHECKPOINT).exists()
    model = model_of_text(task.model, USED)
    log = RunLog(shown=False, words=model.words)
    with log.library_said(), contextlib.closing(log):
        case, recorder = _begun(model, folder, resume=resume)
        write_text(folder / USED, task.model)
        log.open(folder / LOG)  # the recorder has taken the folder
        case.go(recorder, [stop])
        if case.simulation.state.time < case.duration:
            return None
    figures: dict[str, Any] = json.loads(read_regular(folder / SUMMARY))
    return figures


def _begun(model: Model, folder: Path, *, resume: bool) -> tuple[Case, Recorder]:
    """Return the case and its recorder, from the checkpoint where that can be read."""
    case = model.build()
    options = {**model.run_options(), "progress": False, "also": (USED, LOG)}
    if resume:
        try:
            return case, case.recorder(folder, resume=True, **options)
        except (ValueError, FileNotFoundError) as problem:  # of checkpoint, history or frames
            _log.warning("begun afresh: %s", problem)
            case = model.build()  # the checkpoint may have been read in part
    return case, case.recorder(folder, **options)


def _one_line(error: BaseException) -> str:
    if isinstance(error, ModelFileError):  # its places are in a file that only shellcut has read
        return "; ".join(problem.text for problem in error.problems)
    return "; ".join(str(error).splitlines()) or type(error).__name__
