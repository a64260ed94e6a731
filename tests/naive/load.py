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


def pressure_rows_of_part(x, points, pressure, n_point=6):
    """Integral of p N_a a_1 x a_2 over a polygon of the parametric square, shape (4, 3) [N]."""
    rows = np.zeros((4, 3))
    on, weights = np.polynomial.legendre.leggauss(n_point)
    a = np.array(points[0])
    for b, c in zip(np.array(points[1:-1]), np.array(points[2:]), strict=True):
        (ux, uy), (vx, vy) = b - a, c - a
        for u, w in zip(0.5 * (on + 1.0), 0.5 * weights, strict=True):
            for v, z in zip(0.5 * (on + 1.0), 0.5 * weights, strict=True):
                xi, eta = a + u * ((1.0 - v) * (b - a) + v * (c - a))
                value, by_xi, by_eta = shape(xi, eta)
                area = w * z * u * (ux * vy - uy * vx)
                rows += area * pressure * np.outer(value, np.cross(by_xi @ x, by_eta @ x))
    return rows
