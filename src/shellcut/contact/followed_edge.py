"""An edge of the film that presses, followed from step to step, for kernels.

All hills of an edge (:mod:`.edge_hills`) are looked for only when an end of it has moved so far in
the tool since the last time that another may have become the highest, by ``FOLLOWED`` of the
rounding radius at most. In between the highest one is followed: in the wedge of the two faces at
which it lies, taken for the tool without another look, or in the tool itself, from where it would
be if it went on along the edge as over the last step. What presses is still the gradient of an
energy. Where a hill that was not known or another face takes over, it does so later by that way;
energies are equal there, and faces join with equal slope, so little is missed.

An edge near the tool that does not press is looked at again when an end has moved by ``IDLE`` of
the radius. If it presses by then it is as deep as it has moved, and the force has hardly set in.

A hill is looked for among all at once if it has ended, its edge is on another side of the blade,
its depth jumps, or the list is new.
"""

from __future__ import annotations

from math import sqrt

from shellcut.arrays import Vec3
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.jit import inline
from shellcut.numerics.vec3 import add_scaled, dot, load, norm, store, sub
from shellcut.tool.signed_distance import signed_distance

from .captured_edges import closest_edge, is_tool, place_on
from .deepest_on_edge import hill_around, press_on
from .edge_hills import Hills, no_hills
from .edge_tables import EdgeTables
from .tool_wedge import (
    Beside,
    Deepest,
    Place,
    Wedge,
    deepest_in_wedge,
    no_wedge,
    place_in_wedge,
    wedge_along,
)

FOLLOWED, LEAST = 0.12, 0.02
"""Largest and least way of its ends in the tool after which all hills of an edge are looked for
again, over the rounding radius: the least where the next highest hill is as high."""

IDLE = 0.03
"""Likewise, for an edge near the tool that does not press."""

NEXT_STEP = 0.02
"""First step along an edge from the place where it pressed last, over the rounding radius."""

NEXT_FLAT, NEXT_LEVEL = 1e-4, 0.03
"""Slopes of energy and depth that end a search in the tool, see :mod:`.deepest_on_edge`: what is
wrong in both is of second order, 1e-6 of the energy and 5e-4 of the radius."""

_BESIDE = 0.05
"""Way to the places before and behind where the tool is asked for its faces, over the radius."""

# What the hill of an edge is followed in; 0 stands for nothing.
_WEDGE, _TOOL = 1, 2

NO_HILL = 3
"""Stands for the hill of an edge that did not press when all of the tool was searched."""


@inline
def way_since(i: int, a: Vec3, b: Vec3, held: EdgeTables) -> float:
    """Return how far the i-th edge has moved in the tool since all of its hills were looked for.

    a, b : its ends, in the body frame [mm]; no place between them has moved by more.
    """
    then = borrowed(held).memory.then
    of_a, of_b = sub(a, load(then[i], 0)), sub(b, load(then[i], 1))
    return sqrt(max(dot(of_a, of_a), dot(of_b, of_b)))


@inline
def is_idle(i: int, way: float, held: EdgeTables) -> bool:
    """Return whether the i-th edge did not press when it was looked at, and has hardly moved.

    way : since then [mm], of :func:`way_since`.
    """
    tables = borrowed(held)
    return bool(way <= IDLE * tables.law.rounding and tables.memory.follows[i] == NO_HILL)


@inline
def is_followed(i: int, way: float, held: EdgeTables) -> bool:
    """Return whether the hill of the i-th edge may be followed for another step."""
    tables = borrowed(held)
    memory = tables.memory
    return bool(memory.follows[i] in (_WEDGE, _TOOL) and way <= memory.reach[i])


@inline
def follow(i: int, hills: Hills, beside: Beside, held: EdgeTables) -> None:
    """Write down the hill of the i-th edge that has been found among all, to follow it."""
    tables = borrowed(held)
    memory, wedge = tables.memory, hills.wedge
    memory.follows[i] = NO_HILL
    store(memory.then[i], 0, beside.a)
    store(memory.then[i], 1, add_scaled(beside.a, 1.0, beside.u))
    if hills.press.stored == 0.0:
        return
    memory.press_place[i] = hills.press.s
    memory.body[i] = tables.edges.body[closest_edge(hills.press.s, beside, held)]
    if hills.one and not wedge.known:
        wedge = _wedge_around(hills.press.s, beside, held)
    memory.follows[i] = _WEDGE if hills.one and wedge.known else _TOOL
    store(memory.normal[i], 0, wedge.one)
    store(memory.normal[i], 1, wedge.two)
    memory.level[i, 0] = wedge.depth_one + dot(wedge.one, beside.a)
    memory.level[i, 1] = wedge.depth_two + dot(wedge.two, beside.a)
    memory.reach[i] = FOLLOWED * tables.law.rounding
    if hills.second > 0.0:
        # A way w changes a depth beside the chord by up to 2 w; that both hills change so, against
        # each other, is left to LEAST and to the next look.
        until = 0.5 * (hills.press.stored - hills.second) / hills.press.pressure
        memory.reach[i] = min(memory.reach[i], max(until, LEAST * tables.law.rounding))


