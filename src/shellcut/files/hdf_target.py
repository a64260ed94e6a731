"""A file object for HDF5 that hides write failures from it.

If HDF5 cannot write, it can neither continue nor close its file: it raises again on closing, and
the process then ends with a segmentation fault (h5py 3.16, at half of 20 sizes of a full disk). The
file may also be inconsistent. HDF5 therefore writes to this object, which keeps what it writes in
memory until the file is consistent, and writes it then (:meth:`HdfTarget.keep`). If the system
refuses bytes, the file is restored to its last consistent state, and :meth:`HdfTarget.check` raises
the error. What is in memory stays there, and so does what comes later: HDF5 can read it back.

A process may also be killed within such a write: HDF5 has changed its index, which then names what
is not in the file yet. So all that is overwritten is noted before in a file beside this one,
FILE.undo: the size of the last consistent file, then offset, length and old bytes, again and again.
It is there only while the file is not consistent. Who opens the file again puts the old bytes back;
who reads it takes them instead.
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


def _part(first: int, n: int, size: int, is_new: bool) -> tuple[int, int]:
    """Return which bytes of a piece lie beyond a size, or before it."""
    split = min(max(size - first, 0), n)
    return (split, n) if is_new else (0, split)


class HdfTarget(io.RawIOBase):
    """A binary file, created, opened again or read, for ``h5py.File``; close it after that."""

    def __init__(self, path: Path, mode: Literal["w", "r+", "r"]) -> None:
        self._path, self._undo = path, path.with_name(f"{path.name}.undo")
        self._file: Any = path.open("rb") if mode == "r" else opened(path, mode)
        self._at = 0
        self._kept = self._file.seek(0, os.SEEK_END)  # size when last consistent
        self._size = self._kept  # with what is in memory
        self._in_memory: list[tuple[int, bytes]] = []
        self._failure: OSError | None = None
        self._is_raised = mode == "r"  # there is nothing to write, and no failure to raise
        if mode == "w":
            self._undo.unlink(missing_ok=True)
        elif self._undo.exists():
            noted = self._undo.read_bytes()
            if len(noted) >= _SIZE.size:
                (self._size,) = _SIZE.unpack_from(noted)
                self._in_memory = list(_replaced(noted))
            if mode == "r+":
                self._put(self._in_memory, self._size)
                self._in_memory, self._kept = [], self._size
                self._undo.unlink()

    def check(self) -> None:
        """Raise if writing has failed."""
        if self._failure is not None:
            self._is_raised = True
            raise OSError(*self._failure.args[:2], str(self._path)) from self._failure

    def keep(self) -> None:
        """Write what has come, which makes a consistent file; raises OSError if it cannot."""
        if self._failure is None and (self._in_memory or self._size != self._kept):
            spans = [(first, first + len(data)) for first, data in self._in_memory]
            spans.append((self._size, self._kept))  # of a file that gets shorter
            old = [
                (first, self._stored(first, min(end, self._kept) - first)) for first, end in spans
            ]
            # What is new comes first: the index names nothing that is not in the file.
            pieces = [
                (first + begin, data[begin:end])
                for is_new in (True, False)
                for first, data in self._in_memory
                for begin, end in [_part(first, len(data), self._kept, is_new)]
                if begin < end
            ]
            try:
                self._note(old)
                self._put(pieces, self._size)
            except OSError as failure:
                self._failure = failure
                with suppress(OSError):
                    self._put(old, self._kept)
                    self._undo.unlink(missing_ok=True)
            else:
                self._in_memory, self._kept = [], self._size
                self._undo.unlink(missing_ok=True)
        self.check()

    def sync(self) -> None:
        """Wait until everything written is on the disk."""
        os.fsync(self._file.fileno())

    def close(self) -> None:
        """Write what is in memory and close the file; raise a failure that has not been raised."""
        if not self.closed:
            super().close()
            try:
                if not self._is_raised:
                    self.keep()
            finally:
                self._file.close()

    # ------------------------------------------------------------------ called by h5py

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """Go to an offset [bytes]; return it."""
        if whence == os.SEEK_CUR:
            offset += self._at
        elif whence == os.SEEK_END:
            offset += self._size
        self._at = offset
        return offset

    def tell(self) -> int:
        """Return the offset [bytes]."""
        return self._at

    def readinto(self, buffer: Any) -> int:
        """Read what is there, from disk or memory."""
        target = memoryview(buffer).cast("B")
        end = min(self._at + len(target), self._size)
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
        """Take all bytes, into memory."""
        taken = bytes(memoryview(data).cast("B"))
        self._in_memory.append((self._at, taken))
        self._at += len(taken)
        self._size = max(self._size, self._at)
        return len(taken)

    def truncate(self, size: int | None = None) -> int:
        """Shorten or extend the file [bytes]."""
        self._size = self._at if size is None else size
        return self._size

    def flush(self) -> None:
        """Do nothing: the file is written when it is consistent."""

    # ------------------------------------------------------------------ parts

    def _note(self, old: list[tuple[int, bytes]]) -> None:
        """Note bytes that are overwritten next, unless file or folder have been moved away."""
        with suppress(FileNotFoundError):
            if os.path.samestat(self._path.stat(), os.fstat(self._file.fileno())):
                pieces = (_PLACE.pack(first, len(data)) + data for first, data in old if data)
                with opened(self._undo, "w") as undo:
                    write_all(undo, b"".join((_SIZE.pack(self._kept), *pieces)))

    def _put(self, pieces: list[tuple[int, bytes]], size: int) -> None:
        """Write pieces to the disk, and set the size of the file [bytes]."""
        for first, data in pieces:
            self._file.seek(first)
            write_all(self._file, data)
        self._file.truncate(size)

    def _stored(self, first: int, n: int) -> bytes:
        """Return up to ``n`` bytes from the disk."""
        self._file.seek(first)
        pieces = []
        while n > 0 and (piece := self._file.read(n)):
            pieces.append(piece)
            n -= len(piece)
        return b"".join(pieces)
