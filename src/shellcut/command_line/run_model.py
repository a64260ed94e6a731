"""Run a model into a folder, with messages on its progress and outcome."""

from __future__ import annotations

import errno
import time
import traceback
from contextlib import closing
from pathlib import Path
from typing import Any

from shellcut.checks import RefusedModel
from shellcut.files.distribution import VERSION
from shellcut.files.folder_lock import refuse_if_in_use
from shellcut.files.run_folder import CHECKPOINT, LOG, USED
from shellcut.model_file import Model, ModelFileError, read_model
from shellcut.model_file.model import digest_of, is_as_written
from shellcut.models import Case
from shellcut.models.warmup import warmup
from shellcut.numerics.jit import on_compilation
from shellcut.recording.recorder import Recorder, RunEnded
from shellcut.recording.resistance import resistance_of
from shellcut.recording.run_log import RunLog
from shellcut.recording.status_line import start_lines
from shellcut.signals import INTERRUPTED
from shellcut.simulation.instability import UnstableStep

from .shared import BAD_INPUT, DONE, FAILED, STOPPED, refused

_NO_SPACE = {errno.ENOSPC, errno.EFBIG, getattr(errno, "EDQUOT", errno.ENOSPC)}

_BETWEEN_LINES = 3.0
"""Shortest time between two lines on compilation [s]."""


def run_model(
    model: Model,
    folder: Path,
    log: RunLog,
    *,
    resume: bool = False,
    overwrite: bool = False,
    force: bool = False,
) -> int:
    """Build the model, run it into the folder, and return the exit code.

    Nothing in the folder is changed before the model has been built. ``resume`` continues the run
    there, ``overwrite`` says whether it may be removed, ``force`` runs a model that a check
    refuses, where that can make sense.
    """
    options: dict[str, Any] = {"resume": resume, "replace": overwrite, "force": force}
    with log.library_said(), closing(log):
        try:
            if resume:
                log.say(f"resuming {folder}")
            ready = _ready(model, folder, log, options)
            return ready if isinstance(ready, int) else _run(*ready, log)
        except KeyboardInterrupt:
            log.warn("interrupted; nothing was run")
            return INTERRUPTED


def _ready(
    model: Model, folder: Path, log: RunLog, options: dict[str, Any]
) -> tuple[Case, Recorder] | int:
    """Return a case and the recorder of its run, which locks the folder and has its files open.

    Or the exit code if it cannot run.
    """
    try:
        case, lines = built(model, log, options)
    except (ModelFileError, RefusedModel, OSError) as problem:  # other errors are bugs
        log.warn(refused(problem))
        return BAD_INPUT
    try:
        options["log"] = log.keep
        recorder = case.recorder(folder, also=(USED, LOG), **model.run_options(), **options)
        try:
            if not options["resume"]:
                model.write(folder / USED)
            log.open(folder / LOG)
            digest = digest_of(folder / USED)
            log.keep(f"shellcut {VERSION}, {USED} with sha256 {digest}")
            for line in lines:
                log.say(line)
        except BaseException:
            recorder.give_up()
            raise
        return case, recorder
    except RunEnded as ended:
        log.warn(f"{ended}; nothing was changed")
        log.ended = folder
        return DONE
    except (OSError, ValueError) as problem:
        log.warn(refused(problem))
        return BAD_INPUT


def built(model: Model, log: RunLog, options: dict[str, Any]) -> tuple[Case, list[str]]:
    """Build, check and compile the model; return it with lines on its contents."""
    began: list[float] = []
    said = time.perf_counter()

    def compiling() -> None:
        began.append(time.perf_counter())
        log.say("compiling (first run only) ...")

    def progress(n: int, n_all: int) -> None:
        nonlocal said
        if time.perf_counter() - said > _BETWEEN_LINES:
            said = time.perf_counter()
            log.say(f"compiling {n} of {n_all} kernels ...")

    with on_compilation(compiling):
        warmup([model.head.model], told=progress)
        case = model.build()
        if not options["resume"]:
            case.check.enforce(force=options["force"])
        sim = case.simulation
        resistance = resistance_of(sim, case.duration)
        lines = list(start_lines(sim, resistance, case.duration, case.check.sweep))
    if began:
        log.say(f"compiled in {time.perf_counter() - began[0]:.0f} s")
    return case, lines


def _run(case: Case, recorder: Recorder, log: RunLog) -> int:
    """Run to the end; print the outcome, or why the run stopped and what to do."""
    folder = recorder.folder
    try:
        case.go(recorder)
        log.ended = folder
    except UnstableStep as problem:
        log.warn(f"stopped: {problem}")
        log.warn(f"the output up to this step is in {folder}")
        return STOPPED
    except KeyboardInterrupt:
        log.warn(case.interrupted(recorder))
        return INTERRUPTED
    except Exception as problem:
        if not isinstance(problem, OSError):  # unlike a full disk, this needs a traceback
            log.warn(traceback.format_exc().rstrip())
        log.warn(f"failed at {recorder.place()}: {problem}")
        full = isinstance(problem, OSError) and problem.errno in _NO_SPACE
        then = " run it again with --overwrite: there is no checkpoint to resume from"
        if (folder / CHECKPOINT).exists():
            then = f": shellcut resume {folder}"
        log.warn(f"{'free space' if full else 'remove the cause'}, then{then}")
        return FAILED
    return DONE


def stored_model(folder: Path) -> Model:
    """Return the model in the folder of a run.

    Raises
    ------
    OSError
        If there is no folder or no model in it, if the model or a file that it reads has been
        changed since the run began, or if the run is still active.
    """
    used = folder / USED
    if not folder.is_dir():
        raise FileNotFoundError(f"{folder}: there is no such folder")
    if not used.is_file():
        raise FileNotFoundError(f"{folder} holds no {USED}: it is not a folder of shellcut run")
    refuse_if_in_use(folder)
    model = read_model(used)
    wrong = []
    if not is_as_written(used.read_text(encoding="utf-8")):
        wrong.append(f"{used} has been changed")
    wrong += [f"{path} is gone or has been changed" for path in model.changed_files()]
    if wrong:
        raise OSError(
            "\n".join(f"{text} since the run began" for text in wrong)
            + "\nput it back, or run the model again into another folder"
        )
    return model
