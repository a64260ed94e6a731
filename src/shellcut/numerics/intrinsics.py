"""Functions whose code is written in LLVM's language, straight into the kernel that calls them."""

# Numba's classes for typing have no types.
# mypy: disable-error-code="misc, no-untyped-call, untyped-decorator"

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar

from numba.core import types
from numba.core.imputils import lower_builtin
from numba.core.typing.templates import AbstractTemplate, infer_global

F = TypeVar("F", bound=Callable[..., Any])
P = ParamSpec("P")
R = TypeVar("R")


def for_kernels(typed: Callable[P, R]) -> Callable[P, R]:
    """Return a function that only kernels call, from a function that gives the code for its calls.

    The decorated function is annotated as kernels call it, and does what :func:`in_kernels` needs.
    """

    @functools.wraps(typed)
    def called(*_: P.args, **__: P.kwargs) -> R:
        raise TypeError(f"{typed.__name__} is compiled into kernels, Python cannot call it")

    in_kernels(called)(typed)
    return called


def in_kernels(function: Callable[..., Any]) -> Callable[[F], F]:
    """Return a decorator of a function that gives the code for calls of a function in kernels.

    The decorated function takes Numba's types of the arguments and returns a signature, or None if
    there is no such function of them, and a function of context, builder and values that writes
    LLVM's code and returns the value, if there is one. An integer that is written in the source has
    its value in its type. From Python the function itself is called.

    An ``overload`` would be a function of its own to Numba, compiled for each of its callers. Its
    ``inline="always"`` makes Numba look for dead code, and what is stored into a borrowed table
    passes for dead.
    """

    def registered(typed: F) -> F:
        class _Typing(AbstractTemplate):
            key = function
            prefer_literal = True

            def generic(self, args: Any, kws: Any) -> Any:
                return None if kws else (typed(*args) or (None,))[0]

        def write(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            value = typed(*signature.args)[1](context, builder, values)
            return context.get_dummy_value() if value is None else value

        infer_global(function, types.Function(_Typing))
        lower_builtin(function, types.VarArg(types.Any))(write)
        return typed

    return registered
