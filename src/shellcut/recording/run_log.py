"""Messages about a run: in ``run.log``, and on the terminal."""

from __future__ import annotations

import logging
import re
import shutil
import sys
import textwrap
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TextIO

from shellcut.files.file_list import FileList
from shellcut.files.whole_file import log_file
from shellcut.results.answers import ending
from shellcut.results.run_results import summary_in
from shellcut.results.verdict import LOGGER as VERDICT


class RunLog:
    """Lines about a run; kept until its folder exists, then written to a file and flushed.

    They are printed, too, if they are to be ``shown``, the end of a run in all its lines if
    ``verbose``; ``words`` returns a line in those of the reader.
    """

    def __init__(
        self, *, shown: bool = True, verbose: bool = False, words: Callable[[str], str] = str
    ) -> None:
        self._shown, self._verbose, self._words = shown, verbose, words
        self._kept: list[str] = []
        self._warned: set[str] = set()  # a file may be read twice
        self.ended: Path | None = None
        """Folder of a run whose end is still to be said."""
        self.folder: Path | None = None
        """Of the file."""
        self._file: TextIO | None = None

    def open(self, path: Path) -> None:
        """Append to a file from now on, starting with the lines kept so far."""
        self._file, self.folder = log_file(path), path.parent
        for line in self._kept:
            self.keep(line)

    def say(self, text: str, *, stream: TextIO | None = None) -> None:
        """Print a line, on standard output by default, and log it; a closed pipe is ignored."""
        self._print(text, stream or sys.stdout)
        self.keep(self._words(text))

    def _print(self, text: str, stream: TextIO) -> None:
        if self._shown:
            with suppress(OSError):  # a closed pipe, or output redirected to a full disk
                lines = self._words(text).splitlines() or [""]
                wrapped = [_wrapped(line) for line in lines] if stream.isatty() else lines
                print("\n".join(wrapped), file=stream, flush=True)

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

    def say_end(self) -> None:
        """Say the end of a run, once; the file has all its lines."""
        folder, self.ended = self.ended, None
        if folder is None:
            return
        try:
            summary = summary_in(folder)
        except (OSError, ValueError) as problem:  # it is gone, or is none
            self.warn(str(problem))
            return
        files = f"in {folder}: {', '.join(sorted(FileList(folder).there()))}"
        self.keep(self._words("\n".join(ending(summary, verbose=True))))
        self._print("\n".join(ending(summary, verbose=self._verbose)), sys.stdout)
        self.say(files)

    def close(self) -> None:
        """Say the end of the run, and close the file."""
        self.say_end()
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


def _wrapped(line: str) -> str:
    """Return a line broken to the width of the terminal, below its second column if it has one."""
    head = re.search(r"^\S.{,15}? {2,}", line)
    width = max(shutil.get_terminal_size().columns, 40)
    indent = "".ljust(head.end() if head else 4)
    return textwrap.fill(line, width, subsequent_indent=indent, break_on_hyphens=False)


class _Said(logging.Handler):
    def __init__(self, log: RunLog) -> None:
        super().__init__(logging.INFO)
        self._log = log

    def emit(self, record: logging.LogRecord) -> None:
        if record.name == VERDICT.name:
            self._log.ended = self._log.folder
        elif record.levelno >= logging.WARNING:
            self._log.warn(record.getMessage())

    def flush(self) -> None:
        # The process may end here.
        self._log.say_end()
