"""How the energy of quads changes as their corners slide along the reference film.

The film in space stays where it is while the corners of some quads slide along the reference
surface: the *inner variation* of the energy, whose sum over a domain around the tip of a crack is
the force on that tip ([Eshelby1951]; on meshes [MuellerMaugin2002]).

At each point through the thickness the energy density is psi(e, h), of the Cartesian strain e there
and of the history h, with which the law is frozen: what has flowed stays. A slide of the reference
and a move of the film in space change the energy of a quad by the sum over its points of

    (v psi)' = v' psi + v (S · e' + psi_h · h'),

v being the volume of the point. e = A s with the sixteen strains s of the quad, the present
products minus those of the reference (:mod:`shellcut.mitc4.element`), so that e' = A' s + A s'; A'
and v' are differences over ``_STEP``. The history belongs to the film below: where a point slides
by q e, it reaches film whose history is another, h' = q e · ∇h. For a film that yields
psi_h · h' = -T · (q e · ∇) eps_p, with the stress T.

**The slope of the history.** For ∇h, the numbers of a quad and of all that share a node with it are
fitted, height by height, by a plane over their Gauss points, weighted by the film there. That is
exact for a history that is linear in place, also at a border, where all neighbours lie on one side.
The flanks of a crack share no node, so neither is part of the fit of the other. Strains among
the numbers are turned into common axes for the fit, and their slopes back. As its corners slide, a
quad turns, and its axes with it: they find the same strain of the film in other components.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple, TypeAlias

import numpy as np

from shellcut.arrays import Floats, Ints, each, product
from shellcut.material.law_dispatch import HistoryStep, PointLaws, point_stress
from shellcut.material.orthotropic import strain_turns
from shellcut.material.shell_material import POINTS_OF_ELASTIC, ShellMaterial
from shellcut.numerics.bilinear import shape_functions
from shellcut.numerics.jit import kernel
from shellcut.numerics.small_matrices import inverse, pseudo_inverse
from shellcut.state import State

from .element import GAUSS
from .film_tangents import frozen_rule
from .section import (
    axes_in_frame,
    cartesian_map,
    frame_components,
    gauss_geometry,
    strain_map,
    turn_into_axes,
)
from .shell import MITC4Shell
from .tangent import quad_products
from .thickness_points import PointRule, build_rule

# Of the largest change of the history in a slide by 1 mm: a difference exact to its square.
_HISTORY_STEP = 1e-6

# Of a quad's size: the central difference is exact to its square, 1e-8; round-off is 1e-12.
_STEP = 1e-4

# Parametric derivatives of the shape functions at the four corners, shape (4, 2, 4).
_AT_CORNERS = 0.5 * np.array(
    [
        [[-1, 1, 0, 0], [-1, 0, 0, 1]],
        [[-1, 1, 0, 0], [0, -1, 1, 0]],
        [[0, 0, 1, -1], [0, -1, 1, 0]],
        [[0, 0, 1, -1], [-1, 0, 0, 1]],
    ],
    float,
)

# Of the spread of the places: directions in which they lie closer have no slope.
_FLAT = 1e-6

# Change of strains (e_11, e_22, 2 e_12) as the axes turn, per radian.
_SPIN = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [-2.0, 2.0, 0.0]])

_AT_GAUSS = np.array([shape_functions(*point) for point in GAUSS])

Ends: TypeAlias = tuple[Floats, Floats]
"""Reference positions [mm] and directors of quads that have slid, shape (n, 4, 3)."""


class _Maps(NamedTuple):
    """What a reference gives to the points of some quads, Gauss points outermost."""

    strain: Floats
    """A, from the sixteen strains to (e_11, e_22, 2 e_12, 2 e_13, 2 e_23), (n, n_point, 5, 16)."""
    volume: Floats
    """v, shape (n, n_point) [mm³]."""
    products: Floats
    """Of the reference, shape (n, 16)."""


class SlidingPoints:
    """The energy of some quads of a law with or without history, and its change with some slides.

    Parameters
    ----------
    X, T : ndarray, shape (n, 4, 3)
        Reference positions [mm] and directors.
    slides : ndarray, shape (n_slide, n, 4, 3)
        How far each corner slides per mm of the slide: along the quad's own surface, the part
        across it does not count.
    material : ShellMaterial
        Of the film; one whose section is integrated once gets points here.
    """

    def __init__(self, X: Floats, T: Floats, slides: Floats, material: ShellMaterial) -> None:
        if material.integration_points is None:
            material = replace(material, points_per_layer=POINTS_OF_ELASTIC[True])
        rule = build_rule(material)
        rule = frozen_rule(rule) or rule
        self._laws = rule.laws
        self._height = np.tile(np.arange(rule.place.size), len(GAUSS))
        leads = np.array([law.first_leads for law in rule.laws.laws])
        self._leads = np.flatnonzero(leads[rule.laws.kind[self._height]])
        g11, g12, g22 = rule.shear[self._height].T
        self._shear = np.array([[g11, g12], [g12, g22]]).transpose(2, 0, 1)
        self._here = _maps(X, T, material, rule)
        self._changes = []
        for far, near, step in slide_ends(X, T, slides):
            pairs = zip(_maps(*far, material, rule), _maps(*near, material, rule), strict=True)
            self._changes.append(_Maps(*((a - b) / step for a, b in pairs)))

    def changes(
        self,
        x: Floats,
        t: Floats,
        moves: Floats,
        turns: Floats,
        history: tuple[Floats, Floats] | None = None,
    ) -> Floats:
        """Return the changes of the energies with each slide [N], shape (n_slide, n).

        Parameters
        ----------
        x, t : ndarray, shape (n, 4, 3)
            Present positions [mm] and directors.
        moves, turns : ndarray, shape (n_slide, n, 4, 3)
            How each corner moves in space with each slide, per mm, and its director turns [1/mm].
        history : tuple of ndarray, optional
            Of :meth:`SlidingHistory.of_state`, for laws that keep a history.
        """
        here = self._here
        s = quad_products(x, t) - here.products
        e = np.einsum("epij,ej->epi", here.strain, s)
        h, slides = (np.zeros((*e.shape[:2], 0)), None) if history is None else history
        S, stored = self._law(e, h)
        shear = np.einsum("pij,epj->epi", self._shear, e[..., 3:])
        density = stored + 0.5 * np.einsum("epi,epi->ep", shear, e[..., 3:])
        stress = np.concatenate([S, shear], axis=2)
        found = np.empty((len(moves), len(x)))
        for k, (change, move, turn) in enumerate(zip(self._changes, moves, turns, strict=True)):
            # Products are quadratic, so that this difference is exact over any step.
            moved = 0.5 * (quad_products(x + move, t + turn) - quad_products(x - move, t - turn))
            strain = np.einsum("epij,ej->epi", change.strain, s)
            strain += np.einsum("epij,ej->epi", here.strain, moved - change.products)
            by_strain = np.einsum("epi,epi->ep", stress, strain)
            if slides is not None:
                by_strain += self._by_history(e, h, slides[k])
            found[k] = (change.volume * density + here.volume * by_strain).sum(axis=1)
        return found

    def _by_history(self, e: Floats, history: Floats, slope: Floats) -> Floats:
        """Return psi_h · h', shape (n, n_point)."""
        largest = np.abs(slope).max(initial=0.0)
        if largest == 0.0:
            return np.zeros(e.shape[:2])
        step = _HISTORY_STEP / largest
        (_, high), (_, low) = (self._law(e, history + sign * step * slope) for sign in (1.0, -1.0))
        return np.asarray((high - low) / (2.0 * step))

    def _law(self, e: Floats, history: Floats) -> tuple[Floats, Floats]:
        """Return S, shape (n, n_point, 3), and psi, shape (n, n_point)."""
        history = history.copy()
        # What has not flowed yet may slide to film that has: its history must be read, too.
        if history.shape[2]:
            first = history[:, self._leads, 0]
            history[:, self._leads, 0] = np.maximum(first, np.finfo(float).tiny)
        S, stored = np.empty((*e.shape[:2], 3)), np.empty(e.shape[:2])
        _evaluate(self._laws, self._height, e, history, S, stored)
        return S, stored


