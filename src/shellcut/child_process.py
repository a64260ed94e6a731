"""A child of this process that does calls one after the other, in the background.

A step of a small film calls a dozen kernels of some microseconds, each of which releases the
interpreter's lock. Every other thread that takes it makes the step wait, up to 5 ms at a time. So
what is done beside a run, and a run beside other things, has a process of its own.

No pool does this. ``concurrent.futures``, loky and pebble start their processes by
``multiprocessing``, which starts no child of a Dask worker, whose process is a daemon; and where
one process dies, all calls of the first two are lost. Here calls and results go through the child's
standard streams, whose end tells it that this process has died.
"""

from __future__ import annotations

import contextlib
import os
import pickle
import subprocess
import sys
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from multiprocessing import spawn
from queue import SimpleQueue
from typing import Any, BinaryIO

_ONE_THREAD = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
"""Variables that keep libraries from starting threads of their own in every process."""

# Dask has its workers give freed memory back at once. A run takes it again in each of its steps,
# which costs 4 %.
_NOT_FOR_CHILD = "MALLOC_TRIM_THRESHOLD_"

# What anything prints must not come between the results, so these go out by a stream of their own.
# What may have been printed before ends with a line of this text. Modules are found where this
# process finds them. Ctrl-C is left to this process.
_FROM_HERE = b"shellcut: results from here on"
_BEGIN = (
    "import signal; signal.signal(signal.SIGINT, signal.SIG_IGN); "
    "import os, pickle, sys; results = os.fdopen(os.dup(1), 'wb'); os.dup2(2, 1); "
    f"results.write({_FROM_HERE + bytes([10])!r}); results.flush(); "
    f"sys.path[:] = pickle.load(sys.stdin.buffer); from {__name__} import serve; serve(results)"
)

ABANDONED = threading.Event()
"""Set in a child when the process that gives it its calls has ended."""


class ChildDied(RuntimeError):
    """The process of a call has died."""


class Child:
    """A process that does one call after the other.

    It ends when this object is deleted, after the call that it is doing.

    Raises
    ------
    OSError
        If no process can be started, as by a frozen program, which has no interpreter.
    """

    _process: Any = None

    def __init__(self) -> None:
        if getattr(sys, "frozen", False):
            raise OSError("a frozen program must not be started again, as an interpreter")
        environment = {name: v for name, v in os.environ.items() if name != _NOT_FOR_CHILD}
        environment |= dict.fromkeys(_ONE_THREAD, "1")
        self._process = subprocess.Popen(
            [os.fsdecode(spawn.get_executable()), "-c", _BEGIN],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env=environment,
        )
        self._is_heard, self._parent = False, os.getpid()
        # A child that is starting, or busy, does not read what is larger than the pipe.
        self._giving = ThreadPoolExecutor(1, thread_name_prefix="calls")
        self._giving.submit(self._give, pickle.dumps(sys.path))

    def lives(self) -> bool:
        """Whether the process has not ended; in a fork of the process that started it, False."""
        return self._parent == os.getpid() and self._process.poll() is None

    def begin(self, function: Callable[..., Any], *arguments: Any) -> None:
        """Give it a call that can be pickled; calls are done one after the other."""
        self._giving.submit(self._give, pickle.dumps((function, arguments)))

    def result(self) -> Any:
        """Wait for the call given first whose result has not been taken, and return it.

        Raises
        ------
        ChildDied
            If the process has died.
        Exception
            That of the call.
        """
        try:
            self._skip_what_was_printed()
            is_well, value = pickle.load(self._process.stdout)
        except (OSError, EOFError, pickle.UnpicklingError):  # the last one of half a result
            self.end()
            raise ChildDied("its process died: killed, or out of memory") from None
        except BaseException:
            self.end()
            raise
        if not is_well:
            raise value
        return value

    def end(self) -> None:
        """Let it end, which it does after the call that it is doing."""
        self._giving.shutdown()
        with contextlib.suppress(OSError), self._process:
            pass

    def __del__(self) -> None:
        if self._process is not None and self._parent == os.getpid():
            self.end()

    def _give(self, what: bytes) -> None:
        with contextlib.suppress(OSError):  # it has died: so says `result`
            self._process.stdin.write(what)
            self._process.stdin.flush()

    def _skip_what_was_printed(self) -> None:
        while not self._is_heard:
            line = self._process.stdout.readline()
            self._is_heard = line.rstrip().endswith(_FROM_HERE) or not line


def serve(results: BinaryIO) -> None:
    """Do the calls that come through the standard input, until that is closed: be such a child."""
    calls: SimpleQueue[Any] = SimpleQueue()
    threading.Thread(target=_receive, args=[calls], daemon=True).start()
    with contextlib.suppress(BrokenPipeError), results:
        while (call := calls.get()) is not None and not ABANDONED.is_set():
            function, arguments = call
            try:
                answer = True, function(*arguments)
            except Exception as error:
                answer = False, error
            results.write(pickle.dumps(answer))
            results.flush()


def _receive(calls: SimpleQueue[Any]) -> None:
    """Pass calls on; when there are no more, the one that is being done must stop."""
    try:
        while True:
            calls.put(pickle.load(sys.stdin.buffer))
    except (EOFError, OSError):  # there are none
        pass
    finally:  # nor if one cannot be read
        ABANDONED.set()
        calls.put(None)
