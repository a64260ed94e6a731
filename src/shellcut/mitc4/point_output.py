"""Stress, thickness and history of quads with thickness points, from the law.

A law with history has no stress at the centre of a quad, where no history is kept. So the law is
evaluated where the forces evaluate it, at the four Gauss points and the points through the
thickness, with the present strain and the history of t_n. With S its stress in the Cartesian frame
there, sigma = S_ij f_i f_j / J as in :mod:`shellcut.mitc4.centre_stress`, with f_i = F ê_i and
J = |f_1 x f_2|, of linear laws; of others J is the ratio of volumes, with the thickness stretch, so
that sigma is the true stress at any strain. Output is the mean over the four Gauss points, of

=========  =====================================================================================
membrane   the mean over the thickness, with the weights of the quadrature
top        the uppermost point; of five Gauss points in a single layer it lies at 0.91 of h/2
bottom     the lowest point
mid        the point nearest to the mid-surface, or the mean of two that are equally near
nominal    as membrane, S turned with the surface instead of sigma
=========  =====================================================================================

The present thickness is the law's thickness stretch, integrated over the thickness.
"""

from __future__ import annotations

import numpy as np

from shellcut.arrays import Bools, Floats, Ints, SmallIds, Vec3, product
from shellcut.material.law_dispatch import HistoryStep, has_axes, point_stress, point_thickness
from shellcut.material.shell_material import ShellMaterial
from shellcut.numerics.jit import BoundOnce, inline, kernel
from shellcut.numerics.lanes import pick_all
from shellcut.numerics.vec3 import combine, cross, norm, scale
from shellcut.state import State

from .centre_stress import FaceStresses, check_place, check_quads, in_lamina
from .element import GAUSS, Modes, Sixteen
from .places import Places
from .quad_strains import PointQuads, one_quad
from .section import into_axes
from .thickness_points import N_FLAT_FRAME, N_FULL_FRAME, PointTables, strain_at, turn_strain


class PointOutput:
    """Output of a film that has thickness points."""

    def __init__(self, material: ShellMaterial, places: Places) -> None:
        self._places, rule = places, places.points.rule
        self._write_stresses = BoundOnce(_stresses)
        place, weight = rule.place, rule.weight
        off = np.abs(place)
        middle = off <= off.min() + 1e-9 * material.thickness
        share = np.stack([weight / weight.sum(), middle / middle.sum()])
        ends = np.eye(place.size)[[-1, 0]]
        self._share = {
            "membrane": share[0],
            "mid": share[1],
            "nominal": share[0],
            "top": ends[0],
            "bottom": ends[1],
        }
        n_point = place.size // len(material.layers)
        laws = [layer.material.law for layer in material.layers for _ in range(n_point)]
        self._by_volume = np.array([not law.linear for law in laws])
        self._history_share: dict[str, tuple[Floats, Ints]] = {}
        for name in dict.fromkeys(name for law in laws for name in law.history):
            has = np.array([name in law.history for law in laws])
            column = np.array(
                [law.history.index(name) if name in law.history else 0 for law in laws]
            )
            self._history_share[name] = has * weight / (product(has, weight)), column

    def cauchy(self, state: State, which: Ints, place: str) -> Floats:
        """Return the stress tensors of some quads in space [MPa], shape (n, 3, 3).

        Parameters
        ----------
        state : State
            History of t_n.
        which : ndarray of int, shape (n,)
            The quads whose output is wanted.
        place : {"mid", "top", "bottom", "nominal"}
            As in the table of this module.
        """
        check_place(place)
        which = check_quads(which, len(state.quads))
        return self._stress(state, which, [place])[0][:, 0]

    def faces(self, state: State) -> FaceStresses:
        """Return the stresses of membrane, top and bottom, and the thickness of all quads."""
        every, places = np.arange(len(state.quads)), ["membrane", "top", "bottom"]
        sigma, thickness = self._stress(state, every, places)
        return in_lamina(sigma, thickness, state.node.x, state.quads)

    def history_means(self, state: State) -> dict[str, Floats]:
        """Return the means of the history numbers by name, shape (n_quad,) each.

        Over the Gauss points and the thickness points of the layers whose law has this number.
        """
        rule, (n_block, _, width) = self._places.points.rule, state.history.shape
        shape = n_block, 4, rule.place.size, rule.n_history, width
        history = state.history.reshape(shape).mean(axis=1, dtype=float)
        means = {}
        for name, (share, column) in self._history_share.items():
            chosen = history[:, np.arange(column.size), column]
            rows = np.einsum("j,bjl->bl", share, chosen).ravel()
            means[name] = rows[self._places.blocks.slot]
        return means

    def _stress(self, state: State, which: Ints, places: list[str]) -> tuple[Floats, Floats]:
        sigma, thickness = np.zeros((len(which), len(places), 3, 3)), np.zeros(len(which))
        self._write_stresses(
            self._places.blocks.slot[which],
            self._places.present(state),
            state.history,
            np.stack([self._share[place] for place in places]),
            self._by_volume,
            places == ["nominal"],
            sigma,
            thickness,
        )
        return sigma, thickness


