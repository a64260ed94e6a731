"""The poses in which cutting edges will be beyond the tips that they drive: all tips at once.

The same rule as :meth:`.blade_drive.BladeDrive.beyond`, which a test compares with this.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from shellcut.arrays import Bools, Floats, Ints
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.jit import BoundOnce, kernel
from shellcut.numerics.vec3 import cross, dot, load, sub
from shellcut.tool.cutting_edge import BACK, NORMAL, START, CuttingEdges, segment_part
from shellcut.tool.motion import Motion
from shellcut.tool.pose_of_motion import pose_at

from .blade_drive import LOOK_AHEAD, NEAR, TURNS, nearest_edge


class Beyond(NamedTuple):
    """Edges and tips: which drives which, and the pose when it will be beyond it."""

    edge_of: Annotated[Ints, "(n_tip,)"]
    """Segment that drives the tip, -1 if none."""
    off: Annotated[Floats, "(n_tip,)"]
    """Signed distance of the tip from its mid-plane then [mm]."""
    passed: Annotated[Bools, "(n_tip,)"]
    """Whether the edge has passed the tip already."""
    rotation: Annotated[Floats, "(n_tip, 3, 3)"]
    """Of the tool then."""
    time: Annotated[Floats, "(n_tip,)"]
    """Of the pose that is to be tried next [s]."""
    seeking: Annotated[Bools, "(n_tip,)"]
    """Whether there is one."""


class _Tried(NamedTuple):
    """Poses and twists of the tool at the times tried."""

    rotation: Annotated[Floats, "(n_tip, 3, 3)"]
    translation: Annotated[Floats, "(n_tip, 3)"]
    spin: Annotated[Floats, "(n_tip, 3)"]
    velocity: Annotated[Floats, "(n_tip, 3)"]


class PosesBeyond:
    """Finds which edges drive which tips, and when they will be beyond them.

    Parameters
    ----------
    edges : CuttingEdges
        Of the tool.
    motion : Motion
        Of the tool.
    """

    def __init__(self, edges: CuttingEdges, motion: Motion) -> None:
        self.edges, self._motion = edges, motion
        self._try_poses = BoundOnce(_try_poses)
        self._allocate(0)

    def _allocate(self, n: int) -> None:
        self.found = Beyond(
            edge_of=np.full(n, -1),
            off=np.zeros(n),
            passed=np.zeros(n, np.bool_),
            rotation=np.zeros((n, 3, 3)),
            time=np.zeros(n),
            seeking=np.zeros(n, np.bool_),
        )
        self._tried = _Tried(
            np.zeros((n, 3, 3)), np.zeros((n, 3)), np.zeros((n, 3)), np.zeros((n, 3))
        )

    def find(self, x: Floats, size: Floats, time: float) -> Beyond:
        """Return which edge drives each tip, and its pose when it is beyond it.

        x : (n_tip, 3), size : (n_tip,) [mm].  The next call overwrites what is returned.
        """
        if len(x) != len(self.found.time):
            self._allocate(len(x))
        found, tried, motion = self.found, self._tried, self._motion
        tried.rotation[:], tried.translation[:] = pose_at(motion, time)
        tried.spin[:], tried.velocity[:] = motion.twist(time)
        found.time[:], found.seeking[:] = time, True
        count = self._try_poses(x, size, self.edges, tried, found, True, True)
        for k in range(TURNS):
            if not count:
                break
            for i, later in enumerate(found.time.tolist()):
                if found.seeking[i]:
                    tried.rotation[i], tried.translation[i] = pose_at(motion, later)
                    tried.spin[i], tried.velocity[i] = motion.twist(later)
            more = k < TURNS - 1
            count = self._try_poses(x, size, self.edges, tried, found, False, more)
        return found


@kernel
def _try_poses(
    x: Floats,
    size: Floats,
    edges: CuttingEdges,
    tried: _Tried,
    found: Beyond,
    present: bool,
    more: bool,
) -> int:
    """Find the edges at the poses tried, and the times to try next; return for how many tips.

    x : (n_tip, 3), [mm].  size : (n_tip,), [mm].  present : whether the poses are those of now.
    more : whether another time may be tried.
    """
    edges, tried, found = borrowed(edges), borrowed(tried), borrowed(found)
    count = 0
    for i in range(size.shape[0]):
        if not found.seeking[i]:
            continue
        found.seeking[i] = False
        here, R = load(x, i), tried.rotation
        gap = sub(here, load(tried.translation, i))
        p = (
            R[i, 0, 0] * gap[0] + R[i, 1, 0] * gap[1] + R[i, 2, 0] * gap[2],
            R[i, 0, 1] * gap[0] + R[i, 1, 1] * gap[1] + R[i, 2, 1] * gap[2],
            R[i, 0, 2] * gap[0] + R[i, 1, 2] * gap[1] + R[i, 2, 2] * gap[2],
        )
        if present:
            found.edge_of[i], found.off[i], depth, found.passed[i] = nearest_edge(p, size[i], edges)
        edge = found.edge_of[i]
        if edge < 0:
            continue
        k = segment_part(edges.segments, edge, BACK)
        if not present:
            d = sub(p, segment_part(edges.segments, edge, START))
            found.off[i], depth = dot(d, segment_part(edges.segments, edge, NORMAL)), dot(d, k)
        for a in range(3):
            for b in range(3):
                found.rotation[i, a, b] = R[i, a, b]
        left = LOOK_AHEAD[0] * size[i] - depth
        if not more or abs(left) <= NEAR * size[i]:
            continue
        turning = cross(load(tried.spin, i), gap)
        v = load(tried.velocity, i)
        speed = 0.0
        for a in range(3):
            back = R[i, a, 0] * k[0] + R[i, a, 1] * k[1] + R[i, a, 2] * k[2]
            speed += (v[a] + turning[a]) * back
        if speed < 0.0:
            found.time[i] -= left / speed
            found.seeking[i] = True
            count += 1
    return count