def slide_ends(X: Floats, T: Floats, slides: Floats) -> Iterator[tuple[Ends, Ends, float]]:
    """Yield, for each slide, (X, T) a little along it and before it, and their distance [mm].

    Parameters as of :class:`SlidingPoints`.
    """
    base = np.einsum("apb,ebi->eapi", _AT_CORNERS, X)
    step = _STEP * float(np.sqrt(np.einsum("eapi,eaqi->eapq", base, base)[..., 0, 0].mean()))
    for dX, dT in zip(*slid(X, T, slides), strict=True):
        yield (X + step * dX, T + step * dT), (X - step * dX, T - step * dT), 2.0 * step


def slid(X: Floats, T: Floats, slides: Floats) -> tuple[Floats, Floats]:
    """Return how corners and directors change that slide along their quads, (n_slide, n, 4, 3).

    Parameters as of :class:`SlidingPoints`.
    """
    base = np.einsum("apb,ebi->eapi", _AT_CORNERS, X)
    turn = np.einsum("apb,ebi->eapi", _AT_CORNERS, T)
    metric = np.einsum("eapi,eaqi->eapq", base, base)
    covariant = np.einsum("eapi,keai->keap", base, slides)
    by = np.einsum("eapq,keaq->keap", inverse(metric), covariant)
    return np.einsum("keap,eapi->keai", by, base), np.einsum("keap,eapi->keai", by, turn)


