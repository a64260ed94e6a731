"""The sums of trial cuts (:mod:`.trial_cut`) for all driven tips in one kernel.

:meth:`.trial_cut.TrialCut.measure` is the same for one tip; a test compares the two.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, NamedTuple

import numpy as np

from shellcut.arrays import Bools, Floats, Ints, SmallInts, Vec3
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.jit import BoundOnce, inline, kernel
from shellcut.numerics.vec3 import add_scaled, cross, dot, load, norm
from shellcut.state import BROKEN, State

from .ray_ahead import Aimed
from .rows_ahead import RowsAhead
from .trial_cut import Pair, TrialCut

# The measures of the kernel are those of the rules but for this.
_ROUND_OFF = 1e-6


class Trial(NamedTuple):
    """A trial cut: all of it that depends on the topology and on where the segment ends."""

    tip: int
    """Which of the tips."""
    length: float
    """Of the segment behind it [mm]."""
    pairs: list[Pair]


class _Sums(NamedTuple):
    """Trial cuts as the kernel takes them."""

    tip: Annotated[Ints, "(n_trial,)"]
    length: Annotated[Floats, "(n_trial,)"]
    start: Annotated[Ints, "(n_trial + 1,)"]
    """First pair of each trial, and the end."""
    weight: Annotated[Floats, "(n_pair,)"]
    mass: Annotated[Floats, "(n_pair, 2, 3)"]
    """Of minus and plus side, in rows WHOLE, RIGHT and LEFT [t]."""
    member: Annotated[Ints, "(n_member, 4)"]
    """Pair, side, part (WHOLE, RIGHT, LEFT) and row of the corner forces."""
    cable: Annotated[Ints, "(n_link, 4)"]
    """Pair, side, cable and its end."""
    share: Annotated[Floats, "(n_link,)"]
    """How much of that cable's force goes with the side."""


class TrialSums:
    """Weighs trial cuts, all that are known of one topology and one set of ends.

    Parameters
    ----------
    trial_cut : TrialCut
        Gives forces and masses.
    """

    def __init__(self, trial_cut: TrialCut) -> None:
        self._trial_cut = trial_cut
        self._weigh = BoundOnce(_weigh_trials)
        self.take([])

    def take(self, trials: Sequence[Trial]) -> None:
        """Take the trial cuts that are to be weighed from now on."""
        pairs = [pair for trial in trials for pair in trial.pairs]
        corners: dict[tuple[int, int], int] = {}
        members, cables, shares = [], [], []
        mass = np.zeros((len(pairs), 2, 3))
        for p, pair in enumerate(pairs):
            for sign, side in enumerate(pair.sides):
                np.add.at(mass[p, sign], side.part, self._trial_cut.corner_mass(side))
                columns = side.rows.tolist(), side.nodes.tolist(), side.part.tolist()
                for row, node, part in zip(*columns, strict=True):
                    corner = corners.setdefault((row, node), len(corners))
                    members.append((p, sign, part, corner))
                cables += [(p, sign, cable, end) for cable, end, _ in side.cables]
                shares += [share for _, _, share in side.cables]
        held = np.array(list(corners), np.int64).reshape(-1, 2)
        self._rows, self._nodes = (np.ascontiguousarray(column) for column in held.T)
        self._sums = _Sums(
            tip=np.array([trial.tip for trial in trials], np.int64),
            length=np.array([trial.length for trial in trials]),
            start=np.cumsum([0, *(len(trial.pairs) for trial in trials)]),
            weight=np.array([pair.weight for pair in pairs]),
            mass=mass,
            member=np.array(members, np.int64).reshape(-1, 4),
            cable=np.array(cables, np.int64).reshape(-1, 4),
            share=np.array(shares),
        )

    def weigh(
        self,
        state: State,
        ahead: RowsAhead,
        aimed: Aimed,
        passed: Bools,
        measure: Floats,
        due: Bools,
    ) -> None:
        """Write what the trials measure, and whether their tips may be due.

        Parameters
        ----------
        state : State
            Present positions and forces.
        ahead, aimed : RowsAhead, Aimed
            Of the tips; all that have a segment are among the trials.
        passed : ndarray of bool, shape (n_tip,)
            Whether the edge has passed a tip, which is due then.
        measure, due : ndarray, shape (n_tip,)
            Written, where a tip has a segment.
        """
        n, c = state.node, state.cable
        force = self._trial_cut.corner_forces(state, self._rows, self._nodes)
        carried = self._trial_cut.carried
        self._weigh(
            n.x,
            n.t,
            n.X,
            self._sums,
            ahead,
            aimed,
            force,
            c.status,
            c.force,
            carried,
            passed,
            measure,
            due,
        )


