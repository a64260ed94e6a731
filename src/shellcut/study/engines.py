"""Engines: what carries out the runs of a study, and what each does when a part of it dies.

An engine gives tasks to an executor, of ``concurrent.futures`` or of Dask, and yields each with its
outcome, in any order. The state of a run is in its folder, so a task that is lost is simply given
out again: its run goes on from its checkpoint.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import (
    BrokenExecutor,
    CancelledError,
    Executor,
    Future,
    ThreadPoolExecutor,
)
from dataclasses import dataclass
from itertools import islice
from queue import SimpleQueue
from typing import TYPE_CHECKING, Any, TypeAlias

from shellcut.child_process import Child, ChildDied
from shellcut.numerics.threads import available_cores

from .one_run import Outcome, Task, run_one

if TYPE_CHECKING:
    from distributed import Client

AnyExecutor: TypeAlias = "int | Executor | Client | None"
"""What carries out runs: so many processes, an executor or a Dask client; None: one a core."""

Say: TypeAlias = Callable[[str], None] | None
"""Takes the lines about progress; None: they go to standard error."""

MOST_DEATHS = 3
"""Times that the process of a run may die before the run counts as failed."""


@dataclass(frozen=True)
class Engine:
    """Carries out tasks."""

    executor: Executor
    """Or what behaves alike. Its workers must see the folder of the study. It is not shut down."""
    work: Callable[[Task], Outcome]
    """Does a task there."""
    jobs: int
    """Runs at a time, as far as it is known; sets the threads of each and the time left."""
    ahead: int | None
    """Tasks given out at a time; None for all: workers that come later then have some, too."""

    def outcomes(self, tasks: Iterable[Task]) -> Iterator[tuple[Task, Outcome]]:
        """Yield every task with its outcome.

        Raises ConnectionError if the executor gives up its tasks, as Dask does when its scheduler
        is lost.
        """
        rest, given = iter(tasks), dict[Future[Outcome], Task]()
        ended: SimpleQueue[Future[Outcome]] = SimpleQueue()
        while True:
            new = list(islice(rest, None if self.ahead is None else self.ahead - len(given)))
            for task in new:
                try:
                    future = self.executor.submit(self.work, task)
                except BrokenExecutor as error:  # it takes no more
                    yield task, _failed(error)
                    continue
                given[future] = task
                future.add_done_callback(ended.put)
            if not given:
                if not new:
                    return
                continue
            future = ended.get()
            try:
                outcome = future.result()
            except CancelledError:
                raise ConnectionError(
                    "the executor has given up its runs: start it again, or Dask's scheduler, and "
                    "call the study again, what is done is kept"
                ) from None
            except Exception as error:
                outcome = _failed(error)
            yield given.pop(future), outcome


class _Here(Executor):
    """Does a task when it is given, in this process."""

    def submit(self, work: Callable[..., Any], /, *given: Any, **options: Any) -> Future[Any]:
        done: Future[Any] = Future()
        done.set_result(work(*given, **options))
        return done


_of_thread = threading.local()


def run_in_child(task: Task) -> Outcome:
    """Do a run as :func:`.run_one` does, in the child of this thread, a new one if it has none.

    A worker of Dask looks a hundred times a second what its task is at, and answers the network, in
    threads beside that of the task: runs of 600 quads took a third longer than in a child, which is
    kept for the next run. Raises ChildDied.
    """
    child: Child | None = getattr(_of_thread, "child", None)
    if child is None or not child.lives():
        child = _of_thread.child = Child()
    child.begin(run_one, task)
    outcome: Outcome = child.result()
    return outcome


def _in_children(task: Task) -> Outcome:
    """Do a run in a child of this process, in the next one if that dies."""
    for _ in range(MOST_DEATHS):
        try:
            return run_in_child(task)
        except ChildDied as death:
            said = str(death)
    return Outcome("failed", f"{said}, {MOST_DEATHS} times")


def _failed(error: BaseException) -> Outcome:
    """Return the outcome of an error of the executor: its death, its serialisation."""
    if isinstance(error, BrokenExecutor):
        return Outcome("failed", "its process died: killed, or out of memory")
    return Outcome("failed", f"{type(error).__name__}: {error}")


def engine_of(executor: Any) -> Engine:
    """Return an engine for a number of processes (one a core), an executor, or a Dask client."""
    if executor is None:
        executor = available_cores()
    if isinstance(executor, int) and not isinstance(executor, bool):
        if executor < 1:
            raise ValueError(f"a study must have 1 process or more, got {executor}")
        if executor == 1:
            return Engine(_Here(), run_one, jobs=1, ahead=1)
        return Engine(ThreadPoolExecutor(executor), _in_children, executor, executor)
    if type(executor).__module__.partition(".")[0] == "distributed":
        jobs = max(1, sum(executor.nthreads().values()))
        return Engine(executor.get_executor(pure=False), _in_children, jobs, None)
    if isinstance(executor, Executor) or hasattr(executor, "submit"):
        jobs = int(getattr(executor, "_max_workers", 1))
        return Engine(executor, run_one, jobs, jobs)
    raise TypeError(
        "executor must be a number of processes, a concurrent.futures executor or a "
        f"dask.distributed client, got {type(executor).__name__}"
    )
