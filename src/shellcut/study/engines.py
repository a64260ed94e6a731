"""Engines: what carries out the runs of a study, and what each does when a part of it dies.

Every engine takes tasks and yields each with its outcome, in any order. The state of a run is in
its folder, so a task that is lost is simply given out again: its run goes on from its checkpoint.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
import time
from collections import Counter, deque
from collections.abc import Iterable, Iterator
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    Executor,
    Future,
    ProcessPoolExecutor,
    wait,
)
from contextlib import contextmanager
from itertools import chain, islice
from typing import Any, Protocol

from .child_process import ONE_THREAD
from .one_run import UNDER_WAY, Outcome, Task, run_one

_MOST_DEATHS = 3
"""Times that the process of a run may die before the run counts as failed."""

_LOOK_EVERY = 0.2  # s between two looks whether the last run of an orphan has stopped


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
    """Processes of this machine.

    A process that dies (out of memory, killed) takes the pool with it: the runs that were under
    way are given to a new one.

    Parameters
    ----------
    jobs : int
        Number of processes.
    """

    def __init__(self, jobs: int) -> None:
        self.jobs = jobs

    def outcomes(self, tasks: Iterable[Task]) -> Iterator[tuple[Task, Outcome]]:
        """Yield every task with its outcome."""
        rest, again, deaths = iter(tasks), deque[Task](), Counter[str]()
        while True:
            lost: list[Task] = []
            with _one_thread_each(), self._pool() as pool:
                yield from _through(pool, _first(again, rest), self.jobs, lost)
            if not lost:
                return
            for task in lost:
                deaths[task.key] += 1
                if deaths[task.key] < _MOST_DEATHS:
                    again.append(task)
                else:
                    yield task, Outcome("failed", _died(_MOST_DEATHS))

    def _pool(self) -> ProcessPoolExecutor:
        return ProcessPoolExecutor(
            self.jobs,
            # A forked process would share locks and threads of this one in any state.
            mp_context=multiprocessing.get_context("spawn"),
            initializer=_begin_worker,
        )


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
        rest, lost = iter(tasks), list[Task]()
        yield from _through(self._executor, rest, self.jobs, lost)
        if lost:  # a broken executor takes no more
            for task in chain(lost, rest):
                yield task, Outcome("failed", _died(1))


def _first(again: deque[Task], rest: Iterator[Task]) -> Iterator[Task]:
    """Yield, and take away, the tasks that are given out once more, then the others."""
    while again:
        yield again.popleft()
    # Not "yield from", which would close ``rest`` where this generator is given up.
    for task in rest:  # noqa: UP028
        yield task


def _through(
    executor: Executor, tasks: Iterator[Task], jobs: int, lost: list[Task]
) -> Iterator[tuple[Task, Outcome]]:
    """Yield outcomes until all is done or the executor breaks.

    No more tasks are given out than run at a time: what is ``lost`` then was really under way.
    """
    given: dict[Future[Outcome], Task] = {}
    while True:
        for task in islice(tasks, jobs - len(given)):
            try:
                given[executor.submit(run_one, task)] = task
            except BrokenExecutor:
                lost += [task, *given.values()]
                return
        if not given:
            return
        finished, _ = wait(given, return_when=FIRST_COMPLETED)
        for future in finished:
            task = given.pop(future)
            try:
                outcome = future.result()
            except BrokenExecutor:
                lost += [task, *given.values()]
                return
            except Exception as error:  # of the engine: its own serialisation, say
                outcome = Outcome("failed", f"{type(error).__name__}: {error}")
            yield task, outcome


@contextmanager
def _one_thread_each() -> Iterator[None]:
    """Keep the libraries of new processes from starting threads; a run has those of its model."""
    before = {name: os.environ.get(name) for name in ONE_THREAD}
    os.environ.update(dict.fromkeys(ONE_THREAD, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


def _begin_worker() -> None:
    """Leave Ctrl-C to the study, which stops all runs by its file; end when the study is gone."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_the_study, daemon=True).start()


def _end_with_the_study() -> None:
    """End this process when that of the study has ended, be it killed.

    A process of a pool waits for its next task for ever. A run that is under way stops by itself,
    with a checkpoint.
    """
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        while UNDER_WAY:
            time.sleep(_LOOK_EVERY)
        os._exit(1)


def _died(times: int) -> str:
    often = "" if times == 1 else f" {times} times"
    return f"its process died{often}: killed, or out of memory"


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
