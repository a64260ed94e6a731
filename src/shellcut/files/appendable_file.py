"""A file that grows during a run and can be reopened after an interruption."""

from __future__ import annotations

import os
from pathlib import Path
from types import TracebackType
from typing import Literal, TypeVar

_File = TypeVar("_File", bound="AppendableFile")


class AppendableFile:
    """Common part of a run's writers: create or reopen a file, and close it in any case.

    Parameters
    ----------
    path : str or Path
        The file.
    mode : {"w", "a"}
        ``"w"`` replaces an existing file of an earlier run. ``"a"`` appends to the file of an
        interrupted run, or creates the file if there is none.
    until : float, optional
        Only with ``"a"``: records later than this are dropped first, so that a run resumed from a
        checkpoint writes nothing twice.

    Raises
    ------
    ValueError
        If ``mode`` is neither, or ``until`` is given without an existing file.
    """

    def __init__(
        self, path: str | os.PathLike[str], *, mode: Literal["w", "a"], until: float | None
    ) -> None:
        self.path = Path(path)
        if mode not in ("w", "a"):
            raise ValueError(f"mode must be 'w' or 'a', got {mode!r}")
        if mode == "w" and until is not None:
            raise ValueError("until needs mode 'a'")
        self.appending = mode == "a" and self.path.exists()
        """Whether the file of an interrupted run exists."""

    def sync(self) -> None:
        """Wait until everything written is on the disk, safe from a power cut.

        Raises
        ------
        OSError
            If that fails.
        """
        raise NotImplementedError

    def close(self) -> None:
        """Close the file; a second call does nothing."""
        raise NotImplementedError

    def __enter__(self: _File) -> _File:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()
