"""Ctrl-C between two steps: the first signal asks the run to stop, the second one kills it.

A KeyboardInterrupt in the middle of a step would leave the state half updated. Inside an
:class:`Interruption` the first SIGINT or SIGTERM is only recorded; the run checks it between steps,
saves its results and then raises the signal again.
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable
from types import FrameType
from typing import Any

_SIGNALS = (signal.SIGINT, signal.SIGTERM)


class Interruption:
    """Hold back the first SIGINT or SIGTERM while its block runs.

    The first signal puts the previous handlers back, so a second one usually ends the process at
    once. Ignored signals stay ignored; outside the main thread, where Python handles no signals,
    nothing is held back. ``asked`` is called when the first one comes, between two bytecodes of
    whatever runs then.
    """

    def __init__(self, asked: Callable[[], None] | None = None) -> None:
        self._asked = asked
        self._number: int | None = None
        self._former: dict[signal.Signals, Any] = {}

    @property
    def requested(self) -> bool:
        """Whether a signal has arrived."""
        return self._number is not None

    @property
    def ends_process(self) -> bool:
        """Whether the signal held back, if any, would end the process at once."""
        return self._number is not None and signal.getsignal(self._number) is signal.SIG_DFL

    def deliver(self) -> None:
        """Raise the signal held back, if any; call it after the block.

        SIGINT becomes the usual KeyboardInterrupt, SIGTERM ends the process, unless the program
        has its own handlers.
        """
        number, self._number = self._number, None
        if number is not None:
            signal.raise_signal(number)

    def __enter__(self) -> Interruption:
        if threading.current_thread() is threading.main_thread():
            for one in _SIGNALS:
                handler = signal.getsignal(one)
                # None: not installed from Python, which therefore cannot restore it.
                if handler not in (None, signal.SIG_IGN):
                    self._former[one] = handler
                    signal.signal(one, self._note)
        return self

    def __exit__(self, *_: object) -> None:
        self._restore_handlers()

    def _note(self, number: int, _: FrameType | None) -> None:
        self._number = number
        self._restore_handlers()
        if self._asked is not None:
            self._asked()

    def _restore_handlers(self) -> None:
        for one, handler in self._former.items():
            signal.signal(one, handler)
        self._former = {}
