"""Write frames to the result file of a run in a background thread.

Making, packing and writing a frame takes as long as forty steps of a small film, so a separate
thread does it. At most one frame is pending: the next one waits for it, as does a caller who needs
complete files.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor

from shellcut.frame import Frame

from .vtkhdf import VtkHdfWriter


class FrameOutput:
    """Write frames to a result file, which it closes."""

    def __init__(self, file: VtkHdfWriter) -> None:
        self._file = file
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="frames")
        self._writing: Future[None] | None = None
        self.failed = False
        """Whether a frame could not be written."""

    def append(self, make: Callable[[], Frame]) -> None:
        """Start to make and write a frame; raises the error of the previous frame, if any."""
        self.settle()
        self._writing = self._thread.submit(lambda: self._file.append(make()))

    def settle(self) -> None:
        """Wait until all frames are in the file; raises the error of the last frame, if any."""
        writing, self._writing = self._writing, None
        if writing is not None:
            try:
                writing.result()
            except BaseException:
                self.failed = True
                raise

    def sync(self) -> None:
        """Settle, and wait until the result file is on the disk; OSError if that fails."""
        self.settle()
        self._file.sync()

    def check(self) -> None:
        """Raise the error of the last frame, if any, without waiting for a pending one."""
        if self._writing is not None and self._writing.done():
            self.settle()

    def close(self) -> None:
        """Flush pending frames and close the file; a second call does nothing."""
        try:
            self.settle()
        finally:
            self._thread.shutdown()
            self._file.close()