@inline
def _frame_at(
    points: PointTables, flat: bool, b: int, q: int, j: int, lane: int
) -> tuple[float, float, float, float, float]:
    """Return a, b, p of ê_1 and f, r of ê_2 at a point, of :mod:`.thickness_points`."""
    if flat:
        a, c, f = pick_all(points.flat_frame, b, N_FLAT_FRAME * q, 3, lane)
        return a, c, 0.0, f, 0.0
    at = N_FULL_FRAME * (q * points.rule.place.shape[0] + j)
    a, c, p, f, r = pick_all(points.full_frame, b, at, 5, lane)
    return a, c, p, f, r


@inline
def _strain_and_stretch(
    s: Sixteen,
    modes: tuple[Modes, Modes],
    frame: tuple[float, float, float, float, float],
    z: float,
    place: tuple[float, float],
) -> tuple[Vec3, Vec3, Vec3]:
    """Return (E_11, E_22, 2 E_12) as used for the forces, and f_1 and f_2 at a point."""
    a, c, p, f, r = frame
    (xm, tm), (xi, eta) = modes, place
    e, k = strain_at(s, 0, xi, eta), strain_at(s, 6, xi, eta)
    lifted = (e[0] + z * k[0], e[1] + z * k[1], e[2] + z * k[2])
    e1, e2, e12 = turn_strain(0.25 * a, 0.25 * c, 0.25 * f, lifted)
    g1, g2 = 0.25 * (s[12] + eta * s[13]), 0.25 * (s[14] + xi * s[15])
    ag, fg = 0.25 * (a * g1 + c * g2), 0.25 * f * g2
    strain = (e1 + p * ag, e2 + r * fg, e12 + r * ag + p * fg)
    d1 = combine(0.25, combine(1.0, xm[0], eta, xm[2]), 0.25 * z, combine(1.0, tm[0], eta, tm[2]))
    d2 = combine(0.25, combine(1.0, xm[1], xi, xm[2]), 0.25 * z, combine(1.0, tm[1], xi, tm[2]))
    along = combine(1.0, tm[3], xi, tm[0])
    across = combine(eta, tm[1], xi * eta, tm[2])
    director = combine(0.25, along, 0.25, across)
    f1 = combine(1.0, combine(a, d1, c, d2), p, director)
    f2 = combine(f, d2, r, director)
    return strain, f1, f2


@kernel
def _stresses(
    slot: SmallIds,
    quads: PointQuads,
    history: Floats,
    share: Floats,
    by_volume: Bools,
    nominal: bool,
    sigma: Floats,
    thickness: Floats,
) -> None:
    """Add the stresses and the thickness of quads to sigma : (n, n_place, 3, 3), thickness : (n,).

    share : (n_place, n_point), weights of the thickness points in each place.  by_volume :
    (n_point,), whether J is the ratio of volumes.  nominal : S turned
    with the surface instead of sigma.  The other arguments as in the force kernels.
    """
    nodes, points = quads.quads, quads.points
    rule, width = points.rule, nodes.corner.shape[2]
    n_point = rule.place.shape[0]
    trial = np.empty((1, history.shape[1], width))
    for i in range(slot.shape[0]):
        b, lane, flat, (xm, tm), s = one_quad(nodes, slot[i])
        at = HistoryStep(history, trial, b, 0, 0.0)
        # The thickness follows from the history after the law has been called; the state's is kept.
        after = HistoryStep(trial, trial, 0, 0, 0.0)
        for q in range(4):
            xi, eta = GAUSS[q]
            for j in range(n_point):
                block = b if flat else b - nodes.tables.n_flat
                frame = _frame_at(points, flat, block, q, j, lane)
                strain, f1, f2 = _strain_and_stretch(s, (xm, tm), frame, rule.place[j], (xi, eta))
                if has_axes(rule.laws):
                    along, aside = pick_all(points.axes, b, 2 * q, 2, lane)
                    strain = into_axes(along, aside, strain)
                    f1, f2 = (
                        combine(along, f1, aside, f2),
                        combine(along, f2, -aside, f1),
                    )
                first = (q * n_point + j) * rule.n_history
                S, _, _ = point_stress(rule.laws, j, strain, at, first, lane)
                stretch = point_thickness(rule.laws, j, strain, after, first, lane)
                thickness[i] += 0.25 * rule.weight[j] * stretch
                # |f_1 x f_2| is the change of area, times the thickness stretch that of volume.
                normal = cross(f1, f2)
                J = norm(normal) * (stretch if by_volume[j] else 1.0)
                if nominal:
                    # S turned with the surface: unit vectors in the place of the stretched ones.
                    f1 = scale(1.0 / norm(f1), f1)
                    f2 = cross(scale(1.0 / norm(normal), normal), f1)
                    J = 1.0
                for k in range(3):
                    for m in range(3):
                        values = (
                            S[0] * f1[k] * f1[m]
                            + S[1] * f2[k] * f2[m]
                            + S[2] * (f1[k] * f2[m] + f2[k] * f1[m])
                        ) / J
                        for place in range(share.shape[0]):
                            sigma[i, place, k, m] += 0.25 * share[place, j] * values
