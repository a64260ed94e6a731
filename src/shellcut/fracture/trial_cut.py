"""The trial cut: by what force the flanks ahead of a tip pull on each other, and when it is due.

The cut is tried on the topology, the groups of quad corners that would share a node on either side
are read off (*classes*, :mod:`.cut_topology`), and it is mended again (:class:`TrialCut`): they
last as long as the topology. Positions, forces and the shares of the two parts of the row, the quad
that is cut, change with every step (:class:`TrialSums`). With the masses m and nodal forces f of
the classes on the plus and minus side, and the shape functions N_a at the tip,

    (1)  d = sum N_a (f_a+ / m_a+ - f_a- / m_a-)         relative acceleration of the flanks
    (2)  kappa = sum N_a² (1 / m_a+ + 1 / m_a-)          that of a pair of unit forces
    (3)  F_c = d / kappa,  F = (d - d_B) / kappa         F_c is what new cables take over
    (4)  L_F = |s / kappa - (1 - L_in / L)+ b / 2|       from what length F is gathered
    (5)  L_c = max((L_in + L_out) / 2, L_F)              of cables that carry F
    (6)  F · m / (sigma_F h L_c)                         due at 1

d_B is (1) with the forces of the cables behind the tip alone: they pull the flanks together, so F
is F_c and their pull. m is the normal to the segment in the sheet from the minus to the plus side.
At a node F_c is the nodal force parted between the two sides.

L_in and L_out are the lengths of the segments that meet at the tip, whose cables give half of their
force to it. But F is the force of whole classes, also where the segment ahead cuts a corner off and
is short. L_F is what F would be under a tension of 1 N/mm in all directions of the sheet: s is (1)
with (X_next - X_previous) / 2 of each corner in its quad in place of its force, which is the force
of that tension turned by 90 degrees, and the pull of those cables of the classes that d_B leaves
out. Behind the tip counts what cables can carry: b is the segment there, L its length. So film that
carries sigma_F in all directions is due, whatever the segment. In straight rows of equal quads L_F
is (L_in + L_out) / 2.

A tear pulls in whichever direction it opens: |F| replaces F · m in (6), and where the flanks press
on each other, F · m < 0, but F opens the crack in the direction in which the film behind has
parted,

    (7)  sqrt(|F|² - (F · m)²) - |F · m|                 [CamachoOrtiz1996]

The reasons: ``docs/theory/free-cracks.md`` (*When a crack advances*), ``docs/theory/tears.md``.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import sqrt
from typing import Annotated, NamedTuple

import numpy as np

from shellcut.arrays import Floats, Ints, SmallInts, Vec3, product, unit
from shellcut.loads.loads import LoadSet
from shellcut.mitc4.shell import MITC4Shell
from shellcut.numerics.bilinear import shape_functions
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.jit import BoundOnce, inline, inline_or_plain, kernel
from shellcut.numerics.table_address import TableWriter
from shellcut.numerics.vec3 import add_scaled, cross, dot, load, norm, scale, store, sub
from shellcut.state import BROKEN, State
from shellcut.tool.force_term import ForceTerm

from .anisotropy import Anisotropy, factor_along
from .cut_state import parted, rows_along, side_under
from .cut_topology import Corner, CutTopology
from .quad_polygon import UNUSED, Point, between, contains, divide
from .ray_ahead import Aimed
from .tip import Segment, Tip

# In place of a length or a force that is zero, as a divisor.
_TINY = float(np.finfo(float).tiny)

UNCUT, RIGHT, LEFT = 0, 1, 2
"""What a side of a trial cut has of a row: all of it, or what lies to one side of the segment."""


class Link(NamedTuple):
    """A cable that pulls at a class of corners."""

    cable: int
    end: int
    share: float
    """Of its force that acts on the class."""
    at_tip: float
    """Of its force that is handed on where the flanks have not parted: at the tip."""


class Side(NamedTuple):
    """A class of corners of a trial cut, on one side of it."""

    rows: Ints
    """Present rows, shape (n,)."""
    corner: Ints
    """Which of its corners, shape (n,)."""
    nodes: Ints
    """The node there now, shape (n,)."""
    part: Ints
    """UNCUT, RIGHT or LEFT: what of the row belongs to it, shape (n,)."""
    cables: tuple[Link, ...]


class Pair(NamedTuple):
    """The classes that a trial cut makes at a corner of the row ahead."""

    weight: float
    """Shape function of the corner at the tip."""
    sides: tuple[Side, Side]
    """Minus and plus."""


class TrialCut:
    """Tries cuts on a topology, which is as it was when a trial is over.

    Shell, loads and force terms give the nodal forces, sigma_F [MPa] is the strength.
    """

    def __init__(
        self,
        topology: CutTopology,
        shell: MITC4Shell,
        loads: LoadSet,
        strength: float,
        anisotropy: Anisotropy | None = None,
        terms: Sequence[ForceTerm] = (),
    ) -> None:
        self.topology, self.shell = topology, shell
        self._sources: tuple[LoadSet | ForceTerm, ...] = (loads, *terms)
        self.anisotropy, self.thickness = anisotropy, shell.material.thickness
        self.carried = strength * shell.material.thickness
        """What cables carry, sigma_F h [N/mm]."""

    def corner_forces(self, state: State, rows: Ints, nodes: Ints) -> Floats:
        """Return the forces of whole rows on one of their nodes each [N], shape (n, 3)."""
        force = self.shell.corner_forces(state, rows, nodes)
        for source in self._sources:
            source.add_corner_forces(state, rows, nodes, force)
        return force

    def pairs(self, state: State, segment: Segment) -> list[Pair]:
        """Return the classes on both sides of a trial cut, at the corners that carry its tip."""
        ring = self.shell.mesh_quads[segment.row].tolist()
        weights = shape_functions(*segment.entry)
        corners = [c for c in range(4) if weights[c] > UNUSED]
        rows, classes = self._tried(segment, [ring[c] for c in corners])
        pairs = []
        for c, groups in zip(corners, classes, strict=True):
            minus, plus = (
                next((g for g in groups if any(r == row for r, _ in g)), None) for row in rows
            )
            if minus is not None and plus is not None and minus is not plus:
                sides = self._side(state, minus, segment), self._side(state, plus, segment)
                pairs.append(Pair(weights[c], sides))
        return pairs

    def _tried(
        self, segment: Segment, nodes: list[int]
    ) -> tuple[list[int], list[list[list[Corner]]]]:
        """Return the rows on both sides of a trial cut, and classes around nodes of the mesh."""
        topology = self.topology
        if segment.along_side:
            side, part = side_under(self.shell, segment)
            rows, _ = rows_along(topology, side, part)
            topology.break_side(*side, *part)
            classes = [topology.classes(node) for node in nodes]
            topology.mend_side(*side)
            return rows, classes
        whole = topology.polygon(segment.row)
        new = topology.cut(segment.row, segment.entry, segment.exit)
        classes = [topology.classes(node) for node in nodes]
        topology.mend(segment.row, new, whole)
        return [segment.row, new], classes

    def _side(self, state: State, members: list[Corner], segment: Segment) -> Side:
        """Return a class of a trial cut; the row that is only tried is part of the row cut."""
        new, tried = state.n_quad, {}
        if not segment.along_side:
            whole = self.topology.polygon(segment.row)
            right, left = divide(whole, segment.entry, segment.exit)
            tried = {segment.row: (RIGHT, right), new: (LEFT, left)}
        rows = np.array([row if row < new else segment.row for row, _ in members])
        corner = np.array([corner for _, corner in members])
        mine = [tried[row][1] for row, _ in members if row in tried]

        def has_place(row: int, place: Point) -> bool:
            """Return whether the side has a place: of the row that is tried it is one part."""
            return row != segment.row or all(contains(part, place) for part in mine)

        c, cables, opened = state.cable, [], dict[tuple[float, ...], bool]()
        among, intact = np.zeros(new, np.bool_), np.flatnonzero(c.status[: c.count] != BROKEN)
        among[rows] = True
        nth, ends = among[c.row[intact]].nonzero()
        for k, end in zip(intact[nth].tolist(), ends.tolist(), strict=True):
            pair, chords, share = c.row[k].tolist(), c.chord[k].tolist(), float(c.share[k])
            row, (start, stop) = pair[end], chords[end]
            at = int(corner[rows == row][0])
            parts = (1.0 - share) * shape_functions(*start)[at], share * shape_functions(*stop)[at]
            if sum(parts) > UNUSED and has_place(row, between(start, stop, share)):
                closed = 0.0
                for part, *places in zip(parts, *chords, strict=True):
                    at_place = (*pair, *places[0], *places[1])
                    if at_place not in opened:  # several cables are between the same places
                        opened[at_place] = parted(state, pair, places)
                    closed += 0.0 if opened[at_place] else part
                cables.append(Link(k, end, sum(parts), closed))
        return Side(
            rows=rows,
            corner=corner,
            nodes=state.quads[rows, corner].astype(np.int64),
            part=np.array([tried[row][0] if row in tried else UNCUT for row, _ in members]),
            cables=tuple(cables),
        )


class Weighed(NamedTuple):
    """What trial cuts have at their tips."""

    force: Annotated[Floats, "(n_tip, 3)"]
    """F_c [N]."""
    pull: Annotated[Floats, "(n_tip, 3)"]
    """F [N]."""
    length_out: Annotated[Floats, "(n_tip,)"]
    """L_out, of the segment [mm]."""
    length_in: Annotated[Floats, "(n_tip,)"]
    """L_in times the factor on its strength [mm]; 0 where no cables join the flanks of the segment
    behind."""
    gathered: Annotated[Floats, "(n_tip,)"]
    """L_F [mm]; 0 of a segment along a side, which is no shorter."""
    measure: Annotated[Floats, "(n_tip,)"]
    """F · m over what the cables would carry; -inf if the cut parts nothing at the tip."""
    magnitude: Annotated[Floats, "(n_tip,)"]
    """|F| over the same."""

    @classmethod
    def of(cls, n: int) -> Weighed:
        """Return the table of n tips."""
        return cls(*np.zeros((2, n, 3)), *np.zeros((3, n)), *np.full((2, n), -np.inf))


class _Trials(NamedTuple):
    """Trial cuts as the kernel takes them, good until others are tried."""

    tip: Annotated[Ints, "(n_trial,)"]
    start: Annotated[Ints, "(n_trial + 1,)"]
    """First pair of each trial, and the end."""
    weight: Annotated[Floats, "(n_pair,)"]
    mass: Annotated[Floats, "(n_pair, 2, 3)"]
    """Of minus and plus side, in rows UNCUT, RIGHT and LEFT [t]."""
    member: Annotated[Ints, "(n_member, 4)"]
    """Pair, side, part (UNCUT, RIGHT, LEFT) and row of the corner forces."""
    span: Annotated[Floats, "(n_corner, 3)"]
    """Force of the whole row there under a tension of 1 N/mm, turned by 90 degrees [mm]."""
    cable: Annotated[Ints, "(n_link, 4)"]
    """Pair, side, cable and its end."""
    along: Annotated[Floats, "(n_link, 3)"]
    """Unit vector along the segment across which it lies, whose turn by 90 degrees its pull is."""
    share: Annotated[Floats, "(n_link, 2)"]
    """How much of that cable's force acts on the side, and how much of that acts at the tip."""
    behind: Annotated[Floats, "(n_tip, 3)"]
    """Segments behind the tips [mm]."""
    aimed: Aimed
    weighed: Weighed


