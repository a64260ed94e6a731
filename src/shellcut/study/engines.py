"""Engines: what carries out the runs of a study, and what each does when a part of it dies.

Every engine takes tasks and yields each with its outcome, in any order. The state of a run is in
its folder, so a task that is lost is simply given out again: its run goes on from its checkpoint.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    Executor,
    Future,
    ThreadPoolExecutor,
    wait,
)
from itertools import islice
from typing import Any, Protocol

from .child_process import ChildDied, run_in_child
from .one_run import Outcome, Task, run_one

MOST_DEATHS = 3
"""Times that the process of a run may die before the run counts as failed."""


class Engine(Protocol):
    """Carries out tasks."""

    jobs: int
    """Runs at a time, as far as it is known; sets the threads of each and the time left."""

    def outcomes(self, tasks: Iterable[Task]) -> Iterator[tuple[Task, Outcome]]:
        """Yield every task with its outcome."""
        ...


class InTurn:
    """One run after the other, in this process."""

    jobs = 1

    def outcomes(self, tasks: Iterable[Task]) -> Iterator[tuple[Task, Outcome]]:
        """Yield every task with its outcome."""
        for task in tasks:
            yield task, run_one(task)


class Processes:
    """Processes of this machine, each the child of a thread that waits for it.

    A process that dies (out of memory, killed) is replaced, and its run goes on.

    Parameters
    ----------
    jobs : int
        Number of processes.
    """

    def __init__(self, jobs: int) -> None:
        self.jobs = jobs

    def outcomes(self, tasks: Iterable[Task]) -> Iterator[tuple[Task, Outcome]]:
        """Yield every task with its outcome."""
        with ThreadPoolExecutor(self.jobs) as threads:
            yield from _through(threads, _in_children, tasks, self.jobs)


class GivenExecutor:
    """An executor of the caller, ``concurrent.futures`` or one that behaves alike.

    Parameters
    ----------
    executor : Executor
        Its workers must see the folder of the study. It is not shut down.
    """

    def __init__(self, executor: Executor) -> None:
        self._executor = executor
        self.jobs = int(getattr(executor, "_max_workers", 1))

    def outcomes(self, tasks: Iterable[Task]) -> Iterator[tuple[Task, Outcome]]:
        """Yield every task with its outcome."""
        return _through(self._executor, run_one, tasks, self.jobs)


def _in_children(task: Task) -> Outcome:
    """Do a run in a child of this process, in the next one if that dies."""
    for _ in range(MOST_DEATHS):
        try:
            return run_in_child(task)
        except ChildDied as death:
            said = str(death)
    return Outcome("failed", f"{said}, {MOST_DEATHS} times")


def _through(
    executor: Executor, work: Callable[[Task], Outcome], tasks: Iterable[Task], jobs: int
) -> Iterator[tuple[Task, Outcome]]:
    """Yield tasks and outcomes; no more tasks are given out than run at a time."""
    rest, given = iter(tasks), dict[Future[Outcome], Task]()
    while True:
        new = list(islice(rest, jobs - len(given)))
        for task in new:
            try:
                given[executor.submit(work, task)] = task
            except BrokenExecutor as error:  # it takes no more
                yield task, _failed(error)
        if not given and not new:
            return
        for future in wait(given, return_when=FIRST_COMPLETED).done:
            try:
                outcome = future.result()
            except Exception as error:
                outcome = _failed(error)
            yield given.pop(future), outcome


def _failed(error: BaseException) -> Outcome:
    """Return the outcome of an error of the executor: its death, its serialisation."""
    if isinstance(error, BrokenExecutor):
        return Outcome("failed", "its process died: killed, or out of memory")
    return Outcome("failed", f"{type(error).__name__}: {error}")


def engine_of(executor: Any, *, default_jobs: int) -> Engine:
    """Return an engine: for a number of processes, an executor, or a Dask client.

    Raises
    ------
    TypeError
        If it is none of these.
    ValueError
        If the number is below one.
    """
    if executor is None:
        executor = default_jobs
    if isinstance(executor, int) and not isinstance(executor, bool):
        if executor < 1:
            raise ValueError(f"a study must have 1 process or more, got {executor}")
        return InTurn() if executor == 1 else Processes(executor)
    if type(executor).__module__.partition(".")[0] == "distributed":
        from .dask_engine import DaskEngine

        return DaskEngine(executor)
    if isinstance(executor, Executor) or hasattr(executor, "submit"):
        return GivenExecutor(executor)
    raise TypeError(
        "executor must be a number of processes, a concurrent.futures executor or a "
        f"dask.distributed client, got {type(executor).__name__}"
    )
