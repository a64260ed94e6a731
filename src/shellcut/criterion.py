"""Which node splits now, and along which edges. Reads the state, never writes it.

Two criteria, each of which splits a node when its measure reaches 1:

``"force"`` (default)
    The nodal force. A candidate split parts the quads of a node into two groups with the nodal
    forces f_1, f_2 (internal, damping, loads, and the cables that go with each) and the masses m_1,
    m_2. As one node they move with (f_1 + f_2)/(m_1 + m_2), so group 2 pulls on group 1 with

        F_c = (m_1 f_2 - m_2 f_1) / (m_1 + m_2),

    and the measure is F_c · m / (sigma_F A_i), m being the normal from group 1 to group 2. It is
    the very force that the new cable takes over, so the split starts near equilibrium. Among the
    admissible edges the one with the largest normal traction on its chord wins.
``"stress"``
    sigma_I / sigma_F with the recovered stress ([Frangi2010] 4). The edges chosen are the most
    nearly normal to the direction of sigma_I.

Which nodes may split: the crack tips and the nodes that a cutting edge has pierced
(``candidates="tips"``) or any node ("all", the wording of [Frangi2010]). Supported nodes never
split.

**The blade-cut rule** (:mod:`shellcut.blade_cut`) differs from [Frangi2010]: a node that the edge
has pierced, and a tip that it has passed, split whatever the stress, along the edges nearest to the
trace of the blade's mid-plane in the sheet.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from ._jit import Floats, Ints
from .blade_cut import BladeCut
from .fan import arriving, fans_of, origin_edge
from .load import LoadSet
from .recovery import recover
from .shell import MITC4Shell
from .state import BROKEN, State
from .tool import Tool

# Cosines of two turns that count as the same.
_SAME_TURN = 1e-6


@dataclass(frozen=True)
class Fracture:
    """How cracks start and run.

    Parameters
    ----------
    criterion : {"force", "stress"}
        Measure of a split, see the module.
    stress_place : {"mid", "top", "bottom", "largest", "nominal"}
        Where the stress criterion reads the stress.
    candidates : {"tips", "all"}
        Which nodes may split by the measure.
    blade_cut : bool
        Whether the blade-cut rule is on.
    turn_limit_deg : float
        Largest turn of a crack from its last edge [degrees].
    check_every : int
        Steps between two checks.
    equilibrium_start : bool
        Start a cable with the very force that the node carried, fading over 0.05 mm.
    """

    criterion: str = "force"
    stress_place: str = "mid"
    candidates: str = "tips"
    blade_cut: bool = True
    turn_limit_deg: float = 57.0
    check_every: int = 10
    equilibrium_start: bool = False

    def __post_init__(self) -> None:
        problems = []
        places = ("mid", "top", "bottom", "largest", "nominal")
        for name, allowed in (
            ("criterion", ("force", "stress")),
            ("candidates", ("tips", "all")),
            ("stress_place", places),
        ):
            if getattr(self, name) not in allowed:
                problems.append(f"{name} must be one of {allowed}, got {getattr(self, name)!r}")
        if not 0 < self.turn_limit_deg < 180:
            problems.append(
                f"turn_limit_deg must lie between 0 and 180, got {self.turn_limit_deg!r}"
            )
        if not (isinstance(self.check_every, int) and self.check_every > 0):
            problems.append(f"check_every must be a positive count, got {self.check_every!r}")
        if problems:
            raise ValueError("; ".join(problems))


@dataclass(frozen=True)
class Split:
    """One node to split, and how.

    Attributes
    ----------
    node : int
        Which node; it keeps the quads ``minus``.
    minus, plus : tuple of int
        Quads on either side.
    half_edges : tuple of (int, float)
        Origin of the far end and half the reference length [mm] of each cohesive crack edge.
    m : ndarray, shape (3,)
        Unit normal in the sheet, from the minus to the plus side.
    measure : float
        Of the criterion; the split was due at 1.
    force : ndarray, shape (3,)
        F_c, what the plus side pulls the minus side with [N].
    blade : bool
        Whether the blade-cut rule asked for it.
    """

    node: int
    minus: tuple[int, ...]
    plus: tuple[int, ...]
    half_edges: tuple[tuple[int, float], ...]
    m: Floats
    measure: float
    force: Floats
    blade: bool


@dataclass(frozen=True)
class _Option:
    """One way to part the quads of a node; geometry of the reference and of the topology only."""

    minus: tuple[int, ...]
    plus: tuple[int, ...]
    back: tuple[int, ...]
    ahead: tuple[int, ...]
    half_edges: tuple[tuple[int, float], ...]
    length: float


class SplitCriterion:
    """Find the nodes that must split.

    Parameters
    ----------
    fracture : Fracture
        Modes.
    strength : float
        sigma_F [MPa].
    shell, loads : MITC4Shell, LoadSet
        Give the forces of the two sides.
    tool : Tool, optional
        For the blade-cut rule.
    free_edges : frozenset of (int, int)
        Reference edges cut beforehand, which carry no cable.
    rim : ndarray of int
        Nodes of the film's own boundary.
    """

    def __init__(
        self,
        fracture: Fracture,
        strength: float,
        shell: MITC4Shell,
        loads: LoadSet,
        tool: Tool | None,
        free_edges: frozenset[tuple[int, int]],
        rim: Ints,
    ) -> None:
        self.fracture = fracture
        self._strength = strength
        self._shell = shell
        self._loads = loads
        self._blade = None
        if tool is not None and fracture.blade_cut:
            self._blade = BladeCut(tool, float(shell.section.area.max()))
        self._free_edges = free_edges
        self._rim = np.zeros(int(rim.max(initial=-1)) + 1, np.bool_)
        self._rim[rim] = True
        self._cos_limit = float(np.cos(np.radians(fracture.turn_limit_deg)))
        self._options: dict[int, list[_Option]] = {}
        self._options_revision = -1
        self.n_borrowed = 0
        """Nodes that took a neighbour's polynomial in the recovery, summed over all checks."""

    def due(
        self, state: State, tips: Iterable[int], rotation: Floats, translation: Floats, dt: float
    ) -> list[Split]:
        """Return the splits that are due, strongest first, no two of them sharing a quad.

        Parameters
        ----------
        state : State
            Positions at t_{n+1}, strains and cable forces of t_n.
        tips : iterable of int
            Present crack tips.
        rotation, translation : ndarray
            Pose of the tool at t_{n+1}.
        dt : float
            Length of the step that led here [s].
        """
        if self._options_revision != state.revision:
            self._options.clear()
            self._options_revision = state.revision
        tips = [n for n in tips if not state.node.supported[n]]
        found: list[Split] = []
        cut: dict[int, Floats] = {}
        if self._blade is not None:
            cut = self._blade.cut_nodes(state, tips, self._rim, rotation, translation)
            for n, trace in cut.items():
                split = self._along_blade(state, n, trace, dt)
                if split is not None:
                    found.append(split)
        nodes = tips if self.fracture.candidates == "tips" else range(state.n_node)
        rest = [n for n in nodes if n not in cut and not state.node.supported[n]]
        if self.fracture.criterion == "force":
            found += [s for n in rest if (s := self._by_force(state, n, dt)) and s.measure >= 1.0]
        else:
            found += self._by_stress(state, rest, tips, dt)
        return _strongest_apart(found)

    def _along_blade(self, state: State, node: int, trace: Floats, dt: float) -> Split | None:
        options = self._admissible(state, node)
        if not options:
            return None

        def misfit(option: _Option) -> float:
            # The crack through the node shall follow the trace, either way along it.
            e = _direction(state, node, option)
            return -abs(float(e @ trace))

        option = min(options, key=misfit)
        return self._weigh(state, node, option, dt, blade=True)

    def _by_force(self, state: State, node: int, dt: float) -> Split | None:
        options = self._admissible(state, node)
        best, largest = None, -np.inf
        for option in options:
            split = self._weigh(state, node, option, dt, blade=False)
            # A uniform stress gives F_c = ½ h |chord| sigma·m whatever edges lead along the chord
            # from crack to crack: dividing by it compares normal tractions, dividing by the area
            # (the measure) would favour short edges.
            traction = float(split.force @ split.m) / _chord(state, node, option)
            if traction > largest:
                best, largest = split, traction
        return best

    def _by_stress(self, state: State, nodes: list[int], tips: list[int], dt: float) -> list[Split]:
        if not nodes:
            return []
        stress = recover(
            state,
            self._shell,
            np.array(nodes, np.int64),
            place=self.fracture.stress_place,
            tips=tips,
        )
        self.n_borrowed += stress.n_borrowed
        found = []
        for i in np.flatnonzero(stress.principal >= self._strength):
            n, pull = nodes[i], stress.direction[i]
            options = self._admissible(state, n)
            if not options:
                continue
            option = min(options, key=lambda o: abs(float(_direction(state, n, o) @ pull)))
            split = self._weigh(state, n, option, dt, blade=False)
            found.append(
                Split(
                    split.node,
                    split.minus,
                    split.plus,
                    split.half_edges,
                    split.m,
                    float(stress.principal[i] / self._strength),
                    split.force,
                    False,
                )
            )
        return found

    def _admissible(self, state: State, node: int) -> list[_Option]:
        if node not in self._options:
            self._options[node] = self._enumerate(state, node)
        options = self._options[node]
        if not options:
            return []
        cosines = [self._turn_cosine(state, node, option) for option in options]
        # Where every edge turns by more than the limit, as at a node of three quads, the least turn
        # is taken: a crack must not stop for want of mesh lines.
        least = min(self._cos_limit, max(cosines))
        return [o for o, cos in zip(options, cosines, strict=True) if cos >= least - _SAME_TURN]

    def _enumerate(self, state: State, node: int) -> list[_Option]:
        fans = fans_of(state, node)
        cracks = arriving(state, fans)
        first = fans[0]
        if len(fans) > 1:
            rest = tuple(e for fan in fans[1:] for e in fan.quads)
            mine = {first.far[0], first.far[-1]}
            pairs = [p for p in cracks if mine & set(p)]
            # The first fan lies to the right of the way from back to ahead.
            ahead = next((p for p in pairs if p[0] == first.far[-1]), ())
            behind = next((p for p in pairs if p[1] == first.far[0] and p != ahead), ())
            return [self._option(state, node, first.quads, rest, behind, ahead, [])]
        far = first.far
        if first.closed:
            return [
                self._option(
                    state,
                    node,
                    first.quads[i:j],
                    first.quads[j:] + first.quads[:i],
                    (far[i],),
                    (far[j],),
                    [far[i], far[j]],
                )
                for i, j in combinations(range(len(far)), 2)
            ]
        back: tuple[int, ...] = cracks[0] if cracks else ()
        return [
            self._option(state, node, first.quads[:j], first.quads[j:], back, (far[j],), [far[j]])
            for j in range(1, len(first.quads))
        ]

    def _option(
        self,
        state: State,
        node: int,
        minus: tuple[int, ...],
        plus: tuple[int, ...],
        back: tuple[int, ...],
        ahead: tuple[int, ...],
        leaving: list[int],
    ) -> _Option:
        # Each arriving crack counts once; ``back`` and ``ahead`` name both its flank copies.
        ends = {int(state.node.origin[n]): n for n in (*back, *ahead, *leaving)}
        halves = []
        for origin, n in ends.items():
            if origin_edge(state, node, n) not in self._free_edges:
                edge = state.node.X[n] - state.node.X[node]
                halves.append((origin, 0.5 * float(np.linalg.norm(edge))))
        length = sum(half for _, half in halves)
        return _Option(minus, plus, back, ahead, tuple(halves), length)

    def _turn_cosine(self, state: State, node: int, option: _Option) -> float:
        """Return the cosine of the crack's turn at the node."""
        if not (option.back and option.ahead) or len(option.ahead) > 1:
            return 1.0  # nothing to turn from, or a bridge: nothing to choose
        x = state.node.x
        arrive = x[node] - _middle(x, option.back)
        leave = x[option.ahead[0]] - x[node]
        return float(arrive @ leave) / math.sqrt(float((arrive @ arrive) * (leave @ leave)))

    def _weigh(self, state: State, node: int, option: _Option, dt: float, *, blade: bool) -> Split:
        e = _direction(state, node, option)
        t = state.node.t[node]
        m = np.array(
            [t[1] * e[2] - t[2] * e[1], t[2] * e[0] - t[0] * e[2], t[0] * e[1] - t[1] * e[0]]
        )
        m /= math.sqrt(m @ m)
        f1, m1 = self._side(state, node, option.minus, dt)
        f2, m2 = self._side(state, node, option.plus, dt)
        force = (m1 * f2 - m2 * f1) / (m1 + m2)
        area = self._shell.material.thickness * option.length
        pull = float(force @ m)
        # A split that opens free edges only has nothing to hold it: due as soon as it is pulled.
        measure = pull / (self._strength * area) if area > 0 else (np.inf if pull > 0 else -np.inf)
        return Split(node, option.minus, option.plus, option.half_edges, m, measure, force, blade)

    def _side(
        self, state: State, node: int, quads: tuple[int, ...], dt: float
    ) -> tuple[Floats, float]:
        """Return the force on one side of a split node and the side's mass."""
        fan = np.array(quads, np.int64)
        force = self._shell.fan_force(state, node, fan, dt) + self._loads.fan_force(
            state, node, fan
        )
        force += cable_share(state, node, quads)
        corner = np.argmax(state.quads[fan] == node, axis=1)
        return force, float(self._shell.section.mass[fan, corner].sum())


