"""The nodal force of a trial cut, by the sums of ``fracture/trial_cut.py`` one side at a time."""

import numpy as np

from shellcut.fracture.quad_polygon import density, divide, shape_functions, share_of
from shellcut.state import BROKEN


def measures(trial, state, segment):
    """Return F · m and |F| over what the cables would carry; a driven cut is due at 1 of F · m."""
    if force(trial, state, segment) is None:
        return -np.inf, -np.inf
    m, length = across(state, segment)
    found = force(trial, state, segment, held_by=lambda share, closed: share - closed)
    before = behind(trial, state, segment)
    carries = trial.carried * 0.5 * (before + length)
    return float(found @ m) / carries, float(np.linalg.norm(found)) / carries


def force(trial, state, segment, held_by=lambda share, closed: share):
    """Return F_c [N], shape (3,); None if the cut would part nothing at the tip.

    held_by : how much of a cable's force counts.
    """
    part = np.array([1.0, *shares(trial, state, segment)])
    d, kappa = np.zeros(3), 0.0
    for weight, sides in trial.pairs(state, segment):
        for sign, side in zip((-1.0, 1.0), sides, strict=True):
            share = part[side.part]
            mass = float(share @ trial.corner_mass(side))
            total = share @ trial.corner_forces(state, side.rows, side.nodes)
            for cable, end, held, closed in side.cables:
                if state.cable.status[cable] != BROKEN:
                    total += held_by(held, closed) * state.cable.force[cable, end]
            d += sign * weight * total / mass
            kappa += weight**2 / mass
    return d / kappa if kappa > 0.0 else None


def behind(trial, state, segment):
    """Return L_in [mm]: of one side, and of the corners that part, the area of what holds there."""
    pairs = trial.pairs(state, segment)
    areas = [
        closed * state.cable.area[cable]
        for _, (minus, _) in pairs
        for cable, _, _, closed in minus.cables
        if state.cable.status[cable] != BROKEN
    ]
    return 2.0 * sum(areas) / trial.thickness / sum(weight for weight, _ in pairs)


def shares(trial, state, segment):
    """Return which parts of the row lie to the right and left of a segment."""
    if segment.along_side:
        return 1.0, 1.0
    J = density(state.node.X[state.quads[segment.row]])
    whole = trial.topology.polygon(segment.row)
    right, left = (share_of(p, J) for p in divide(whole, segment.entry, segment.exit))
    return right / (right + left), left / (right + left)


def across(state, segment):
    """Return the unit normal to a segment in the sheet, shape (3,), and its length [mm]."""
    nodes = state.quads[segment.row]
    start, stop = (np.array(shape_functions(p)) for p in (segment.entry, segment.exit))
    m = np.cross(start @ state.node.t[nodes], (stop - start) @ state.node.x[nodes])
    return m / np.linalg.norm(m), float(np.linalg.norm((stop - start) @ state.node.X[nodes]))
