"""Find the chain of mesh edges to move onto a path: a shortest path over directed edges.

Near the path every edge is directed forward, along the path; edges across it may have either
direction, up to 20 degrees backward, because mesh lines may cross the path at an angle. An edge of
length l with its ends at distances d_1 and d_2 from the path, which advances by a along it, has the
cost, with h the local edge length of the mesh,

    l/h ( (d_1² + d_1 d_2 + d_2²) / (3 h²) + 0.05 )  +  0.3 max(0, 0.7 - a/h)²,

the mean of d² along the edge, a little for the length itself, and a penalty for an edge that will
be short once it lies on the path. Two consecutive edges of one quad turn through its corner, which
the chain would open to 180 degrees on one side: they cost 0.15 more. The nodes of the graph are
edges of the mesh, so that turns can have a cost.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from shellcut.arrays import Bools, Floats, Ints

from .course import Course, RimEnd
from .film_plane import FilmPlane, ImprintError

_REACH = 1.8  # largest distance of nodes considered from the path, in edge lengths
_LENGTH_PRICE = 0.05
_SHORT_PRICE, _SHORT = 0.3, 0.7
_TURN_PRICE = 0.15
_PINNED_PRICE = 1.0  # cost of moving a node of a named set
_SHARP_TURN = np.cos(np.radians(130.0))  # larger turns between edges are not allowed
_BACKWARD = 0.35  # an edge may go back by this part of its length
_LEAST_ADVANCE = 0.3  # between nodes once they lie on the path, in edge lengths
_LEAST_EDGES = 3
_STARTS = 10  # nodes tried as the seam of a closed chain
_LEAD = (0.6, 2.6)  # range in which the chain of an inner end starts, in edges before it


@dataclass(frozen=True, eq=False)
class Chain:
    """Nodes of the mesh from the start to the end of a course.

    At an inner end the first (last) node is outside the course; it closes the layer of quads and
    is not moved onto the path.
    """

    course: Course
    nodes: Ints
    """In order; a closed chain does not repeat the first."""
    u: Floats
    """Parameters of their initial positions on the path, increasing, shape (n_node,), [mm]."""

    @property
    def closed(self) -> bool:
        """Whether the last node is joined to the first."""
        return self.course.closed

    @property
    def on_path(self) -> slice:
        """The nodes that lie on the path, as a slice."""
        inner = not self.closed
        first = 1 if inner and self.course.rim_start is None else 0
        last = len(self.nodes) - (1 if inner and self.course.rim_end is None else 0)
        return slice(first, last)


def find_chain(film: FilmPlane, course: Course, taken: Bools) -> Chain:
    """Return the cheapest chain of edges along a course.

    Parameters
    ----------
    film : FilmPlane
    course : Course
    taken : ndarray of bool, shape (n_node,)
        Nodes that may not be used, because they are next to another chain.

    Raises
    ------
    ImprintError
        If no line of edges runs along the course.
    """
    graph = _EdgeGraph(film, course, taken)
    nodes, u = graph.closed_way() if course.closed else graph.open_way()
    chain = Chain(course, nodes, u)
    kept = chain.nodes[chain.on_path]
    if len(kept) - (not course.closed) < _LEAST_EDGES:
        raise ImprintError(
            f"a path must take {_LEAST_EDGES} edges of the mesh at least, got {len(kept) - 1} near "
            f"{film.place(course.curve.point(0.5 * (course.start + course.end))[0])}; "
            "refine the mesh or lengthen the path"
        )
    return chain


class _EdgeGraph:
    # directed edges near a course, and the costs of going from one to the next

    def __init__(self, film: FilmPlane, course: Course, taken: Bools) -> None:
        self.film, self.course = film, course
        curve = course.curve
        x, h = film.x, film.edge_length
        reach = _REACH * h
        low, high = self._bounding_box()
        near = np.flatnonzero(((x > low) & (x < high)).all(axis=1))
        u_near = course.unrolled(curve.nearest(x[near]))
        off = x[near] - curve.point(u_near)
        d = np.linalg.norm(off, axis=1)
        self.u = np.full(len(x), np.nan)
        self.d = np.full(len(x), np.inf)
        self.u[near], self.d[near] = u_near, d
        usable = (self.d < reach) & ~taken
        if not course.closed:
            lead = _LEAD[1] * h
            usable &= (self.u > course.start - lead) & (self.u < course.end + lead)
        self.usable = usable
        inner = usable & ~film.boundary & ~film.cracked
        starts, ends = self._end_nodes(course.rim_start), self._end_nodes(course.rim_end)
        ok = inner.copy()
        ok[starts] = ok[ends] = True
        self.starts, self.ends = starts, ends
        self._direct(ok)

    def _bounding_box(self) -> tuple[Floats, Floats]:
        margin = (_REACH + _LEAD[1]) * float(self.film.edge_length.max())
        c = self.course
        x = c.curve.point(np.linspace(c.start, c.end, 2000))
        return x.min(axis=0) - margin, x.max(axis=0) + margin

    def _end_nodes(self, end: RimEnd | None) -> Ints:
        # nodes of the rim that may be moved to the crossing of the path
        if end is None:
            return np.zeros(0, np.int64)
        if end.corner is not None:
            return np.array([end.corner], dtype=np.int64)
        assert end.piece is not None
        nodes = self.film.pieces[end.piece].nodes
        film = self.film
        gap = np.linalg.norm(film.x[nodes] - end.x, axis=1) / film.edge_length[nodes]
        near: Ints = nodes[(gap < 1.5) & ~film.corner[nodes] & self.usable[nodes]]
        return near

    def _direct(self, ok: Bools) -> None:
        film, course = self.film, self.course
        edges = film.mesh.edges()
        rows = (edges.n_quad == 2) & ok[edges.nodes].all(axis=1)
        tail, head = edges.nodes[rows].T
        tail, head = np.concatenate([tail, head]), np.concatenate([head, tail])
        quads = np.concatenate([edges.quads[rows], edges.quads[rows]])
        advance = self.u[head] - self.u[tail]
        if course.closed:
            advance -= course.length * np.round(advance / course.length)
        length = np.linalg.norm(film.x[head] - film.x[tail], axis=1)
        h = 0.5 * (film.edge_length[tail] + film.edge_length[head])
        # signed sides: an edge that crosses the path has d of both signs
        d_tail, d_head = self._signed(tail), self._signed(head)
        mean_square = (d_tail**2 + d_tail * d_head + d_head**2) / (3.0 * h**2)
        cost = length / h * (mean_square + _LENGTH_PRICE)
        cost += _SHORT_PRICE * np.maximum(0.0, _SHORT - advance / h) ** 2
        cost += _PINNED_PRICE * film.pinned[head]
        forward = advance > -_BACKWARD * length
        self.tail, self.head = tail[forward], head[forward]
        self.advance, self.cost = advance[forward], cost[forward]
        self.quads = quads[forward]
        self.way = (film.x[self.head] - film.x[self.tail]) / length[forward][:, None]

    def _signed(self, nodes: Ints) -> Floats:
        curve = self.course.curve
        u = self.u[nodes]
        t, off = curve.tangent(u), self.film.x[nodes] - curve.point(u)
        return np.asarray(t[:, 0] * off[:, 1] - t[:, 1] * off[:, 0])

    def _turns(self) -> tuple[Ints, Ints, Floats]:
        # pairs of consecutive edges, and the cost of their turn
        n = len(self.tail)
        order = np.argsort(self.tail, kind="stable")
        first = np.searchsorted(self.tail[order], self.head, side="left")
        last = np.searchsorted(self.tail[order], self.head, side="right")
        count = last - first
        one = np.repeat(np.arange(n), count)
        offset = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
        two = order[np.repeat(first, count) + offset]
        keep = (self.way[one] * self.way[two]).sum(axis=1) > _SHARP_TURN
        one, two = one[keep], two[keep]
        shared = (self.quads[one][:, :, None] == self.quads[two][:, None, :]).any(axis=(1, 2))
        return one, two, self.cost[two] + _TURN_PRICE * shared

    def open_way(self) -> tuple[Ints, Floats]:
        """Return nodes and parameters of the cheapest chain from one end to the other."""
        course, film = self.course, self.film
        n = len(self.tail)
        one, two, price = self._turns()
        if course.rim_start is None:
            lead = (course.start - self.u[self.tail]) / film.edge_length[self.tail]
            begins = np.flatnonzero(
                (lead > _LEAD[0]) & (lead < _LEAD[1]) & (self.u[self.head] < course.start)
            )
            begin_price = self.cost[begins]
        else:
            begins = np.flatnonzero(np.isin(self.tail, self.starts))
            begin_price = self.cost[begins] + self._shift(self.tail[begins], course.rim_start)
        if course.rim_end is None:
            lead = (self.u[self.head] - course.end) / film.edge_length[self.head]
            finals = np.flatnonzero(
                (lead > _LEAD[0]) & (lead < _LEAD[1]) & (self.u[self.tail] > course.end)
            )
            final_price = np.zeros(len(finals))
        else:
            finals = np.flatnonzero(np.isin(self.head, self.ends))
            final_price = self._shift(self.head[finals], course.rim_end)
        source, sink = np.full(len(begins), n), np.full(len(finals), n + 1)
        rows = np.concatenate([one, source, finals])
        columns = np.concatenate([two, begins, sink])
        prices = np.concatenate([price, begin_price, final_price + 1e-12])
        graph = scipy.sparse.csr_array((prices, (rows, columns)), shape=(n + 2, n + 2))
        total, before = scipy.sparse.csgraph.dijkstra(graph, indices=n, return_predecessors=True)
        if not np.isfinite(total[n + 1]):
            raise self._no_way(total[:n])
        edges = _follow(before, n + 1)[1:-1]
        nodes = np.append(self.tail[edges], self.head[edges[-1]])
        return nodes, _growing(self.u[nodes], self._gap(nodes))

    def closed_way(self) -> tuple[Ints, Floats]:
        """Return nodes and parameters of the cheapest closed chain."""
        # first round from a node near the path, second from the middle of the result: the seam
        # then lies where the first round was free to choose
        nodes = self._first_round()
        again = self._round(int(nodes[len(nodes) // 2]))
        assert again is not None  # the first round is one
        nodes = again
        period = self.course.length
        steps = np.diff(self.u[nodes], append=self.u[nodes[0]])
        steps -= period * np.round(steps / period)
        # put the seam after the longest edge, where nodes need not be pushed apart
        seam = int(steps.argmax()) + 1
        nodes, steps = np.roll(nodes, -seam), np.roll(steps, -seam)
        u = self.u[nodes[0]] + np.cumsum(np.concatenate([[0.0], steps[:-1]]))
        return nodes, _growing(u, self._gap(nodes))

    def _gap(self, nodes: Ints) -> float:
        return _LEAST_ADVANCE * float(self.film.edge_length[nodes].min())

    def _first_round(self) -> Ints:
        candidates = np.intersect1d(self.tail, self.head)
        nearest = candidates[np.argsort(self.d[candidates], kind="stable")]
        for start in nearest[:_STARTS].tolist():
            nodes = self._round(start)
            if nodes is not None:
                return nodes
        raise self._no_way(np.zeros(0))

    def _round(self, start: int) -> Ints | None:
        # unroll: positions along the path from 0 at the start node to one period; edges across the
        # seam belong to no round
        period = self.course.length
        at = np.mod(self.u[self.tail] - self.u[start], period)
        to = at + self.advance
        kept = (to >= 0.0) & (to <= period * (1.0 + 1e-9))
        kept &= (self.head != start) | (at > 0.5 * period)
        n = len(self.tail)
        one, two, price = self._turns()
        follows = kept[one] & kept[two] & (np.abs(at[two] - to[one]) < 0.5 * period)
        one, two, price = one[follows], two[follows], price[follows]
        begins = np.flatnonzero((self.tail == start) & kept)
        finals = np.flatnonzero((self.head == start) & kept)
        rows = np.concatenate([one, np.full(len(begins), n), finals])
        columns = np.concatenate([two, begins, np.full(len(finals), n + 1)])
        prices = np.concatenate([price, self.cost[begins], np.full(len(finals), 1e-12)])
        graph = scipy.sparse.csr_array((prices, (rows, columns)), shape=(n + 2, n + 2))
        total, before = scipy.sparse.csgraph.dijkstra(graph, indices=n, return_predecessors=True)
        if not np.isfinite(total[n + 1]):
            return None
        return np.asarray(self.tail[_follow(before, n + 1)[1:-1]])

    def _shift(self, nodes: Ints, end: RimEnd) -> Floats:
        # cost of sliding a node of the rim to the crossing
        gap = np.linalg.norm(self.film.x[nodes] - end.x, axis=1) / self.film.edge_length[nodes]
        return np.asarray(gap**2)

    def _no_way(self, price: Floats) -> ImprintError:
        # `price` of reaching each edge; the line breaks off at the last one reached
        where = "near it"
        reached = np.flatnonzero(np.isfinite(price))
        if len(reached):
            last = self.head[reached[self.u[self.head[reached]].argmax()]]
            where = f"that ends at {self.film.place(self.film.x[last])}"
        elif not self.course.closed:
            first = self.course.curve.point(self.course.start)[0]
            where = f"that starts at {self.film.place(first)}"
        return ImprintError(
            f"a line of inner edges must run along the path, got none {where}; refine the mesh "
            "there or keep the path off the rim, pre-cracks and other paths"
        )


def _growing(u: Floats, gap: float) -> Floats:
    # the nearest sequence with increments of at least `gap`: pool violators
    gap = min(gap, 0.5 * abs(float(u[-1] - u[0])) / max(len(u) - 1, 1))
    ramp = gap * np.arange(len(u))
    blocks: list[tuple[float, int]] = []
    for value in (u - ramp).tolist():
        total, count = value, 1
        while blocks and blocks[-1][0] / blocks[-1][1] >= total / count:
            before = blocks.pop()
            total, count = total + before[0], count + before[1]
        blocks.append((total, count))
    grown: Floats = np.concatenate([np.full(n, t / n) for t, n in blocks]) + ramp
    return grown


def _follow(before: Ints, last: int) -> Ints:
    # from the source to `last` along the predecessors
    way = [last]
    while before[way[-1]] >= 0:
        way.append(int(before[way[-1]]))
    return np.array(way[::-1], dtype=np.int64)