class TrialSums:
    """Weighs trial cuts, all that are known of one topology and one set of ends.

    :meth:`of_tear` and :meth:`at_start` weigh one segment and replace the trials taken before: use
    an object for single segments, and another for a list.
    """

    def __init__(self, trial_cut: TrialCut) -> None:
        self._trial_cut = trial_cut
        self._weigh, self._address_of = BoundOnce(_weigh_trials), TableWriter()

    def take(
        self,
        state: State,
        trials: Sequence[tuple[int, list[Pair]]],
        behind: Floats,
        aimed: Aimed,
        weighed: Weighed,
    ) -> None:
        """Take the trial cuts to be weighed from now on: which of the tips, and its pairs.

        behind : (n_tip, 3), segments behind the tips [mm].  aimed : segments of the tips; all that
        have one are among the trials.  weighed : written by :meth:`weigh`, where a tip has a
        segment.
        """
        tips, every = zip(*trials, strict=True) if trials else ((), ())
        pairs = [pair for some in every for pair in some]
        corners: dict[tuple[int, int], int] = {}
        members, cables, shares = [], [], []
        mass = np.zeros((len(pairs), 2, 3))
        for p, pair in enumerate(pairs):
            for sign, side in enumerate(pair.sides):
                whole = self._trial_cut.shell.mass[side.rows, side.corner]
                np.add.at(mass[p, sign], side.part, whole)
                rows, nodes, parts = side.rows.tolist(), side.nodes.tolist(), side.part.tolist()
                for row, node, part in zip(rows, nodes, parts, strict=True):
                    corner = corners.setdefault((row, node), len(corners))
                    members.append((p, sign, part, corner))
                cables += [(p, sign, link.cable, link.end) for link in side.cables]
                shares += [(link.share, link.at_tip) for link in side.cables]
        whole_corners = np.array(list(corners), np.int64).reshape(-1, 2)
        self._rows, self._nodes = (np.ascontiguousarray(column) for column in whole_corners.T)
        links = np.array(cables, np.int64).reshape(-1, 4)
        table = _Trials(
            tip=np.array(tips, np.int64),
            start=np.cumsum([0, *map(len, every)]),
            weight=np.array([pair.weight for pair in pairs]),
            mass=mass,
            member=np.array(members, np.int64).reshape(-1, 4),
            span=_spans(state, self._rows, self._nodes),
            cable=links,
            along=_along_segments(state, links[:, 2], links[:, 3]),
            share=np.array(shares, float).reshape(-1, 2),
            behind=behind,
            aimed=aimed,
            weighed=weighed,
        )
        self._trials = self._address_of(table)

    def weigh(self, state: State) -> None:
        """Write what the trials have at their tips, at the present positions and forces."""
        n, c, trial = state.node, state.cable, self._trial_cut
        self._weigh(
            n.x,
            n.t,
            n.X,
            self._trials,
            trial.corner_forces(state, self._rows, self._nodes),
            c.status,
            c.force,
            c.area,
            c.length,
            trial.carried,
            trial.thickness,
        )

    def of_tear(self, state: State, tip: Tip, segment: Segment) -> float:
        """Return |F| over what the cables would carry; less if it presses. A tear is due at 1."""
        pairs = self._trial_cut.pairs(state, segment)
        alone = self._alone(state, segment, pairs, tip.length * tip.heading)
        if alone.measure[0] == -np.inf:
            return -np.inf
        trial, force = self._trial_cut, alone.pull[0]
        pull = sqrt(product(force, force))
        across = pull * float(alone.measure[0]) / max(float(alone.magnitude[0]), _TINY)  # F · m
        if across < 0.0:  # (7)
            along = sqrt(max(pull * pull - across * across, 0.0))
            opens = product(force, _parted_behind(state, segment, pairs)) > 0.0
            pull = max(along + across, 0.0) if opens else 0.0
        chord, X = (segment.entry, segment.exit), state.node.X[state.quads[segment.row]]
        factor = factor_along(trial.anisotropy, X, chord)
        length_out, gathered = factor * alone.length_out[0], factor * alone.gathered[0]
        return pull / (trial.carried * float(_carrying(alone.length_in[0], length_out, gathered)))

    def at_start(self, state: State, segment: Segment) -> Floats:
        """Return F_c where a segment begins [N], shape (3,); zero if nothing parts there."""
        pairs = self._trial_cut.pairs(state, segment)
        return np.asarray(self._alone(state, segment, pairs, np.zeros(3)).force[0])

    def _alone(self, state: State, segment: Segment, pairs: list[Pair], behind: Floats) -> Weighed:
        """Return what the trial cut along one segment has.

        behind : (3,), segment behind the tip [mm].
        """
        alone = Weighed.of(1)
        self.take(state, [(0, pairs)], behind[None], Aimed.along(state, [segment]), alone)
        self.weigh(state)
        return alone


