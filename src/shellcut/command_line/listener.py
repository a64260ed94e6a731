"""Standard output that may be closed early: the command still completes its work.

``shellcut compare ... | head -1`` closes the pipe after the first line. Later lines are dropped;
the files are still written.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stdout, suppress
from typing import Any, TextIO, cast


@contextmanager
def ignore_closed_pipe() -> Iterator[None]:
    """Drop printed text once the pipe behind standard output is closed."""
    output = _Output(sys.stdout)
    with redirect_stdout(cast("TextIO", output)):
        try:
            yield
        finally:
            output.flush()


class _Output:
    """A stream that drops its text once its pipe is closed."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream

    def write(self, text: str) -> int:
        self._tried(self._stream.write, text)
        return len(text)

    def flush(self) -> None:
        self._tried(self._stream.flush)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    def _tried(self, do: Callable[..., object], *what: str) -> None:
        try:
            do(*what)
        except BrokenPipeError:
            # Redirect the file descriptor: the stream still flushes its own lines at exit.
            with suppress(OSError):
                nothing = os.open(os.devnull, os.O_WRONLY)
                os.dup2(nothing, self._stream.fileno())
                os.close(nothing)
