"""Ctrl-C between two steps: the first signal is a request, the second one goes through.

A KeyboardInterrupt in the middle of a step would leave the state half done. Within an
:class:`Interruption` the first SIGINT or SIGTERM is only noted; the run looks at it between steps,
saves what there is to save, and then lets the signal do what it would have done.
"""

from __future__ import annotations

import signal
import threading
from types import FrameType, TracebackType
from typing import Any

_SIGNALS = (signal.SIGINT, signal.SIGTERM)


class Interruption:
    """Hold back the first SIGINT or SIGTERM while its block runs.

    With the first signal the former handlers are back: a second one ends the process at once, if
    that is what they do. Signals that are ignored stay ignored, and outside the main thread, where
    Python takes no signals, nothing is held back.

    Examples
    --------
    >>> with Interruption() as interruption:
    ...     signal.raise_signal(signal.SIGINT)
    ...     print(interruption.requested)
    True
    """

    def __init__(self) -> None:
        self._number: int | None = None
        self._former: dict[signal.Signals, Any] = {}

    @property
    def requested(self) -> bool:
        """Whether a signal has come."""
        return self._number is not None

    @property
    def ends_process(self) -> bool:
        """Whether the signal that was held back, if any, ends the process at once."""
        return self._number is not None and signal.getsignal(self._number) is signal.SIG_DFL

    def deliver(self) -> None:
        """Raise the signal that was held back, if any, after the block.

        SIGINT becomes the usual KeyboardInterrupt, SIGTERM ends the process, unless the program
        handles them in ways of its own.
        """
        number, self._number = self._number, None
        if number is not None:
            signal.raise_signal(number)

    def __enter__(self) -> Interruption:
        if threading.current_thread() is threading.main_thread():
            for one in _SIGNALS:
                handler = signal.getsignal(one)
                # None: installed by other than Python, which could not put it back.
                if handler not in (None, signal.SIG_IGN):
                    self._former[one] = handler
                    signal.signal(one, self._note)
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._give_back()

    def _note(self, number: int, _: FrameType | None) -> None:
        self._number = number
        self._give_back()

    def _give_back(self) -> None:
        for one, handler in self._former.items():
            signal.signal(one, handler)
        self._former = {}
