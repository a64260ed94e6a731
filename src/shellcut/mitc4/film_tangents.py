"""Tangent stiffness of the quads of a film: of the linear section, of the law, and its bound.

For a linear film it is the derivative of the forces. For a nonlinear law it is the consistent one
(:mod:`.point_tangent`), of a step from the history to the present positions; and its bound, for the
time step, is that of the frozen law, or of the elastic moduli, with the stresses of the law.
"""

from __future__ import annotations

import numpy as np

from shellcut.arrays import Floats, Ints

from .element import N_STRAIN
from .places import Places
from .point_tangent import differentiate_resultants, frozen_rule
from .quad_strains import PointQuads
from .tangent import N_FREEDOM, add_tangent_products, quad_tangents

# Marks the moduli of the linear film.
_NO_MODULI = np.empty((0, N_STRAIN, N_STRAIN))
_ANY_BASIS = np.empty((0, 2, 3))


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
        if self._linear:
            return self._made(present, quads, bent, False, _NO_MODULI, basis)
        resultants, moduli = self._differentiated(present, quads, area, history, dt)
        return self._made(present, quads, resultants, True, moduli, basis)

    def bound(self, present: PointQuads, quads: Ints, area: Floats, history: Floats) -> Floats:
        """Return bounds of the tangents for the time step, shape (n, 20, 20)."""
        if self._linear:
            return self._made(present, quads, None, False, _NO_MODULI)
        if self._frozen is None:
            resultants, moduli = self._differentiated(
                present, quads, area, history, 0.0, moduli=_NO_MODULI
            )
        else:
            # Its stress is that of the law but for the flow of one step, which only lowers it.
            frozen = present._replace(points=present.points._replace(rule=self._frozen))
            resultants, moduli = self._differentiated(frozen, quads, area, history, 0.0)
        return self._made(present, quads, resultants, True, moduli)

    def damping(self, present: PointQuads, quads: Ints) -> Floats:
        """Return Bᵀ H B of some quads, which the damping acts with, shape (n, 20, 20).

        H is that of the elastic moduli, at every stretch, whatever law gives the stress.
        """
        none = np.zeros((quads.size, N_STRAIN))
        return self._made(present, quads, none, True, _NO_MODULI)

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
        given, moduli = not self._linear, _NO_MODULI
        if given:
            bent, moduli = self._differentiated(present, np.arange(slot.size), area, history, dt)
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

    def _differentiated(
        self,
        present: PointQuads,
        quads: Ints,
        area: Floats,
        history: Floats,
        dt: float,
        moduli: Floats | None = None,
    ) -> tuple[Floats, Floats]:
        """Return r, shape (n, 16), and dr/ds, shape (n, 16, 16), of some quads."""
        resultants = np.empty((quads.size, N_STRAIN))
        if moduli is None:
            moduli = np.empty((quads.size, N_STRAIN, N_STRAIN))
        differentiate_resultants(
            slot=self._places.blocks.slot[quads],
            quads=present,
            history=history,
            dt=dt,
            area=area,
            resultants=resultants,
            moduli=moduli,
        )
        return resultants, moduli

    def _made(
        self,
        present: PointQuads,
        quads: Ints,
        bent: Floats | None,
        given: bool,
        moduli: Floats,
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
