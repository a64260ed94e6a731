"""How kernels are compiled."""

import ast
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

import shellcut
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.jit import BoundOnce, always_inline, bound, inline, kernel
from shellcut.numerics.processor import align_stack, seldom

SOURCES = Path(shellcut.__file__).parent


COMPILED = {"kernel", "inline", "inline_or_plain", "always_inline"}


def compiled_functions():
    """Yield name, decorator and syntax tree of every function that Numba compiles."""
    for path in SOURCES.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            for decorator in getattr(node, "decorator_list", []):
                if getattr(decorator, "id", "") in COMPILED:
                    yield node.name, decorator.id, node


def test_kernels_do_not_call_kernels():
    functions = list(compiled_functions())
    kernels = {name for name, kind, _ in functions if kind == "kernel"}
    assert {"add_press_forces", "quad_tangents", "stiffened_quads"} <= kernels
    calls = {
        (name, call.func.id)
        for name, _, tree in functions
        for call in ast.walk(tree)
        if isinstance(call, ast.Call) and getattr(call.func, "id", name) in kernels - {name}
    }
    assert not calls


@kernel
def _scaled_sum(numbers, factor):
    return factor * numbers.sum()


def test_a_bound_kernel_is_that_of_the_types_it_was_bound_for():
    once = BoundOnce(_scaled_sum)
    for n in (4, 7):
        numbers = np.arange(float(n))
        for call in (bound(_scaled_sum, numbers, 2.0), once):
            assert call(numbers, 2.0) == _scaled_sum(numbers, 2.0) == n * (n - 1)
    for other in (np.arange(4), np.arange(8.0)[::2]):
        with pytest.raises(TypeError, match="a bound kernel was given other types"):
            once(other, 2.0)


@inline
def _halved(number):
    return 0.5 * number


@kernel
def _halved_sum(numbers):
    return _halved(numbers.sum())


def test_what_kernels_call_is_compiled_by_itself_only_for_python():
    assert _halved_sum(np.array([2.0, 4.0])) == 3.0
    if hasattr(_halved, "overloads"):
        assert not _halved.overloads
    assert [_halved(6.0), _halved(number=6)] == [3.0, 3.0]
    if hasattr(_halved, "overloads"):
        assert len(_halved.overloads) == 2


@always_inline
def _from(numbers, first):
    return numbers[first] + numbers[first + 1]


@kernel
def _pairs(numbers):
    return _from(numbers, 0) + _from(numbers, 1) + _from(numbers, numbers.size - 2)


def test_a_function_of_kernels_is_compiled_once_and_is_not_for_python():
    numbers = np.array([1.0, 2.0, 4.0, 8.0])
    for _ in range(2):  # before it is compiled, and after
        with pytest.raises(TypeError, match="_from is inlined into kernels, Python cannot call"):
            _from(numbers, 0)
        assert _pairs(numbers) == 3.0 + 6.0 + 12.0
    if hasattr(_from, "overloads"):
        assert len(_from.overloads) <= 1  # none if the kernel was in the cache


class _Pair(NamedTuple):
    a: np.ndarray
    b: np.ndarray


@kernel
def _fill(pair, x):
    align_stack()
    pair = borrowed(pair)
    b = pair.b
    for i in range(3):
        if seldom(x > 5.0):
            b[i] = 2.0
        pair.a[i] = 1.0
        b[i] += x


def test_what_is_stored_in_a_borrowed_table_is_there_after_the_kernel():
    # Numba's removal of dead code takes an array for unused if it does not know whose it is
    pair = _Pair(np.zeros(3), np.zeros(3))
    _fill(pair, 7.0)
    assert (pair.a == 1.0).all()
    assert (pair.b == 9.0).all()
