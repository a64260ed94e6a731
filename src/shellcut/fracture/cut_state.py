"""Carry out cuts: copies of quads, and nodes for the classes of their corners.

All copies start where the quad was: position, director, velocity and spin of a new node are those
of the node it was split from, and its mass and rotary inertia are summed over its own copies. Mass,
momentum, angular momentum, kinetic and strain energy of the film stay as they were, to round-off.

A sliver would be so light that the cables at its flank set the time step. So a part gets
``LEAST_MASS`` of what is cut at least, and the other that much less: no mass is made, the sliver's
is that of film a hair's breadth further. The largest frequency of the other part grows by the
square root of 1 / (1 - LEAST_MASS), 2.6 %, that of the sliver falls.

A node without film at its corner is *virtual*: it has no film and no contact. Which of the
classes keeps the old node makes no difference to the solution; it is the first one with film, so
that what users know of a node by its id stays where the film is.
"""

from __future__ import annotations

from collections.abc import Iterable

from shellcut.mitc4.shell import MITC4Shell
from shellcut.numerics.bilinear import shape_functions
from shellcut.state import State

from .cut_topology import Corner, CutTopology
from .flank_points import bearable_area
from .quad_polygon import (
    CORNERS,
    UNUSED,
    Point,
    along_side,
    density,
    film_beside,
    on_side,
    share_of,
    span,
)
from .tip import Segment

LEAST_MASS = 0.05
"""Of a quad or copy that is cut, the mass that either part gets at least."""


def cut_row(state: State, shell: MITC4Shell, topology: CutTopology, segment: Segment) -> int:
    """Cut a quad, or a copy of one, along a chord; return the row of what lies to the left.

    Nodes are to be renewed at the corners of the quad (:func:`renew_nodes`).

    Parameters
    ----------
    state, shell, topology : State, MITC4Shell, CutTopology
        Written.
    segment : Segment
        Its row keeps what lies to the right of the line from entry to exit.
    """
    row = segment.row
    new = topology.cut(row, segment.entry, segment.exit)
    J = density(state.node.X[shell.mesh_quads[row]])
    polygons = topology.polygon(row), topology.polygon(new)
    right, left = (share_of(polygon, J) for polygon in polygons)
    light = min(max(right / (right + left), LEAST_MASS), 1.0 - LEAST_MASS)
    mass = state.quad.mass_share[row]
    state.quad.append_copy(row)
    state.quad.centre[[row, new]] = [shape_functions(*film_beside(polygon)) for polygon in polygons]
    shell.cut(state, row, new, (right, left), (mass * light, mass * (1.0 - light)))
    return new


def side_under(shell: MITC4Shell, segment: Segment) -> tuple[tuple[int, int], tuple[float, float]]:
    """Return the side of the mesh along which a segment runs, and which part of it.

    The nodes of the side in the direction of the segment, and fractions of it from the first.
    """
    ring = shell.mesh_quads[segment.row].tolist()
    a, b = ring[segment.side], ring[(segment.side + 1) % 4]
    start, stop = (along_side(segment.side, place) for place in (segment.entry, segment.exit))
    return ((a, b), (start, stop)) if start < stop else ((b, a), (1.0 - start, 1.0 - stop))


def rows_along(
    topology: CutTopology, side: tuple[int, int], part: tuple[float, float]
) -> tuple[list[int], list[tuple[Point, Point]]]:
    """Return the rows to the right and left of a part of a side, and its ends in the quad of each.

    side, part : as of :func:`side_under`.
    """
    (start, stop), rows, chords = part, [-1, -1], [(CORNERS[0], CORNERS[0])] * 2
    for row, k, up in topology.rows_beside(*side):
        first, last = (start, stop) if up else (1.0 - start, 1.0 - stop)
        interval = span(topology.polygon(row), k)
        if interval is not None and interval[0] < 0.5 * (first + last) < interval[1]:
            # A quad's sides run counter-clockwise: its film lies to their left.
            rows[up], chords[up] = row, (on_side(k, first), on_side(k, last))
    return rows, chords


def nodes_at(state: State, row: int, place: Point) -> set[int]:
    """Return the nodes of a row that move a place in it."""
    corners = zip(state.quads[row].tolist(), shape_functions(*place), strict=True)
    return {node for node, weight in corners if weight > UNUSED}


def parted(state: State, rows: Iterable[int], places: Iterable[Point]) -> bool:
    """Return whether two flanks have parted at one place of a crack, in the quad of each."""
    minus, plus = (nodes_at(state, row, at) for row, at in zip(rows, places, strict=True))
    return minus != plus


def renew_nodes(
    state: State, shell: MITC4Shell, topology: CutTopology, nodes: Iterable[int]
) -> None:
    """Give every class of corners around some nodes of the mesh a node of its own."""
    for mesh_node in nodes:
        of_node: dict[int, list[list[Corner]]] = {}
        for members in topology.classes(mesh_node):
            row, corner = members[0]
            of_node.setdefault(int(state.quads[row, corner]), []).append(members)
        for node, groups in of_node.items():
            groups.sort(key=lambda members: (not topology.is_real(members), members))
            _share_node(state, shell, topology, node, groups)


def _share_node(
    state: State,
    shell: MITC4Shell,
    topology: CutTopology,
    node: int,
    groups: list[list[Corner]],
) -> None:
    """Give each of some groups of corners at one node a node; the first keeps it."""
    before = state.node.mass[node]
    ids = [node, *(state.node.append_copy(node) for _ in groups[1:])]
    n = state.node
    for half, members in zip(ids, groups, strict=True):
        for row, corner in members:
            state.quad.nodes[row, corner] = half
        n.take_quads(half, sorted(row for row, _ in members))
        n.real[half] = topology.is_real(members)
        if not n.real[half]:
            n.supported[half] = False
            n.support[half] = False
            n.support_rate[half] = n.reaction[half] = 0.0
        mass, inertia, n.contact_area[half] = shell.node_inertia(state, half)
        n.weigh(half, mass, inertia)
        bears = bearable_area(n.mass[half], shell.material.area_density)
        n.contact_share[half] = min(1.0, bears / n.contact_area[half])
        # Forces of the last evaluation, shared like the mass, enter the next work increment only.
        share = mass / before
        n.contact_force[half] *= share
        n.friction_force[half] *= share
        n.contact_work[half] *= share
        n.load_force[half] *= share
        if len(groups) > 1:
            n.contact_side[half] = 0
            n.halved[half] = True
