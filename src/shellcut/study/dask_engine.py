"""Runs of a study on the workers of a Dask cluster, local or remote.

Dask gives the task of a dead worker to another one by itself. It does not bring back a scheduler:
if that is lost, its futures are lost with it. The engine then waits for a scheduler at the same
address, and gives it the tasks that are not done. A worker that still is at a run keeps the lock of
its folder, and the new one waits for that. Each worker has a child process that does its runs: in
one process they would disturb each other, as :mod:`.child_process` says.
"""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator
from concurrent.futures import CancelledError
from contextlib import ExitStack, contextmanager, suppress
from typing import Any

from distributed import Client, KilledWorker, LocalCluster, as_completed

from .child_process import ChildDied, run_in_child
from .engines import MOST_DEATHS
from .one_run import Outcome, Task

_PATIENCE = 300.0
"""Wall time for which to wait for a lost scheduler [s]."""


@contextmanager
def cluster_at(address: str, n_worker: int) -> Iterator[Client]:
    """Give a client of the scheduler at an address, or of a cluster begun here for ``local``.

    Raises
    ------
    ConnectionError
        If there is no scheduler.
    """
    with ExitStack() as close:
        where: Any = address
        if address == "local":
            cluster = LocalCluster(n_workers=n_worker, threads_per_worker=1, dashboard_address=None)
            where = close.enter_context(cluster)
        try:
            client = close.enter_context(Client(where, timeout=10.0))
        except (OSError, TimeoutError, ValueError) as problem:
            said = f"{type(problem).__name__}: {problem}"
            raise ConnectionError(f"there is no Dask scheduler at {address}: {said}") from None
        yield client


class DaskEngine:
    """The workers of a ``dask.distributed`` client; they must see the folder of the study.

    Parameters
    ----------
    client : distributed.Client
        It is not closed. If its scheduler is lost, the study goes on with a client of its own,
        which is.
    """

    def __init__(self, client: Any) -> None:
        self._client = self._given = client
        self._address = client.scheduler.address
        self.jobs = max(1, sum(client.nthreads().values()))

    def outcomes(self, tasks: Iterable[Task]) -> Iterator[tuple[Task, Outcome]]:
        """Yield every task with its outcome.

        Raises
        ------
        ConnectionError
            If the scheduler is lost and does not come back.
        """
        waiting = {task.key: task for task in tasks}
        try:
            while waiting:
                for task, outcome in self._round(list(waiting.values())):
                    del waiting[task.key]
                    yield task, outcome
                if waiting:
                    self._connect_again()
        finally:
            self._close_own()

    def _round(self, tasks: list[Task]) -> Iterator[tuple[Task, Outcome]]:
        """Yield the outcomes that the present scheduler lives to see."""
        try:
            given = {
                self._client.submit(
                    run_in_child,
                    task,
                    key=f"shellcut-{task.key}",
                    retries=MOST_DEATHS - 1,
                    pure=False,
                ): task
                for task in tasks
            }
        except (OSError, RuntimeError, CancelledError):  # the scheduler has gone meanwhile
            return
        for future in as_completed(given):
            task = given.pop(future)
            try:
                outcome = future.result()
            except (KilledWorker, ChildDied):
                yield task, Outcome("failed", "its processes died: killed, or out of memory")
                continue
            except (CancelledError, OSError, TimeoutError):
                if self._client.status == "running" and not future.cancelled():
                    raise
                continue
            except Exception as error:  # the engine's own: its serialisation, say
                outcome = Outcome("failed", f"{type(error).__name__}: {error}")
            yield task, outcome

    def _connect_again(self) -> None:
        """Wait for a scheduler at the address of the lost one."""
        self._close_own()
        end = time.monotonic() + _PATIENCE
        while True:
            try:
                self._client = Client(self._address, timeout=5.0, set_as_default=False)
                return
            except (OSError, TimeoutError) as problem:
                if time.monotonic() > end:
                    raise ConnectionError(
                        f"the Dask scheduler at {self._address} must come back within "
                        f"{_PATIENCE:.0f} s: start it again and call the study again, what is done "
                        "is kept"
                    ) from problem
                time.sleep(1.0)

    def _close_own(self) -> None:
        """Close a client that was made here; one whose scheduler is lost may say so."""
        if self._client is not self._given:
            with suppress(OSError, TimeoutError, CancelledError):
                self._client.close(timeout=5.0)
            self._client = self._given
