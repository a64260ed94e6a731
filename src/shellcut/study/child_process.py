"""Runs in a child of this process.

A study on several processes gives each of its threads such a child, and so does a worker that does
other things in its own process. A Dask worker looks a hundred times a second what its task is at,
and answers the network, in threads beside that of the task. A step of a small film calls a dozen
kernels of some microseconds, each of which releases the interpreter's lock, and every other thread
that takes it makes the step wait: runs of 600 quads took a third longer than in a process of their
own. So the worker hands a run to a child and waits for its outcome; the child is kept for the next
run, and ends with the thread that it belongs to.

No pool does this. ``concurrent.futures``, loky and pebble start their processes by
``multiprocessing``, which starts no child of a Dask worker, whose process is a daemon; and where
one process dies, all runs of the first two are lost. Here tasks and outcomes go through the child's
standard streams, whose end tells it that the worker has died.
"""

from __future__ import annotations

import contextlib
import os
import pickle
import subprocess
import sys
import threading
from multiprocessing import spawn
from queue import SimpleQueue
from typing import Any, BinaryIO

from .one_run import ABANDONED, Outcome, Task, run_one

_ONE_THREAD = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
"""Variables that keep libraries from starting threads of their own in every process."""

# Dask has its workers give freed memory back at once. A run takes it again in each of its steps,
# which costs 4 %.
_NOT_FOR_CHILD = "MALLOC_TRIM_THRESHOLD_"

# What anything prints must not come between the outcomes, so these go out by a stream of their own.
# What may have been printed before ends with a line of this text. Modules are found where this
# process finds them. Ctrl-C is left to the study, which stops all runs by its file.
_FROM_HERE = b"shellcut: outcomes from here on"
_BEGIN = (
    "import signal; signal.signal(signal.SIGINT, signal.SIG_IGN); "
    "import os, pickle, sys; outcomes = os.fdopen(os.dup(1), 'wb'); os.dup2(2, 1); "
    f"outcomes.write({_FROM_HERE + bytes([10])!r}); outcomes.flush(); "
    f"sys.path[:] = pickle.load(sys.stdin.buffer); from {__name__} import serve; serve(outcomes)"
)


class ChildDied(RuntimeError):
    """The process of a run has died."""


class _Child:
    """A process that does one run after the other."""

    def __init__(self) -> None:
        environment = {name: v for name, v in os.environ.items() if name != _NOT_FOR_CHILD}
        environment |= dict.fromkeys(_ONE_THREAD, "1")
        self._process: Any = subprocess.Popen(
            [os.fsdecode(spawn.get_executable()), "-c", _BEGIN],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env=environment,
        )
        with contextlib.suppress(OSError):  # it has died: so says the first run
            self._give(sys.path)
        stream: Any = self._process.stdout
        for line in stream:
            if line.rstrip().endswith(_FROM_HERE):
                break

    def lives(self) -> bool:
        return self._process.poll() is None

    def run(self, task: Task) -> Outcome:
        try:
            self._give(task)
            outcome: Outcome = pickle.load(self._process.stdout)
        except (OSError, EOFError, pickle.UnpicklingError):  # the last one of half an outcome
            self.end()
            raise ChildDied("its process died: killed, or out of memory") from None
        except BaseException:
            self.end()
            raise
        return outcome

    def end(self) -> None:
        """Let it end, which it does after its run."""
        with contextlib.suppress(OSError), self._process:
            pass

    __del__ = end

    def _give(self, what: object) -> None:
        self._process.stdin.write(pickle.dumps(what))  # all of it, or nothing
        self._process.stdin.flush()


_of_thread = threading.local()


def run_in_child(task: Task) -> Outcome:
    """Do a run as :func:`run_one` does, in the child of this thread, a new one if it has none."""
    child: _Child | None = getattr(_of_thread, "child", None)
    if child is None or not child.lives():
        child = _of_thread.child = _Child()
    return child.run(task)


def serve(outcomes: BinaryIO) -> None:
    """Do the runs that come through the standard input, until that is closed: be such a child."""
    tasks: SimpleQueue[Task | None] = SimpleQueue()
    threading.Thread(target=_receive, args=[tasks], daemon=True).start()
    with contextlib.suppress(BrokenPipeError), outcomes:
        while (task := tasks.get()) is not None:
            pickle.dump(run_one(task), outcomes)
            outcomes.flush()


def _receive(tasks: SimpleQueue[Task | None]) -> None:
    """Pass tasks on; when there are no more, a run that is under way must stop."""
    try:
        while True:
            tasks.put(pickle.load(sys.stdin.buffer))
    except (EOFError, OSError):  # there are none
        pass
    finally:  # nor if one cannot be read
        ABANDONED.set()
        tasks.put(None)
