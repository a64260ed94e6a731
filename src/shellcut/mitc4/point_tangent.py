"""Stiffness dr/ds of quads with thickness points, by differentiation of the law.

The resultants r of a quad are functions of its sixteen strains s and of the history of t_{n-1}.
Their central differences, each strain moved by some 1e-8 there and back, are far finer than any
yield strain and differ from the derivative by round-off, 1e-8 of the moduli: Newton's iteration
with them converges as with exact ones until it has gained eight digits, and by as many in every
turn then. It is the *consistent* tangent ([SimoTaylor1985]): the whole return to the yield surface
is differentiated, not its rate form.

With frozen laws (:class:`~shellcut.material.point_law.PointLaw`) it is the stiffness of the film if
it unloads from the present state, which bounds that of the step.
"""

from __future__ import annotations

import numpy as np

from shellcut.arrays import Floats, Ints
from shellcut.material.law_dispatch import HistoryStep
from shellcut.numerics.jit import kernel
from shellcut.numerics.lanes import pick_all, put_all

from .element import N_STRAIN, Sixteen
from .forces import point_resultants
from .quad_strains import PointQuads, one_quad
from .thickness_points import PointRule

# Change of a Cartesian strain for the differences.
_STEP = 2e-8


def frozen_rule(rule: PointRule) -> PointRule | None:
    """Return the rule with frozen laws in place of those that have one; None if none has."""
    laws = rule.laws
    if not any(law.frozen for law in laws.laws):
        return None
    frozen = tuple(law.frozen or law for law in laws.laws)
    return rule._replace(laws=laws._replace(laws=frozen))


@kernel
def differentiate_resultants(
    slot: Ints,
    quads: PointQuads,
    history: Floats,
    dt: float,
    area: Floats,
    resultants: Floats,
    moduli: Floats,
) -> None:
    """Write r to resultants : (n, 16) and dr/ds to moduli : (n, 16, 16) of the quads at ``slot``.

    If moduli is empty, r alone.

    history : of t_{n-1}, as in the force kernels; not changed.  dt : length of the step [s].
    area : (n,), of the quads [mm²], which sets the differences.
    """
    nodes, rule = quads.quads, quads.points.rule
    width = nodes.corner.shape[2]
    trial = np.empty((1, history.shape[1], width))
    row = np.empty((1, N_STRAIN, width))
    height = np.abs(rule.place).max() + 0.5 * rule.weight.max()
    for i in range(slot.shape[0]):
        b, lane, flat, _, s = one_quad(nodes, slot[i])
        at = HistoryStep(history, trial, b, 0, dt)
        r, _, _ = point_resultants(quads, quads.points, flat, s, at, lane)
        for k in range(N_STRAIN):
            resultants[i, k] = r[k]
        if not moduli.shape[0]:
            continue
        for m in range(N_STRAIN):
            # Sixteen times the covariant strain, whose unit is the square of half an edge.
            step = 4.0 * area[i] * _STEP
            if m >= 12:
                step = 8.0 * np.sqrt(area[i]) * _STEP
            elif m >= 6:
                step /= height
            for sign in range(2):
                put_all(row, 0, 0, 0, s)
                row[0, m, 0] += step if sign == 0 else -step
                moved: Sixteen = pick_all(row, 0, 0, N_STRAIN, 0)
                r, _, _ = point_resultants(quads, quads.points, flat, moved, at, lane)
                for k in range(N_STRAIN):
                    if sign == 0:
                        moduli[i, k, m] = r[k] / (2.0 * step)
                    else:
                        moduli[i, k, m] -= r[k] / (2.0 * step)
        # It has a potential up to the differences' error; the tangent's solvers want it exactly.
        for k in range(N_STRAIN):
            for m in range(k):
                mean = 0.5 * (moduli[i, k, m] + moduli[i, m, k])
                moduli[i, k, m] = moduli[i, m, k] = mean
