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
    sigma_I / sigma_F with the stress recovered at the mid-surface ([Frangi2010] 4). The edges
    chosen are the most nearly normal to the direction of sigma_I.

Which nodes may split: the crack tips and the nodes that a cutting edge has pierced. [Frangi2010]
says any node, which would also split nodes beside the cut. Supported nodes never split.

**The blade-cut rule** (:mod:`shellcut.fracture.blade_cut`) differs from [Frangi2010]: a node that
the edge has pierced, and a tip that it has passed, split whatever the stress, along the edges
nearest to the trace of the blade's mid-plane in the sheet.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Annotated, Any, Literal, TypeAlias, get_args

import numpy as np

from shellcut.arguments import Option, checked
from shellcut.arrays import Floats, Ints, product
from shellcut.loads.loads import LoadSet
from shellcut.mitc4.nodal_stress import recover
from shellcut.mitc4.shell import MITC4Shell
from shellcut.numerics.jit import BoundOnce
from shellcut.state import KnownTopology, State
from shellcut.tool.pose import Pose
from shellcut.tool.tool import Tool

from .anisotropy import Anisotropy
from .blade_cut import BladeCut
from .candidate_splits import Parting, PartingTable, partings_of, weigh_partings

Measure: TypeAlias = Literal["force", "stress"]
Path: TypeAlias = Literal["free", "edges"]
CablePlaces: TypeAlias = Literal["ends", "gauss"]
DropLoose: TypeAlias = Literal["never", "clear"]

_ONLY_ALONG_EDGES = "criterion", "blade_cut", "turn_limit_deg", "equilibrium_start"
_ONLY_THROUGH_QUADS = "anisotropy", "branching", "cable_places", "largest_speed"


NO_IMPRINT = "cracks go through the quads of any mesh: take path = 'free', or leave it out"
"""What to write for the path ``"imprint"`` of earlier versions."""


