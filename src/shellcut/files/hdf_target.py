"""A file object for HDF5 that hides write failures from it.

If HDF5 cannot write, it can neither continue nor close its file: it raises again on closing, and
the process then ends with a segmentation fault (h5py 3.16, at half of 20 sizes of a full disk). The
file may also be inconsistent. HDF5 therefore writes to this object. Once the system refuses bytes,
the file is restored to its last consistent state, and everything written since then and later is
kept in memory, where HDF5 can read it back; :meth:`HdfTarget.check` raises the error.

A process may also be killed while HDF5 changes its index, which then names what is not in the file
yet. So whatever is overwritten is noted before in a file beside this one, FILE.undo: the size of
the last consistent file, then offset, length and old bytes, again and again. It is there only while
the file is not consistent. Who opens the file again puts the old bytes back; who reads it takes
them instead.
"""

from __future__ import annotations

import io
import os
import struct
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any, Literal

from .whole_file import opened, write_all

_SIZE, _PLACE = struct.Struct("<Q"), struct.Struct("<QQ")


def _replaced(noted: bytes) -> Iterator[tuple[int, bytes]]:
    """Yield the offsets and old bytes that were noted completely."""
    at = _SIZE.size
    while at + _PLACE.size <= len(noted):
        first, n = _PLACE.unpack_from(noted, at)
        at += _PLACE.size + n
        if at <= len(noted):
            yield first, noted[at - n : at]


class HdfTarget(io.RawIOBase):
    """A binary file, created, opened again or read, for ``h5py.File``; close it after that."""

    def __init__(self, path: Path, mode: Literal["w", "r+", "r"]) -> None:
        self._path, self._undo = path, path.with_name(f"{path.name}.undo")
        self._file: Any = path.open("rb") if mode == "r" else opened(path, mode)
        self._noted: Any = None
        self._at = 0
        self._kept = self._file.seek(0, os.SEEK_END)  # size when last consistent
        self._is_read = mode == "r"
        self._replaced: list[tuple[int, bytes]] = []  # overwritten since then: offset, old bytes
        self._in_memory: list[tuple[int, bytes]] = []
        self._failure: OSError | None = None
        self._told = False
        if mode == "w":
            self._undo.unlink(missing_ok=True)
        elif self._undo.exists():
            noted = self._undo.read_bytes()
            if len(noted) >= _SIZE.size:
                (self._kept,) = _SIZE.unpack_from(noted)
                self._replaced = list(_replaced(noted))
            if mode == "r":
                self._in_memory = self._replaced[::-1]  # the oldest bytes count
            else:
                self._restore()
                self._replaced.clear()
                self._undo.unlink()

    def check(self) -> None:
        """Raise if writing has failed."""
        if self._failure is not None:
            self._told = True
            raise OSError(*self._failure.args[:2], str(self._path)) from self._failure

    def keep(self) -> None:
        """Mark the file as consistent now: a later failure restores this state."""
        self.check()
        self._kept = self._file.seek(0, os.SEEK_END)
        self._forget()

    def sync(self) -> None:
        """Wait until everything written is on the disk."""
        os.fsync(self._file.fileno())

    def close(self) -> None:
        """Close the file; raise its failure if it has not been raised yet."""
        if not self.closed:
            super().close()
            self._file.close()
            if not self._is_read and self._failure is None:
                self._forget()
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
                    self._note(self._at, old)
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
            self._restore()
            self._forget()

    def _note(self, first: int, old: bytes) -> None:
        """Note bytes that are overwritten next."""
        self._replaced.append((first, old))
        if self._noted is None:
            if not self._is_in_place():
                return
            self._noted = opened(self._undo, "w")
            write_all(self._noted, _SIZE.pack(self._kept))
        write_all(self._noted, _PLACE.pack(first, len(old)) + old)

    def _is_in_place(self) -> bool:
        """Return whether nobody has moved the file, or its folder, away."""
        with suppress(FileNotFoundError):
            return os.path.samestat(self._path.stat(), os.fstat(self._file.fileno()))
        return False

    def _restore(self) -> None:
        """Restore the last consistent file."""
        for first, old in reversed(self._replaced):
            self._file.seek(first)
            write_all(self._file, old)
        self._file.truncate(self._kept)

    def _forget(self) -> None:
        """Drop what was overwritten: the file is consistent."""
        self._replaced.clear()
        if self._noted is not None:
            self._noted.close()
            self._noted = None
            self._undo.unlink(missing_ok=True)

    def _stored(self, first: int, n: int) -> bytes:
        """Return up to ``n`` bytes from the disk."""
        self._file.seek(first)
        pieces = []
        while n > 0 and (piece := self._file.read(n)):
            pieces.append(piece)
            n -= len(piece)
        return b"".join(pieces)

    def _size(self) -> int:
        if self._is_read:
            return self._kept
        ends = (first + len(data) for first, data in self._in_memory)
        return max(int(self._file.seek(0, os.SEEK_END)), *ends, 0)
