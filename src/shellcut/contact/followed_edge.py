"""An edge of the film that presses, followed from step to step, for kernels.

All hills of an edge (:mod:`.edge_hills`) are looked for only when film and tool have moved by
``FOLLOWED`` of the rounding radius since the last time, some ten steps. In between the highest one
follows the edge: in the wedge of the two faces at which it lay, taken for the tool without another
look, or in the tool itself, from its last place. What presses is still the gradient of an energy.
Where another hill or another face takes over, it does so that much later; both have equal energies
there, and faces join with equal slope, so little is missed.

An edge near the tool that does not press is looked at again when it has moved by ``IDLE`` of the
radius. If it presses by then it is as deep as it has moved, and the force has hardly set in.

A hill is looked for among all at once if it has ended, its edge is on another side of the blade,
its depth jumps, or the list is new.
"""

from __future__ import annotations

from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.jit import inline
from shellcut.numerics.vec3 import dot, load, store

from .captured_edges import closest_edge
from .deepest_on_edge import hill_around, place_along, press_on
from .edge_hills import Hills, no_hills
from .edge_tables import EdgeTables
from .tool_wedge import Beside, Deepest, deepest_in_wedge, no_wedge, wedge_along

FOLLOWED = 0.3
"""Way of film and tool after which all hills of an edge are looked for again, over the rounding
radius."""

IDLE = 0.1
"""Likewise, for an edge near the tool that does not press."""

NEXT_STEP = 0.02
"""First step along an edge from the place where it pressed last, over the rounding radius."""

# What the hill of an edge is followed in.
_NOTHING, _WEDGE, _TOOL = 0, 1, 2

NO_HILL = 3
"""Stands for the hill of an edge that did not press when all of the tool was searched."""


@inline
def is_idle(i: int, held: EdgeTables) -> bool:
    """Return whether the i-th edge did not press when it was looked at, and has hardly moved."""
    tables = borrowed(held)
    memory = tables.memory
    idle: bool = memory.way[i] <= IDLE * tables.law.rounding
    return idle and memory.follows[i] == NO_HILL


@inline
def is_followed(i: int, held: EdgeTables) -> bool:
    """Return whether the hill of the i-th edge may be followed for another step."""
    tables = borrowed(held)
    memory = tables.memory
    followed: bool = memory.way[i] <= FOLLOWED * tables.law.rounding
    return followed and (memory.follows[i] == _WEDGE or memory.follows[i] == _TOOL)


@inline
def follow(i: int, hills: Hills, beside: Beside, held: EdgeTables) -> None:
    """Write down the hill of the i-th edge that has been found among all, to follow it."""
    tables = borrowed(held)
    memory, wedge = tables.memory, hills.wedge
    memory.way[i], memory.follows[i] = 0.0, _NOTHING
    if hills.press.stored == 0.0:
        memory.follows[i] = NO_HILL
        return
    memory.body[i] = tables.edges.body[closest_edge(hills.press.s, beside, held)]
    memory.follows[i] = _WEDGE if hills.one and wedge.known else _TOOL
    store(memory.normal[i], 0, wedge.one)
    store(memory.normal[i], 1, wedge.two)
    memory.level[i, 0] = wedge.depth_one + dot(wedge.one, beside.a)
    memory.level[i, 1] = wedge.depth_two + dot(wedge.two, beside.a)


@inline
def followed_hill(i: int, beside: Beside, held: EdgeTables) -> Hills:
    """Return the hill of the i-th edge that is followed, without energy if it has ended."""
    tables = borrowed(held)
    memory, wedge = tables.memory, no_wedge()
    found = no_hills(beside).deepest
    if memory.follows[i] == _WEDGE:
        one, two = load(memory.normal[i], 0), load(memory.normal[i], 1)
        level = memory.level[i]
        wedge = wedge_along(beside.a, beside.u, one, two, level[0], level[1])
        says, found = deepest_in_wedge(wedge, beside.end_a, beside.end_b, tables.law.rounding)
        if not says:
            return no_hills(beside)
    else:
        found = hill_around(memory.place[i], found, beside, held)
    if found.depth == 0.0:
        return no_hills(beside)
    s = memory.press_place[i]
    begin = Deepest(found.depth, s, place_along(s, beside, wedge, held))
    press = press_on(begin, memory.offset[i], beside, wedge, held, NEXT_STEP)
    return Hills(True, found, press, True, wedge)
