"""What a command says about a run: on the terminal at once, and in ``run.log``."""

from __future__ import annotations

import logging
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TextIO


class RunLog:
    """Lines of a run, kept until its folder is there and then written to a file, flushed."""

    def __init__(self) -> None:
        self._kept: list[str] = []
        self._file: TextIO | None = None

    @property
    def is_open(self) -> bool:
        """Whether there is a file."""
        return self._file is not None

    def open(self, path: Path) -> None:
        """Append to a file from now on, with what was said before."""
        self._file = path.open("a", encoding="utf-8")
        for line in self._kept:
            self.keep(line)

    def say(self, text: str, *, stream: TextIO | None = None) -> None:
        """Print and keep, on standard output by default."""
        print(text, file=stream or sys.stdout, flush=True)
        self.keep(text)

    def keep(self, text: str) -> None:
        """Write to the file only."""
        if self._file is None:
            self._kept.append(text)
            return
        try:
            self._file.write(text + "\n")
            self._file.flush()
        except OSError:  # a full disk: the log is not worth a run
            pass

    def close(self) -> None:
        """Close the file."""
        if self._file is not None:
            self._file.close()

    @contextmanager
    def library_said(self) -> Iterator[None]:
        """Say what the library warns of: what a reader assumed, turned or left out."""
        logger, handler = logging.getLogger("shellcut"), _Said(self)
        logger.addHandler(handler)
        try:
            yield
        finally:
            logger.removeHandler(handler)


class _Said(logging.Handler):
    def __init__(self, log: RunLog) -> None:
        super().__init__(logging.WARNING)
        self._log = log

    def emit(self, record: logging.LogRecord) -> None:
        self._log.say(record.getMessage(), stream=sys.stderr)