@inline
def _wedge_around(s: float, beside: Beside, held: EdgeTables) -> Wedge:
    """Return the wedge of the tool's faces before and behind a place, if it is the tool there."""
    tables = borrowed(held)
    surface, radius = tables.grid.surface, tables.law.rounding
    away = _BESIDE * radius / norm(beside.u)
    before = add_scaled(beside.a, s - away, beside.u)
    behind = add_scaled(beside.a, s + away, beside.u)
    one_found, _, one, _, _, _ = signed_distance(before, beside.side, tables.grid)
    two_found, _, two, _, _, _ = signed_distance(behind, beside.side, tables.grid)
    if not (one_found and two_found) or one == two:
        return no_wedge()
    n_one, n_two = load(surface.pseudo_normals[one], 0), load(surface.pseudo_normals[two], 0)
    level_one = dot(n_one, load(surface.corners[one], 0))
    level_two = dot(n_two, load(surface.corners[two], 0))
    wedge = wedge_along(beside.a, beside.u, n_one, n_two, level_one, level_two)
    says, found = deepest_in_wedge(wedge, beside.end_a, beside.end_b, radius)
    here = place_in_wedge(s, wedge, radius)
    if says and found.depth > 0.0 and here.inside and is_tool(s, here, beside, held)[0]:
        return wedge
    return no_wedge()


@inline
def followed_hill(i: int, beside: Beside, held: EdgeTables) -> Hills:
    """Return the hill of the i-th edge that is followed, without energy if it has ended."""
    if borrowed(held).memory.follows[i] == _WEDGE:
        return _in_wedge(i, beside, held)
    return _in_tool(i, beside, held)


@inline
def _expected(i: int, held: EdgeTables) -> float:
    """Return where the i-th edge presses if that goes on along it as over the last step."""
    memory = borrowed(held).memory
    s: float = min(max(memory.press_place[i] + memory.drift[i], 0.0), 1.0)
    return s


@inline
def _in_wedge(i: int, beside: Beside, held: EdgeTables) -> Hills:
    tables = borrowed(held)
    memory, radius = tables.memory, tables.law.rounding
    one, two, level = load(memory.normal[i], 0), load(memory.normal[i], 1), memory.level[i]
    wedge = wedge_along(beside.a, beside.u, one, two, level[0], level[1])
    says, found = deepest_in_wedge(wedge, beside.end_a, beside.end_b, radius)
    if not says or found.depth == 0.0:
        return no_hills(beside)
    s = _expected(i, held)
    begin = Deepest(found.depth, s, place_in_wedge(s, wedge, radius))
    press = press_on(begin, memory.offset[i], beside, wedge, held, NEXT_STEP)
    return Hills(True, found, press, True, wedge, 0.0)


@inline
def _in_tool(i: int, beside: Beside, held: EdgeTables) -> Hills:
    tables = borrowed(held)
    memory, wedge = tables.memory, no_wedge()
    s = _expected(i, held)
    here = place_on(s, beside, held)
    begin = Deepest(here.depth, s, here)
    press = press_on(begin, memory.offset[i], beside, wedge, held, NEXT_STEP, NEXT_FLAT)
    if press.stored == 0.0:
        return no_hills(beside)
    # With both ends outside the place that presses is the deepest one, too.
    found = Deepest(press.depth, press.s, Place(True, press.depth, press.out))
    if beside.end_a.depth > 0.0 or beside.end_b.depth > 0.0:
        nothing = no_hills(beside).deepest
        found = hill_around(memory.place[i], nothing, beside, held, NEXT_STEP, NEXT_LEVEL)
    if found.depth == 0.0:
        return no_hills(beside)
    return Hills(True, found, press, True, wedge, 0.0)
