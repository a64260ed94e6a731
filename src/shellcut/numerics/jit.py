"""The only place that asks Numba to compile: sets of options, with reasons.

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

# Numba's classes have no types.
# mypy: disable-error-code="misc, no-untyped-call, attr-defined"

from __future__ import annotations

import gc
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cached_property
from typing import Any, Generic, ParamSpec, TypeVar, cast

import numba as nb
from numba.core import event, types
from numba.core.compiler import Compiler
from numba.core.registry import CPUDispatcher
from numba.extending import register_jitable

from shellcut.signals import SignalsDeferred

from .inlined_code import InlinedCompiler, KernelCompiler
from .kernel_cache import KernelCache
from .kernel_tables import check_tables

P = ParamSpec("P")
R = TypeVar("R")

if nb.config.DISABLE_JIT:
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


class _Compiled(CPUDispatcher):
    """What Numba makes of a function, with our options: it compiles it for types of arguments."""

    def __init__(self, function: Callable[..., Any], compiler: Any, **options: Any) -> None:
        options = {"nopython": True, **_OPTIONS, **options}
        super().__init__(function, targetoptions=options, pipeline_class=compiler)


class _Kernel(_Compiled):
    """A kernel: one process compiles it, and the others load it."""

    def __init__(self, function: Callable[..., Any]) -> None:
        super().__init__(function, KernelCompiler, nogil=True)
        self._cache = KernelCache(function)

    def compile(self, sig: Any, wait: bool = True) -> Any:
        """Return the machine code; None if another process compiles it, and not to wait."""
        if self.overloads.get(sig) is not None:
            return super().compile(sig)
        with self._cache.alone(wait=wait) as is_alone, SignalsDeferred(), _uncollected():
            return super().compile(sig) if is_alone else None


class _Inline(_Compiled):
    """A function in two versions: that of kernels, and another that Python calls."""

    def __init__(self, function: Callable[..., Any]) -> None:
        super().__init__(function, Compiler)

    @cached_property
    def _within(self) -> _Compiled:
        return _Compiled(self.py_func, InlinedCompiler, no_cpython_wrapper=True)

    def get_call_template(self, args: Any, kws: Any) -> Any:
        """Return that of the version of kernels."""
        return self._within.get_call_template(args, kws)

    def get_overload(self, sig: Any) -> Any:
        """Return that of the version of kernels."""
        return self._within.get_overload(sig)

    def compile(self, sig: Any) -> Any:
        """Compile the version for Python; signals wait for the end."""
        with SignalsDeferred():
            return super().compile(sig)


class _ForKernels(_Compiled):
    """A function that Python cannot call: it has no wrapper, and is never run by itself."""

    def __init__(self, function: Callable[..., Any], **options: Any) -> None:
        super().__init__(function, InlinedCompiler, no_cpython_wrapper=True, **options)

    def _insert(self, *_: Any, **__: Any) -> None:
        """Keep the machine code, which is none, from calls by Python."""

    def _compile_for_args(self, *_: Any, **__: Any) -> Any:
        raise TypeError(f"{self.py_func.__name__} is inlined into kernels, Python cannot call it")


class _AlwaysInlined(_ForKernels):
    """A function without code of its own in a kernel."""

    def __init__(self, function: Callable[..., Any]) -> None:
        super().__init__(function, forceinline=True)

    def get_call_template(self, args: Any, kws: Any) -> Any:
        """Compile the function for a call: once for an integer, whatever its value.

        For Numba 0 and 1 in the source are of two types, and a function that is called with each
        would be compiled twice. The value is put in when LLVM inlines the function; where it may
        not inline it, a version for each value is faster.
        """
        of_any_value: Any = types.unliteral
        by_name = {name: of_any_value(kind) for name, kind in kws.items()}
        return super().get_call_template(tuple(map(of_any_value, args)), by_name)


def kernel(function: Callable[P, R]) -> Callable[P, R]:
    """Compile a loop over entities; called from Python with arrays and numbers only."""
    return cast("Callable[P, R]", _Kernel(function))


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
    types = tuple(nb.typeof(a) for a in arguments)
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
    return cast("Callable[P, R]", _Inline(function))


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
    return cast("Callable[P, R]", _AlwaysInlined(function))


def apart(function: Callable[P, R]) -> Callable[P, R]:
    """Compile arithmetic that kernels call, compiled once for all calls within a kernel.

    For many operations on few numbers, or operations that are seldom needed: they get registers of
    their own, and a kernel with several calls compiles faster. The function begins with
    :func:`shellcut.numerics.processor.not_inlined`. Python cannot call it.
    """
    return cast("Callable[P, R]", _ForKernels(function))


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