def _maps(X: Floats, T: Floats, material: ShellMaterial, rule: PointRule) -> _Maps:
    """Return what a reference gives to the points."""
    maps, volumes = [], []
    for point, (n, A1, A2, T0, T1, T2) in zip(GAUSS, gauss_geometry(X, T), strict=True):
        B = strain_map(*point)
        turn = None
        if material.has_axes:
            turn = turn_into_axes(A1, A2, T0, material.direction_at(np.einsum("a,eac->ec", n, X)))
        for z, weight in zip(rule.place, rule.weight, strict=True):
            G1, G2 = A1 + z * T1, A2 + z * T2  # [Frangi2010] (6)
            Q, _ = cartesian_map(G1, G2, T0)
            lifted = np.concatenate([B[:3] + z * B[3:6], B[6:]])
            maps.append(product(Q if turn is None else product(turn, Q), lifted))
            volumes.append(weight * np.einsum("ei,ei->e", np.cross(G1, G2), T0))
    return _Maps(np.stack(maps, axis=1), np.stack(volumes, axis=1), quad_products(X, T))


@kernel
def _evaluate(
    laws: PointLaws, height: Ints, strain: Floats, history: Floats, S: Floats, stored: Floats
) -> None:
    """Write the stress S : (n, n_point, 3) and the stored energy density : (n, n_point).

    height : (n_point,), place of the point among the heights.  strain : (n, n_point, 5).
    history : (n, n_point, n_history).
    """
    n_history = history.shape[2]
    before, after = np.zeros((1, n_history, 8)), np.zeros((1, n_history, 8))
    for i in range(strain.shape[0]):
        for p in range(strain.shape[1]):
            # The law reads a block of eight lanes; only the first is in use.
            for k in range(n_history):
                before[0, k, 0] = history[i, p, k]
            e = (strain[i, p, 0], strain[i, p, 1], strain[i, p, 2])
            at = HistoryStep(before, after, 0, 0, 0.0)
            stress, energy, _ = point_stress(laws, height[p], e, at, 0, 0)
            S[i, p, 0], S[i, p, 1], S[i, p, 2] = stress
            stored[i, p] = energy


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
