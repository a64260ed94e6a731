"""Ctrl-C where it does no harm: between two steps, and not while code is loaded.

A KeyboardInterrupt in the middle of a step would leave the state half updated. Inside an
:class:`Interruption` the first SIGINT or SIGTERM is only recorded; the run checks it between steps,
saves its results and then raises the signal again.

While Python imports modules, and while Numba and LLVM load or compile a kernel, much of what runs
is called from C: by ctypes, or when an object is deleted. Python drops an exception that is raised
there: the interrupt is lost, and LLVM may be left with half a module. :class:`SignalsDeferred`
keeps the signals until that is done. What is dropped elsewhere :class:`RaisedAgain` raises again.

This module is the first that the package imports, so it imports little itself.
"""

from __future__ import annotations

import _thread
import os
import signal
import sys
import threading

TYPE_CHECKING = False  # of typing, which is slow to import
if TYPE_CHECKING:
    from collections.abc import Callable
    from types import FrameType
    from typing import Any

_SIGNALS = (signal.SIGINT, signal.SIGTERM)

INTERRUPTED = 130
"""Exit code of the command after Ctrl-C, as a shell reports a process that SIGINT has ended."""

# Time after which an interrupt that was dropped is raised again [s]: what dropped it has returned.
_AGAIN_AFTER = 0.02


def in_main_thread() -> bool:
    """Return whether this is the thread in which Python handles signals."""
    return threading.current_thread() is threading.main_thread()


class Interruption:
    """Defer the first SIGINT or SIGTERM while its block runs.

    The first signal puts the previous handlers back, so a second one usually ends the process at
    once. Ignored signals stay ignored; outside the main thread, where Python handles no signals,
    nothing is deferred. ``asked`` is called at the first signal, between two bytecodes of
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
        """Whether the deferred signal, if any, would end the process at once."""
        return self._number is not None and signal.getsignal(self._number) is signal.SIG_DFL

    def deliver(self) -> None:
        """Raise the deferred signal, if any; call it after the block.

        SIGINT becomes the usual KeyboardInterrupt, SIGTERM ends the process, unless the program
        has its own handlers.
        """
        number, self._number = self._number, None
        if number is not None:
            signal.raise_signal(number)

    def __enter__(self) -> Interruption:
        if in_main_thread():
            for number in _SIGNALS:
                handler = signal.getsignal(number)
                # None: not installed from Python, which therefore cannot restore it.
                if handler not in (None, signal.SIG_IGN):
                    self._former[number] = handler
                    signal.signal(number, self._note)
        return self

    def __exit__(self, *_: object) -> None:
        self._restore_handlers()

    def _note(self, number: int, _: FrameType | None) -> None:
        self._number = number
        self._restore_handlers()
        if self._asked is not None:
            self._asked()

    def _restore_handlers(self) -> None:
        for number, handler in self._former.items():
            signal.signal(number, handler)
        self._former = {}


class SignalsDeferred:
    """Defer SIGINT and SIGTERM while its block runs; raise the last one that arrived after it.

    Only where a handler of Python's answers them, as by KeyboardInterrupt: it may raise anything. A
    signal that ends the process at once, or is ignored, does so here too. Outside the main thread
    there is nothing to defer. Blocks may be nested.
    """

    def __init__(self) -> None:
        self._arrived: list[int] = []
        self._former: list[tuple[signal.Signals, Any]] = []

    def __enter__(self) -> None:
        if in_main_thread():
            for number in _SIGNALS:
                handler = signal.getsignal(number)
                if callable(handler):
                    self._former.append((number, handler))
                    signal.signal(number, self._note)

    def __exit__(self, *_: object) -> None:
        for number, handler in self._former:
            signal.signal(number, handler)
        if self._arrived:
            signal.raise_signal(self._arrived[-1])

    def _note(self, number: int, _: FrameType | None) -> None:
        self._arrived.append(number)


class Importing(SignalsDeferred):
    """Defer signals while the package is imported, in the command until :func:`answer_deferred`.

    The command answers in its own words and by its exit code, where a script gets a traceback.
    """

    def __exit__(self, *_: object) -> None:
        if is_command():
            _deferred_by_command.append(self)
        else:
            super().__exit__()


_deferred_by_command: list[SignalsDeferred] = []


def answer_deferred() -> None:
    """Raise what the command has deferred since its start, and defer nothing any more."""
    while _deferred_by_command:
        SignalsDeferred.__exit__(_deferred_by_command.pop())


class RaisedAgain:
    """Raise a KeyboardInterrupt again that Python drops while its block runs.

    Where an exception cannot be handed on, as from ``__del__``, Python only reports it.
    """

    def __enter__(self) -> None:
        self._former, sys.unraisablehook = sys.unraisablehook, self._again

    def __exit__(self, *_: object) -> None:
        sys.unraisablehook = self._former

    def _again(self, dropped: Any) -> None:
        if not issubclass(dropped.exc_type, KeyboardInterrupt):
            self._former(dropped)
            return
        timer = threading.Timer(_AGAIN_AFTER, _interrupt_main_thread)
        timer.daemon = True
        timer.start()


def _interrupt_main_thread() -> None:
    """Send SIGINT to the main thread; on Windows it finds out when it next runs Python."""
    if hasattr(signal, "pthread_kill"):
        signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGINT)
    else:
        _thread.interrupt_main()


def is_of_interrupt(problem: BaseException | None) -> bool:
    """Return whether an error occurred while a KeyboardInterrupt was answered, or is one.

    A library written in C that an interrupt has left half done may fail when it is tidied up.
    """
    while problem is not None and not isinstance(problem, KeyboardInterrupt):
        problem = problem.__cause__ or problem.__context__
    return problem is not None


def is_command() -> bool:
    """Return whether this process is the ``shellcut`` command: the script, or ``-m shellcut``."""
    program = sys.argv[0] if sys.argv else ""
    if program == "-m":  # while Python imports what it is to run
        return "shellcut" in (name.removeprefix("-m") for name in sys.orig_argv)
    folder, name = os.path.split(program)
    if name == "__main__.py":
        name = os.path.basename(folder)
    return os.path.splitext(name)[0] == "shellcut"


def ignore_ctrl_c() -> None:
    """Ignore SIGINT from here on in the process of the command, which has nothing left to do."""
    if is_command() and in_main_thread():
        signal.signal(signal.SIGINT, signal.SIG_IGN)