@kernel
def _weigh_trials(
    x: Floats,
    t: Floats,
    X: Floats,
    sums: _Sums,
    ahead: RowsAhead,
    aimed: Aimed,
    corner_force: Floats,
    status: SmallInts,
    cable_force: Floats,
    carried: float,
    passed: Bools,
    measure: Floats,
    due: Bools,
) -> None:
    """Write what trial cuts measure.

    x, t, X : (n_node, 3).  corner_force : (n_corner, 3), [N].  status : (n_cable,).  cable_force :
    (n_cable, 2, 3), [N].  carried : sigma_F h [N/mm].  passed, measure, due : (n_tip,).
    """
    sums, ahead, aimed = borrowed(sums), borrowed(ahead), borrowed(aimed)
    n_trial = sums.tip.shape[0]
    owner = np.empty(sums.weight.shape[0], np.int64)
    for k in range(n_trial):
        for p in range(sums.start[k], sums.start[k + 1]):
            owner[p] = sums.tip[k]
    force = np.zeros((sums.weight.shape[0], 2, 3))
    for i in range(sums.member.shape[0]):
        p, side, part, corner = _four(sums.member, i)
        share = _part(part, aimed.right[owner[p]])
        for c in range(3):
            force[p, side, c] += share * corner_force[corner, c]
    for i in range(sums.cable.shape[0]):
        p, side, cable, end = _four(sums.cable, i)
        if status[cable] != BROKEN:
            for c in range(3):
                force[p, side, c] += sums.share[i] * cable_force[cable, end, c]
    for k in range(n_trial):
        tip = sums.tip[k]
        right, kappa, d = aimed.right[tip], 0.0, (0.0, 0.0, 0.0)
        for p in range(sums.start[k], sums.start[k + 1]):
            for side in range(2):
                mass = 0.0
                for part in range(3):
                    mass += _part(part, right) * sums.mass[p, side, part]
                sign = 1.0 if side else -1.0
                d = add_scaled(d, sign * sums.weight[p] / mass, load(force[p], side))
                kappa += sums.weight[p] ** 2 / mass
        if kappa == 0.0:
            measure[tip], due[tip] = -np.inf, passed[tip]
            continue
        m, out = _normal_and_length(x, t, X, ahead, aimed, tip)
        carries = carried * 0.5 * (sums.length[k] + out)
        measure[tip] = dot(d, m) / norm(m) / kappa / carries
        due[tip] = passed[tip] or measure[tip] >= 1.0 - _ROUND_OFF


@inline
def _four(rows: Ints, i: int) -> tuple[int, int, int, int]:
    return rows[i, 0], rows[i, 1], rows[i, 2], rows[i, 3]


@inline
def _part(part: int, right: float) -> float:
    """Return the share of a row for WHOLE, RIGHT or LEFT."""
    if part == 0:
        return 1.0
    return right if part == 1 else 1.0 - right


@inline
def _normal_and_length(
    x: Floats, t: Floats, X: Floats, ahead: RowsAhead, aimed: Aimed, tip: int
) -> tuple[Vec3, float]:
    """Return the normal to a segment in the sheet, of any length, and its reference length [mm]."""
    k = aimed.way[tip, 0]
    xi, eta = ahead.entry[k, 0], ahead.entry[k, 1]
    to_xi, to_eta = aimed.exit[tip, 0], aimed.exit[tip, 1]
    director, way, out = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for a in range(4):
        sx = 1.0 if 1 <= a <= 2 else -1.0
        sy = 1.0 if a >= 2 else -1.0
        start = 0.25 * (1.0 + sx * xi) * (1.0 + sy * eta)
        gain = 0.25 * (1.0 + sx * to_xi) * (1.0 + sy * to_eta) - start
        node = ahead.nodes[k, a]
        director = add_scaled(director, start, load(t, node))
        way = add_scaled(way, gain, load(x, node))
        out = add_scaled(out, gain, load(X, node))
    return cross(director, way), norm(out)
