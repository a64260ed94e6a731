"""Smoothing of the quads near a path: untangle them, then make them square and large.

At every corner of a quad the edges p and q, in units of the quad's target size s, span the
determinant D = p x q / s². The cost of the corner is

    S^a + w T^a,    S = (|p|² + |q|²) / (2 s² D),    T = S / D.

S is 1 for a square corner of any size and grows with shear or stretch; T bounds the stable step,
about (s / length that sets the step)². The exponent emphasises the worst corners. D is replaced by
chi = (D + sqrt(D² + eps²)) / 2, which is positive for inverted quads as well: eps decreases as the
worst of them recovers, so minimising untangles ([Garanzha2021]).

Unknowns are the two coordinates of a free node and the one parameter of a node that slides on a
curve: chain nodes on the path, rim nodes on the rim. These nodes therefore stay exactly on it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from shellcut.arrays import Bools, Floats, Ints
from shellcut.numerics.jit import kernel

from .descent import minimise
from .path_curve import PathCurve

STAGES = (1.0, 2.0, 4.0)
"""Exponents a of consecutive minimisations: starting with a high power is hard to minimise."""

STEP_WEIGHT = 0.03
"""w: a larger value makes the step longer and the angles worse. On 30 gmsh meshes, with one target
size for all rows, w = 0.02 to 0.2 gave smallest scaled Jacobians of 0.66 to 0.60 near the path."""

_UNTANGLE_ROUNDS = 30
_UNTANGLE_STEPS = 40
_QUALITY_STEPS = 400
_CLEAR = 0.02  # untangled: every determinant above this part of the target area
_QUALITY_EPS = 1e-3  # keeps the cost finite if a line search overshoots
_TOLERANCE = 3e-3  # a minimisation ends when a step lowers the cost by less; a square costs 4
_FIRST_MOVE = 0.02  # relative to the smallest target size


@dataclass(frozen=True, eq=False)
class Sliders:
    """Nodes that slide on one curve."""

    nodes: Ints
    curve: PathCurve
    u: Floats
    """Initial parameters, shape (n,), [mm]."""


class Smoother:
    """Moves nodes so that the quads around them get a good shape.

    Parameters
    ----------
    x : ndarray, shape (n_node, 2)
        Initial positions [mm]; quads may be inverted.
    quads : ndarray, shape (n_quad, 4)
    size : ndarray, shape (n_quad,)
        Target edge length of every quad [mm].
    free : ndarray of bool, shape (n_node,)
        Nodes that may move freely.
    sliders : sequence of Sliders
        Nodes that move on curves; all others stay.
    weight : ndarray, shape (n_quad, 4)
        Of every corner; 0 ignores it.
    """

    def __init__(
        self,
        x: Floats,
        quads: Ints,
        size: Floats,
        free: Bools,
        sliders: Sequence[Sliders],
        weight: Floats,
    ) -> None:
        self._x = x.copy()
        self._free = np.flatnonzero(free)
        self._sliders = [s for s in sliders if len(s.nodes)]
        moves = free.copy()
        for s in self._sliders:
            moves[s.nodes] = True
        active = np.flatnonzero(moves[quads].any(axis=1))
        self._quads = np.ascontiguousarray(quads[active])
        self._weight = np.ascontiguousarray(weight[active])
        self._size = np.ascontiguousarray(size[active])
        # rows inserted into a given area must shrink: scale the targets to the available area
        corners = x[self._quads]
        diagonals = corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]
        area = 0.5 * (
            diagonals[0][:, 0] * diagonals[1][:, 1] - diagonals[0][:, 1] * diagonals[1][:, 0]
        )
        if len(active):
            self._size *= np.sqrt(area.sum() / (self._size**2).sum())

    def run(self) -> Floats:
        """Return the positions of all nodes after smoothing, shape (n_node, 2).

        Quads that no motion of these nodes can untangle stay inverted; the caller checks.
        """
        unknowns = self._pack()
        if not len(unknowns):
            return self._x
        unknowns = self._untangle(unknowns)
        for power in STAGES:
            unknowns = self._minimise(unknowns, power, _QUALITY_EPS, _QUALITY_STEPS)
        return self._place(unknowns)

    def _pack(self) -> Floats:
        return np.concatenate([self._x[self._free].ravel(), *(s.u for s in self._sliders)])

    def _place(self, unknowns: Floats) -> Floats:
        x = self._x.copy()
        n = 2 * len(self._free)
        x[self._free] = unknowns[:n].reshape(-1, 2)
        for s in self._sliders:
            x[s.nodes] = s.curve.point(unknowns[n : n + len(s.nodes)])
            n += len(s.nodes)
        return x

    def _cost(self, unknowns: Floats, power: float, eps: float) -> tuple[float, Floats]:
        x = self._place(unknowns)
        gradient = np.zeros_like(x)
        value = quad_cost(
            x, self._quads, self._size, self._weight, eps, power, STEP_WEIGHT, gradient
        )
        n = 2 * len(self._free)
        parts = [gradient[self._free].ravel()]
        for s in self._sliders:
            slope = s.curve.derivative(unknowns[n : n + len(s.nodes)])
            parts.append((gradient[s.nodes] * slope).sum(axis=1))
            n += len(s.nodes)
        return value, np.concatenate(parts)

    def _minimise(self, unknowns: Floats, power: float, eps: float, n_step: int) -> Floats:
        return minimise(
            lambda v: self._cost(v, power, eps),
            unknowns,
            n_step=n_step,
            tolerance=_TOLERANCE,
            first_move=_FIRST_MOVE * float(self._size.min()),
        )

    def _untangle(self, unknowns: Floats) -> Floats:
        for _ in range(_UNTANGLE_ROUNDS):
            D = corner_determinants(self._place(unknowns), self._quads, self._size)
            least = float(D[self._weight > 0.0].min())
            if least > _CLEAR:
                break
            # chi of the worst corner stays well above zero, so that its cost stays finite
            eps = float(np.sqrt(0.01 + 0.1 * least**2)) if least <= 0.0 else _CLEAR
            unknowns = self._minimise(unknowns, STAGES[0], eps, _UNTANGLE_STEPS)
        return unknowns


@kernel
def quad_cost(
    x: Floats,
    quads: Ints,
    size: Floats,
    weight: Floats,
    eps: float,
    power: float,
    step_weight: float,
    gradient: Floats,
) -> float:
    """Return the sum of the corner costs and add its derivatives to gradient : (n_node, 2).

    weight : (n_quad, 4), of the corners.  power : a.  step_weight : w.  eps > 0.
    """
    total = 0.0
    for e in range(quads.shape[0]):
        inverse = 1.0 / size[e]
        for a in range(4):
            if weight[e, a] == 0.0:
                continue
            i, j, k = quads[e, a], quads[e, (a + 1) % 4], quads[e, (a + 3) % 4]
            p0, p1 = (x[j, 0] - x[i, 0]) * inverse, (x[j, 1] - x[i, 1]) * inverse
            q0, q1 = (x[k, 0] - x[i, 0]) * inverse, (x[k, 1] - x[i, 1]) * inverse
            D = p0 * q1 - p1 * q0
            root = np.sqrt(D * D + eps * eps)
            # avoids cancellation where D is far below zero
            chi = 0.5 * (D + root) if D > 0.0 else 0.5 * eps * eps / (root - D)
            slope = chi / root
            N = 0.5 * (p0 * p0 + p1 * p1 + q0 * q0 + q1 * q1)
            # both terms are powers of N and chi: S = N / chi, T = N / chi²
            S_cost = weight[e, a] * (N / chi) ** power
            T_cost = weight[e, a] * step_weight * (N / (chi * chi)) ** power
            total += S_cost + T_cost
            by_N = power * (S_cost + T_cost) / N
            by_D = -power * (S_cost + 2.0 * T_cost) / chi * slope
            gp0, gp1 = (by_N * p0 + by_D * q1) * inverse, (by_N * p1 - by_D * q0) * inverse
            gq0, gq1 = (by_N * q0 - by_D * p1) * inverse, (by_N * q1 + by_D * p0) * inverse
            gradient[j, 0] += gp0
            gradient[j, 1] += gp1
            gradient[k, 0] += gq0
            gradient[k, 1] += gq1
            gradient[i, 0] -= gp0 + gq0
            gradient[i, 1] -= gp1 + gq1
    return total


def corner_determinants(x: Floats, quads: Ints, size: Floats) -> Floats:
    """Return the determinants of all corners over the target areas, shape (n_quad, 4)."""
    at = x[quads]
    p, q = np.roll(at, -1, axis=1) - at, np.roll(at, 1, axis=1) - at
    return np.asarray((p[..., 0] * q[..., 1] - p[..., 1] * q[..., 0]) / size[:, None] ** 2)
