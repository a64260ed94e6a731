"""The only place that calls ``numba.njit``: sets of options, with reasons.

``error_model="numpy"``
    A division by zero gives inf or nan, as NumPy does, instead of a branch and an exception in
    every kernel; lengths that may vanish are guarded by documented branches.
``fastmath={"contract"}``
    Allows fused multiply-add. Nothing is reassociated and nan stays nan, so results do not depend
    on vectorisation and the divergence guard works.
``nogil=True``
    Kernels use no Python objects, so threads may run them in parallel
    (:mod:`shellcut.numerics.threads`).
``forceinline=False``
    Said, because Numba gives what is not said to a function from the one that is compiled with a
    call of it: machine code would depend on which of its callers came first.

Kernels are compiled once per machine (:mod:`shellcut.numerics.kernel_cache`).

Kernels do not call kernels: the machine code of a cached kernel contains a copy of its callees,
which may differ in the last bit from the callees compiled by themselves. A process that compiled
both runs one version, a process that loaded the caller from the cache the other. With inlined
functions this cannot happen.
"""

from __future__ import annotations

import functools
import gc
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, Generic, ParamSpec, TypeVar, cast

import numba as nb
from numba.core import event, types
from numba.extending import register_jitable

from shellcut.signals import SignalsDeferred

from .inlined_code import InlinedCompiler, KernelCompiler
from .kernel_cache import KernelCache
from .kernel_tables import check_tables

P = ParamSpec("P")
R = TypeVar("R")

if nb.config.DISABLE_JIT:  # type: ignore[attr-defined]
    raise ImportError("kernels are for Numba's compiler: unset NUMBA_DISABLE_JIT")

# Nobody calls these functions from C: without Numba's wrapper for that they compile faster.
_OPTIONS: dict[str, Any] = {
    "error_model": "numpy",
    "fastmath": {"contract"},
    "forceinline": False,
    "no_cfunc_wrapper": True,
}
# Without Numba's wrapper for calls from Python, too, and compiled as part of the kernel only.
_WITHIN_KERNELS: dict[str, Any] = {
    "no_cpython_wrapper": True,
    "pipeline_class": InlinedCompiler,
    **_OPTIONS,
}
ALWAYS_INLINED: Any = {**_WITHIN_KERNELS, "forceinline": True}
"""Options of :func:`always_inline`, for ``overload``."""


def kernel(function: Callable[P, R]) -> Callable[P, R]:
    """Compile a loop over entities; called from Python with arrays and numbers only."""
    compiled: Any = nb.njit(nogil=True, pipeline_class=KernelCompiler, **_OPTIONS)(function)
    compiled._cache = KernelCache(function)
    compiled.compile = _in_one_process(compiled, compiled.compile)
    return cast("Callable[P, R]", compiled)


def _in_one_process(compiled: Any, compile_: Callable[..., Any]) -> Callable[..., Any]:
    """Wrap a compilation so that one process compiles a kernel, and the others load it."""

    def compile_alone(types: object, wait: bool = True) -> Any:
        if compiled.overloads.get(types) is not None:
            return compile_(types)
        with compiled._cache.alone(wait=wait) as is_alone, SignalsDeferred(), _uncollected():
            return compile_(types) if is_alone else None

    return compile_alone


def _undisturbed(compile_: Callable[..., Any]) -> Callable[..., Any]:
    """Wrap a compilation so that signals wait for its end."""

    def compile_undisturbed(types: object) -> Any:
        with SignalsDeferred():
            return compile_(types)

    return compile_undisturbed


@contextmanager
def _uncollected() -> Iterator[None]:
    """Keep Python from looking for garbage while a kernel is compiled.

    Numba makes objects by the million and keeps most of them until then. The collector would go
    through them again and again: a fifth of the time.
    """
    was_on = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_on:
            gc.enable()


def compile_if_free(kernel: Any, types: tuple[Any, ...]) -> bool:
    """Compile a kernel for types of its arguments, or load it, unless another process is at it."""
    return kernel.compile(types, wait=False) is not None


def is_stored(kernel: Any, types: tuple[Any, ...]) -> bool:
    """Return whether it is of no use to compile a kernel beforehand."""
    cache: KernelCache = kernel._cache
    return not cache.can_store or cache.has(types)


def bound(kernel: Any, *arguments: object) -> Callable[..., Any]:
    """Return a kernel's machine code for arguments of exactly these types, compiled if needed.

    Every call of a kernel selects the compiled variant, and with tuples among the arguments this
    takes longer than passing them: 1.5 µs hot, several within a step. A caller with thousands of
    calls per second and fixed types selects it once. Arguments of other types would be misread.
    """
    types = tuple(nb.typeof(a) for a in arguments)  # type: ignore[no-untyped-call]
    code: Callable[..., Any] = kernel.compile(types)
    return code


