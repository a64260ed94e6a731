"""Lists of what is near, how long they are complete, and how long what they list waits.

A list is made with a margin: of more than is near enough, so that for many steps nothing else can
have come near. :class:`ListAge` tells how long, for all lists of the contact. Of what is listed
most does not touch for some steps: it waits by a :class:`Clock`, one of each term.

The nodes near a tool are those inside boxes fixed to it, each wider by a margin than needed. The
list lasts until tool and listed nodes together may have moved by half the margin (the others are
not counted in the time step before), or tool and other film by the whole: film may come to a tool
at rest. So each step only treats the nodes of the list, and the search over all nodes is rare. The
list never changes a result: its users check each node again. A quad, or a segment of the border,
may be near without any of its nodes: it is found by the box around it.
"""

from __future__ import annotations

from math import sqrt
from typing import Annotated, NamedTuple

import numpy as np

from shellcut.arrays import Floats, Ints
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.boxes import are_near, box_around
from shellcut.numerics.jit import BoundOnce, always_inline, inline, kernel
from shellcut.numerics.kept import Kept
from shellcut.numerics.vec3 import dot, load, sub
from shellcut.state import KnownTopology, OncePerTopology, State
from shellcut.tool.pose import Pose, to_body

# Steps between two checks of how far things have moved, by hundredths of a margin; and what they
# may move until the next check, over what they have moved since the last.
_CHECK_EVERY, _FASTER = 5, 2.0


class ListAge(Kept):
    """Tells when a list of what is near is to be made anew.

    Parameters
    ----------
    distance : float
        That listed film and tool together may move until then [mm].
    radius : float, optional
        Of the farthest point of the tool around the body's origin [mm]; without it the motion of
        the tool does not count.
    """

    kept_names = "_known", "_x", "_pose", "_gone", "_look_at"

    def __init__(self, distance: float, radius: float | None = None) -> None:
        self._distance, self._radius = distance, radius
        self._known, self._farthest = KnownTopology(), BoundOnce(_farthest)
        self._film = OncePerTopology(film_nodes)
        self._x, self._pose = np.zeros((0, 3)), Pose.at_origin()
        self._gone, self._look_at = 0.0, 0

    def is_over(self, state: State, pose: Pose, listed: Ints) -> bool:
        """Return whether film and tool may move too far before the next check.

        Also if the film has been cut.  listed : nodes; other film may move twice as far.
        """
        if not self._known.is_of(state):
            return True
        if 0 < state.step < self._look_at:  # before the run film may be put anywhere
            return False
        there = self._pose if self._radius is None else pose
        gone, of_any = (
            self._farthest(nodes, state.node.x, self._x, there, self._pose, self._radius or 0.0)
            for nodes in (listed, self._film.of(state))
        )
        gone = max(gone, 0.5 * of_any)
        further = max(gone - self._gone, 0.0)
        self._gone, self._look_at = gone, state.step + _CHECK_EVERY
        return bool(gone + _FASTER * further > self._distance)

    def begin(self, state: State, pose: Pose) -> None:
        """Begin anew: the list has just been made."""
        self._known.take(state)
        self._x, self._pose = state.node.x[: state.n_node].copy(), pose
        self._gone, self._look_at = 0.0, state.step + _CHECK_EVERY


