"""Pressure forces of one quad by a quadrature of high order."""

import numpy as np

from .shell import shape


def pressure_rows(x, pressure, n_point=6):
    """Integral of p N_a a_1 x a_2 over the quad, shape (4, 3) [N]."""
    rows = np.zeros((4, 3))
    points, weights = np.polynomial.legendre.leggauss(n_point)
    for xi, u in zip(points, weights, strict=True):
        for eta, v in zip(points, weights, strict=True):
            value, by_xi, by_eta = shape(xi, eta)
            rows += u * v * pressure * np.outer(value, np.cross(by_xi @ x, by_eta @ x))
    return rows