def cable_share(state: State, node: int, quads: tuple[int, ...]) -> Floats:
    """Return the cable forces on a node that go with some of its quads [N].

    Each half-edge of a cable belongs to the quads that own its flank.
    """
    c, force = state.cable, np.zeros(3)
    which, side = np.nonzero(c.ends[: c.count] == node)
    for k, s in zip(which.tolist(), side.tolist(), strict=True):
        if c.status[k] == BROKEN:
            continue
        mine = sum(
            float(c.half_edge[k, i])
            for i in range(2)
            if c.half_edge[k, i] > 0 and owns_flank(state, node, quads, int(c.half_edge_far[k, i]))
        )
        force += c.force[k, s] * (mine / float(c.half_edge[k].sum()))
    return force


def owns_flank(state: State, node: int, quads: tuple[int, ...], far_origin: int) -> bool:
    """Whether one of the quads at a node has the edge to a far end of the given origin."""
    for e in quads:
        ring = state.quads[e].tolist()
        a = ring.index(node)
        if far_origin in (
            int(state.node.origin[ring[(a + 1) % 4]]),
            int(state.node.origin[ring[a - 1]]),
        ):
            return True
    return False


def _direction(state: State, node: int, option: _Option) -> Floats:
    """Return the unit direction in which a crack would run through the node."""
    e = _way(state, node, option)
    e -= (e @ state.node.t[node]) * state.node.t[node]
    return np.asarray(e / math.sqrt(e @ e))


def _chord(state: State, node: int, option: _Option) -> float:
    """Return the distance from where a crack would come to where it would go [mm]."""
    way = _way(state, node, option)
    return math.sqrt(way @ way)


def _way(state: State, node: int, option: _Option) -> Floats:
    x = state.node.x
    start = _middle(x, option.back) if option.back else x[node]
    end = _middle(x, option.ahead) if option.ahead else x[node]
    return np.asarray(end - start)


def _middle(x: Floats, nodes: tuple[int, ...]) -> Floats:
    """Return the place of one node, or the middle of a crack's two flank copies."""
    one = x[nodes[0]]
    return np.asarray(one if len(nodes) == 1 else 0.5 * (one + x[nodes[1]]))


def _strongest_apart(found: list[Split]) -> list[Split]:
    """Keep the strongest of splits that share a quad: two at once would make parallel cracks."""
    taken: set[int] = set()
    kept = []
    for split in sorted(found, key=lambda s: (not s.blade, -s.measure, s.node)):
        quads = {*split.minus, *split.plus}
        if not quads & taken:
            taken |= quads
            kept.append(split)
    return kept