@kernel
def _weigh_trials(
    x: Floats,
    t: Floats,
    X: Floats,
    trials: _Trials,
    corner_force: Floats,
    status: SmallInts,
    cable_force: Floats,
    cable_area: Floats,
    cable_length: Floats,
    carried: float,
    thickness: float,
) -> None:
    """Write what trial cuts have at their tips.

    x, t, X : (n_node, 3).  corner_force : (n_corner, 3), [N].  status : (n_cable,).  cable_force :
    (n_cable, 2, 3), [N].  cable_area, cable_length : (n_cable,), [mm²] and [mm].  carried :
    sigma_F h [N/mm].
    """
    trials = borrowed(trials)
    aimed, weighed = trials.aimed, trials.weighed
    n_trial = trials.tip.shape[0]
    trial = np.empty(trials.weight.shape[0], np.int64)
    for k in range(n_trial):
        trial[trials.start[k] : trials.start[k + 1]] = k
    # f of each class: of whole rows, or of the part of the row that lies on its side of the ray.
    force, cable_force_behind, span = np.zeros((3, trials.weight.shape[0], 2, 3))
    cable_area_behind, cable_length_behind = np.zeros((2, n_trial))
    for i in range(trials.member.shape[0]):
        p, side, part, corner = _four(trials.member, i)
        share = _part(part, aimed.right[trials.tip[trial[p]]])
        for c in range(3):
            force[p, side, c] += share * corner_force[corner, c]
            span[p, side, c] += share * trials.span[corner, c]
    # Cables pull at the classes too; those behind the tip also alone, for d_B.
    for i in range(trials.cable.shape[0]):
        p, side, cable, end = _four(trials.cable, i)
        if status[cable] == BROKEN:
            continue
        cable_area_behind[trial[p]] += trials.share[i, 1] * cable_area[cable]
        cable_length_behind[trial[p]] += trials.share[i, 1] * cable_length[cable]
        for c in range(3):
            force[p, side, c] += trials.share[i, 0] * cable_force[cable, end, c]
            cable_force_behind[p, side, c] += trials.share[i, 1] * cable_force[cable, end, c]
            not_at_tip = (trials.share[i, 0] - trials.share[i, 1]) * cable_length[cable]
            span[p, side, c] += not_at_tip * trials.along[i, c]
    for k in range(n_trial):
        tip = trials.tip[k]
        right, kappa, d, d_B = aimed.right[tip], 0.0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        s = 0.0, 0.0, 0.0
        sum_of_weights = trials.weight[trials.start[k] : trials.start[k + 1]].sum()
        for p in range(trials.start[k], trials.start[k + 1]):
            for side in range(2):
                mass = 0.0
                for part in range(3):
                    mass += _part(part, right) * trials.mass[p, side, part]
                moves = trials.weight[p] / mass if side else -trials.weight[p] / mass
                # (1) with all forces, with those of the cables behind alone and with those of the
                # tension, and (2).
                d = add_scaled(d, moves, load(force[p], side))
                d_B = add_scaled(d_B, moves, load(cable_force_behind[p], side))
                s = add_scaled(s, moves, load(span[p], side))
                kappa += trials.weight[p] ** 2 / mass
        if kappa == 0.0:  # the cut would part nothing at the tip
            weighed.measure[tip] = weighed.magnitude[tip] = -np.inf
            continue
        m, ahead = _normal_and_segment(x, t, X, aimed, tip)
        out = norm(ahead)
        pull = scale(1.0 / kappa, sub(d, d_B))  # (3)
        # L_in by the area of the cables across it, which has the factor on their strength in a film
        # with axes. L_out has it in :meth:`TrialSums.of_tear`: with a tool no film has axes.
        length_in = cable_area_behind[k] / (thickness * sum_of_weights)
        weighed.gathered[tip] = 0.0
        if right < 1.0:  # through a quad
            behind = load(trials.behind, tip)
            joined = cable_length_behind[k] / sum_of_weights
            open_behind = max(0.0, 1.0 - joined / max(norm(behind), _TINY))
            gathered = sub(scale(1.0 / kappa, s), scale(0.5 * open_behind, behind))
            weighed.gathered[tip] = norm(gathered)  # (4)
        carries = carried * _carrying(length_in, out, weighed.gathered[tip])
        weighed.measure[tip] = dot(pull, m) / norm(m) / carries  # (6)
        weighed.magnitude[tip] = norm(pull) / carries
        weighed.length_out[tip], weighed.length_in[tip] = out, length_in
        store(weighed.force, tip, scale(1.0 / kappa, d))
        store(weighed.pull, tip, pull)