@checked
@dataclass(frozen=True)
class Fracture:
    """How cracks start and run.

    Left out, the path is ``"free"``, or ``"edges"`` where another option exists for these only:
    ``criterion``, ``blade_cut``, ``turn_limit_deg`` or ``equilibrium_start`` that differ from their
    defaults. A ready model takes ``"edges"`` too where edges lie under the whole path.

    Parameters
    ----------
    anisotropy : Anisotropy, optional
        How strength and energy depend on the direction of a crack, for cracks through the quads
        that no blade drives.
    branching : bool
        Whether a crack through quads that no blade drives may become two (:mod:`.branching`): once
        it runs at half of the film's Rayleigh speed. Needs ``check_every`` so small that it can.

    Examples
    --------
    >>> Fracture(criterion="stress").blade_cut
    True
    >>> Fracture().decided().path, Fracture(criterion="stress").decided().path
    ('free', 'edges')
    """

    criterion: Annotated[Measure, Option("", "measure of a split")] = "force"
    blade_cut: Annotated[
        bool, Option("", "whether the blade splits nodes that it pierces and passes")
    ] = True
    turn_limit_deg: Annotated[
        float, Option("deg", "largest turn of a crack from its last edge", above=0, below=180)
    ] = 57.0
    check_every: Annotated[int, Option("", "steps between two checks", least=1)] = 10
    equilibrium_start: Annotated[
        bool,
        Option("", "start a cable with the force that the node carried, fading as the cable opens"),
    ] = False
    path: Annotated[
        Path | None,
        Option(
            "",
            "of cracks: free through quads, or along edges",
            unset="edges if they lie under the whole path or another option needs them, else free",
        ),
    ] = None
    anisotropy: Anisotropy | None = None
    cable_places: Annotated[
        CablePlaces,
        Option(
            "",
            "cables across a segment of a crack through quads, at its ends or its Gauss points, "
            "where the force of a cut ripples less",
        ),
    ] = "ends"
    largest_speed: Annotated[
        float | None,
        Option(
            "mm/s",
            "of cracks through quads that no blade drives",
            above=0,
            unset="one quad in check_every steps, mostly below the film's Rayleigh speed",
        ),
    ] = None
    branching: bool = False
    drop_loose: Annotated[
        DropLoose,
        Option("", "take pieces that nothing holds out of the run once clear of film and tool"),
    ] = "never"

    def __post_init__(self) -> None:
        if problems := list(self._contradictions()):
            raise ValueError("; ".join(problems))

    def _contradictions(self) -> Iterator[str]:
        """Yield what does not go with the path, or with another option."""
        of_edges, of_quads = self.only_along_edges, self._set_of(_ONLY_THROUGH_QUADS)
        if str(self.path) == "imprint":
            yield f"path must be one of {get_args(Path)}, got 'imprint'; {NO_IMPRINT}"
        elif self.path == "free":
            for name in of_edges:
                needed = type(self).__dataclass_fields__[name].default
                yield (
                    f"path = 'free' goes with {name} = {needed!r} only, got {getattr(self, name)!r}"
                )
        elif self.path is not None:
            for name in of_quads:
                yield f"{name} is of cracks through the quads only: take path='free'"
        elif of_edges and of_quads:
            yield (
                f"{', '.join(of_edges)} must be left out, of cracks along edges only, or "
                f"{', '.join(of_quads)}, of cracks through the quads only"
            )

    @property
    def only_along_edges(self) -> tuple[str, ...]:
        """Names of the options that exist for cracks along edges only and are set."""
        return self._set_of(_ONLY_ALONG_EDGES)

    @property
    def needed_path(self) -> Path | None:
        """The path that is given, or that other options need; None where any will do."""
        if self.path is not None:
            return self.path
        if self.only_along_edges:
            return "edges"
        return "free" if self._set_of(_ONLY_THROUGH_QUADS) else None

    def decided(self) -> Fracture:
        """Return the same with a path, the default where any will do."""
        return replace(self, path=self.needed_path or "free")

    def _set_of(self, names: Iterable[str]) -> tuple[str, ...]:
        every = type(self).__dataclass_fields__
        return tuple(name for name in names if getattr(self, name) != every[name].default)


