"""Three-vectors as tuples of scalars, for use inside kernels, and the finite-rotation update.

Tuples stay in registers: ``cross`` of two tuples costs a few nanoseconds, ``np.cross`` of two
rows some seventy.
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from shellcut.arrays import Floats, Numbers, Vec3

from .jit import always_inline


@always_inline
def load(rows: Numbers, i: int) -> Vec3:
    """Return row i, which is not negative: an unsigned index needs no test for the end."""
    k = np.uintp(i)
    return rows[k, 0], rows[k, 1], rows[k, 2]


@always_inline
def store(rows: Floats, i: int, a: Vec3) -> None:
    """Write a into row i."""
    k = np.uintp(i)
    rows[k, 0] = a[0]
    rows[k, 1] = a[1]
    rows[k, 2] = a[2]


@always_inline
def add_to(rows: Floats, i: int, a: Vec3) -> None:
    """Add a to row i."""
    k = np.uintp(i)
    rows[k, 0] += a[0]
    rows[k, 1] += a[1]
    rows[k, 2] += a[2]


@always_inline
def add(a: Vec3, b: Vec3) -> Vec3:
    """Return a + b."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@always_inline
def sub(a: Vec3, b: Vec3) -> Vec3:
    """Return a - b."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@always_inline
def scale(s: float, a: Vec3) -> Vec3:
    """Return s a."""
    return s * a[0], s * a[1], s * a[2]


@always_inline
def combine(s: float, a: Vec3, r: float, b: Vec3) -> Vec3:
    """Return s a + r b."""
    return s * a[0] + r * b[0], s * a[1] + r * b[1], s * a[2] + r * b[2]


@always_inline
def add_scaled(a: Vec3, s: float, b: Vec3) -> Vec3:
    """Return a + s b."""
    return a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]


@always_inline
def dot(a: Vec3, b: Vec3) -> float:
    """Return a · b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@always_inline
def cross(a: Vec3, b: Vec3) -> Vec3:
    """Return a x b."""
    return (
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    )


@always_inline
def norm(a: Vec3) -> float:
    """Return the length of a."""
    return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])


@always_inline
def mean_of(rows: Numbers, nodes: Numbers, weights: Floats, i: int) -> Vec3:
    """Return the mean of rows by the four weights in row i, those of the nodes in row i."""
    mean = (0.0, 0.0, 0.0)
    for c in range(4):
        mean = add_scaled(mean, weights[i, c], load(rows, nodes[i, c]))
    return mean


@always_inline
def rotate_director(t: Vec3, spin: Vec3) -> Vec3:
    """Rotate the unit director ``t`` by the Cayley map of ``spin`` = Δt ω.

    With a = ½ Δt ω the Cayley rotation (1 + ã)(1 - ã)⁻¹ t is
    ((1 - a·a) t + 2 a × t + 2 (a·t) a) / (1 + a·a): rational, exactly of unit length. It turns
    about ω itself, so a spin normal to the director stays normal to it. a·t differs from zero only
    if a support makes the director turn about an axis that is not normal to it.
    """
    a = scale(0.5, spin)
    aa, twice = dot(a, a), 2.0 * dot(a, t)
    turned = add(combine(1.0 - aa, t, 2.0, cross(a, t)), scale(twice, a))
    return scale(1.0 / (1.0 + aa), turned)


@always_inline
def tangent_basis(t: Floats, n: int, basis: Floats) -> None:
    """Write two unit tangents b_1, b_2 of director n, with b_1 x b_2 = t, into basis : (2, 3)."""
    axis = 0  # smallest component of the director: best conditioned tangent
    for c in range(1, 3):
        if abs(t[n, c]) < abs(t[n, axis]):
            axis = c
    length = sqrt(1.0 - t[n, axis] ** 2)
    for c in range(3):
        unit = 1.0 if c == axis else 0.0
        basis[0, c] = (unit - t[n, axis] * t[n, c]) / length
    basis[1, 0] = t[n, 1] * basis[0, 2] - t[n, 2] * basis[0, 1]
    basis[1, 1] = t[n, 2] * basis[0, 0] - t[n, 0] * basis[0, 2]
    basis[1, 2] = t[n, 0] * basis[0, 1] - t[n, 1] * basis[0, 0]
