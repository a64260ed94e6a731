"""The direction of a crack that no blade drives: most energy released, largest pull.

When it runs is not decided here but by its trial cut (:mod:`.trial_cut`).

A crack needs energy, G h per mm, and it needs stress, sigma_F, where it is to open. A sharp tip has
stress enough and lacks energy; film under an even stress has energy enough and lacks stress. With
J(e) the energy released per mm of a crack along e (:mod:`.tip_force`) and p(e) the stress across
it in the sheet, the measure of both,

    phi(e) = J(e) / R + (p(e) / sigma_F)²,

is 1 when the crack runs: a crack of length a under a stress p in a large sheet has J = pi a p² h /
E, and phi = 1 with R = G h is the rule p² (pi a + E G / sigma_F²) = E G, good for short and long
cracks ([ElHaddad1979]). R is the energy that the crack absorbs now, which is less than G h until
its process zone has grown. When a tip is due, by its trial cut (:mod:`.trial_cut`), phi is 1, so R
follows: the energy has to make up for what the stress leaves open,

    phi(e) = (1 - s) J(e) / max J + (p(e) / sigma_F)²,    s = max (p / sigma_F)² <= 1.

**The crack runs in the direction where phi is largest.** Far from strength, s = 0, it runs along J:
so does a tear out of the plane, where the energy does not depend on the stress ahead. Under even
tension, s = 1, it runs across the largest principal stress. Nothing else enters. Where strength and
energy depend on the direction (:mod:`.anisotropy`), J(e) and p(e) are those over f(e).

The stress ahead of a tip, sigma(e), is that of the sheet and the tip's own, which J counts already:
p(e) = sigma(e) p / max sigma with what p is by J and max sigma (:mod:`.sheet_stress`). Without that
a fold, which pulls most along the tears beside it, would turn them from where energy is released.

sigma is the traction that the mean Cauchy stress of the mid-surface ahead exerts across e, as far
as it pulls: over the quads ahead, weighted by the area of their film and a Gaussian as wide as the
process zone is long, and ``AVERAGE`` edge lengths at least: nearer than that stress is what the
cables carry. Their mean distance is sqrt(pi / 2) of that width. On a curved film each stress is
first turned into the sheet at the tip by the least rotation that takes one normal to the other: the
mean of tensors in planes that lean against each other would lose the part across the lean. Film
that is not connected to the film at the tip counts for neither J nor p.

All film moves along with the tip that is no farther from it than the cables carry, measured along
the crack, so that J is the energy that flows into all of the process zone. Over that length film
bends that is torn out of its plane, more on one flank than on the other. A smaller domain misses
that and turns J aside; what its cables give would make up for the part of J along the crack only,
for a line that moves sideways keeps its length. Where another part of the border or another tip is
nearer than ``LEAST`` no domain is left to tell where energy is released, and J is taken to lie
along the crack.

What a film would give back is not known if its law keeps a history and cannot be frozen; there the
stress decides alone.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from shellcut.arrays import Floats, Ints, each, product, unit
from shellcut.cables.cohesive_law import CohesiveTable
from shellcut.mesh.quad_geometry import corner_normals
from shellcut.mitc4.shell import MITC4Shell
from shellcut.numerics.bilinear import shape_functions
from shellcut.numerics.small_matrices import symmetric_eigen
from shellcut.state import BROKEN, KnownTopology, State

from .anisotropy import Anisotropy
from .cut_film import CutFilm
from .film_border import GAP, FilmBorder
from .sheet_stress import sheet_stress
from .tip import Tip
from .tip_domain import TipDomain
from .tip_force import TipForce, gives_back

AVERAGE = 2.5
"""Least standard deviation of the weights around a tip, in local edge lengths."""

FALL = 2
"""Local edge lengths over which the motion of the film around a tip falls to zero, and least radius
within which all of it moves along."""

LEAST = 1.5
"""Local edge lengths between a tip and what does not move along with it, below which no domain
shows where energy is released: the crack keeps its direction."""

_ALONG = np.array([1.0, 0.0])

# Of 1 + c, for film folded back onto itself, where no least rotation exists.
_FOLDED = 1e-3

# Quads farther than this many standard deviations have no weight.
_FAR = 2.5

# Forward directions that are compared; between them phi is a parabola, exact to 1e-4 degrees.
_ANGLES = np.radians(np.linspace(-90.0, 90.0, 361))
_DIRECTIONS = np.stack([each(math.cos, _ANGLES), each(math.sin, _ANGLES)], axis=1)

# A force below this is none.
_TINY = float(np.finfo(float).tiny)

# Of these, the ones to fall back on where no film lies in the best direction: every 3 degrees.
_OTHERS = np.arange(0, len(_ANGLES), 6)


class _Ahead(NamedTuple):
    """What lies around a tip, as long as the topology stays."""

    rows: Ints
    """That touch the tip, one or those around a node, shape (n_row,)."""
    weights: Floats
    """Shape functions at the tip in each, shape (n_row, 4), over their number."""
    base: Floats
    """Weights that give, of the positions of their nodes, what has become of two unit vectors of
    the reference sheet at the tip, forward and to the left, in the mean; shape (2, n_row, 4)."""
    factors: Floats
    """On strength and energy in the directions compared, shape (n_direction,)."""
    force: TipForce | None
    straight: bool
    """Whether no domain shows where energy is released, and the crack keeps its direction."""
    quads: Ints
    """Rows ahead whose stress counts, shape (n,)."""
    weight: Floats
    """Of each, their sum being 1, shape (n,)."""
    distance: float
    """Of a large sheet the mean distance with these weights [mm]."""


class FreeDirection:
    """Finds the directions of cracks that no blade drives.

    Parameters
    ----------
    shell, film : MITC4Shell, CutFilm
        The film, and how it is cut.
    law : CohesiveTable
        Gives sigma_F.
    anisotropy : Anisotropy, optional
        Of the film.
    """

    def __init__(
        self,
        shell: MITC4Shell,
        film: CutFilm,
        law: CohesiveTable,
        anisotropy: Anisotropy | None = None,
    ) -> None:
        self._shell, self._film = shell, film
        self._strength = law.strength
        # Length of the process zone in a sheet [mm] over J [N].
        self._zone_of = math.pi * shell.material.stretching_stiffness
        self._zone_of /= 8.0 * (law.strength * shell.material.thickness) ** 2
        self._anisotropy = anisotropy
        self._known = KnownTopology()
        self._border = FilmBorder(shell, film.topology)
        self._behind: dict[Tip, tuple[Ints, Floats]] = {}
        self._ahead: dict[tuple[Tip, int], _Ahead] = {}

    def directions(self, state: State, tip: Tip, tips: Sequence[Tip] = ()) -> Iterator[Floats]:
        """Yield unit directions in space, shape (3,): the best first, then others by their phi.

        Parameters
        ----------
        state : State
            Present positions.
        tip : Tip
            With film ahead.
        tips : sequence of Tip
            All of them, which end its domain.
        """
        if not self._known.is_of(state):
            self._ahead.clear()
            self._behind.clear()
            self._border.find()
            self._known.take(state)
        key = tip, self._zone(state, tip)
        if key not in self._ahead:
            self._ahead[key] = self._surroundings(state, *key, tips)
        ahead = self._ahead[key]
        nodes = state.quads[ahead.rows].ravel()
        t = unit(product(ahead.weights.ravel(), state.node.t[nodes]))
        moved = product(ahead.base.reshape(2, -1), state.node.x[nodes])
        directions = product(_DIRECTIONS, moved)
        stress = self._pull(state, ahead, t, directions) / (ahead.factors * self._strength)
        phi = stress**2
        if ahead.force is not None or ahead.straight:
            force = _ALONG if ahead.force is None else ahead.force.of(state)
            released = product(_DIRECTIONS, force) / ahead.factors
            most = max(float(np.abs(released).max()), _TINY)
            if ahead.force is not None:
                top = max(float(stress.max()), _TINY)
                # Its strength depends on the direction, too.
                zone = self._zone_of * float(np.abs(released / ahead.factors).max())
                phi *= (sheet_stress(top, zone / ahead.distance) / top) ** 2
            phi += max(1.0 - phi.max(), 0.0) * released / most
        angle = _between(phi, int(np.argmax(phi)))
        yield unit(product(np.array([math.cos(angle), math.sin(angle)]), moved))
        for k in _OTHERS[np.argsort(-phi[_OTHERS], kind="stable")].tolist():
            yield unit(directions[k])

    def _zone(self, state: State, tip: Tip) -> int:
        """Return how far back cables hold the flanks of a tip, in local edge lengths, rounded up.

        Along the crack, and at least ``FALL``.
        """
        if tip not in self._behind:
            place, size = self._film.at_tip(tip, state.node.X), self._size(tip)
            self._behind[tip] = self._border.cables_behind(state, place, size)
        cables, back = self._behind[tip]
        back = back[state.cable.status[cables] != BROKEN]
        apart = np.diff(back, prepend=0.0) > GAP
        zone = back[: np.argmax(apart)] if apart.any() else back
        return int(np.ceil(zone.max(initial=FALL)))

    def _surroundings(self, state: State, tip: Tip, zone: int, tips: Sequence[Tip]) -> _Ahead:
        """Gather what lies around a tip."""
        rows = self._film.rows_at_tip(tip)
        share, continued = 1.0 / len(rows), self._film.heading_weights
        T = unit(np.sum([self._film.reference_director(*at) for at in rows], axis=0))
        forward = unit(tip.heading - product(tip.heading, T) * T)
        base = np.stack([forward, np.cross(T, forward)])
        place, size = self._film.at_tip(tip, state.node.X), self._size(tip)
        others = [
            (
                self._film.at_tip(other, state.node.X),
                [row for row, _ in self._film.rows_at_tip(other)],
            )
            for other in tips
            if other is not tip
        ]
        domain = TipDomain.of(
            state,
            self._shell,
            self._border,
            place,
            base,
            (zone * size, (zone + FALL) * size),
            [row for row, _ in rows],
            others,
        )
        known, force = gives_back(self._shell.material), None
        if known and domain.room > LEAST * size:
            force = TipForce(state, self._shell, domain, base)
        factors = np.ones(len(_DIRECTIONS))
        if self._anisotropy is not None:
            factors = self._anisotropy.factors(product(_DIRECTIONS, base), T)
        width = max(AVERAGE, zone) * size
        near, weight = self._near(state, domain.rows, place, forward, width)
        return _Ahead(
            rows=np.array([row for row, _ in rows]),
            weights=share * np.array([shape_functions(*entry) for _, entry in rows]),
            base=share * np.array([[continued(*at, along) for at in rows] for along in base]),
            factors=factors,
            force=force,
            straight=known and force is None,
            quads=near,
            weight=weight,
            distance=math.sqrt(0.5 * math.pi) * width,
        )

    def _size(self, tip: Tip) -> float:
        """Return the edge length at a tip, in the mean of the rows that touch it [mm]."""
        return float(np.mean([self._film.size(row) for row, _ in self._film.rows_at_tip(tip)]))

    def _near(
        self, state: State, rows: Ints, place: Floats, forward: Floats, width: float
    ) -> tuple[Ints, Floats]:
        """Return which rows ahead of a place count with their stress, and how much, shapes (n,)."""
        film = self._shell.reference
        gap = film.x[film.quads[rows]].mean(axis=1) - place
        squared = np.einsum("ij,ij->i", gap, gap)
        ahead = (squared < (_FAR * width) ** 2) & (product(gap, forward) > 0.0)
        near, squared = rows[ahead], squared[ahead]
        weight = each(math.exp, -0.5 * squared / width**2)
        weight *= self._shell.area[near] * state.quad.share[near]
        return near, weight / max(float(weight.sum()), _TINY)

    def _pull(self, state: State, ahead: _Ahead, t: Floats, directions: Floats) -> Floats:
        """Return how much the mean stress ahead pulls across some directions [MPa], shape (n,).

        t : (3,), unit director.  directions : (n, 3), in the sheet, of any length.
        """
        if not ahead.quads.size:
            return np.zeros(len(directions))
        stress = self._shell.stress(state, ahead.quads, place="mid")
        turn = _turns(corner_normals(state.node.x[state.quads[ahead.quads]]), t)
        stress = product(turn, stress, turn.transpose(0, 2, 1))
        mean = np.einsum("i,ijk->jk", ahead.weight, stress)
        values, vectors = symmetric_eigen(mean)
        pulling = product(vectors * np.maximum(values, 0.0), vectors.T)
        across = unit(np.cross(t, directions))
        return np.asarray(np.linalg.norm(product(across, pulling), axis=1))


def _between(phi: Floats, best: int) -> float:
    """Return the angle [rad] where phi is largest, by a parabola through three of ``_ANGLES``."""
    if not 0 < best < len(phi) - 1:
        return float(_ANGLES[best])
    before, here, after = phi[best - 1 : best + 2].tolist()
    bend = before - 2.0 * here + after
    shift = 0.5 * (before - after) / bend if bend < 0.0 else 0.0
    return float(_ANGLES[best] + shift * (_ANGLES[1] - _ANGLES[0]))


def _turns(start: Floats, end: Floats) -> Floats:
    """Return the least rotations that take unit vectors start : (n, 3) to end, shape (n, 3, 3).

    With v = start x end and c their cosine, R = 1 + [v] + [v]² / (1 + c): exactly 1 where v is 0.
    """
    x, y, z = np.cross(start, end).T
    zero = np.zeros_like(x)
    v = np.array([[zero, -z, y], [z, zero, -x], [-y, x, zero]]).transpose(2, 0, 1)
    squared = product(v, v) / np.maximum(1.0 + product(start, end), _FOLDED)[:, None, None]
    return np.asarray(np.eye(3) + v + squared)
