"""Names of array types; products, lengths and functions that give the same bits on every processor.

``@``, ``numpy.dot``, the norm of a single vector and ``numpy.linalg`` call BLAS, which adds in an
order that depends on the processor; NumPy's exp, log, arctan2 and the like have an approximation of
their own for AVX-512. Nothing that the state of a run depends on may call them. In their place are
:func:`product`, whose plain loops NumPy compiles for all processors alike, and the functions of
``math``, :func:`each` for every element of an array. Sums, roots and squares of NumPy are the same
everywhere.

Imports only NumPy.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

Floats: TypeAlias = npt.NDArray[np.float64]
Numbers: TypeAlias = npt.NDArray[Any]
"""Array of any numeric type."""
Ints: TypeAlias = npt.NDArray[np.integer[Any]]
SmallInts: TypeAlias = npt.NDArray[np.int8]
Bools: TypeAlias = npt.NDArray[np.bool_]
SmallIds: TypeAlias = npt.NDArray[np.int32]
ArrayLike: TypeAlias = npt.ArrayLike
Number: TypeAlias = Any
"""Number type of the mechanics: a float, or several at once (:mod:`shellcut.numerics.lanes`)."""
Vec3: TypeAlias = tuple[float, float, float]
Vector: TypeAlias = tuple[Number, Number, Number]
"""A three-vector of numbers."""

NodeStiffness: TypeAlias = tuple[Ints, Floats]
"""Nodes, of which each may be listed more than once, and a stiffness on each [N/mm]."""

StiffnessBy: TypeAlias = Mapping[str, NodeStiffness]
"""The same of several force terms, by their names."""


def product(first: Any, *others: Any) -> Any:
    """Return the matrix product of vectors, matrices or stacks of them, from left to right."""
    for other in others:
        rows, columns = "h" if np.ndim(first) > 1 else "", "j" if np.ndim(other) > 1 else ""
        first = np.einsum(f"...{rows}i,...i{columns}->...{rows}{columns}", first, other)
    return first


def norm(vectors: Floats) -> Any:
    """Return the length of a vector, or of every row along the last axis."""
    return np.sqrt(np.add.reduce(vectors * vectors, axis=-1))


def unit(vectors: Floats) -> Floats:
    """Return a vector, or every row along the last axis, divided by its length; zeros stay zero."""
    length = norm(vectors)[..., None]
    out = np.zeros(np.shape(vectors))
    return np.asarray(np.divide(vectors, length, out=out, where=length != 0.0))


def cross(first: Floats, second: Floats) -> Floats:
    """Return the vector product of two vectors, or of rows along the last axis.

    NumPy's takes five times as long for a few of them.
    """
    out = np.empty(np.broadcast_shapes(first.shape, second.shape))
    for c in range(3):
        a, b = (c + 1) % 3, (c + 2) % 3
        out[..., c] = first[..., a] * second[..., b] - first[..., b] * second[..., a]
    return out


def angles(first: Floats, second: Floats) -> Floats:
    """Return the angles between vectors, or rows along the last axis [rad]."""
    # The arc tangent keeps small angles, which an arc cosine rounds to zero.
    cosine = np.add.reduce(first * second, axis=-1)
    return each(math.atan2, norm(cross(first, second)), cosine)


def off_segments(points: Floats, starts: Floats, vectors: Floats) -> tuple[Floats, Floats]:
    """Return vectors to points from the nearest places of segments, and the shares of these.

    points, starts, vectors : (..., 2 or 3), which broadcast; the shares, from 0 to 1, are (...).
    """
    arm, tiny = points - starts, np.finfo(float).tiny
    squared = np.maximum(np.add.reduce(vectors * vectors, axis=-1), tiny)
    share = np.clip(np.add.reduce(arm * vectors, axis=-1) / squared, 0.0, 1.0)
    return arm - share[..., None] * vectors, share


def three(name: str, values: Any, unit: str = "") -> Floats:
    """Return three finite numbers; ValueError, by the name of the argument, if they are not."""
    numbers = np.asarray(values, dtype=np.float64)
    if numbers.shape != (3,) or not np.isfinite(numbers).all():
        of = f" in {unit}" if unit else ""
        raise ValueError(f"{name} must be three finite numbers{of}, got {values!r}")
    return numbers


def node_rows(name: str, values: Any, n_node: int) -> Floats:
    """Return three finite numbers a node, shape (n_node, 3); ValueError, by the name, if not."""
    rows = np.asarray(values, dtype=np.float64)
    if rows.shape != (n_node, 3):
        raise ValueError(f"{name} must have shape ({n_node}, 3), a row per node, got {rows.shape}")
    if not np.isfinite(rows).all():
        bad = np.flatnonzero(~np.isfinite(rows).all(axis=1))[:5].tolist()
        raise ValueError(f"{name} must be finite, but is not at nodes {bad}")
    return rows


def each(function: Callable[..., float], *arrays: npt.ArrayLike) -> Floats:
    """Return a function of single numbers, of the module ``math``, for every element of arrays."""
    return np.asarray(np.frompyfunc(function, len(arrays), 1)(*arrays), float)
