"""A file that grows during a run, and may be gone on with after an interruption."""

from __future__ import annotations

import os
from pathlib import Path
from types import TracebackType
from typing import Literal, TypeVar

_File = TypeVar("_File", bound="GrowingFile")


class GrowingFile:
    """What the writers of a run share: begin anew or go on, and close however it ends.

    Parameters
    ----------
    path : str or Path
        The file.
    mode : {"w", "a"}
        ``"w"`` replaces an existing file: a run owns its output folder and overwrites what an
        earlier run left there. ``"a"`` goes on with the file of an interrupted run; without a file
        it begins one.
    until : float, optional
        Only with ``"a"``: what is later than this is dropped first, so that a run that restarts
        from a checkpoint writes nothing twice.

    Raises
    ------
    ValueError
        If ``mode`` is neither, or ``until`` is given without a file to go on with.
    """

    def __init__(
        self, path: str | os.PathLike[str], *, mode: Literal["w", "a"], until: float | None
    ) -> None:
        self.path = Path(path)
        if mode not in ("w", "a"):
            raise ValueError(f"mode must be 'w' or 'a', got {mode!r}")
        if mode == "w" and until is not None:
            raise ValueError("until needs mode 'a'")
        self.goes_on = mode == "a" and self.path.exists()
        """Whether there is an interrupted run's file to go on with."""

    def sync(self) -> None:
        """Wait until all that was written is on the disk, where a power cut does not reach it.

        Raises
        ------
        OSError
            If it cannot be.
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