class BoundOnce(Generic[R]):
    """A kernel :func:`bound` to the types of its first call, the same at every call.

    For a caller whose arrays are replaced but keep their types: binding takes 0.6 ms. Tables among
    the arguments of the first call are checked (:mod:`shellcut.numerics.kernel_tables`). Arguments
    of other types would be misread: the tests refuse them (``tests/conftest.py``).
    """

    __slots__ = ("code",)

    code: Callable[..., R]
    """Machine code from the second call on, for callers in every step: a Python frame less."""

    def __init__(self, function: Callable[..., R]) -> None:
        def bind(*arguments: object) -> R:
            check_tables(arguments)
            self.code = bound(function, *arguments)
            return self.code(*arguments)

        self.code = bind

    def __call__(self, *arguments: object) -> R:
        """Call the kernel."""
        call = self.code
        return call(*arguments)


def inline(function: Callable[P, R]) -> Callable[P, R]:
    """Compile scalar arithmetic that only kernels call; LLVM may inline it into them.

    Not cached by itself: it is part of cached kernels. They take a second version, compiled as part
    of each kernel; the first is compiled if Python calls it.
    """
    compiled: Any = nb.njit(**_OPTIONS)(function)

    @functools.cache
    def within() -> Any:
        return nb.njit(**_WITHIN_KERNELS)(function)

    compiled.get_call_template = lambda *kinds: within().get_call_template(*kinds)
    compiled.get_overload = lambda signature: within().get_overload(signature)
    compiled.compile = _undisturbed(compiled.compile)
    return cast("Callable[P, R]", compiled)


def inline_or_plain(function: Callable[P, R]) -> Callable[P, R]:
    """Compile scalar arithmetic as :func:`inline` does; from Python it is the plain function.

    For one formula that kernels need for a number and NumPy for a whole array.
    """
    shared: Callable[P, R] = register_jitable(**_WITHIN_KERNELS)(function)
    return shared


def always_inline(function: Callable[P, R]) -> Callable[P, R]:
    """Compile arithmetic on many numbers, always inlined: a call would pass them through memory.

    A quad has sixteen strains and as many resultants live at a time; by default LLVM calls such
    functions, and passing the numbers costs as much as the arithmetic.
    Numba's wrapper for calls from Python would hold a second copy of that arithmetic at every level
    of inlining; without it kernels compile a quarter faster. So Python cannot call these functions;
    it gets an error.
    """
    compiled: Any = nb.njit(**ALWAYS_INLINED)(function)
    compiled.get_call_template = _for_all_numbers(compiled.get_call_template)
    return _for_kernels_only(compiled, function)


def _for_kernels_only(compiled: Any, function: Callable[P, R]) -> Callable[P, R]:
    def refuse(*_: object) -> None:
        raise TypeError(f"{function.__name__} is inlined into kernels, Python cannot call it")

    # No machine code is found for a call from Python.
    compiled._insert, compiled._compile_for_args = lambda *_: None, refuse
    return cast("Callable[P, R]", compiled)


def _for_all_numbers(template: Callable[..., Any]) -> Callable[..., Any]:
    """Wrap what compiles a function for a call: once for an integer, whatever its value.

    For Numba 0 and 1 in the source are of two types, and a function that is called with each would
    be compiled twice. The value is put in when LLVM inlines the function; where it may not inline
    it, a version for each value is faster.
    """
    of_any_value: Any = types.unliteral

    def template_for_all(arguments: Any, named: Any) -> Any:
        by_name = {name: of_any_value(kind) for name, kind in named.items()}
        return template(tuple(map(of_any_value, arguments)), by_name)

    return template_for_all


def apart(function: Callable[P, R]) -> Callable[P, R]:
    """Compile arithmetic that kernels call, compiled once for all calls within a kernel.

    For many operations on few numbers, or operations that are seldom needed: they get registers of
    their own, and a kernel with several calls compiles faster. The function begins with
    :func:`shellcut.numerics.processor.not_inlined`. Python cannot call it.
    """
    return _for_kernels_only(nb.njit(**_WITHIN_KERNELS)(function), function)


def apart_as(name: str) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Return :func:`apart` for a function that is made several times, with other functions within.

    Kernels from Numba's cache are linked by the names of what they call, and a process that loads
    two of them would run one's function in both: each needs a name of its own.
    """

    def compiled(function: Callable[P, R]) -> Callable[P, R]:
        function.__qualname__ = f"{function.__qualname__}[{name}]"
        return apart(function)

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

    Numba reports compilations only, not kernels loaded from the cache.
    """
    with event.install_listener("numba:compile", _Once(call)):
        yield
