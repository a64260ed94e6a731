"""The bilinear shape functions of a quad.

    N_a = (1 + xi_a xi) (1 + eta_a eta) / 4,

with xi and eta from -1 to 1, and the corners (xi_a, eta_a) counted from (-1, -1) anticlockwise.
"""

from __future__ import annotations

from typing import TypeVar

from shellcut.arrays import Floats

from .jit import inline_or_plain

_Numbers = TypeVar("_Numbers", float, Floats)


@inline_or_plain
def shape_functions(xi: _Numbers, eta: _Numbers) -> tuple[_Numbers, _Numbers, _Numbers, _Numbers]:
    """Return N_a at a place, or at an array of them."""
    return (
        0.25 * (1.0 - xi) * (1.0 - eta),
        0.25 * (1.0 + xi) * (1.0 - eta),
        0.25 * (1.0 + xi) * (1.0 + eta),
        0.25 * (1.0 - xi) * (1.0 + eta),
    )


@inline_or_plain
def slopes_by_xi(eta: _Numbers) -> tuple[_Numbers, _Numbers, _Numbers, _Numbers]:
    """Return the derivatives of N_a by xi, which do not depend on xi."""
    low, high = 0.25 * (1.0 - eta), 0.25 * (1.0 + eta)
    return -low, low, high, -high


@inline_or_plain
def slopes_by_eta(xi: _Numbers) -> tuple[_Numbers, _Numbers, _Numbers, _Numbers]:
    """Return the derivatives of N_a by eta, which do not depend on eta."""
    left, right = 0.25 * (1.0 - xi), 0.25 * (1.0 + xi)
    return -left, -right, right, left
