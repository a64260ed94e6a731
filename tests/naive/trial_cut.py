"""The nodal force of a trial cut, by the sums of ``fracture/trial_cut.py``, corner by corner.

The cut is made on the topology and undone: the classes of corners there say which film is on either
side. Masses and forces of corners are those of shell and loads.
"""

from typing import NamedTuple

import numpy as np

from shellcut.state import BROKEN

from .load import pressure_rows_of_part
from .shell import CORNERS, shape

RIGHT, LEFT = 0, 1
NONE = 1e-9  # of a shape function: the corner has no part in the place


class Film(NamedTuple):
    """What a trial cut is made in; the strength of its cables [MPa]."""

    topology: object
    shell: object
    loads: object
    strength: float


def at(place):
    """Shape functions at a place of a quad, (4,)."""
    return shape(*place)[0]


def measures(film, state, tip, segment):
    """Return F · m and |F| over what the cables would carry; a driven cut is due at 1 of F · m."""
    if force(film, state, segment) is None:
        return -np.inf, -np.inf
    m, length = across(state, segment)
    found = force(film, state, segment, share_of=lambda share, closed: share - closed)
    carries = film.strength * film.shell.material.thickness
    carries *= max(
        0.5 * (behind(film, state, segment) + length), gathered(film, state, tip, segment)
    )
    return float(found @ m) / carries, float(np.linalg.norm(found)) / carries


def force(film, state, segment, share_of=lambda share, closed: share):
    """Return F_c [N], shape (3,); None if the cut would part nothing at the tip.

    share_of : how much of a cable's force counts.
    """
    part = shares(film, state, segment)
    d, kappa = np.zeros(3), 0.0
    for weight, sides in pairs(film, segment):
        for sign, members in zip((-1.0, 1.0), sides, strict=True):
            mass, total = 0.0, np.zeros(3)
            for row, corner, of in members:
                share = 1.0 if of is None else part[of]
                mass += share * film.shell.mass[row, corner]
                total += share * corner_force(film, state, row, corner)
            for cable, end, cable_share, closed in cables(film, state, segment, members):
                total += share_of(cable_share, closed) * state.cable.force[cable, end]
            d += sign * weight * total / mass
            kappa += weight**2 / mass
    return d / kappa if kappa > 0.0 else None


def gathered(film, state, tip, segment):
    """Return what F would be under a tension of 1 N/mm in all directions [mm], 0 along a side."""
    if segment.along_side:
        return 0.0
    part = shares(film, state, segment)
    d, kappa = np.zeros(3), 0.0
    for weight, sides in pairs(film, segment):
        for sign, members in zip((-1.0, 1.0), sides, strict=True):
            mass, total = 0.0, np.zeros(3)
            for row, corner, of in members:
                share = 1.0 if of is None else part[of]
                mass += share * film.shell.mass[row, corner]
                total -= share * state.quad.share[row] * area_slope(state, row, corner)
            for cable, end, cable_share, closed in cables(film, state, segment, members):
                length = state.cable.length[cable]
                total += (cable_share - closed) * length * pull_of(state, cable, end)
            d += sign * weight * total / mass
            kappa += weight**2 / mass
    # Where no cables are the flanks behind do not pull at the tip.
    normal = unit_normal(state.node.X[state.quads[segment.row]])
    joined = joined_by(film, state, segment, state.cable.length)
    open_ = max(0.0, 1.0 - joined / tip.length) if tip.length else 0.0
    missing = 0.5 * open_ * tip.length * np.cross(normal, tip.heading)
    return float(np.linalg.norm(d / kappa - missing))


def pull_of(state, cable, end):
    """Return the direction of the pull on an end of a cable in the reference film, shape (3,)."""
    row, (start, stop) = state.cable.row[cable, 0], state.cable.chord[cable, 0]
    X = state.node.X[state.quads[row]]
    m = np.cross(unit_normal(X), (at(stop) - at(start)) @ X)
    return (-1.0 if end else 1.0) * m / np.linalg.norm(m)


def area_slope(state, row, corner):
    """Return by how much the area of a flat quad grows if a corner moves [mm], shape (3,)."""
    X = state.node.X[state.quads[row]]
    return 0.5 * np.cross(X[(corner + 1) % 4] - X[corner - 1], unit_normal(X))


def unit_normal(X):
    """Return the unit normal to a quad, shape (3,)."""
    normal = np.cross(X[2] - X[0], X[3] - X[1])
    return normal / np.linalg.norm(normal)


def corner_force(film, state, row, corner):
    """Return the force of a whole row on one of its nodes [N], (3,)."""
    at_corner = np.array([row]), np.array([state.quads[row, corner]], np.int64)
    force = film.shell.corner_forces(state, *at_corner)
    film.loads.add_corner_forces(state, *at_corner, force)
    return force[0]


