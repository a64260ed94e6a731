"""What an edge of the film presses with: the highest of its hills, for kernels.

Along an edge of the film its depth over the chord of its ends has one hill beside a convex tool.
Beside a hollow flank of facets, or between two teeth, it may have several, and the one that is
deepest need not have the most energy, above all where a part of the depth does not press. So the
energy is looked for on each of them, and the largest presses: it is continuous where two hills take
turns.

The wedges at the captured edges of the tool come first (:mod:`.captured_edges`). On an edge of many
short facets the deepest place of a wedge mostly lies at another edge: the wedge of that one says
better how deep it is there. Where wedges say so of each other, or a wedge is deeper than the tool
at an end of the film's edge, the tool itself is searched, all along the edge
(:mod:`.deepest_on_edge`).
"""

from __future__ import annotations

from typing import NamedTuple

from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.jit import inline

from .captured_edges import (
    closest_edge,
    is_tool,
    wedge_at,
    with_faces_there,
)
from .deepest_on_edge import Press, hill_around, no_press, press_on
from .edge_tables import EdgeTables
from .tool_wedge import (
    Beside,
    Deepest,
    Wedge,
    deepest_in_wedge,
    no_wedge,
    place_in_wedge,
)

_PARTS = 8
"""Of an edge of the film; hills are looked for from where these meet. With four a run of the
opening test misses twice the energy, where hills take turns."""

# Of the edge's length: what presses at places closer than this is one hill.
_APART = 0.01


class Hills(NamedTuple):
    """The highest of the hills of an edge of the film."""

    known: bool
    """Whether wedges show them; if not, ``deepest`` is where to begin the search."""
    deepest: Deepest
    """Place that is deepest beside the chord."""
    press: Press
    """The largest, over the stiffness of the edge."""
    one: bool
    """Whether both are of one hill."""
    wedge: Wedge
    """In which that lies, known if it stands for the tool there."""
    second: float
    """Energy of the next highest hill [mm²], 0 if none is known."""


@inline
def no_hills(beside: Beside) -> Hills:
    """Return those of an edge that is nowhere deeper than its chord."""
    nowhere = Deepest(0.0, 0.0, beside.end_a)
    return Hills(True, nowhere, no_press(nowhere), True, no_wedge(), 0.0)


@inline
def hills_of(last: float, offset: float, beside: Beside, held: EdgeTables) -> Hills:
    """Return the highest hills of an edge of the film.

    last : place where it was deepest before, from 0 to 1, negative for none.  offset : part of the
    depth that does not press [mm].
    """
    hills = _of_wedges(offset, beside, held)
    if hills.known:
        return hills
    begin = hills.deepest.s
    # Where the wedges do not say it, they save no look at the tool either.
    beside = Beside(beside.a, beside.u, beside.side, beside.end_a, beside.end_b, 0)
    hills = _with_hill(begin, offset, no_hills(beside), beside, held)
    if last >= 0.0:
        hills = _with_hill(last, offset, hills, beside, held)
    for k in range(1, _PARTS):
        hills = _with_hill(k / _PARTS, offset, hills, beside, held)
    return hills


@inline
def _of_wedges(offset: float, beside: Beside, held: EdgeTables) -> Hills:
    """Return the highest hills that wedges show, or where to begin if they do not."""
    tables = borrowed(held)
    hills = no_hills(beside)
    elsewhere, between, silent = hills.deepest, no_wedge(), beside.n_captured > 0
    for i in range(beside.n_captured):
        e = tables.captured[i]
        at = wedge_at(e, beside, held)
        says, found = deepest_in_wedge(at, beside.end_a, beside.end_b, tables.law.rounding)
        silent &= not says
        if says and found.depth == 0.0:
            continue
        if closest_edge(found.s, beside, held) != e:
            if found.depth > elsewhere.depth:
                elsewhere, between = found, at
            continue
        known = False
        if says:
            known, hills = _with_wedge(found, at, offset, hills, beside, held)
        if not known:
            return Hills(False, found, hills.press, False, no_wedge(), 0.0)
    if silent and hills.deepest.depth == 0.0 and elsewhere.depth == 0.0:
        # All are deeper than the tool at an end: the edge may still lie in faces between them.
        return Hills(False, elsewhere, hills.press, False, no_wedge(), 0.0)
    if hills.deepest.depth == 0.0 and elsewhere.depth > 0.0:
        known, hills = _with_wedge(elsewhere, between, offset, hills, beside, held)
        if not known:
            return Hills(False, elsewhere, hills.press, False, no_wedge(), 0.0)
    return hills


@inline
def _with_wedge(
    found: Deepest, wedge: Wedge, offset: float, so_far: Hills, beside: Beside, held: EdgeTables
) -> tuple[bool, Hills]:
    """Return whether the tool is as deep as a wedge at its deepest place, and hills with that."""
    agrees, found, wedge = with_faces_there(found, wedge, beside, held)
    if not agrees:
        return False, so_far
    press = press_on(found, offset, beside, wedge, held)
    agrees = press.stored > 0.0
    if agrees:
        here = place_in_wedge(press.s, wedge, borrowed(held).law.rounding)
        agrees, _ = is_tool(press.s, here, beside, held)
    if not agrees:
        # In the wedge the energy may rise up to the end of the edge, or where other faces are.
        wedge = no_wedge()
        press = press_on(found, offset, beside, wedge, held)
    return True, _higher(found, press, wedge, so_far)


@inline
def _with_hill(at: float, offset: float, so_far: Hills, beside: Beside, held: EdgeTables) -> Hills:
    """Return hills with the one around a place of the edge."""
    found = hill_around(at, so_far.deepest, beside, held)
    if found.depth == 0.0:
        return so_far
    press = press_on(found, offset, beside, no_wedge(), held)
    return _higher(found, press, no_wedge(), so_far)


@inline
def _higher(found: Deepest, press: Press, wedge: Wedge, so_far: Hills) -> Hills:
    deeper = found.depth > so_far.deepest.depth
    stronger = press.stored > so_far.press.stored
    deepest = found if deeper else so_far.deepest
    most = press if stronger else so_far.press
    one = (deeper and stronger) if (deeper or stronger) else so_far.one
    lower = so_far.press if stronger else press
    another = abs(lower.s - most.s) > _APART
    second = max(so_far.second, lower.stored if another else 0.0)
    return Hills(True, deepest, most, one, wedge if stronger else so_far.wedge, second)
