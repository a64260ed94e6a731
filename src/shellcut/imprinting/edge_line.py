"""Find a line of edges that a mesh already has along a course.

A course is in the mesh if edges lie under it from its start to its end. Its nodes are those on the
path, to ``IN_THE_MESH`` of the local edge length; each must be joined to the next by an inner edge.
The ends may lie anywhere along an edge: the blade needs an edge under it only up to its last
position, so the line continues to the next node beyond an end, wherever that node is.

A point of the path has an edge under it if its distance is below the tolerance plus the sagitta of
a chord of length l under an arc of curvature k at t from its start, k t (l - t) / 2. This is
checked halfway between two nodes, which excludes a path that takes the long way round from one to
the other, and at the ends.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from shellcut.arrays import Floats, Ints

from .course import Course
from .film_plane import FilmPlane

IN_THE_MESH = 5e-3
"""A line of edges this close to the path (in edge lengths) is the path: nothing is moved. An offset
of 0.05 edge lengths increases the work by 3.5 %."""


@dataclass(frozen=True, eq=False)
class EdgeLine:
    """Nodes of the mesh that already lie along a course."""

    course: Course
    """Without extensions beyond the given ends of the path."""
    nodes: Ints
    """In order, to the node at or next beyond each end; a closed line does not repeat the first."""


def find_edge_line(film: FilmPlane, course: Course) -> EdgeLine | None:
    """Return the line of inner edges under a course, None if the mesh has none.

    Parameters
    ----------
    film : FilmPlane
    course : Course
        Parts extended to the rim are ignored.
    """
    course = course.as_given()
    x, curve = film.x, course.curve
    u = course.unrolled(curve.nearest(x))
    slack = IN_THE_MESH * film.edge_length
    on = np.linalg.norm(x - curve.point(u), axis=1) <= slack
    if not course.closed:
        on &= (u >= course.start - slack) & (u <= course.end + slack)
    nodes = np.flatnonzero(on)
    nodes = nodes[np.argsort(u[nodes], kind="stable")]
    edges = _Edges(film, course)
    line = edges.round(nodes, u) if course.closed else edges.between_ends(nodes, u)
    return None if line is None else EdgeLine(course, line)


class _Edges:
    # the inner edges of a film, to check whether a course runs along them

    def __init__(self, film: FilmPlane, course: Course) -> None:
        self.film, self.course = film, course
        edges = film.mesh.edges()
        inner = edges.nodes[edges.n_quad == 2]
        self.tail = np.concatenate([inner[:, 0], inner[:, 1]])
        self.head = np.concatenate([inner[:, 1], inner[:, 0]])
        self.keys = self.tail * film.mesh.n_node + self.head

    def round(self, nodes: Ints, u: Floats) -> Ints | None:
        """Return the nodes from the seam on if they close a line."""
        if len(nodes) < 3:
            return None
        period = self.course.length
        steps = np.diff(u[nodes], append=u[nodes[0]] + period)
        if not self._joined(nodes, np.roll(nodes, -1), u[nodes] + 0.5 * steps):
            return None
        # put the seam after the longest edge, as for a chain
        return np.roll(nodes, -int(steps.argmax()) - 1)

    def between_ends(self, nodes: Ints, u: Floats) -> Ints | None:
        """Return the nodes and the next ones beyond the ends if they form a line."""
        start, end = self.course.start, self.course.end
        if not len(nodes):
            return self._one_edge()
        first, last = int(nodes[0]), int(nodes[-1])
        if not self._joined(nodes[:-1], nodes[1:], 0.5 * (u[nodes[:-1]] + u[nodes[1:]])):
            return None
        line = nodes
        for node, at, before in ((first, start, True), (last, end, False)):
            if abs(u[node] - at) <= IN_THE_MESH * self.film.edge_length[node]:
                continue
            from_node = np.flatnonzero(self.tail == node)
            found = self._under(from_node, [0.5 * (u[node] + at), at])
            if found is None:
                return None
            beyond = self.head[found]
            line = np.concatenate([[beyond], line] if before else [line, [beyond]])
        return line if len(line) > 1 else None

    def _one_edge(self) -> Ints | None:
        # of a path between two nodes
        start, end = self.course.start, self.course.end
        found = self._under(np.arange(len(self.tail)), [start, 0.5 * (start + end), end])
        if found is None:
            return None
        pair = np.array([self.tail[found], self.head[found]])
        way = self.film.x[pair[1]] - self.film.x[pair[0]]
        along = float(way @ self.course.curve.tangent(0.5 * (start + end))[0])
        return pair if along > 0.0 else pair[::-1]

    def _joined(self, tail: Ints, head: Ints, between: Floats) -> bool:
        # whether edges join the nodes and the path goes along them
        keys = tail * self.film.mesh.n_node + head
        if not np.isin(keys, self.keys).all():
            return False
        return bool(np.isfinite(self._off(tail, head, between)).all())

    def _under(self, rows: Ints, places: Sequence[float]) -> int | None:
        # the edge that lies under all given points of the path, the nearest to the last of them
        off = np.stack(
            [self._off(self.tail[rows], self.head[rows], np.full(len(rows), u)) for u in places]
        )
        off = np.where(np.isfinite(off).all(axis=0), off[-1], np.inf)
        if not np.isfinite(off).any():
            return None
        return int(rows[off.argmin()])

    def _off(self, tail: Ints, head: Ints, u: Floats) -> Floats:
        # distance of points of the path from edges, infinite where these are not under them
        film, curve = self.film, self.course.curve
        way = film.x[head] - film.x[tail]
        length = np.linalg.norm(way, axis=1)
        from_tail = curve.point(u) - film.x[tail]
        t = (from_tail * way).sum(axis=1) / length
        off = np.abs(way[:, 0] * from_tail[:, 1] - way[:, 1] * from_tail[:, 0]) / length
        slack = IN_THE_MESH * 0.5 * (film.edge_length[tail] + film.edge_length[head])
        rise = 0.5 * curve.curvature(u) * np.maximum(t * (length - t), 0.0)
        under = (t >= -slack) & (t <= length + slack) & (off <= slack + rise)
        return np.where(under, off, np.inf)
