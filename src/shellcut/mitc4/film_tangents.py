"""Tangent stiffness of the quads of a film: of the linear section, of the law, and its bound.

For a linear film it is the derivative of the forces. For a nonlinear law it is the consistent one
of a step from the history to the present positions; and its bound, for the time step, is that of
the frozen law (:class:`~shellcut.material.point_law.PointLaw`), or of the elastic moduli, with the
stresses of the law: the stiffness of the film if it unloads from the present state.

The resultants r of a quad with thickness points are functions of its sixteen strains s and of the
history of t_{n-1}. Their central differences, each strain moved by some 1e-8 there and back, are
far finer than any yield strain and differ from the derivative by round-off, 1e-8 of the moduli:
Newton's iteration with them converges as with exact ones until it has gained eight digits, and by
as many in every turn then. It is the *consistent* tangent ([SimoTaylor1985]): the whole return to
the yield surface is differentiated, not its rate form.
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np

from shellcut.arrays import Floats, Ints
from shellcut.material.law_dispatch import HistoryStep
from shellcut.numerics.jit import BoundOnce, kernel
from shellcut.numerics.lanes import pick_all, put_all

from .element import N_STRAIN, Sixteen
from .forces import point_resultants
from .places import Places
from .quad_strains import PointQuads, one_quad
from .tangent import N_FREEDOM, add_tangent_products, quad_tangents
from .thickness_points import PointRule

# Marks the moduli of the linear film.
_NO_MODULI = np.empty((0, N_STRAIN, N_STRAIN))
_ANY_BASIS = np.empty((0, 2, 3))

_Section: TypeAlias = tuple[Floats | None, bool, Floats]
"""Resultants, shape (n, 16), with True, or strains that are left out of those of the linear film,
with False; and moduli dr/ds, shape (n, 16, 16), of none for those of the linear film."""

# Change of a Cartesian strain for the differences.
_STEP = 2e-8


class FilmTangents:
    """Tangents of some quads of a film.

    Parameters
    ----------
    places : Places
        Where the quads stand.
    linear : bool
        Whether the law is linear in all layers.
    """

    def __init__(self, places: Places, linear: bool) -> None:
        self._places, self._linear = places, linear
        self._frozen = frozen_rule(places.points.rule)
        # Once each: Numba's type of a law has a digest of all that its functions read.
        self._differentiate, self._differentiate_frozen = (
            BoundOnce(differentiate_resultants) for _ in range(2)
        )

    @property
    def has_frozen_law(self) -> bool:
        """Whether a law relates the logarithmic strain to its stress, or has a like."""
        return self._frozen is not None

    def of_step(
        self,
        present: PointQuads,
        quads: Ints,
        area: Floats,
        history: Floats,
        dt: float,
        bent: Floats | None,
        basis: Floats,
    ) -> Floats:
        """Return the tangents of a step, shape (n, 20, 20).

        Parameters
        ----------
        present : PointQuads
            All quads at the present positions.
        quads, area : ndarray, shape (n,)
            Which quads, and their reference areas [mm²].
        history : ndarray
            Of the thickness points at the start of the step.
        dt : float
            Its length [s].
        bent : ndarray, shape (n, 16), optional
            Part of the strains that is left out of the stresses, of linear films.
        basis : ndarray, shape (n_node, 2, 3)
            Unit tangents along which directors turn; of no nodes for any.
        """
        section = self._section(present, quads, area, history, dt, bent)
        return self._made(present, quads, *section, basis)

    def bound(self, present: PointQuads, quads: Ints, area: Floats, history: Floats) -> Floats:
        """Return bounds of the tangents for the time step, shape (n, 20, 20)."""
        if self._linear:
            return self._made(present, quads, None, False)
        if self._frozen is None:
            law = self._differentiated(present, quads, area, history, 0.0, moduli=_NO_MODULI)
        else:
            # Its stress is that of the law but for the flow of one step, which only lowers it.
            frozen = present._replace(points=present.points._replace(rule=self._frozen))
            law = self._differentiated(frozen, quads, area, history, 0.0, frozen=True)
        return self._made(present, quads, *law)

    def damping(self, present: PointQuads, quads: Ints) -> Floats:
        """Return Bᵀ H B of some quads, which the damping acts with, shape (n, 20, 20).

        H is that of the elastic moduli, at every stretch, whatever law gives the stress.
        """
        return self._made(present, quads, None, True)

    def add_product(
        self,
        present: PointQuads,
        area: Floats,
        history: Floats,
        dt: float,
        bent: Floats | None,
        motion: tuple[Floats, Floats],
        rows: Floats,
    ) -> None:
        """Add the tangent of the whole film times a motion to rows : (n_node, 6)."""
        slot = self._places.blocks.slot
        every = np.arange(slot.size)
        bent, given, moduli = self._section(present, every, area, history, dt, bent)
        add_tangent_products(
            slot=slot,
            quads=present.quads,
            bent=np.zeros((slot.size, N_STRAIN)) if bent is None else bent,
            given=given,
            moduli=moduli,
            dx=np.asfortranarray(motion[0]),
            dt=np.asfortranarray(motion[1]),
            rows=rows,
        )

    def _section(
        self,
        present: PointQuads,
        quads: Ints,
        area: Floats,
        history: Floats,
        dt: float,
        bent: Floats | None,
    ) -> _Section:
        """Return what the kernels take of the section of some quads in a step."""
        if self._linear:
            return bent, False, _NO_MODULI
        return self._differentiated(present, quads, area, history, dt)

    def _differentiated(
        self,
        present: PointQuads,
        quads: Ints,
        area: Floats,
        history: Floats,
        dt: float,
        *,
        moduli: Floats | None = None,
        frozen: bool = False,
    ) -> _Section:
        """Return r and dr/ds of some quads, the latter by default."""
        resultants = np.empty((quads.size, N_STRAIN))
        if moduli is None:
            moduli = np.empty((quads.size, N_STRAIN, N_STRAIN))
        differentiate = self._differentiate_frozen if frozen else self._differentiate
        slot = self._places.blocks.slot[quads]
        differentiate(slot, present, history, dt, area, resultants, moduli)
        return resultants, True, moduli

    def _made(
        self,
        present: PointQuads,
        quads: Ints,
        bent: Floats | None,
        given: bool,
        moduli: Floats = _NO_MODULI,
        basis: Floats = _ANY_BASIS,
    ) -> Floats:
        tangent = np.empty((quads.size, N_FREEDOM, N_FREEDOM))
        quad_tangents(
            slot=self._places.blocks.slot[quads],
            quads=present.quads,
            tangents=basis,
            bent=np.zeros((quads.size, N_STRAIN)) if bent is None else bent,
            given=given,
            moduli=moduli,
            tangent=tangent,
        )
        return tangent


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
    # A curvature of step / height strains the farthest height by step; half a weight, for a
    # single point lies in the middle.
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
            # Central differences, of which the error is of the second order.
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
