"""A study: carry out the runs of a plan that are not done yet, and keep their table."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from shellcut.files.file_list import claim, folder_named
from shellcut.files.folder_lock import FolderLock
from shellcut.files.whole_file import exclusive
from shellcut.model_file.key_index import with_values
from shellcut.model_file.model import model_text
from shellcut.model_file.reader import ModelVariants
from shellcut.models.warmup import warmup
from shellcut.results.summary_figures import key_figures
from shellcut.signals import Interruption
from shellcut.view.progress import duration

from .engines import AnyExecutor, Engine, Say, engine_of
from .factors import Design
from .one_run import STOP, Outcome, Task, outcome_in
from .plan import FEW_FILES, STUDY, Definition, Plan, PlannedRun, planned_runs, write_study
from .report.studied import of_interest
from .table import TABLE, CommonWindow, columns_of, write_table

_TABLE_EVERY = 10.0
"""Wall time between two tables during a study [s]."""


@dataclass(frozen=True)
class StudyResults:
    """What a study has found so far.

    Examples
    --------
    >>> found = sweep("opening", {"motion.pitch": [12, 20]}, "pitches")  # doctest: +SKIP
    >>> found.count("done"), found.table.name  # doctest: +SKIP
    (2, 'table.csv')
    """

    folder: Path
    """Of the study."""
    plan: Plan
    """Its runs with their inputs."""
    outcomes: Mapping[int, Outcome]
    """By the number of the run; means are over the steady window that all runs have in common,
    or :data:`.NOT_COMMON` says why not."""

    @property
    def table(self) -> Path:
        """The table as CSV."""
        return self.folder / TABLE

    @property
    def rows(self) -> list[dict[str, Any]]:
        """Inputs and values of the runs that are done, by name, in the order of the design."""
        _, figures = columns_of(self.plan, self.outcomes)
        return [
            {**run.values, **{n: one.figures[n] for n in figures if n in one.figures}}
            for run in self.plan.runs
            if (one := self.outcomes.get(run.number)) is not None and one.status == "done"
        ]

    def count(self, status: str) -> int:
        """Return the number of runs with a status: done, failed or stopped."""
        return sum(one.status == status for one in self.outcomes.values())


def sweep(
    model: str | os.PathLike[str],
    factors: Mapping[str, object],
    out: str | os.PathLike[str],
    *,
    settings: Mapping[str, object] | None = None,
    design: Design | None = None,
    executor: AnyExecutor = None,
    say: Say = None,
) -> StudyResults:
    """Run a model with many values, and write the table of inputs and values.

    Runs that are done are found by the hash of their inputs and not repeated; one that was
    interrupted continues from its checkpoint; one that failed is tried again at the next call.

    Parameters
    ----------
    model : str or path
        Model file, or name of a shipped model.
    factors : mapping from str to values
        By key, as of :func:`read_model`: a list, a text like ``"40,60,80"``, or a range like
        ``"10:20"`` or ``"1 mm : 2 mm"``, for designs other than a grid. Values of several keys
        that go together: ``{"tool.edge_inclination_deg, motion.pitch": [(40, 12), (60, 20)]}``. One
        value that is a list is written in another: ``{"r_values": [[1.2, 1.0, 1.1]]}``.
    out : str or path
        Folder of the study; each run has a folder in it.
    settings : mapping, optional
        Keys with one value for all runs.
    design : Design, optional
        Every combination by default.
    executor : int, Executor or distributed.Client, optional
        Number of processes, by default one a core; or what carries out tasks. Its workers must see
        the folder. Threads are shared out so that the cores are not oversubscribed.
    say : callable, optional
        Takes the lines about progress; by default they go to standard error.

    Returns
    -------
    StudyResults

    Raises
    ------
    ModelFileError
        With all that is wrong with the model or a value, or if no combination can be run, before
        anything runs.
    ValueError
        If factors and design do not fit together.
    FolderInUse
        If another study runs in the folder.
    FileExistsError
        If ``study.toml`` or another file of the study in the folder is somebody else's.
    ConnectionError
        If the executor gives up its runs, as Dask does when its scheduler is lost.
    KeyboardInterrupt
        After Ctrl-C, when all runs have stopped with a checkpoint.

    Examples
    --------
    >>> found = sweep(
    ...     "opening",
    ...     {"motion.pitch": [12, 20]},
    ...     "pitches",
    ...     settings={"mesh": "quick"},
    ... )  # doctest: +SKIP
    >>> [row["torque_plateau_Nmm"] for row in found.rows]  # doctest: +SKIP
    [139.8, 146.1]
    """
    folder = folder_named(out)
    given = {**FEW_FILES, **(settings or {})}
    planned = Definition(str(model), factors, given, design or Design()).plan()
    return run_study(planned, folder, engine_of(executor), say)


def run_study(planned: Plan, folder: Path, engine: Engine, say: Say = None) -> StudyResults:
    """Carry out the runs of a plan that are not done yet; see :func:`sweep`."""
    with taken(folder, [STUDY, TABLE]):
        write_study(folder / STUDY, planned)
        common = CommonWindow(lambda number: planned.runs[number].folder(folder))
        found, progress = _carried_out(
            planned, folder, engine, say, lambda found: write_table(folder, planned, common(found))
        )
        progress.end(found)
    return StudyResults(folder, planned, common(found))


@contextmanager
def taken(folder: Path, files: Sequence[str]) -> Iterator[None]:
    """Lock the folder of a study, and claim the files that it writes there; see :func:`sweep`."""
    folder.mkdir(parents=True, exist_ok=True)
    with closing(FolderLock(folder)):
        claim(folder, [*files, STOP])
        yield


def run_values(
    variants: ModelVariants,
    several: Sequence[Mapping[str, object]],
    folder: Path,
    engine: Engine,
    say: Say,
) -> list[tuple[PlannedRun, Outcome]]:
    """Carry out the runs of some sets of values, or find them done; return each with its outcome.

    The folder is locked by the caller. A run that was not begun counts as stopped.
    """
    plan = Plan(variants, tuple(planned_runs(variants, several)))
    found, _ = _carried_out(plan, folder, engine, say, lambda _: None)
    return [(run, found.get(run.number, Outcome("stopped"))) for run in plan.runs]


def done_before(planned: Plan, folder: Path) -> dict[int, Outcome]:
    """Return the outcomes of the runs that are done in a folder, by their numbers."""
    each = ((run.number, outcome_in(run.folder(folder))) for run in planned.runs)
    return {number: outcome for number, outcome in each if outcome}


def _carried_out(
    planned: Plan,
    folder: Path,
    engine: Engine,
    say: Say,
    keep: Callable[[Mapping[int, Outcome]], object],
) -> tuple[dict[int, Outcome], _Progress]:
    """Give the runs of a plan that are not done to the engine; return the outcomes of all.

    Takes them to ``keep`` at the beginning, now and then, and at the end. The first Ctrl-C or
    SIGTERM stops all runs at their next step, with a checkpoint, and acts when they have stopped.
    """
    found = done_before(planned, folder)
    progress = _Progress(planned, len(found), engine.jobs, say)
    keep(found)
    open_ = [run for run in planned.runs if run.number not in found]
    if not open_:
        return found, progress
    if engine.jobs > 1:  # compile together, before many processes wait for one another
        some = planned.runs[:: max(1, len(planned.runs) // 8)]
        warmup({planned.variants.read(run.values, try_out=False).head.model for run in some})
    (folder / STOP).unlink(missing_ok=True)  # of a study that was killed while it stopped

    def stop() -> None:
        with suppress(FileExistsError), open(folder / STOP, "wb", opener=exclusive):
            pass
        progress.say("stopping: the present runs keep their checkpoints ...")

    written = time.monotonic()
    with Interruption(stop) as interruption:
        for task, outcome in engine.outcomes(_tasks(planned, open_, folder, engine.jobs)):
            found[task.number] = outcome
            progress.ended(task.number, outcome, len(found))
            if time.monotonic() - written > _TABLE_EVERY:
                keep(found)
                written = time.monotonic()
    keep(found)
    (folder / STOP).unlink(missing_ok=True)
    interruption.deliver()
    return found, progress


def _tasks(planned: Plan, runs: list[PlannedRun], folder: Path, jobs: int) -> Iterator[Task]:
    """Yield the tasks of runs until the study is to stop."""
    for run in runs:
        if (folder / STOP).exists():
            return
        text = model_text(planned.model_of(run, jobs))
        yield Task(run.number, str(run.folder(folder).resolve()), text)


class _Progress:
    """Says when a run ends; ``say`` takes a line, which goes to standard error by default."""

    def __init__(self, plan: Plan, n_done: int, jobs: int, say: Say) -> None:
        self._plan, self._n_run = plan, len(plan.runs)
        self._began, self._done_before = time.monotonic(), n_done
        self.say = say or _to_standard_error
        """Says a line."""
        at_a_time = "one after the other" if jobs == 1 else f"{jobs} at a time"
        self.say(f"{self._n_run} runs, {n_done} of them done before; {at_a_time}")

    def ended(self, number: int, outcome: Outcome, n_ended: int) -> None:
        """Say how a run ended."""
        values = with_values(self._plan.runs[number].values)
        said = f"{outcome.status}: {outcome.reason}" if outcome.reason else outcome.status
        if outcome.status == "done":
            chosen, _ = of_interest((), outcome.figures)
            figures = key_figures(outcome.figures, chosen[:1])
            said = f"{outcome.seconds:.1f} s" + "".join(f", {name} {v}" for name, v in figures)
            if n := len(outcome.doubts):
                said += f", distrusted by {n} check" + ("s" if n > 1 else "")
        left, new = self._n_run - n_ended, n_ended - self._done_before
        if left > 0 and new > 0:
            said += f"; {duration((time.monotonic() - self._began) / new * left)} left"
        self.say(f"[{n_ended}/{self._n_run}] {values or 'as given'}: {said}")

    def end(self, outcomes: Mapping[int, Outcome]) -> None:
        """Say how the study ended."""
        ended = [one.status for one in outcomes.values()]
        counts = ((ended.count(status), status) for status in ("done", "failed", "stopped"))
        said = ", ".join(f"{n} {status}" for n, status in counts if n)
        if n := sum(bool(one.doubts) for one in outcomes.values()):
            said += f", {n} distrusted (see {TABLE})"
        self.say(f"{said}, in {duration(time.monotonic() - self._began)}")


def _to_standard_error(line: str) -> None:
    with suppress(OSError):  # a closed pipe
        print(line, file=sys.stderr, flush=True)