class NearNodes(Kept):
    """The nodes near a tool.

    Parameters
    ----------
    low, high : ndarray, shape (n_box, 3)
        Corners of the boxes in the body frame [mm]; every node inside one of them is in the list.
    margin : float
        Width of the margin [mm]: large enough to last hundreds of steps, small beside a tooth.
    """

    kept_names = "ids", "n_search", "_age"

    def __init__(self, low: Floats, high: Floats, margin: float) -> None:
        self.margin = margin
        """Width of the margin [mm]."""
        self._low, self._high = low, high
        corner = np.maximum(abs(low), abs(high)) + margin
        self._age = ListAge(self.half_margin, float(np.linalg.norm(corner, axis=1).max()))
        self.ids: Ints = np.zeros(0, np.int64)
        """Listed nodes, ascending."""
        self.n_search = 0
        """Searches so far."""
        self._within = BoundOnce(_within)

    @property
    def half_margin(self) -> float:
        """Distance that tool and listed nodes may move before the list is made anew [mm]."""
        return 0.5 * self.margin

    def renew(self, state: State, pose: Pose) -> bool:
        """Search again if needed, with the tool at its pose of t_n; return whether it was done."""
        if not self._age.is_over(state, pose, self.ids):
            return False
        every = np.flatnonzero(state.node.real[: state.n_node])
        self.ids = every[self.within(self.margin, every[:, None], state, pose)]
        self.n_search += 1
        self._age.begin(state, pose)
        return True

    def within(self, distance: float, corners: Ints, state: State, pose: Pose) -> Ints:
        """Return which nodes, segments or quads are near the boxes by the box around each.

        That depends on the present positions only, not on when the list was made.

        Parameters
        ----------
        distance : float
            From the boxes without the margin, up to which they are near [mm].
        corners : ndarray of int, shape (n, n_corner)
            Node ids.
        state, pose : State, Pose
            With the tool at the pose.
        """
        corners, found = corners.astype(np.int64, copy=False), np.empty(len(corners), np.int64)
        n = self._within(corners, state.node.x, pose, self._low, self._high, distance, found)
        return found[:n].copy()


class Clock(NamedTuple):
    """How far points and film, or tool and film, may have approached each other.

    An evaluation of a point tells how far both may move before it can touch. Until the clock has
    advanced by that distance the point waits.
    """

    node: Annotated[Ints, "(n_moving,)"]
    """Nodes whose largest speed counts."""
    walked: Annotated[Floats, "(1,)"]
    """Distance moved by both together since the list was made [mm]."""
    radius: float
    """Of the tool's farthest point, around the body's origin [mm]."""


@always_inline
def approach(
    clock: Clock, with_tool: bool, velocity: Floats, dt: float, pose: Pose, before: Pose
) -> tuple[float, float]:
    """Return how far two bodies may have moved in the last step, by which the clock advances [mm].

    with_tool : whether the tool moves against the film; else film moves against film.
    """
    film = dt * _largest_speed(clock.node, velocity)
    return film, tool_motion_bound(pose, before, clock.radius) if with_tool else film


@inline
def tool_motion_bound(pose: Pose, then: Pose, radius: float) -> float:
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
def _largest_speed(ids: Ints, velocity: Floats) -> float:
    """Return the largest speed of some nodes [mm/s]."""
    fastest = 0.0
    for i in range(ids.shape[0]):
        v = load(velocity, ids[i])
        fastest = max(fastest, v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
    return sqrt(fastest)


def film_nodes(state: State) -> Ints:
    """Return the nodes as which film moves: the ends of its flanks, too, but no virtual node."""
    film = state.node.real[: state.n_node].copy()
    film[state.flank.node[: state.flank.count]] = True
    return np.flatnonzero(film)


@kernel
def _farthest(
    nodes: Ints, x: Floats, then: Floats, pose: Pose, before: Pose, radius: float
) -> float:
    """Return how far some nodes, and the tool within a radius, have moved at most together [mm]."""
    square = 0.0
    for i in range(nodes.shape[0]):
        moved = sub(load(x, nodes[i]), load(then, nodes[i]))
        square = max(square, dot(moved, moved))
    return sqrt(square) + tool_motion_bound(pose, before, radius)


@kernel
def _within(
    corners: Ints, x: Floats, pose: Pose, low: Floats, high: Floats, distance: float, found: Ints
) -> int:
    """Write the rows of corners : (n, n_corner) near any box to found : (n,), return their number.

    Near is what has a box around it up to a distance [mm] from it along each axis.
    """
    pose, count = borrowed(pose), 0
    for i in range(corners.shape[0]):
        p = to_body(load(x, corners[i, 0]), pose)
        least, most = box_around(p, p, p, p)
        for a in range(1, corners.shape[1]):
            q = to_body(load(x, corners[i, a]), pose)
            least, most = box_around(least, most, q, q)
        hit = False
        for b in range(low.shape[0]):
            hit |= are_near(least, most, load(low, b), load(high, b), distance)
        # Without a branch: a row that is not near is overwritten by the next one.
        found[count] = i
        count += hit
    return count
