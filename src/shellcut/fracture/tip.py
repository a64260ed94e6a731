"""Crack tips, the segments between them, where cuts begin, and how a checkpoint keeps tips."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from shellcut.arrays import Floats, Ints, norm, unit
from shellcut.numerics.bilinear import shape_functions
from shellcut.state import State

from .open_edges import crack_tips
from .quad_polygon import Point, corner_at

# Outside the parametric square: written for a tip that lies on no flank.
_NOWHERE = (2.0, 2.0)


@dataclass(eq=False)
class Tip:
    """Where a crack ends: at a node of the mesh, on a side of it, or on a flank."""

    ends: tuple[int, int]
    """Nodes of the mesh at the ends of the side, ascending; twice the same at a node."""
    s: float
    """Fraction of the side from its first node."""
    quad: int
    """Quad of the mesh from which the crack came, -1 of a notch; of a tip on a flank the quad of
    its place."""
    heading: Floats
    """Unit direction in which it came, in the reference film, shape (3,)."""
    length: float = 0.0
    """Of the segment behind it [mm], 0 where it has none: at a border or on a flank."""
    flank: Point | None = None
    """Place in ``quad`` if it lies on the flank of another crack, which may be on a side or at a
    corner; ``ends`` is then of no meaning."""
    behind: tuple[int, ...] = ()
    """Rows that touch that place from behind, the side from which the crack came."""
    torn: int = -1
    """Step in which the crack tore up to here, -1 if it was cut otherwise."""

    @property
    def at_node(self) -> bool:
        """Whether it lies at a node."""
        return self.flank is None and self.ends[0] == self.ends[1]


DUE = 1.0
"""Measure from which on a crack advances: the force at its tip over what its cables would carry, or
by the paper's criterion the largest stress over the strength."""


class Candidate(NamedTuple):
    """Along which segment a crack would run that no blade drives, and whether it does."""

    segment: Segment
    measure: float
    """It runs from :data:`DUE` on."""
    force: Floats | None = None
    """F_c of one along a side [N], shape (3,)."""


def tips_of_notches(state: State) -> list[Tip]:
    """Return the tips of the notches with which a mesh is made."""
    tips = []
    for node, far in crack_tips(state).items():
        behind = state.node.X[node] - state.node.X[far]
        tips.append(Tip((node, node), 0.0, -1, unit(behind), float(norm(behind))))
    return tips


def saved_tips(tips: list[Tip]) -> dict[str, Any]:
    """Return tips as arrays, a row each."""
    return {
        "ends": np.array([tip.ends for tip in tips], np.int64).reshape(-1, 2),
        "s": np.array([tip.s for tip in tips], float),
        "quad": np.array([tip.quad for tip in tips], np.int64),
        "heading": np.array([tip.heading for tip in tips], float).reshape(-1, 3),
        "torn": np.array([tip.torn for tip in tips], np.int64),
        "length": np.array([tip.length for tip in tips], float),
        "flank": np.array([tip.flank or _NOWHERE for tip in tips], float).reshape(-1, 2),
        "n_behind": np.array([len(tip.behind) for tip in tips], np.int64),
        "behind": np.array([row for tip in tips for row in tip.behind], np.int64),
    }


def restored_tips(saved: dict[str, Any]) -> list[Tip]:
    """Return the tips of :func:`saved_tips`."""
    stop = np.cumsum(saved["n_behind"]).tolist()
    rows = {name: column.tolist() for name, column in saved.items()}
    return [
        Tip(
            ends=tuple(rows["ends"][i]),
            s=rows["s"][i],
            quad=rows["quad"][i],
            heading=saved["heading"][i].copy(),
            torn=rows["torn"][i],
            length=rows["length"][i],
            flank=None if (flank := tuple(rows["flank"][i])) == _NOWHERE else flank,
            behind=tuple(rows["behind"][stop[i] - rows["n_behind"][i] : stop[i]]),
        )
        for i in range(len(stop))
    ]


@dataclass(frozen=True)
class Segment:
    """A straight piece of a crack's path through a row."""

    row: int
    entry: Point
    exit: Point
    side: int
    """Side of the quad on which the exit lies, FLANK on an earlier cut."""
    corner: int
    """Corner of the quad at the exit, -1 if it is none."""
    along_side: bool = False
    """Whether it runs from corner to corner along a side of the quad."""
    right: float = 1.0
    """Share of the row to the right of it, 1 along a side."""

    @property
    def weights(self) -> Floats:
        """Weights of the nodes of its row that give the vector along it, shape (4,)."""
        return np.subtract(shape_functions(*self.exit), shape_functions(*self.entry))

    def reversed(self) -> Segment:
        """Return the same along a side in the other direction."""
        corner = corner_at(self.entry)
        return Segment(self.row, self.exit, self.entry, self.side, corner, self.along_side)


class Place(NamedTuple):
    """Where a tip is in the film now."""

    x: Floats
    """Position [mm], shape (3,)."""
    t: Floats
    """Unit director, shape (3,)."""
    size: float
    """Local edge length [mm]."""
    T: Floats
    """Unit director in the reference film, shape (3,)."""


class DrivenTips(NamedTuple):
    """Tips that cutting edges drive."""

    x: Floats
    """Where they are [mm], shape (n, 3)."""
    edge: Ints
    """Segment of the edge that drives each, shape (n,)."""
    tips: list[Tip]


class Pierced(NamedTuple):
    """How a tool pierces the face of whole film."""

    measure: float
    """Force or stress over that which the film carries."""
    force: float
    """On the cutting edge [N]."""
    delay: float
    """Of the mean force on a tip, see :mod:`.pressing_tips`."""
    depth: float
    """By which the film has been pushed out of its reference shape there [mm]."""


class Begun(NamedTuple):
    """A place where an edge cuts whole film."""

    row: int
    place: Point
    segment: int
    """Of the cutting edge."""
    pierced: Pierced | None = None
    """None where nothing supports the film against the edge."""