@dataclass(frozen=True)
class Split:
    """One node to split, and how.

    Attributes
    ----------
    node : int
        Which node.
    minus, plus : tuple of int
        Quads on either side.
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
    m: Floats
    measure: float
    force: Floats
    blade: bool


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
            on_rim = np.zeros(int(rim.max(initial=-1)) + 1, np.bool_)
            on_rim[rim] = True
            self._blade = BladeCut(tool, float(shell.area.max()), on_rim)
        self._free_edges = free_edges
        self._cos_limit = math.cos(math.radians(fracture.turn_limit_deg))
        self._partings: dict[int, list[Parting]] = {}
        self._weigh = BoundOnce(weigh_partings)
        self._table: PartingTable | None = None
        self._nodes: list[int] = []
        self._known = KnownTopology()
        self.n_borrowed = 0
        """Nodes that took a neighbour's polynomial in the recovery, summed over all checks."""

    def due(self, state: State, tips: Iterable[int], pose: Pose) -> list[Split]:
        """Return the splits that are due, strongest first, no two of them sharing a quad.

        Parameters
        ----------
        state : State
            Positions at t_{n+1} and the length of the step there, strains and cable forces of t_n.
        tips : iterable of int
            Present crack tips.
        pose : Pose
            Of the tool at t_{n+1}.
        """
        self._forget(state)
        supported = state.node.supported
        tips = [n for n in tips if not supported[n]]
        found: list[Split] = []
        cut: dict[int, Floats] = {}
        if self._blade is not None:
            cut = self._blade.cut_nodes(state, tips, pose)
            found += self._along_blade(state, cut)
        nodes = [n for n in tips if n not in cut]
        by_measure = self._by_force if self.fracture.criterion == "force" else self._by_stress
        return _strongest_apart(found + by_measure(state, nodes, tips))

    def saved(self) -> dict[str, Any]:
        """Return its count and the blade's list; the partings follow from the state."""
        blade = {} if self._blade is None else self._blade.saved()
        return {"n_borrowed": self.n_borrowed, "blade": blade}

    def restore(self, state: State, saved: dict[str, Any]) -> None:
        """Take over :meth:`saved`; ``state`` is restored already."""
        self.n_borrowed = saved["n_borrowed"]
        if self._blade is not None:
            self._blade.restore(state, saved["blade"])

    def _forget(self, state: State) -> None:
        """Drop what splits since the last call have changed: all around the nodes they split.

        Across the crack too: a cable there is new.
        """
        if self._known.is_of(state):
            return
        new = self._known.new_splits(state)
        halves = np.unique([half for record in new for half in (record.node, record.twin)])
        quads = self._known.changed_quads(state)
        ends = state.cable.ends[: state.n_cable]
        across = ends[np.isin(ends, halves).any(axis=1)]
        for n in np.union1d(state.quads[quads], across).tolist():
            self._partings.pop(n, None)
        self._table = None
        self._known.take(state)

    def _weighed(self, state: State, nodes: list[int]) -> tuple[PartingTable, float]:
        """Return the partings of some nodes, weighed, and the largest admissible measure."""
        if self._table is None or self._nodes != nodes:
            mass, free = self._shell.mass, self._free_edges
            for n in nodes:
                if n not in self._partings:
                    self._partings[n] = partings_of(state, n, mass, free)
            partings = [self._partings[n] for n in nodes]
            self._table = PartingTable(
                self._shell, self._loads, self._strength, partings, self._cos_limit, self._weigh
            )
            self._nodes = nodes
        return self._table, self._table.weigh(state)

    def _along_blade(self, state: State, cut: dict[int, Floats]) -> list[Split]:
        if not cut:
            return []
        table, _ = self._weighed(state, list(cut))
        found = []
        for i, trace in enumerate(cut.values()):
            # The crack through the node shall follow the trace, either way along it.
            ways = table.admissible[i]
            if ways:
                along = np.abs(product(table.direction[ways], trace))
                best = ways[int(np.argmax(along))]
                found.append(self._split(table, best, blade=True))
        return found

    def _by_force(self, state: State, nodes: list[int], _tips: list[int]) -> list[Split]:
        table, largest = self._weighed(state, nodes)
        if largest < 1.0:
            return []
        # A uniform stress gives F_c = ½ h |chord| sigma·m whatever edges lead along the chord from
        # crack to crack: dividing by it compares normal tractions, dividing by the area (the
        # measure) would favour short edges.
        traction = table.pull / table.chord
        found = []
        for i in table.nodes_due():
            ways = table.admissible[i]
            best = ways[int(np.argmax(traction[ways]))]
            if table.measure[best] >= 1.0:
                found.append(self._split(table, best))
        return found

    def _by_stress(self, state: State, nodes: list[int], tips: list[int]) -> list[Split]:
        if not nodes:
            return []
        stress = recover(state, self._shell, np.array(nodes, np.int64), tips=tips)
        self.n_borrowed += stress.n_borrowed
        over = np.flatnonzero(stress.principal >= self._strength).tolist()
        if not over:
            return []
        table, _ = self._weighed(state, [nodes[i] for i in over])
        found = []
        for row, i in enumerate(over):
            ways = table.admissible[row]
            if ways:
                across = np.abs(product(table.direction[ways], stress.direction[i]))
                measure = float(stress.principal[i] / self._strength)
                found.append(self._split(table, ways[int(np.argmin(across))], measure))
        return found

    def _split(
        self, table: PartingTable, k: int, measure: float | None = None, *, blade: bool = False
    ) -> Split:
        way = table.ways[k]
        return Split(
            way.node,
            way.minus,
            way.plus,
            table.m[k].copy(),
            float(table.measure[k]) if measure is None else measure,
            table.force[k].copy(),
            blade,
        )


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
