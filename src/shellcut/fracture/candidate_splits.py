"""Ways to part the quads of a node, and what each of them would have to hold.

A split gives the quads of a node to two groups, minus and plus, along edges that lead through it:
two edges of a whole interior node, one of a node on a free edge or at a crack tip, none of a bridge
between cracks. Which ways there are follows from the topology and the reference mesh alone; it is
found once a topology. What they hold, force, direction and normal, changes with every step and is
computed for all ways of all candidates in one kernel.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Annotated, NamedTuple

import numpy as np

from shellcut.arrays import Bools, Floats, Ints, SmallInts, product
from shellcut.loads.loads import LoadSet
from shellcut.mitc4.shell import MITC4Shell
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.jit import inline, kernel
from shellcut.numerics.vec3 import combine, cross, dot, load, norm, scale, store, sub
from shellcut.state import BROKEN, State

from .quad_fans import arriving, fans_of, origin_edge

# Cosines of two turns that count as the same.
_SAME_TURN = 1e-6


@dataclass(frozen=True)
class Parting:
    """One way to part the quads of a node: all of it that lasts as long as the topology around it.

    Attributes
    ----------
    node : int
        Which node; it keeps the quads ``minus``.
    minus, plus : tuple of int
        Quads on either side.
    back, ahead : tuple of int
        Far ends of the edges where the crack comes from and where it goes; both flank copies of an
        edge that is cracked already, none of an edge that is not there.
    length : float
        Half the reference lengths of the cohesive crack edges, which its cables hold [mm].
    mass : tuple of float
        Of the two sides [t].
    cables : tuple of (int, int, int)
        Side, cable, and its end at the node.
    cosine : float
        Of the crack's turn at the node, 1 where it has no edge to turn from or no choice. In the
        reference film: film that folds under the blade bends by any angle, and to go straight on
        across a fold is no turn.
    """

    node: int
    minus: tuple[int, ...]
    plus: tuple[int, ...]
    back: tuple[int, ...]
    ahead: tuple[int, ...]
    length: float
    mass: tuple[float, float]
    cables: tuple[tuple[int, int, int], ...]
    cosine: float


def partings_of(
    state: State, node: int, quad_mass: Floats, free_edges: frozenset[tuple[int, int]]
) -> list[Parting]:
    """Return all ways to part the quads of a node.

    Parameters
    ----------
    state : State
        Its present topology.
    node : int
        Which node.
    quad_mass : ndarray, shape (n_quad, 4)
        Share of each node in the mass of a quad [t].
    free_edges : frozenset of (int, int)
        Reference edges that carry no cable.
    """
    fans = fans_of(state, node)
    fan = fans[0]
    cracks = arriving(state, fans)
    held = np.argwhere(state.cable.ends[: state.n_cable] == node).tolist()
    way = _Around(state, node, quad_mass, free_edges, held).parting
    if len(fans) > 1:
        rest = tuple(e for other in fans[1:] for e in other.quads)
        mine = {fan.far[0], fan.far[-1]}
        pairs = [p for p in cracks if mine & set(p)]
        # The first fan lies to the right of the way from back to ahead.
        ahead = next((p for p in pairs if p[0] == fan.far[-1]), ())
        behind = next((p for p in pairs if p[1] == fan.far[0] and p != ahead), ())
        return [way(fan.quads, rest, behind, ahead)]
    quads, far = fan.quads, fan.far
    if fan.closed:
        return [
            way(quads[i:j], quads[j:] + quads[:i], (far[i],), (far[j],))
            for i, j in combinations(range(len(far)), 2)
        ]
    back: tuple[int, ...] = cracks[0] if cracks else ()
    return [way(quads[:j], quads[j:], back, (far[j],)) for j in range(1, len(quads))]


class _Around(NamedTuple):
    """A node and what its partings are counted from."""

    state: State
    node: int
    quad_mass: Floats
    free_edges: frozenset[tuple[int, int]]
    held: list[list[int]]
    """Cables that end at the node, and which end."""

    def parting(
        self,
        minus: tuple[int, ...],
        plus: tuple[int, ...],
        back: tuple[int, ...],
        ahead: tuple[int, ...],
    ) -> Parting:
        state, node = self.state, self.node
        # Each arriving crack counts once; ``back`` and ``ahead`` name both its flank copies.
        ends = {int(state.node.origin[n]): n for n in (*back, *ahead)}
        length = 0.0
        for n in ends.values():
            if origin_edge(state, node, n) not in self.free_edges:
                edge = state.node.X[n] - state.node.X[node]
                length += 0.5 * float(np.linalg.norm(edge, axis=0))
        sides = [np.array(quads) for quads in (minus, plus)]
        mass = [self.quad_mass[e, np.argmax(state.quads[e] == node, axis=1)].sum() for e in sides]
        return Parting(
            node,
            minus,
            plus,
            back,
            ahead,
            length,
            (float(mass[0]), float(mass[1])),
            tuple((int(state.cable.row[k, end] in plus), k, end) for k, end in self.held),
            _cosine_of_turn(state.node.X, node, back, ahead),
        )


def _cosine_of_turn(
    reference: Floats, node: int, back: tuple[int, ...], ahead: tuple[int, ...]
) -> float:
    # Both flank copies of an edge have one place in the reference film. At a bridge, where the
    # crack goes on along an edge that is cracked already, there is nothing to choose.
    if not back or len(ahead) != 1:
        return 1.0
    arrive = reference[node] - reference[back[0]]
    leave = reference[ahead[0]] - reference[node]
    return float(product(arrive, leave) / np.sqrt(product(arrive, arrive) * product(leave, leave)))


class _Ways(NamedTuple):
    """Partings as the kernel takes them: what lasts as long as the topology."""

    node: Annotated[Ints, "(n_parting,)"]
    """Which node is parted."""
    back: Annotated[Ints, "(n_parting, 2)"]
    """Flank copies of the node where the crack comes from."""
    ahead: Annotated[Ints, "(n_parting, 2)"]
    """Those of the node where it goes."""
    side_start: Annotated[Ints, "(2 n_parting + 1,)"]
    """First row of ``member`` of each side of each parting, and the end."""
    member: Annotated[Ints, "(n_member,)"]
    """Rows of the corner forces."""
    mass: Annotated[Floats, "(n_parting, 2)"]
    """Of the two sides [t]."""
    carried: Annotated[Floats, "(n_parting,)"]
    """What a cable would carry [N]."""
    cable: Annotated[Ints, "(n_link, 4)"]
    """Parting, side, cable and its end."""
    admissible: Annotated[Bools, "(n_parting,)"]
    """Whether a crack may turn so."""


class _Held(NamedTuple):
    """What the partings hold, written by the kernel; see :class:`PartingTable`."""

    force: Annotated[Floats, "(n_parting, 3)"]
    direction: Annotated[Floats, "(n_parting, 3)"]
    m: Annotated[Floats, "(n_parting, 3)"]
    pull: Annotated[Floats, "(n_parting,)"]
    measure: Annotated[Floats, "(n_parting,)"]
    chord: Annotated[Floats, "(n_parting,)"]


class PartingTable:
    """The partings of some nodes as a kernel takes them, and what they hold at the last weighing.

    Parameters
    ----------
    shell, loads : MITC4Shell, LoadSet
        Give the forces of the two sides.
    strength : float
        sigma_F [MPa].
    partings : sequence of sequence of Parting
        Of each candidate node, all of one topology, which the table does not outlive.
    cos_limit : float
        Cosine of the largest admissible turn of an arriving crack. Where every edge of a node turns
        by more, as at a node of three quads, the least turn is admissible: a crack must not stop
        for want of mesh lines.
    weigh : callable
        :func:`weigh_partings`, bound by whoever makes one table after the other.
    """

    def __init__(
        self,
        shell: MITC4Shell,
        loads: LoadSet,
        strength: float,
        partings: Sequence[Sequence[Parting]],
        cos_limit: float,
        weigh: Callable[..., float],
    ) -> None:
        self._shell, self._loads, self._weigh = shell, loads, weigh
        self.ways = [way for ways in partings for way in ways]
        """All partings, node by node."""
        start = np.cumsum([0, *map(len, partings)]).tolist()
        self.admissible: list[list[int]] = [
            [begin + k for k in _admissible(ways, cos_limit)]
            for begin, ways in zip(start[:-1], partings, strict=True)
        ]
        """Of each node, the partings by which an arriving crack turns by no more than it may."""
        n = len(self.ways)
        may = np.zeros(n, np.bool_)
        may[[k for ways in self.admissible for k in ways]] = True
        corners: dict[tuple[int, int], int] = {}
        sides = [
            [corners.setdefault((e, way.node), len(corners)) for e in quads]
            for way in self.ways
            for quads in (way.minus, way.plus)
        ]
        cables = [(k, *one) for k, way in enumerate(self.ways) for one in way.cables]
        corner = np.array(list(corners), np.int64).reshape(-1, 2)
        self._quads, self._at = (np.ascontiguousarray(column) for column in corner.T)
        length = np.array([way.length for way in self.ways])
        self._fixed = _Ways(
            node=np.array([way.node for way in self.ways], np.int64),
            back=_both([way.back or (way.node,) for way in self.ways]),
            ahead=_both([way.ahead or (way.node,) for way in self.ways]),
            side_start=np.cumsum([0, *map(len, sides)]),
            member=np.array([corner for side in sides for corner in side], np.int64),
            mass=np.array([way.mass for way in self.ways]).reshape(-1, 2),
            carried=strength * shell.material.thickness * length,
            cable=np.array(cables, np.int64).reshape(-1, 4),
            admissible=may,
        )
        self.force = np.zeros((n, 3))
        """F_c, what the plus side pulls the minus side with [N], shape (n_parting, 3)."""
        self.direction = np.zeros((n, 3))
        """Unit direction in which the crack would run through the node, in the sheet."""
        self.m = np.zeros((n, 3))
        """Unit normal in the sheet, from the minus to the plus side."""
        self.pull = np.zeros(n)
        """F_c · m [N]."""
        self.measure = np.zeros(n)
        """F_c · m over what a cable would carry, sigma_F A_i; the split is due at 1."""
        self.chord = np.zeros(n)
        """Distance from where the crack would come to where it would go [mm]."""
        self._held = _Held(
            force=self.force,
            direction=self.direction,
            m=self.m,
            pull=self.pull,
            measure=self.measure,
            chord=self.chord,
        )

    def weigh(self, state: State) -> float:
        """Write what the partings hold at the positions to which the last step has led.

        Returns
        -------
        float
            The largest measure of those that are admissible.
        """
        n, c = state.node, state.cable
        corner_force = self._shell.corner_forces(state, self._quads, self._at)
        self._loads.add_corner_forces(state, self._quads, self._at, corner_force)
        return self._weigh(n.x, n.t, self._fixed, corner_force, c.status, c.force, self._held)

    def nodes_due(self) -> list[int]:
        """Return the nodes with an admissible parting whose measure has reached 1."""
        due = self.measure >= 1.0
        return [i for i, ways in enumerate(self.admissible) if due[ways].any()]


def _admissible(ways: Sequence[Parting], cos_limit: float) -> list[int]:
    """Return which partings of a node turn an arriving crack by no more than it may."""
    largest = max((way.cosine for way in ways), default=1.0)
    least = min(cos_limit, largest) - _SAME_TURN
    return [k for k, way in enumerate(ways) if way.cosine >= least]


def _both(ends: list[tuple[int, ...]]) -> Ints:
    """Return the two flank copies of an edge's far end, or the one node twice, shape (n, 2)."""
    return np.array([(end[0], end[-1]) for end in ends], np.int64).reshape(-1, 2)


