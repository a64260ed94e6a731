"""Where a crack goes on that has come to an earlier one: on the other flank of that.

Several rows touch the place where the two meet. Film hangs together there where rows have the same
nodes: the row into which the crack would go on, and those that hang together with it, are the other
flank; all others lie behind.
"""

from __future__ import annotations

from shellcut.arrays import Floats
from shellcut.state import State

from .crack_path import CrackPath
from .cut_state import nodes_at
from .cut_topology import CutTopology
from .segment import Segment
from .tip import Tip


def tip_across(
    state: State,
    topology: CutTopology,
    path: CrackPath,
    segment: Segment,
    heading: Floats,
    way: Floats,
) -> Tip | None:
    """Return the tip on the other flank of the crack at which a segment has ended.

    Parameters
    ----------
    state, topology : State, CutTopology
        After the cut.
    path : CrackPath
        Of the film.
    segment : Segment
        Whose exit lies on that crack.
    heading, way : ndarray, shape (3,)
        Direction of the segment in the reference film, and in space.

    Returns
    -------
    Tip or None
        None where there is no film beyond, at a rim. There is no crack behind the new tip: its
        length is 0.
    """
    quad = topology.parent(segment.row)
    touching = path.rows_at(quad, segment.exit)
    ahead = next((at for at in touching if path.segment(state, *at, way) is not None), None)
    if ahead is None:
        return None
    row, place = ahead
    nodes = nodes_at(state, row, place)
    behind = tuple(other for other, at in touching if nodes_at(state, other, at) != nodes)
    return Tip((-1, -1), 0.0, topology.parent(row), heading, 0.0, place, behind)
