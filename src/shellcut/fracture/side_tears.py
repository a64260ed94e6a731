"""Where and when a crack runs along sides of the mesh that no blade drives.

From its tip, a node, it may run on along every side that has whole film on both sides of it and by
which it does not turn too sharply; if all sides turn by more, along those that turn least, for a
crack must not stop for want of mesh lines. Each of them is tried (:mod:`.trial_cut`). With the
force F at the tip and the chord c from where the crack ran from to where it would go, m being the
normal to c in the sheet, the measure is

    F · m / (sigma_F h (L_in + L_out) / 2),

and the side with the largest normal traction F · m / |c| is taken: a uniform stress gives
F = ½ h |c| sigma · m whatever sides lead along c, where the measure would favour short ones.

By the paper's criterion ([Frangi2010] 4) the measure is sigma_I / sigma_F, the largest principal
stress of the mid-surface recovered from the node's patch ([ZienkiewiczZhu1992]), and the side is
the one most nearly normal to the direction of sigma_I. It depends on the mesh, which F does not.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from shellcut.arrays import Floats, Ints, norm, product, unit
from shellcut.mitc4.nodal_stress import NodalStress, recover
from shellcut.mitc4.shell import MITC4Shell
from shellcut.state import OncePerTopology, State

from .cut_film import CutFilm
from .options import Fracture
from .quad_polygon import CORNERS, corner_at
from .ray_ahead import Aimed
from .tip import Candidate, Segment, Tip
from .trial_cut import TrialCut, TrialSums, Weighed

# Cosines of two turns that count as the same.
_SAME_TURN = 1e-6


class LargestStress:
    """The paper's measure at the tips of cracks along sides.

    Parameters
    ----------
    shell, film : MITC4Shell, CutFilm
        The film, and what lies ahead of a tip.
    strength : float
        sigma_F [MPa].
    """

    def __init__(self, shell: MITC4Shell, film: CutFilm, strength: float) -> None:
        self._shell, self._film, self._strength = shell, film, strength
        self.n_borrowed = 0
        """Nodes that took a neighbour's polynomial in the recovery, summed over all checks."""

    def at(self, state: State, tips: Sequence[Tip], others: Sequence[Tip]) -> tuple[Floats, Floats]:
        """Return sigma_I / sigma_F, shape (n_tip,), and its directions, at tips with film ahead.

        others : all tips, whose patches lie on both flanks.
        """
        nodes, ends = (self._film.nodes_of(state, group) for group in (tips, others))
        found: NodalStress = recover(state, self._shell, nodes, tips=ends.tolist())
        self.n_borrowed += found.n_borrowed
        return found.principal / self._strength, found.direction


class _Tried(NamedTuple):
    """Sides along which a crack may run on from its tip, and the trial cuts along them."""

    segments: list[Segment]
    nodes: Ints
    """Of their rows, and of the row whose director counts, shape (n_side + 1, 4)."""
    vectors: Floats
    """Weights that give of their positions the vectors along them, and the direction of the
    crack."""
    corner: int
    """Of that last row, at which the tip is."""
    sums: TrialSums
    weighed: Weighed


class SideTears:
    """Finds the sides along which cracks tear, by the strength sigma_F [MPa]."""

    def __init__(
        self,
        shell: MITC4Shell,
        film: CutFilm,
        trial_cut: TrialCut,
        strength: float,
        fracture: Fracture,
    ) -> None:
        self._film, self._trial_cut = film, trial_cut
        self._cos_limit = math.cos(math.radians(fracture.turn_limit_deg))
        self.stress: LargestStress | None = None
        """Decides instead of the nodal force."""
        if fracture.criterion == "stress":
            self.stress = LargestStress(shell, film, strength)
        self._tried = OncePerTopology[dict[Tip, _Tried]](lambda _: {})

    def best(self, state: State, tip: Tip, tips: Sequence[Tip]) -> Candidate | None:
        """Return along which side a crack would run from its tip, None if there is none.

        tips : all of them.
        """
        tried = self._tried.of(state)
        if tip not in tried:
            tried[tip] = self._try(state, tip)
        segments, nodes, weights, corner, sums, weighed = tried[tip]
        if not segments:
            return None
        sums.weigh(state)
        vectors = np.einsum("ij,ijk->ik", weights, state.node.x[nodes])
        chord = vectors[:-1] + weighed.length_in[:, None] * unit(vectors[-1])
        a, b, c = state.node.t[nodes[-1, corner]].tolist()
        m = product(chord, np.array([[0.0, c, -b], [-c, 0.0, a], [b, -a, 0.0]]))  # t x chord
        chord_length = norm(m)
        pull = (weighed.pull * m).sum(axis=1) / chord_length
        if self.stress is None:
            k = int(np.argmax(pull / chord_length))
            carried = 0.5 * (weighed.length_in[k] + weighed.length_out[k]) * self._trial_cut.carried
            return Candidate(segments[k], float(pull[k] / carried), weighed.force[k])
        measure, direction = self.stress.at(state, [tip], tips)
        k = int(np.argmin(np.abs(product(chord, direction[0])) / chord_length))
        return Candidate(segments[k], float(measure[0]), weighed.force[k])

    def _try(self, state: State, tip: Tip) -> _Tried:
        """Return the sides along which a crack may run on, each with its trial cut."""
        segments = self._sides(state, tip)
        sums, weighed = TrialSums(self._trial_cut), Weighed.of(len(segments))
        trials = [(i, self._trial_cut.pairs(state, segment)) for i, segment in enumerate(segments)]
        behind = np.zeros((len(segments), 3))
        sums.take(state, trials, behind, Aimed.along(state, segments), weighed)
        row, entry = self._film.rows_ahead(tip)[0]
        vectors = [segment.weights for segment in segments]
        vectors.append(self._film.heading_weights(row, entry, tip.heading))
        nodes = state.quads[[*(segment.row for segment in segments), row]]
        return _Tried(segments, nodes, np.array(vectors), corner_at(entry), sums, weighed)

    def _sides(self, state: State, tip: Tip) -> list[Segment]:
        """Return the sides by which a crack turns by no more than it may."""
        found: dict[int, Segment] = {}
        for row, entry in self._film.rows_ahead(tip):
            ring, start = self._film.ring(row), corner_at(entry)
            for side, end in ((start, (start + 1) % 4), ((start - 1) % 4, (start - 1) % 4)):
                if ring[end] not in found and self._film.may_break(row, start, end):
                    found[ring[end]] = Segment(row, entry, CORNERS[end], side, end, along_side=True)
        sides = list(found.values())
        vectors = [product(side.weights, state.node.X[state.quads[side.row]]) for side in sides]
        turns = [float(product(unit(vector), tip.heading)) for vector in vectors]
        least = min(self._cos_limit, max(turns, default=1.0)) - _SAME_TURN
        return [side for side, cosine in zip(sides, turns, strict=True) if cosine >= least]