@inline
def _four(rows: Ints, i: int) -> tuple[int, int, int, int]:
    return rows[i, 0], rows[i, 1], rows[i, 2], rows[i, 3]


@inline
def _part(part: int, right: float) -> float:
    """Return the share of a row for UNCUT, RIGHT or LEFT."""
    if part == UNCUT:
        return 1.0
    return right if part == RIGHT else 1.0 - right


@inline_or_plain
def _carrying(length_in: float, length_out: float, gathered: float) -> float:
    """Return the length of the cables that carry F at a tip [mm]."""
    return max(0.5 * (length_in + length_out), gathered)  # (5)


@inline
def _normal_and_segment(
    x: Floats, t: Floats, X: Floats, aimed: Aimed, tip: int
) -> tuple[Vec3, Vec3]:
    """Return the normal to a segment in the sheet, of any length, and the segment in the film.

    The segment is that in the reference film [mm].
    """
    xi, eta = aimed.entry[tip, 0], aimed.entry[tip, 1]
    to_xi, to_eta = aimed.exit[tip, 0], aimed.exit[tip, 1]
    director, along, out = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    start, stop = shape_functions(xi, eta), shape_functions(to_xi, to_eta)
    for a in range(4):
        node, gain = aimed.nodes[tip, a], stop[a] - start[a]
        director = add_scaled(director, start[a], load(t, node))
        along = add_scaled(along, gain, load(x, node))
        out = add_scaled(out, gain, load(X, node))
    return cross(director, along), out