@kernel
def weigh_partings(
    x: Floats,
    t: Floats,
    ways: _Ways,
    corner_force: Floats,
    status: SmallInts,
    cable_force: Floats,
    held: _Held,
) -> float:
    """Write what n partings hold; return the largest measure of admissible ones.

    x, t : (n_node, 3).  corner_force : (n_corner, 3).  status : (n_cable,).  cable_force :
    (n_cable, 2, 3).
    """
    ways, held = borrowed(ways), borrowed(held)
    side_force = _side_forces(ways, corner_force, status, cable_force)
    largest = -np.inf
    for k in range(ways.node.shape[0]):
        director = load(t, ways.node[k])
        start = combine(0.5, load(x, ways.back[k, 0]), 0.5, load(x, ways.back[k, 1]))
        end = combine(0.5, load(x, ways.ahead[k, 0]), 0.5, load(x, ways.ahead[k, 1]))
        way = sub(end, start)
        held.chord[k] = norm(way)
        e = combine(1.0, way, -dot(way, director), director)
        e = scale(1.0 / norm(e), e)
        store(held.direction, k, e)
        across = cross(director, e)
        store(held.m, k, scale(1.0 / norm(across), across))
        m1, m2 = ways.mass[k, 0], ways.mass[k, 1]
        for c in range(3):
            pulled = m1 * side_force[k, 1, c] - m2 * side_force[k, 0, c]
            held.force[k, c] = pulled / (m1 + m2)
        held.pull[k] = dot(load(held.force, k), load(held.m, k))
        if ways.carried[k] > 0.0:
            held.measure[k] = held.pull[k] / ways.carried[k]
        else:  # opens free edges only, with nothing to hold them: due as soon as they are pulled
            held.measure[k] = np.inf if held.pull[k] > 0.0 else -np.inf
        if ways.admissible[k]:
            largest = max(largest, held.measure[k])
    return largest


@inline
def _side_forces(
    ways: _Ways, corner_force: Floats, status: SmallInts, cable_force: Floats
) -> Floats:
    """Return the nodal forces of the two sides of each parting, shape (n_parting, 2, 3), [N]."""
    side_force = np.zeros((ways.node.shape[0], 2, 3))
    for k in range(ways.node.shape[0]):
        for side in range(2):
            for i in range(ways.side_start[2 * k + side], ways.side_start[2 * k + side + 1]):
                for c in range(3):
                    side_force[k, side, c] += corner_force[ways.member[i], c]
    of = ways.cable
    for i in range(of.shape[0]):
        k, side, cable, end = of[i, 0], of[i, 1], of[i, 2], of[i, 3]
        if status[cable] != BROKEN:
            for c in range(3):
                side_force[k, side, c] += cable_force[cable, end, c]
    return side_force
