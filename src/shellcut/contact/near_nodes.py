"""List of the nodes near the tool, valid while no other node can have come near.

The nodes inside boxes fixed to the tool, each wider by a margin than needed, are listed. The list
is valid until tool and nodes together may have moved by half the margin; the other half is for the
nodes outside, whose speed is not tracked. So each step only treats the nodes of the list, and the
search over all nodes is rare. The list never changes a result: its users check each node again.
"""

from __future__ import annotations

from math import sqrt
from typing import Any

import numpy as np

from shellcut.arrays import Floats, Ints
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.jit import BoundOnce, always_inline, inline, kernel
from shellcut.numerics.vec3 import load
from shellcut.state import KnownTopology, State
from shellcut.tool.pose import Pose, to_body

# Steps between two checks of how far nodes have moved: they move by hundredths of the margin.
_LOOK_EVERY = 10


class NearNodes:
    """The nodes near a tool.

    Parameters
    ----------
    low, high : ndarray, shape (n_box, 3)
        Corners of the boxes in the body frame [mm]; every node inside one of them is in the list.
    margin : float
        Width of the margin [mm]: large enough to last hundreds of steps, small beside a tooth.
    """

    def __init__(self, low: Floats, high: Floats, margin: float) -> None:
        self._margin = margin
        self._low, self._high = low - margin, high + margin
        corner = np.maximum(abs(self._low), abs(self._high))
        self._radius = float(np.linalg.norm(corner, axis=1).max())
        self._pose = Pose.at_origin()
        self._time = 0.0
        self._known = KnownTopology()
        self._walked = 0.0
        self.ids: Ints = np.zeros(0, np.int64)
        """Listed nodes, ascending."""
        self.n_search = 0
        """Searches so far."""
        self._way, self._within = BoundOnce(_moved), BoundOnce(_within)

    @property
    def half_margin(self) -> float:
        """Way that tool and listed nodes may go together before the list is made anew [mm]."""
        return 0.5 * self._margin

    def renew(self, state: State, pose: Pose) -> bool:
        """Search again if needed, with the tool at its pose of t_n; return whether it was done."""
        n = state.node
        if self._known.is_of(state):
            if state.step % _LOOK_EVERY:
                return False
            tool, fastest = self._way(self.ids, n.velocity_half, pose, self._pose, self._radius)
            self._walked += (state.time - self._time) * fastest
            self._time = state.time
            if tool + self._walked < self.half_margin:
                return False
        self.ids = self._in_boxes(np.flatnonzero(n.real[: n.count]), state, pose, 0.0)
        self.n_search += 1
        self._pose = pose
        self._known.take(state)
        self._time, self._walked = state.time, 0.0
        return True

    def saved(self) -> dict[str, Any]:
        """Return the list, with the time and the pose of its search."""
        return {
            "ids": self.ids,
            "n_search": self.n_search,
            "pose": self._pose._asdict(),
            "time": self._time,
            "walked": self._walked,
            "revision": self._known.revision,
        }

    def restore(self, state: State, saved: dict[str, Any]) -> None:
        """Take over :meth:`saved`, a list of the nodes of ``state``."""
        self.ids, self.n_search = saved["ids"].copy(), saved["n_search"]
        self._pose = Pose(**saved["pose"]).copied()
        self._time, self._walked = saved["time"], saved["walked"]
        self._known.restore(saved["revision"], state)

    def within(self, state: State, pose: Pose) -> Ints:
        """Return the nodes within half the margin of the boxes.

        They depend on the present positions only, not on when the list was made.
        """
        return self._in_boxes(self.ids, state, pose, self.half_margin)

    def _in_boxes(self, ids: Ints, state: State, pose: Pose, inner: float) -> Ints:
        """Return those of some nodes that are inside boxes narrower by so much [mm]."""
        low, high, found = self._low + inner, self._high - inner, np.empty(ids.size, np.int64)
        return found[: self._within(ids, state.node.x, pose, low, high, found)].copy()

    def rows(self, state: State) -> Ints:
        """Return the quads at listed nodes, ascending."""
        n, listed = state.node, np.zeros(state.n_quad, np.bool_)
        at = np.arange(n.quads.shape[1]) < n.n_quad_at[self.ids, None]
        listed[n.quads[self.ids][at]] = True
        return np.flatnonzero(listed)


@inline
def in_box(p: tuple[float, float, float], low: Floats, high: Floats, b: int) -> bool:
    """Return whether a point lies inside box b of low, high : (n_box, 3)."""
    # Branch-free: branches here would be mispredicted.
    return bool(
        (low[b, 0] < p[0])
        & (p[0] < high[b, 0])
        & (low[b, 1] < p[1])
        & (p[1] < high[b, 1])
        & (low[b, 2] < p[2])
        & (p[2] < high[b, 2])
    )


@inline
def tool_way(pose: Pose, then: Pose, radius: float) -> float:
    """Return a bound on the motion of the tool within a radius around its origin [mm]."""
    # No point of the tool has moved by more than the origin plus rotation times radius.
    turn = 0.0
    shift = 0.0
    for i in range(3):
        shift += (pose.translation[i] - then.translation[i]) ** 2
        for j in range(3):
            turn += (pose.rotation[i, j] - then.rotation[i, j]) ** 2
    return sqrt(shift) + radius * sqrt(turn)


@always_inline
def largest_speed(ids: Ints, count: int, velocity: Floats) -> float:
    """Return the largest speed of the first ``count`` of some nodes [mm/s]."""
    fastest = 0.0
    for i in range(count):
        v = load(velocity, ids[i])
        fastest = max(fastest, v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
    return sqrt(fastest)


@kernel
def _moved(
    ids: Ints,
    velocity: Floats,
    pose: Pose,
    then: Pose,
    radius: float,
) -> tuple[float, float]:
    """Return a bound on the motion of the tool within a radius, and the largest nodal speed."""
    return tool_way(pose, then, radius), largest_speed(ids, ids.shape[0], velocity)


@kernel
def _within(ids: Ints, x: Floats, pose: Pose, low: Floats, high: Floats, found: Ints) -> int:
    """Write those of some nodes that are inside any box to found : (n,), return their number."""
    pose, count = borrowed(pose), 0
    for n in ids:
        p = to_body(load(x, n), pose)
        hit = False
        for b in range(low.shape[0]):
            hit |= in_box(p, low, high, b)
        found[count] = n
        count += hit
    return count
