"""Named tables of the arguments of the kernels of the film's contact with itself."""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

import numpy as np

from shellcut.arrays import Bools, Floats, Ints, SmallInts

from .close_pairs import Pairs
from .film_law import FilmLaw
from .film_outline import Outline


class Memory(NamedTuple):
    """What is remembered of a point and a sheet close to it."""

    side: Annotated[SmallInts, "(n_sheet,)"]
    """Side of the sheet that the point is on, +1 along its normals or -1; 0 beside its edge."""
    met: Annotated[Bools, "(n_sheet,)"]
    """Whether the point has been seen close to the sheet."""
    offset: Annotated[Floats, "(n_sheet,)"]
    """Depth at first sight, which does not press; it goes as the two part [mm]."""
    depth: Annotated[Floats, "(n_sheet,)"]
    """Depth at the last look [mm], 0 where they do not touch."""
    force: Annotated[Floats, "(n_sheet,)"]
    """Force at the last look [N]."""
    work: Annotated[Floats, "(n_sheet,)"]
    """Work put into the spring since they touch [N·mm]."""
    drag: Annotated[Floats, "(n_sheet, 3)"]
    """Elongation of the spring of friction in the frame of its quad [mm]."""
    drag_row: Annotated[Ints, "(n_sheet,)"]
    """That quad."""
    drag_place: Annotated[Floats, "(n_sheet, 2)"]
    """xi and eta of the foot there."""

    @classmethod
    def blank(cls, n: int) -> Memory:
        """Return the memory of sheets that have not been met."""
        return cls(
            side=np.zeros(n, np.int8),
            met=np.zeros(n, np.bool_),
            offset=np.zeros(n),
            depth=np.zeros(n),
            force=np.zeros(n),
            work=np.zeros(n),
            drag=np.zeros((n, 3)),
            drag_row=np.zeros(n, np.int64),
            drag_place=np.zeros((n, 2)),
        )


class Waits(NamedTuple):
    """How long points need not be looked at: ways, on the scale of ``walked``."""

    point: Annotated[Floats, "(n_point,)"]
    """Until when a point touches nothing [mm]."""
    pair: Annotated[Floats, "(n_pair,)"]
    """Until when it does not come near the quad [mm]."""


class SelfNodes(NamedTuple):
    """Fields of the nodes that the kernels need, as in :class:`shellcut.state.NodeTable`."""

    x: Annotated[Floats, "(n_node, 3)"]
    velocity_half: Annotated[Floats, "(n_node, 3)"]
    push: Annotated[Floats, "(n_node, 2)"]
    force: Annotated[Floats, "(n_node, 3)"]
    """Written."""


class Ties(NamedTuple):
    """Which nodes flank points are tied to."""

    flank: Annotated[Ints, "(n_node,)"]
    """Row among the flank points, -1 of a node."""
    nodes: Annotated[Ints, "(n_flank, 4)"]
    weight: Annotated[Floats, "(n_flank, 4)"]


class Presses(NamedTuple):
    """Forces of the last evaluation: on a point, and on the nodes of the quad that it touches."""

    node: Annotated[Ints, "(n_room, 5)"]
    force: Annotated[Floats, "(n_room, 5, 3)"]
    """[N]"""
    n: Annotated[Ints, "(1,)"]
    """How many points press."""

    @classmethod
    def with_room(cls, n_room: int, last: Presses | None = None) -> Presses:
        """Return a table for so many points that press, with those of another one."""
        count = 0 if last is None else int(last.n[0])
        room = max(n_room, count)
        node, force = np.zeros((room, 5), np.int64), np.zeros((room, 5, 3))
        if last is not None:
            node[:count], force[:count] = last.node[:count], last.force[:count]
        return cls(node, force, np.array([count], np.int64))

    def saved(self) -> dict[str, Any]:
        """Return the rows in use."""
        count = int(self.n[0])
        return {"node": self.node[:count], "force": self.force[:count]}

    @classmethod
    def of_saved(cls, saved: dict[str, Any], n_room: int) -> Presses:
        """Return a table of what :meth:`saved` gave."""
        count = np.array([len(saved["node"])], np.int64)
        return cls.with_room(n_room, cls(saved["node"], saved["force"], count))


class Touches(NamedTuple):
    """Which point presses on which sheet, row by row as in :class:`Presses`."""

    point: Annotated[Ints, "(n_room,)"]
    """Place of the point among those of the pairs."""
    sheet: Annotated[Ints, "(n_room,)"]
    row: Annotated[Ints, "(n_room,)"]
    """Quad that the point is over."""
    place: Annotated[Floats, "(n_room, 2)"]
    """xi and eta of its foot there."""

    @classmethod
    def with_room(cls, n_room: int) -> Touches:
        """Return a table for so many points that press."""
        ids = np.zeros((3, n_room), np.int64)
        return cls(ids[0], ids[1], ids[2], np.zeros((n_room, 2)))


class SelfContactTables(NamedTuple):
    """Kernel arguments that stay valid until the search is repeated."""

    law: FilmLaw
    pairs: Pairs
    stiffness: Annotated[Floats, "(n_point,)"]
    """k of every point [N/mm]."""
    memory: Memory
    waits: Waits
    moving: Annotated[Ints, "(n_moving,)"]
    """Points and nodes of the quads close to them."""
    outline: Outline
    quads: Annotated[Ints, "(n_row, 4)"]
    nodes: SelfNodes
    ties: Ties
    presses: Presses
    touches: Touches
