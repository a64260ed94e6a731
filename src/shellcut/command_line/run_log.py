"""Messages of a command about its run: on the terminal, and in ``run.log``."""

from __future__ import annotations

import logging
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TextIO

from shellcut.files.whole_file import log_file
from shellcut.results.verdict import LOGGER as VERDICT


class RunLog:
    """Lines about a run; kept until its folder exists, then written to a file and flushed."""

    def __init__(self) -> None:
        self._kept: list[str] = []
        self._verdict: list[str] = []
        self._file: TextIO | None = None

    def open(self, path: Path) -> None:
        """Append to a file from now on, starting with the lines kept so far."""
        self._file = log_file(path)
        for line in self._kept:
            self.keep(line)

    def say(self, text: str, *, stream: TextIO | None = None) -> None:
        """Print a line, on standard output by default, and log it; a closed pipe is ignored."""
        with suppress(OSError):  # a closed pipe, or output redirected to a full disk
            print(text, file=stream or sys.stdout, flush=True)
        self.keep(text)

    def keep(self, text: str) -> None:
        """Write to the file only."""
        if self._file is None:
            self._kept.append(text)
            return
        with suppress(OSError):  # a full disk must not stop the run here
            self._file.write(text + "\n")
            self._file.flush()

    def keep_for_last(self, line: str) -> None:
        """Keep a line of the verdict, which is printed last."""
        self._verdict.append(line)

    def say_verdict(self) -> None:
        """Print the verdict, once."""
        lines, self._verdict = self._verdict, []
        if lines:
            self.say("\n".join(["how far the results can be trusted:", *lines]))

    @property
    def has_verdict(self) -> bool:
        """Whether there is a verdict to print."""
        return bool(self._verdict)

    def close(self) -> None:
        """Close the file."""
        if self._file is not None:
            with suppress(OSError):  # a pending write failed
                self._file.close()

    @contextmanager
    def library_said(self) -> Iterator[None]:
        """Print the library's warnings, such as a reader's assumptions and omissions."""
        logger, handler = logging.getLogger("shellcut"), _Said(self)
        logger.addHandler(handler)
        try:
            yield
        finally:
            logger.removeHandler(handler)


class _Said(logging.Handler):
    def __init__(self, log: RunLog) -> None:
        super().__init__(logging.INFO)
        self._log = log

    def emit(self, record: logging.LogRecord) -> None:
        if record.name == VERDICT.name:
            self._log.keep_for_last(record.getMessage())
        elif record.levelno >= logging.WARNING:
            self._log.say(record.getMessage(), stream=sys.stderr)

    def flush(self) -> None:
        # The process may end here.
        self._log.say_verdict()
