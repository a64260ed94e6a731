"""Argument tables of kernels: NamedTuples of arrays, and a check that each array is in its place.

A kernel takes its arrays in a few tables built by keyword, so that two arrays cannot be swapped by
mistake. The annotation of a field gives its contents,

    class Cables(NamedTuple):
        ends: Annotated[Ints, "(n_cable, 2)"]
        area: Annotated[Floats, "(n_cable,)"]

and :func:`check_tables` compares the arrays with it: kind of number, number of dimensions, lengths
given as numbers, and that lengths of the same name are equal. Fields without a shape are not
checked; tables within tables are. This costs a few tenths of a millisecond, so it is done when a
kernel is bound, not at each call.
"""

from __future__ import annotations

import functools
from collections.abc import Iterable
from typing import Any, NamedTuple, get_args, get_origin, get_type_hints

import numpy as np


class _Wanted(NamedTuple):
    """Requirements of an annotation on a field."""

    name: str
    dtype: Any
    """Type of the array's numbers, None for any."""
    shape: tuple[str, ...]
    """Lengths, each a number or a name."""

    @property
    def text(self) -> str:
        lengths = ", ".join(self.shape) + ("," if len(self.shape) == 1 else "")
        kind = "" if self.dtype is None else f" of {self.dtype.__name__}"
        return f"an array{kind} of shape ({lengths})"


class TableAddress(int):
    """Address of a table that is laid out for kernels; it keeps the arrays alive.

    An int, because a kernel reads the value of an int in a single call.
    """

    table: Any
    """As it was given."""
    kind: Any
    """Numba's type of it."""
    memory: Any
    """In which it lies, an array of bytes."""


def check_tables(arguments: Iterable[object]) -> None:
    """Refuse arguments with a table with a wrong array in some field.

    Raises
    ------
    TypeError
        Naming table and field.
    """
    known: dict[str, tuple[int, str]] = {}
    for argument in arguments:
        table = argument.table if isinstance(argument, TableAddress) else argument
        if _is_table(table):
            _check_table(table, known)


def _check_table(table: Any, known: dict[str, tuple[int, str]]) -> None:
    """Check one table; ``known`` has the lengths by name, with the field that gave them first."""
    for field in table:
        if _is_table(field):
            _check_table(field, known)
    for wanted in _wanted(table.__class__):
        place = f"{type(table).__name__}.{wanted.name}"
        array = getattr(table, wanted.name)
        fits = (
            isinstance(array, np.ndarray)
            and (wanted.dtype is None or np.issubdtype(array.dtype, wanted.dtype))
            and array.ndim == len(wanted.shape)
        )
        lengths = dict(zip(wanted.shape, array.shape, strict=True)) if fits else {}
        if not fits or any(name.isdigit() and int(name) != n for name, n in lengths.items()):
            got = f"{array.dtype} of {array.shape}" if isinstance(array, np.ndarray) else array
            raise TypeError(
                f"{place} must be {wanted.text}, got {got}: is another array in its place?"
            )
        for name, length in lengths.items():
            first, there = known.setdefault(name, (length, place))
            if length != first:
                raise TypeError(
                    f"{place} must be {wanted.text}, where {name} is {first} in {there}, "
                    f"got {array.dtype} of {array.shape}: is another array in its place?"
                )


def _is_table(value: object) -> bool:
    return isinstance(value, tuple) and hasattr(value, "_fields")


@functools.cache
def _wanted(table: type) -> tuple[_Wanted, ...]:
    """Return the requirements of a table's fields that have a shape; Python reads them slowly."""
    found = []
    for name, hint in get_type_hints(table, include_extras=True).items():
        for shape_text in getattr(hint, "__metadata__", ()):
            shape = tuple(length.strip() for length in shape_text.strip("()").split(",") if length)
            number = _of_dtype(get_args(hint.__origin__)[-1])
            found.append(_Wanted(name, None if number is Any else _generic(number), shape))
    return tuple(found)


def _of_dtype(kind: Any) -> Any:
    """Return ``np.float64`` of ``np.dtype[np.float64]``, as which NumPy 2.4 writes it."""
    return get_args(kind)[0] if get_origin(kind) is np.dtype else kind


def _generic(dtype: Any) -> Any:
    """Return the number class of ``np.integer[Any]`` or ``np.float64``."""
    return getattr(dtype, "__origin__", dtype)
