"""Messages about a run: in ``run.log``, and on the terminal."""

from __future__ import annotations

import logging
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TextIO

from shellcut.files.whole_file import log_file
from shellcut.results.verdict import LOGGER as VERDICT


class RunLog:
    """Lines about a run; kept until its folder exists, then written to a file and flushed.

    They are printed, too, if they are to be ``shown``; ``words`` returns a line in those of the
    reader.
    """

    def __init__(self, *, shown: bool = True, words: Callable[[str], str] = str) -> None:
        self._shown, self._words = shown, words
        self._kept: list[str] = []
        self._warned: set[str] = set()  # a file may be read twice
        self.verdict: list[str] = []
        """Its lines so far, which are printed last."""
        self._file: TextIO | None = None

    def open(self, path: Path) -> None:
        """Append to a file from now on, starting with the lines kept so far."""
        self._file = log_file(path)
        for line in self._kept:
            self.keep(line)

    def say(self, text: str, *, stream: TextIO | None = None) -> None:
        """Print a line, on standard output by default, and log it; a closed pipe is ignored."""
        text = self._words(text)
        if self._shown:
            with suppress(OSError):  # a closed pipe, or output redirected to a full disk
                print(text, file=stream or sys.stdout, flush=True)
        self.keep(text)

    def warn(self, text: str) -> None:
        """Say a line on standard error, once."""
        if text not in self._warned:
            self._warned.add(text)
            self.say(text, stream=sys.stderr)

    def keep(self, text: str) -> None:
        """Write to the file only."""
        if self._file is None:
            self._kept.append(text)
            return
        with suppress(OSError):  # a full disk must not stop the run here
            self._file.write(text + "\n")
            self._file.flush()

    def say_verdict(self) -> None:
        """Print the verdict, once."""
        lines, self.verdict = self.verdict, []
        if lines:
            self.say("\n".join(["how far the results can be trusted:", *lines]))

    def close(self) -> None:
        """Print the verdict, and close the file."""
        self.say_verdict()
        if self._file is not None:
            with suppress(OSError):  # a pending write failed
                self._file.close()

    @contextmanager
    def library_said(self) -> Iterator[None]:
        """Say the library's warnings, such as a reader's assumptions and omissions, each once."""
        logger, handler = logging.getLogger("shellcut"), _Said(self)
        propagate, logger.propagate = logger.propagate, logger.propagate and self._shown
        logger.addHandler(handler)
        try:
            yield
        finally:
            logger.propagate = propagate
            logger.removeHandler(handler)


class _Said(logging.Handler):
    def __init__(self, log: RunLog) -> None:
        super().__init__(logging.INFO)
        self._log = log

    def emit(self, record: logging.LogRecord) -> None:
        if record.name == VERDICT.name:
            self._log.verdict.append(record.getMessage())
        elif record.levelno >= logging.WARNING:
            self._log.warn(record.getMessage())

    def flush(self) -> None:
        # The process may end here.
        self._log.say_verdict()
