"""A file object for HDF5 that hides write failures from it.

If HDF5 cannot write, it can neither continue nor close its file: it raises again on closing, and
the process then ends with a segmentation fault (h5py 3.16, at half of 20 sizes of a full disk). The
file may also be inconsistent. HDF5 therefore writes to this object. Once the system refuses bytes,
the file is restored to its last consistent state, and everything written since then and later is
kept in memory, where HDF5 can read it back; :meth:`HdfTarget.check` raises the error.
"""

from __future__ import annotations

import io
import os
from contextlib import suppress
from pathlib import Path
from typing import Any, Literal

from .whole_file import opened, write_all


class HdfTarget(io.RawIOBase):
    """A binary file, created or opened again, to pass to ``h5py.File``; close it after that."""

    def __init__(self, path: Path, mode: Literal["w", "r+"]) -> None:
        self._path = path
        self._file: Any = opened(path, mode)
        self._at = 0
        self._kept = self._file.seek(0, os.SEEK_END)  # size when last consistent
        self._replaced: list[tuple[int, bytes]] = []  # overwritten since then: offset, old bytes
        self._in_memory: list[tuple[int, bytes]] = []
        self._failure: OSError | None = None
        self._told = False

    def check(self) -> None:
        """Raise if writing has failed."""
        if self._failure is not None:
            self._told = True
            raise OSError(*self._failure.args[:2], str(self._path)) from self._failure

    def keep(self) -> None:
        """Mark the file as consistent now: a later failure restores this state."""
        self.check()
        self._kept = self._file.seek(0, os.SEEK_END)
        self._replaced.clear()

    def sync(self) -> None:
        """Wait until everything written is on the disk."""
        os.fsync(self._file.fileno())

    def close(self) -> None:
        """Close the file; raise its failure if it has not been raised yet."""
        if not self.closed:
            super().close()
            self._file.close()
            if not self._told:
                self.check()

    # ------------------------------------------------------------------ called by h5py

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """Go to an offset [bytes]; return it."""
        if whence == os.SEEK_CUR:
            offset += self._at
        elif whence == os.SEEK_END:
            offset += self._size()
        self._at = offset
        return offset

    def tell(self) -> int:
        """Return the offset [bytes]."""
        return self._at

    def readinto(self, buffer: Any) -> int:
        """Read what is there, from disk or memory."""
        target = memoryview(buffer).cast("B")
        end = min(self._at + len(target), self._size())
        n = max(end - self._at, 0)
        stored = self._stored(self._at, n)
        target[:n] = stored + bytes(n - len(stored))
        for first, data in self._in_memory:
            low, high = max(first, self._at), min(first + len(data), end)
            if low < high:
                target[low - self._at : high - self._at] = data[low - first : high - first]
        self._at += n
        return n

    def write(self, data: Any) -> int:
        """Write all bytes, to disk or memory."""
        view = memoryview(data).cast("B")
        if self._failure is None:
            try:
                if self._at < self._kept:
                    old = self._stored(self._at, min(len(view), self._kept - self._at))
                    self._replaced.append((self._at, old))
                self._file.seek(self._at)
                write_all(self._file, view)
            except OSError as failure:
                self._put_back(failure)
        if self._failure is not None:
            self._in_memory.append((self._at, bytes(view)))
        self._at += len(view)
        return len(view)

    def truncate(self, size: int | None = None) -> int:
        """Shorten or extend the file [bytes], unless it has failed."""
        size = self._at if size is None else size
        if self._failure is None:
            try:
                self._file.truncate(size)
                self._kept = min(self._kept, size)
            except OSError as failure:
                self._put_back(failure)
        return size

    def flush(self) -> None:
        """Do nothing: each write is passed to the system at once."""

    # ------------------------------------------------------------------ parts

    def _put_back(self, failure: OSError) -> None:
        """Restore the last consistent file; keep HDF5's newer bytes in memory."""
        self._failure = failure
        with suppress(OSError):
            now = [(first, self._stored(first, len(old))) for first, old in self._replaced]
            end = self._file.seek(0, os.SEEK_END)
            now.append((self._kept, self._stored(self._kept, end - self._kept)))
            self._in_memory = now
            for first, old in reversed(self._replaced):
                self._file.seek(first)
                write_all(self._file, old)
            self._file.truncate(self._kept)

    def _stored(self, first: int, n: int) -> bytes:
        """Return up to ``n`` bytes from the disk."""
        self._file.seek(first)
        pieces = []
        while n > 0 and (piece := self._file.read(n)):
            pieces.append(piece)
            n -= len(piece)
        return b"".join(pieces)

    def _size(self) -> int:
        ends = (first + len(data) for first, data in self._in_memory)
        return max(int(self._file.seek(0, os.SEEK_END)), *ends, 0)