def pairs(film, segment):
    """Return for each corner at the tip its shape function, and what is on both sides of the cut.

    Minus and plus side: each a list of rows, which corner it is of them, and RIGHT or LEFT for the
    parts of the row that is cut.
    """
    topology, row = film.topology, segment.row
    ring = film.shell.mesh_quads[row].tolist()
    corners = [c for c in range(4) if at(segment.entry)[c] > NONE]
    if segment.along_side:
        # The row lies to the left of its own side; the other, if its film is there, to the right.
        a, b = ring[segment.side], ring[(segment.side + 1) % 4]
        places = np.subtract([segment.entry, segment.exit], CORNERS[segment.side])
        s = np.linalg.norm(places, axis=1) / 2.0
        on = [one for one in topology.rows_beside(a, b) if reaches(topology, *one[:2], s, one[2])]
        (mine,), (other,) = ([r for r, _, up in on if up == upward] for upward in (True, False))
        ahead = s[0] < s[1]
        parts = {other: None, mine: None}
        topology.break_side(a, b, min(s), max(s))
        classes = [topology.classes(ring[c]) for c in corners]
        topology.mend_side(a, b)
        sides = (other, mine) if ahead else (mine, other)
    else:
        whole = topology.polygon(row)
        new = topology.cut(row, segment.entry, segment.exit)
        classes = [topology.classes(ring[c]) for c in corners]
        topology.mend(row, new, whole)
        sides, parts = (row, new), {row: RIGHT, new: LEFT}
    found = []
    for c, groups in zip(corners, classes, strict=True):
        both = [next((g for g in groups if any(r == row for r, _ in g)), None) for row in sides]
        if None not in both and both[0] is not both[1]:
            members = [
                [(row if parts.get(r) == LEFT else r, k, parts.get(r)) for r, k in group]
                for group in both
            ]
            found.append((at(segment.entry)[c], members))
    return found


def reaches(topology, row, side, s, up):
    """Whether the film of a row lies along a part of one of its sides."""
    polygon = topology.polygon(row)
    on = [
        np.linalg.norm(np.subtract(point, CORNERS[side])) / 2.0
        for k, point in enumerate(polygon.points)
        if side in (polygon.sides[k], polygon.sides[k - 1])
    ]
    middle = 0.5 * sum(s) if up else 1.0 - 0.5 * sum(s)
    return len(on) == 2 and min(on) < middle < max(on)


def cables(film, state, segment, members):
    """Return cable, end, how much of its force the corners of a side have, and of that at the tip.

    That is where the flanks have not parted yet: both move with the same nodes.
    """
    c, corner, found = state.cable, {row: k for row, k, _ in members}, []
    own = [of for row, _, of in members if of is not None]
    for k in range(c.count):
        for end in (0, 1):
            row = int(c.row[k, end])
            if c.status[k] == BROKEN or row not in corner:
                continue
            start, stop = c.chord[k, end]
            place = start + c.share[k] * (stop - start)
            if row == segment.row and any(side_of(segment, place) == 1 - of for of in own):
                continue
            weights = 1.0 - c.share[k], c.share[k]
            parts = [w * at(p)[corner[row]] for w, p in zip(weights, (start, stop), strict=True)]
            if sum(parts) <= NONE:
                continue
            closed = 0.0
            for part, which in zip(parts, (0, 1), strict=True):
                nodes = [
                    {int(n) for n, w in zip(state.quads[r], at(place), strict=True) if w > NONE}
                    for r, place in zip(c.row[k], c.chord[k, :, which], strict=True)
                ]
                closed += part if nodes[0] == nodes[1] else 0.0
            found.append((k, end, sum(parts), closed))
    return found


def side_of(segment, place):
    """RIGHT or LEFT of a segment, None on it."""
    along, gap = np.subtract(segment.exit, segment.entry), np.subtract(place, segment.entry)
    z = along[0] * gap[1] - along[1] * gap[0]
    return None if abs(z) < 1e-9 or segment.along_side else LEFT if z > 0.0 else RIGHT


def behind(film, state, segment):
    """Return L_in [mm], which has the factor on the strength of the cables there."""
    thickness = film.shell.material.thickness
    return joined_by(film, state, segment, state.cable.area / thickness)


def joined_by(film, state, segment, length):
    """Return how much of the segment behind cables join, half of it at the tip [mm].

    length : (n_cable,), of each cable.
    """
    every = pairs(film, segment)
    lengths = [
        closed * length[cable]
        for _, (minus, _) in every
        for cable, _, _, closed in cables(film, state, segment, minus)
    ]
    return 2.0 * sum(lengths) / sum(weight for weight, _ in every)


def shares(film, state, segment):
    """Return which parts of the row lie to the right and left of a segment."""
    if segment.along_side:
        return 1.0, 1.0
    points = np.array(film.topology.polygon(segment.row).points)
    areas = []
    for of in (RIGHT, LEFT):
        ring = []
        for a, b in zip(points, np.roll(points, -1, axis=0), strict=True):
            sides = [side_of(segment, p) for p in (a, b)]
            ring += [a] if sides[0] in (of, None) else []
            if None not in sides and sides[0] != sides[1]:
                ring.append(segment.entry if _between(segment.entry, a, b) else segment.exit)
        X = state.node.X[state.quads[segment.row]]
        areas.append(np.linalg.norm(pressure_rows_of_part(X, ring, 1.0).sum(axis=0)))
    return areas[RIGHT] / sum(areas), areas[LEFT] / sum(areas)


def _between(place, a, b):
    """Whether a place lies on the line from a to b."""
    distances = np.linalg.norm(np.subtract(place, a)) + np.linalg.norm(np.subtract(place, b))
    return distances < np.linalg.norm(b - a) + 1e-6


def across(state, segment):
    """Return the unit normal to a segment in the sheet, shape (3,), and its length [mm]."""
    nodes, start, stop = state.quads[segment.row], at(segment.entry), at(segment.exit)
    m = np.cross(start @ state.node.t[nodes], (stop - start) @ state.node.x[nodes])
    return m / np.linalg.norm(m), float(np.linalg.norm((stop - start) @ state.node.X[nodes]))
