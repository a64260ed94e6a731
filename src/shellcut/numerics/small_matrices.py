"""Inverses and eigenvectors of matrices of two or three rows.

LAPACK would give bits that depend on the processor; see :mod:`shellcut.arrays`.
"""

from __future__ import annotations

from math import copysign, sqrt

import numpy as np

from shellcut.arrays import Floats, product

# Columns whose angle is below the root of this are parallel: a sum over both has one solution too
# many, and the shortest is taken.
_PARALLEL = 1e-14

# Jacobi's method doubles the digits with every sweep; three rows take five or six.
_MOST_SWEEPS = 30

_ROUND_OFF = 2.0**-53


def inverse(matrices: Floats) -> Floats:
    """Return the inverses, shape (..., 2, 2) or (..., 3, 3), by cofactors.

    Raises
    ------
    ValueError
        If one has the determinant 0.
    """
    if matrices.shape[-1] == 2:
        (a, b), (c, d) = np.moveaxis(matrices, (-2, -1), (0, 1))
        cofactors = np.moveaxis(np.array([[d, -b], [-c, a]]), (0, 1), (-2, -1))
    else:
        first, second, third = np.moveaxis(matrices, -1, 0)
        across = np.cross(second, third), np.cross(third, first), np.cross(first, second)
        cofactors = np.stack(across, axis=-2)
    determinant = np.einsum("...i,...i->...", cofactors[..., 0, :], matrices[..., :, 0])
    if not determinant.all():
        raise ValueError("the matrix must have an inverse, its determinant is 0")
    return np.asarray(cofactors / determinant[..., None, None])


def pseudo_inverse(matrix: Floats, flat: float) -> Floats:
    """Return the pseudo-inverse of a symmetric matrix without negative eigenvalues, shape (2, 2).

    If one eigenvalue is less than ``flat`` times the other, it counts as zero.
    """
    (a, b), (_, d) = matrix.tolist()
    if a * d - b * b > flat * (a + d) ** 2:
        return inverse(matrix)
    return np.asarray(matrix / max((a + d) ** 2, np.finfo(float).tiny))


def least_squares(columns: Floats, wanted: Floats) -> Floats:
    """Return the factors, shape (2,), with which columns : (n, 2) sum up nearest to a vector."""
    squares = pseudo_inverse(product(columns.T, columns), _PARALLEL)
    return np.asarray(product(squares, product(wanted, columns)))


def symmetric_eigen(matrix: Floats) -> tuple[Floats, Floats]:
    """Return the eigenvalues of a symmetric matrix in increasing order, and its eigenvectors.

    The eigenvectors are columns. Jacobi's method turns two axes at a time so that the element
    between them is zero.
    """
    A, axes = np.array(matrix), np.eye(len(matrix))
    small = _ROUND_OFF * float(np.abs(A).max())
    for _ in range(_MOST_SWEEPS):
        for p, q in zip(*np.triu_indices(len(A), 1), strict=True):
            if abs(A[p, q]) <= small:
                continue
            cot = float((A[q, q] - A[p, p]) / (2.0 * A[p, q]))  # of twice the angle
            tangent = copysign(1.0, cot) / (abs(cot) + sqrt(1.0 + cot * cot))
            c = 1.0 / sqrt(1.0 + tangent * tangent)
            s = tangent * c
            for rows in (A, A.T, axes):
                rows[p], rows[q] = c * rows[p] - s * rows[q], s * rows[p] + c * rows[q]
        if np.abs(np.triu(A, 1)).max() <= small:
            break
    values = A.diagonal()
    order = np.argsort(values, kind="stable")
    return values[order], axes[order].T