def _spans(state: State, rows: Ints, nodes: Ints) -> Floats:
    """Return half of the diagonals from before to after a node of each row, times its share.

    Shape (n, 3) [mm].
    """
    quads = state.quads[rows]
    at = (quads == nodes[:, None]).argmax(axis=1)
    after, before = (state.node.X[quads[np.arange(len(at)), (at + k) % 4]] for k in (1, 3))
    return np.asarray(0.5 * state.quad.share[rows, None] * (after - before))


def _along_segments(state: State, cables: Ints, ends: Ints) -> Floats:
    """Return unit vectors along the segments across which cables lie, shape (n, 3).

    In the reference film, turned by 180 degrees for the plus end.
    """
    c = state.cable
    stop, start = (np.array(shape_functions(*c.chord[cables, 0, k].T)) for k in (1, 0))
    nodes = state.quads[c.row[cables, 0]]
    along = unit(np.einsum("an,nai->ni", stop - start, state.node.X[nodes]))
    return np.where(ends[:, None] == 0, along, -along)


def _parted_behind(state: State, segment: Segment, pairs: list[Pair]) -> Floats:
    """Return how far the copies of the quad behind the tip have parted [mm], shape (3,).

    From the minus to the plus side, the mean of their corners; zero behind a tip that ran along a
    side of the mesh.
    """
    parted, parent = np.zeros(3), state.quad.parent
    for weight, (minus, plus) in pairs:
        for a in minus.rows[minus.rows != segment.row].tolist():
            for b in plus.rows[parent[plus.rows] == parent[a]].tolist():
                apart = state.node.x[state.quads[b]] - state.node.x[state.quads[a]]
                parted += weight * apart.mean(axis=0)
    return parted
