"""Superconvergent patch recovery of the nodal stress ([ZienkiewiczZhu1992], [Frangi2010] 5).

The samples are the Cauchy stresses at the centres of the quads around a node. Their components are
rotated into the node's tangent frame and fitted with 1, x, y; the value at the node is the
recovered stress. The patch is the node's own fan, so it never reaches across a crack: split nodes
have split fans. A patch with fewer than three samples, or with samples nearly on a line, uses the
polynomial of the neighbour on the same side with the largest patch; these nodes are counted. If
there is none, the mean of the samples is used.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, NamedTuple

import numpy as np

from shellcut.arrays import Floats, Ints, SmallIds
from shellcut.numerics.jit import inline, kernel
from shellcut.numerics.vec3 import tangent_basis
from shellcut.state import State

from .shell import MITC4Shell
from .surface import Surface

# Least ratio of the smaller to the larger second moment of the samples: below it the slope normal
# to their line is noise.
_FLATTEST_PATCH = 1e-3


@dataclass(frozen=True)
class NodalStress:
    """Recovered stress of some nodes.

    Attributes
    ----------
    principal : ndarray, shape (n,)
        Largest principal stress [MPa].
    direction : ndarray, shape (n, 3)
        Its unit direction in space, in the tangent plane.
    n_borrowed : int
        Number of nodes that used a neighbour's polynomial.
    """

    principal: Floats
    direction: Floats
    n_borrowed: int


class _Patches(NamedTuple):
    """The quads around nodes, and the stresses at their centres."""

    surface: Surface
    quads_at: Annotated[SmallIds, "(n_node, n_most)"]
    """Quads at every node; the first ``n_quad_at`` are valid."""
    n_quad_at: Annotated[SmallIds, "(n_node,)"]
    sampled: Annotated[Ints, "(n_sampled,)"]
    """All quads around the nodes and around their neighbours, ascending."""
    stress: Annotated[Floats, "(n_sampled, 3, 3)"]
    """Of these [MPa]."""


def recover(
    state: State,
    shell: MITC4Shell,
    nodes: Ints,
    *,
    tips: Sequence[int] = (),
) -> NodalStress:
    """Recover the largest principal stress of the mid-surface at some nodes.

    Parameters
    ----------
    state : State
        At t_n.
    shell : MITC4Shell
        For the stresses at the quads' centres.
    nodes : ndarray of int, shape (n,)
        Which nodes.
    tips : sequence of int
        Crack tips: their patches have quads on both flanks and are not used for other nodes.
    """
    if len(nodes) == 0:
        return NodalStress(np.zeros(0), np.zeros((0, 3)), 0)
    n = state.node
    rows = [n.quads[i, : n.n_quad_at[i]] for i in nodes]
    ring = np.unique(state.quads[np.concatenate(rows)])
    needed = np.unique(np.concatenate([n.quads[i, : n.n_quad_at[i]] for i in ring]))
    principal, direction = np.zeros(len(nodes)), np.zeros((len(nodes), 3))
    borrowed = _recover(
        nodes=np.asarray(nodes, np.int64),
        patches=_Patches(
            Surface(n.x, n.t, state.quads),
            n.quads,
            n.n_quad_at,
            needed,
            shell.stress(state, needed),
        ),
        tips=np.sort(np.array(tips, np.int64)),
        principal=principal,
        direction=direction,
    )
    return NodalStress(principal, direction, borrowed)


@inline
def _fit(
    n: int,
    at: int,
    frame: Floats,
    patches: _Patches,
    value: Floats,
) -> bool:
    """Fit the patch of node n in the given frame, write its value at node ``at``; False if poor."""
    surface, quads_at, n_quad_at, sampled, stress = patches
    x, quads = surface.x, surface.quads
    k = n_quad_at[n]
    px, py = np.empty(k), np.empty(k)
    s = np.empty((k, 3))
    mx = my = 0.0
    mean = np.zeros(3)
    for i in range(k):
        e = quads_at[n, i]
        # Stresses are stored for the quads that are needed only.
        sample = np.searchsorted(sampled, e)
        px[i] = py[i] = 0.0
        for c in range(3):
            centre = 0.25 * (
                x[quads[e, 0], c] + x[quads[e, 1], c] + x[quads[e, 2], c] + x[quads[e, 3], c]
            )
            px[i] += (centre - x[at, c]) * frame[0, c]
            py[i] += (centre - x[at, c]) * frame[1, c]
        # (11, 22, 12) in the frame of the node at which the value is wanted.
        for row in range(3):
            a = 1 if row == 1 else 0
            b = 0 if row == 0 else 1
            s[i, row] = 0.0
            for c in range(3):
                for d in range(3):
                    s[i, row] += frame[a, c] * stress[sample, c, d] * frame[b, d]
            mean[row] += s[i, row] / k
        mx += px[i] / k
        my += py[i] / k
    # Least squares with 1, x, y: about the mean the constant decouples from the slopes.
    sxx = sxy = syy = 0.0
    for i in range(k):
        sxx += (px[i] - mx) ** 2
        sxy += (px[i] - mx) * (py[i] - my)
        syy += (py[i] - my) ** 2
    for row in range(3):
        value[row] = mean[row]
    half_trace = 0.5 * (sxx + syy)
    spread = np.sqrt((0.5 * (sxx - syy)) ** 2 + sxy**2)
    if k < 3 or half_trace - spread < _FLATTEST_PATCH * (half_trace + spread):
        return False
    det = sxx * syy - sxy * sxy
    for row in range(3):
        bx = by = 0.0
        for i in range(k):
            bx += (px[i] - mx) * (s[i, row] - mean[row])
            by += (py[i] - my) * (s[i, row] - mean[row])
        slope_x = (syy * bx - sxy * by) / det
        slope_y = (sxx * by - sxy * bx) / det
        value[row] -= slope_x * mx + slope_y * my
    return True


@kernel
def _recover(
    nodes: Ints,
    patches: _Patches,
    tips: Ints,
    principal: Floats,
    direction: Floats,
) -> int:
    """Write principal : (n,) and direction : (n, 3) of the nodes; return ``n_borrowed``.

    tips : ascending.
    """
    (_, t, quads), quads_at, n_quad_at = patches.surface, patches.quads_at, patches.n_quad_at
    frame = np.empty((2, 3))
    value, other = np.empty(3), np.empty(3)
    borrowed = 0
    for i in range(nodes.shape[0]):
        n = nodes[i]
        tangent_basis(t, n, frame)
        if not _fit(n, n, frame, patches, value):
            # The polynomial of the neighbour with most samples; a tip's has both flanks in it.
            richest = 0
            for j in range(n_quad_at[n]):
                e = quads_at[n, j]
                for a in range(4):
                    near = quads[e, a]
                    k = np.searchsorted(tips, near)
                    lends = k == tips.shape[0] or tips[k] != near
                    if not (near != n and lends and n_quad_at[near] > richest):
                        continue
                    if _fit(near, n, frame, patches, other):
                        richest = n_quad_at[near]
                        for c in range(3):
                            value[c] = other[c]
            if richest > 0:
                borrowed += 1
        mean = 0.5 * (value[0] + value[1])
        radius = np.sqrt((0.5 * (value[0] - value[1])) ** 2 + value[2] ** 2)
        # Mohr's circle.
        angle = 0.5 * np.arctan2(2.0 * value[2], value[0] - value[1])
        principal[i] = mean + radius
        for c in range(3):
            direction[i, c] = np.cos(angle) * frame[0, c] + np.sin(angle) * frame[1, c]
    return borrowed
