"""The only place that says ``numba.njit``: option sets, each with its reason.

``error_model="numpy"``
    A division by zero gives inf or nan, as NumPy does, instead of a branch and an exception in
    every kernel; lengths that may vanish are guarded by a documented branch.
``fastmath={"contract"}``
    Lets a multiplication and an addition become one fused instruction. Nothing is reassociated
    and nan stays nan, so results do not depend on how a loop was vectorised and the divergence
    guard keeps working.
``nogil=True``
    Kernels touch no Python object, so two threads may run them side by side
    (:mod:`shellcut.numerics.threads`).
``cache=True``
    Compile once a machine. A cached caller does not see an edit in a kernel it imports, hence
    the tests key ``NUMBA_CACHE_DIR`` by a hash of the sources.

Kernels do not call kernels: the machine code of a cached kernel has a copy of its callees, which
may differ from the callees' own in the last bit. A process that has compiled both runs one, a
process that has found the caller in the cache the other; a function inlined into both has no such
freedom.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, ParamSpec, TypeVar

import numba as nb
from numba.core import event

from .kernel_tables import check_tables

P = ParamSpec("P")
R = TypeVar("R")

# Calls of a bound kernel whose arguments' types are looked at, where they are: the first and every
# so many later ones, because finding the types takes longer than most of the kernels.
_CHECKED_FIRST, _CHECKED_EVERY = 3, 1000

_OPTIONS: dict[str, Any] = {"error_model": "numpy", "fastmath": {"contract"}}


def kernel(function: Callable[P, R]) -> Callable[P, R]:
    """Compile a loop over entities; called from Python, arrays and numbers only."""
    compiled: Callable[P, R] = nb.njit(cache=True, nogil=True, **_OPTIONS)(function)
    return compiled


def bound(function: Callable[..., Any], *arguments: object) -> Callable[..., Any]:
    """Return a kernel's machine code for arguments of just these types, compiled if need be.

    Which variant of a kernel is meant is found out at every call, and with tuples among the
    arguments this takes longer than handing them over: 1.5 µs hot, several amid a step. Whoever
    calls it thousands of times a second with the same types asks once. Others would be misread.
    """
    if not hasattr(function, "compile"):
        return function
    types = tuple(nb.typeof(a) for a in arguments)  # type: ignore[no-untyped-call]
    code: Callable[..., Any] = function.compile(types)
    return code


def bound_once(function: Callable[..., R]) -> Callable[..., R]:
    """Return a kernel :func:`bound` to the types of its first call, the same at every call.

    For a caller whose arrays are replaced but keep their types: binding takes 0.6 ms. Tables among
    the arguments of the first call are looked through (:mod:`shellcut.numerics.kernel_tables`).
    Arguments of other types would be misread; with SHELLCUT_CHECK_TYPES in the environment, as in
    the tests, they are refused, looked for in the first calls and in every so many later ones.
    """
    code: Callable[..., R] | None = None

    def call(*arguments: object) -> R:
        nonlocal code
        if code is None:
            check_tables(arguments)
            code = bound(function, *arguments)
        return code(*arguments)

    return _checked(call) if "SHELLCUT_CHECK_TYPES" in os.environ else call


def _checked(call: Callable[..., R]) -> Callable[..., R]:
    """Return ``call`` with the types of its arguments compared with those of its first call."""
    first: tuple[Any, ...] = ()
    count = 0

    def checked(*arguments: object) -> R:
        nonlocal first, count
        if count < _CHECKED_FIRST or count % _CHECKED_EVERY == 0:
            found = tuple(nb.typeof(a) for a in arguments)  # type: ignore[no-untyped-call]
            first = first or found
            if found != first:
                differing = [f"{a} after {b}" for a, b in zip(found, first, strict=True) if a != b]
                raise TypeError(f"a bound kernel was given other types: {', '.join(differing)}")
        count += 1
        return call(*arguments)

    return checked


def inline(function: Callable[P, R]) -> Callable[P, R]:
    """Compile scalar arithmetic that only kernels call; LLVM may inline it into them.

    Not cached by itself: it is part of the kernels that are.
    """
    compiled: Callable[P, R] = nb.njit(**_OPTIONS)(function)
    return compiled


def always_inline(function: Callable[P, R]) -> Callable[P, R]:
    """Compile arithmetic on many numbers at once, which a call would send through memory.

    Of a quad's mechanics sixteen strains and as many resultants are alive at a time; left to
    itself LLVM calls such functions, and passing the numbers costs as much as the arithmetic.
    """
    compiled: Callable[P, R] = nb.njit(forceinline=True, **_OPTIONS)(function)
    return compiled


class _Once(event.Listener):
    def __init__(self, call: Callable[[], None]) -> None:
        self._call: Callable[[], None] | None = call

    def on_start(self, event: Any) -> None:
        if self._call is not None:
            call, self._call = self._call, None
            call()

    def on_end(self, event: Any) -> None:
        pass


@contextmanager
def on_compilation(call: Callable[[], None]) -> Iterator[None]:
    """Call a function when the first kernel is compiled within the block; not if all are cached.

    Numba tells of compilations only, not of kernels that it loads from the cache.
    """
    with event.install_listener("numba:compile", _Once(call)):
        yield
