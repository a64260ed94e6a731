"""State: every array that changes in time, and the log of the splits.

Do not keep a reference to an array across a split (:class:`KnownTopology`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, fields
from typing import Any, Generic, TypeVar

import numpy as np

from shellcut.arrays import Floats, Ints, SmallIds
from shellcut.numerics.lanes import aligned_zeros

from .tables import NOTCH, CableTable, FlankTable, NodeTable, QuadsAtNodes, QuadTable

T = TypeVar("T")


@dataclass(frozen=True)
class SplitRecord:
    """Record of one split."""

    time: float
    """[s]"""
    node: int
    """Node that was split along sides, -1 for a cut along a segment."""
    twin: int
    """Its new half."""
    place: tuple[float, float, float]
    """Position at the split [mm]."""
    reference: tuple[float, float, float]
    """Reference position [mm]."""
    end: tuple[float, float, float]
    """Reference position where the cut ends [mm]."""
    kind: str
    """``"criterion"`` or ``"blade"`` at a tip, see :mod:`shellcut.fracture.options`; ``"puncture"``
    where a cut begins, see :mod:`shellcut.fracture.pierce`; or ``TEAR`` or ``NOTCH``."""
    measure: float
    """Value of the criterion; a split is due at 1."""
    force_jump: float
    """Magnitude of the difference between the node's load and the new cable's force [N]."""
    rows: tuple[int, ...] = ()
    """Quads or copies to the right and left of it, of a split those of each side; -1 for none."""
    edge: int = -1
    """Chain of the cutting edge that made it, -1 for none."""
    force: float = 0.0
    """With which the film pressed on an edge that pierced it, on a tip without the impacts of nodes
    [N]."""
    depth: float = 0.0
    """How far it had pressed the film in there [mm]."""
    work: float = 0.0
    """Of the tool until then [N·mm]."""
    delay: float = 0.0
    """By which the force on a tip is late, over the time for which it had pressed."""


@dataclass
class State:
    """Everything that changes in time; mesh, sections and tool are constant."""

    node: NodeTable
    cable: CableTable
    quad: QuadTable
    flank: FlankTable
    strain: Floats
    """Strains of the last force evaluation, in blocks of quads, shape (n_block, 16, width)."""
    strain_before: Floats
    """Strains of the evaluation before, likewise."""
    history: Floats
    """History of the thickness points, likewise, shape (n_block, 4 n_point n_history, width)."""
    strain_forms: tuple[float, float] = (0.0, 0.0)
    """A and B of :mod:`shellcut.mitc4.forces` at the last evaluation [N·mm]."""
    time: float = 0.0
    """t_n [s]."""
    dt: float = 0.0
    """Length of the step that led to t_n [s]."""
    pace: float = 1.0
    """The part of dt by which time advances in it, less than 1 in a quasi-static run."""
    step: int = 0
    revision: int = 0
    """Number of splits; identifies the topology."""
    crack_length: float = 0.0
    """Of all that has been cut but notches, in the reference film [mm]."""
    split_log: list[SplitRecord] = field(default_factory=list)
    """Every split, in order."""

    @property
    def tick(self) -> float:
        """By how much time has advanced in the step that led to t_n [s]."""
        return self.pace * self.dt

    @property
    def n_node(self) -> int:
        """Number of nodes in use."""
        return self.node.count

    @property
    def n_quad(self) -> int:
        """Number of quads and copies."""
        return self.quad.count

    @property
    def quads(self) -> SmallIds:
        """Node ids of every quad and copy, rewired at a split, shape (n_quad, 4)."""
        return self.quad.nodes[: self.quad.count]

    @property
    def splits(self) -> list[SplitRecord]:
        """Every split of the run, in order, without notches beforehand."""
        return [record for record in self.split_log if record.kind != NOTCH]

    @property
    def n_cable(self) -> int:
        """Number of cables ever made."""
        return self.cable.count

    def is_moved(self, least: float) -> bool:
        """Whether any node is farther than ``least`` [mm] from its reference position."""
        n = self.node
        return bool(np.linalg.norm(n.x[: n.count] - n.X[: n.count], axis=1).max() > least)

    def quads_at_nodes(self) -> QuadsAtNodes:
        """Return which quads are at which node now."""
        return QuadsAtNodes(
            quads=self.quads,
            centre=self.quad.centre[: self.n_quad],
            share=self.quad.share[: self.n_quad],
            at=self.node.quads,
            n_at=self.node.n_quad_at,
        )

    def most_strained_quad(self) -> int:
        """Return the quad with the largest change of edge length, or one that is not finite."""
        X, x = self.node.X[self.quads], self.node.x[self.quads]
        with np.errstate(all="ignore"):  # the lengths themselves may overflow
            length = [np.linalg.norm(np.roll(v, -1, axis=1) - v, axis=2) for v in (X, x)]
            change = np.abs(length[1] / length[0] - 1.0).max(axis=1)
        return int(np.argmax(np.where(np.isfinite(change), change, np.inf)))

    def saved(self) -> dict[str, Any]:
        """Return the state as arrays and numbers by name, in nested dictionaries."""
        log = {f.name: [getattr(s, f.name) for s in self.split_log] for f in fields(SplitRecord)}
        saved = {f.name: getattr(self, f.name) for f in fields(self)}
        return saved | {
            **{name: getattr(self, name).saved() for name in _TABLES},
            "strain_forms": np.array(self.strain_forms),
            "split_log": {name: np.array(column) for name, column in log.items() if name != "rows"}
            | {"rows": _padded(log["rows"])},
        }

    def restore(self, saved: dict[str, Any]) -> None:
        """Load :meth:`saved` of a state of the same mesh.

        The arrays keep their addresses as long as they are large enough.
        """
        for name in ("strain", "strain_before", "history"):
            blocks = getattr(self, name)
            got = saved[name].shape
            if got[1:] != blocks.shape[1:] or got[0] < len(blocks):
                raise ValueError(f"{name} must have shape {blocks.shape}, or more rows, got {got}")
            if got != blocks.shape:
                blocks = aligned_zeros(got, blocks.dtype)
                setattr(self, name, blocks)
            blocks[:] = saved[name]
        for name in ("time", "dt", "pace", "step", "revision", "crack_length"):
            setattr(self, name, saved[name])
        for name in _TABLES:
            getattr(self, name).restore(saved[name])
        a, b = saved["strain_forms"].tolist()
        self.strain_forms = a, b
        splits = {name: column.tolist() for name, column in saved["split_log"].items()}
        for name in ("place", "reference", "end"):
            splits[name] = [tuple(place) for place in splits[name]]
        splits["rows"] = [tuple(k for k in row if k != _NO_ROW) for row in splits["rows"]]
        self.split_log = [
            SplitRecord(**dict(zip(splits, row, strict=True)))
            for row in zip(*splits.values(), strict=True)
        ]


_NO_ROW = -2
_TABLES = "node", "cable", "quad", "flank"


def _padded(rows: list[tuple[int, ...]]) -> Ints:
    """Return rows of different length as one table, filled up."""
    table = np.full((len(rows), max(map(len, rows), default=0)), _NO_ROW)
    for filled, row in zip(table, rows, strict=True):
        filled[: len(row)] = row
    return table


class OncePerTopology(Generic[T]):
    """Something that follows from the topology of a film: built once, and anew after a cut.

    Parameters
    ----------
    build : Callable
        Returns it for a state.
    """

    def __init__(self, build: Callable[[State], T]) -> None:
        self._build, self._known = build, KnownTopology()
        self._built: Any = None

    def of(self, state: State) -> T:
        """Return what belongs to the present topology."""
        if self._built is None or not self._known.is_of(state):
            self._built = self._build(state)
            self._known.take(state)
        built: T = self._built
        return built


class KnownTopology:
    """The topology for which a part has built its tables: the one rule after a split.

    A part calls :meth:`is_of` before it uses tables that a split would change. If the answer is no,
    it builds them again and calls :meth:`take`; :meth:`new_splits` are the splits in between.
    """

    def __init__(self) -> None:
        self._state: State | None = None
        self.revision = -1
        """Of the state, when it was taken last; stored in checkpoints."""

    def is_of(self, state: State) -> bool:
        """Return whether nothing has split since, and it is the same state."""
        if self._state is state:  # of every part in every step
            return self.revision == state.revision
        return self._state is None and self.revision == state.revision

    def take(self, state: State) -> None:
        """Remember the present topology."""
        self._state, self.revision = state, state.revision

    def new_splits(self, state: State) -> list[SplitRecord]:
        """Return the splits since it was taken last; a revision counts the splits before it."""
        return state.split_log[max(self.revision, 0) :]

    def changed_quads(self, state: State) -> Ints:
        """Return the quads that may have got other nodes since it was taken last, ascending."""
        if self.revision > state.revision or (self._state is not None and self._state is not state):
            return np.arange(len(state.quads))
        # A cut changes the nodes of the copies on both its sides, and of those that share them.
        node, new = state.node, self.new_splits(state)
        cut = np.array([row for s in new for row in s.rows if row >= 0], np.int64)
        duplicates = np.array([s.twin for s in new if s.twin >= 0], np.int64)
        duplicates = np.union1d(duplicates, state.quads[cut])
        at = np.arange(node.quads.shape[1]) < node.n_quad_at[duplicates, None]
        return np.unique(node.quads[duplicates][at])

    def saved(self) -> int:
        """Return the revision, for a checkpoint."""
        return self.revision

    def restore(self, revision: int) -> None:
        """Take over ``revision`` from a checkpoint; the next state given is the one meant."""
        self._state, self.revision = None, revision
