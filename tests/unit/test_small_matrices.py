"""Products, lengths, inverses and eigenvectors without BLAS and LAPACK, against NumPy's."""

import functools

import numpy as np
import pytest

from shellcut.arrays import angles, norm, product, unit
from shellcut.numerics.small_matrices import (
    inverse,
    least_squares,
    pseudo_inverse,
    symmetric_eigen,
)

RANDOM = np.random.default_rng(5)


@pytest.mark.parametrize(
    "shapes",
    [
        [(3,), (3,)],
        [(4,), (4, 3)],
        [(361, 2), (2,)],
        [(2, 3), (3, 3), (3, 2)],
        [(7, 3, 8), (8, 8), (7, 8, 3)],
        [(2, 5, 4, 3), (3,)],
    ],
)
def test_products(shapes):
    factors = [RANDOM.standard_normal(shape) for shape in shapes]
    wanted = functools.reduce(np.matmul, factors)
    found = product(*factors)
    assert np.shape(found) == np.shape(wanted)
    np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-14 * max(map(np.size, factors)))


def test_whole_numbers_stay_whole():
    keys = product(np.array([[3, 5], [0, 2**33]]), [2**20, 1])
    assert keys.tolist() == [3 * 2**20 + 5, 2**33]


def test_lengths_and_angles():
    rows = RANDOM.standard_normal((50, 4, 3))
    np.testing.assert_allclose(norm(rows), np.linalg.norm(rows, axis=-1), rtol=1e-15)
    np.testing.assert_allclose(norm(unit(rows)), 1.0, rtol=1e-15)
    small = np.array([1e-12, 1e-3, 1.0, np.pi])
    turned = np.stack([np.cos(small), np.sin(small), 0.0 * small], axis=1)
    np.testing.assert_allclose(angles(np.array([2.0, 0.0, 0.0]), turned), small, rtol=1e-12)


@pytest.mark.parametrize("n", [2, 3])
def test_inverses(n):
    matrices = RANDOM.standard_normal((5, 200, n, n))
    near = np.broadcast_to(np.eye(n), matrices.shape)
    bound = 1e-15 * np.linalg.cond(matrices)[..., None, None]
    assert (np.abs(matrices @ inverse(matrices) - near) < bound).all()
    with pytest.raises(ValueError, match="must have an inverse, its determinant is 0"):
        inverse(np.ones((n, n)))


def test_two_columns():
    columns = RANDOM.standard_normal((3, 3, 2))
    columns[2] = np.outer([1.0, 2.0, -1.0], [3.0, -0.5])  # parallel
    wanted = RANDOM.standard_normal(3)
    for pair in columns:
        found, *_ = np.linalg.lstsq(pair, wanted, rcond=None)
        np.testing.assert_allclose(least_squares(pair, wanted), found, rtol=1e-12)


@pytest.mark.parametrize("line", [[1.0, 0.0], [0.0, 1.0], [0.6, -0.8], [0.0, 0.0]])
def test_spread_along_a_line(line):
    spread = np.outer(line, line)
    wanted = np.linalg.pinv(spread, rcond=1e-9)
    np.testing.assert_allclose(pseudo_inverse(spread, 1e-9), wanted, atol=1e-14)


@pytest.mark.parametrize(
    "matrix",
    [
        np.diag([3.0, -1.0, 2.0]),
        np.zeros((3, 3)),
        np.eye(3) + 0.1,
        [[2.0, 1.0, 0.0], [1.0, 2.0, 0.0], [0.0, 0.0, 1e-9]],
        [[0.0, 1.0], [1.0, 0.0]],
        *(lambda a: a + a.transpose(0, 2, 1))(RANDOM.standard_normal((40, 3, 3))),
    ],
)
def test_eigenvectors(matrix):
    matrix = np.array(matrix, float)
    values, vectors = symmetric_eigen(matrix)
    round_off = 4e-15 * max(np.abs(matrix).max(), 1e-300)
    np.testing.assert_allclose(values, np.linalg.eigvalsh(matrix), rtol=0, atol=round_off)
    np.testing.assert_allclose(vectors.T @ vectors, np.eye(len(matrix)), rtol=0, atol=2e-15)
    np.testing.assert_allclose(matrix @ vectors, vectors * values, rtol=0, atol=2 * round_off)
