"""How the history at the points of quads changes as these slide along the reference film.

The history belongs to the film: a point that slides by q e reaches film with the history
h + q e · ∇h. For the slope ∇h, the numbers of a quad and of all that share a node with it are
fitted, height by height, by a plane over their Gauss points, weighted by the film there. That is
exact for a history that is linear in place, also at a border, where all neighbours lie on one side.
The flanks of a crack share no node, so neither is part of the fit of the other. Strains among
the numbers are turned into common axes for the fit, and their slopes back. As its corners slide, a
quad turns, and its axes with it: they find the same strain of the film in other components.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from shellcut.arrays import Floats, Ints, each, product
from shellcut.material.orthotropic import strain_turns
from shellcut.material.shell_material import ShellMaterial
from shellcut.numerics.bilinear import shape_functions
from shellcut.numerics.small_matrices import inverse, pseudo_inverse
from shellcut.state import State

from .element import GAUSS
from .section import axes_in_frame, frame_components, gauss_geometry
from .shell import MITC4Shell
from .sliding_points import slide_ends

# Of the spread of the places: directions in which they lie closer have no slope.
_FLAT = 1e-6

# Change of strains (e_11, e_22, 2 e_12) as the axes turn, per radian.
_SPIN = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [-2.0, 2.0, 0.0]])

_AT_GAUSS = np.array([shape_functions(*point) for point in GAUSS])


class SlidingHistory(NamedTuple):
    """The history of some quads and its change with two slides, as long as the topology stays."""

    slot: Ints
    """Places of all quads that take part in a fit, shape (n_near,)."""
    own: Ints
    """Which of these are the quads that slide, shape (n,)."""
    weights: Floats
    """That give the changes at the Gauss points of the latter, per mm of each slide, from the
    values at those of all, shape (2, n, 4, n_near, 4) [1/mm]."""
    turn: Floats
    """Of strains from the axes of Gauss points into common ones, shape (n_near, 4, 3, 3)."""
    spin: Floats
    """How the axes of the quads that slide turn with each slide, shape (2, n, 4) [rad/mm]."""
    strains: tuple[tuple[int, ...], ...]
    """For each height, where strains begin among the history numbers."""

    @classmethod
    def of(
        cls, state: State, shell: MITC4Shell, rows: Ints, q: Floats, base: Floats
    ) -> SlidingHistory:
        """Prepare the changes.

        Parameters
        ----------
        state, shell : State, MITC4Shell
            Of the topology.
        rows : ndarray of int, shape (n,)
            The quads that slide, in increasing order.
        q : ndarray, shape (n, 4)
            How far their corners do, over the slide.
        base : ndarray, shape (2, 3)
            Unit vectors of the sheet, along which the slides are.
        """
        film, quads, layers = shell.reference, state.quads, shell.material.layers
        near = np.flatnonzero(np.isin(quads, quads[rows]).any(axis=1))
        X, T = film.x[film.quads[near]], film.t[film.quads[near]]
        places = np.einsum("qa,eai,ki->eqk", _AT_GAUSS, X, base)
        film_area = shell.area[near] * state.quad.share[near]
        slopes = []
        for row in rows:
            on = np.isin(quads[near], quads[row]).any(axis=1)
            slopes.append(_slope(places, on * film_area))
        weights = np.einsum("eq,kenr->keqnr", product(q, _AT_GAUSS.T), np.stack(slopes, axis=1))
        n_each = shell.points.rule.place.size // len(layers)
        strains = tuple(layer.material.law.turning for layer in layers for _ in range(n_each))
        own = np.searchsorted(near, rows)
        slides = np.einsum("ea,ki->keai", q, base)
        spin = []
        for far, before, step in slide_ends(X[own], T[own], slides):
            ends = [_angles(*end, shell.material, base) for end in (far, before)]
            turn = ends[0] - ends[1]
            # Without the jump of an angle at half a turn.
            spin.append((turn - 2.0 * np.pi * np.round(turn / (2.0 * np.pi))) / step)
        angle = _angles(X, T, shell.material, base)
        turn = strain_turns(each(math.cos, angle), -each(math.sin, angle))
        return cls(shell.blocks.slot[near], own, weights, turn, np.array(spin), strains)

    def of_state(self, state: State) -> tuple[Floats, Floats]:
        """Return the history of the sliding quads, and its changes per mm of each slide.

        Returns
        -------
        history : ndarray, shape (n, n_point, n_history)
            Gauss points outermost.
        changes : ndarray, shape (2, n, n_point, n_history)
        """
        n_block, _, width = state.history.shape
        table = state.history.reshape(n_block, len(GAUSS), len(self.strains), -1, width)
        near = table[self.slot // width, ..., self.slot % width].astype(float)
        level = near.copy()
        for height, strains in enumerate(self.strains):
            for k in strains:
                part = level[:, :, height, k : k + 3]
                part[...] = np.einsum("eqij,eqj->eqi", self.turn, part)
        changes = np.einsum("keqnr,nrhj->keqhj", self.weights, level)
        back, history = inverse(self.turn[self.own]), near[self.own]
        for height, strains in enumerate(self.strains):
            for k in strains:
                part = changes[..., height, k : k + 3]
                spun = product(history[:, :, height, k : k + 3], _SPIN.T)
                part[...] = np.einsum("eqij,keqj->keqi", back, part)
                part += self.spin[..., None] * spun
        shape = len(history), -1, near.shape[-1]
        return history.reshape(shape), changes.reshape(2, *shape)


def _slope(places: Floats, weight: Floats) -> Floats:
    """Return the weights of all values in the slopes of the plane through them, shape (2, n, 4).

    places : (n, 4, 2), of the values.  weight : (n,), of the quads, 0 for those that take no part.
    """
    w = np.repeat(weight[:, None], places.shape[1], axis=1)
    if not w.any():
        return np.zeros((2, *w.shape))
    off = places - np.einsum("eq,eqk->k", w, places) / w.sum()
    spread = np.einsum("eq,eqi,eqj->ij", w, off, off)
    return np.asarray(np.einsum("ij,eqj,eq->ieq", pseudo_inverse(spread, _FLAT), off, w))


def _angles(X: Floats, T: Floats, material: ShellMaterial, base: Floats) -> Floats:
    """Return the angles from the first vector of a base to axis 1 at Gauss points, shape (n, 4)."""
    angles = []
    for n, A1, A2, T0, _, _ in gauss_geometry(X, T):
        _, frame = frame_components(A1, A2, T0)
        axis = frame[:, 0]
        if material.has_axes:
            along = material.direction_at(np.einsum("a,eac->ec", n, X))
            axis = np.einsum("in,nij->nj", axes_in_frame(A1, A2, T0, along), frame)
        angles.append(each(math.atan2, product(axis, base[1]), product(axis, base[0])))
    return np.stack(angles, axis=1)
