"""Quality of a cut at one frame: cut length, bridges, flaps, cut-out, loose pieces.

docs/howto/read-results.md defines the values. Everything is derived from the quads, the two flanks
of the crack edges and the supported nodes. A mean normal is that of the sum of the area vectors.

A *place* is a point at which flanks coincide before the cut: one node, or a node and its twins.
Crack edges with a common place belong to one *crack*, unless the node there is not split: there
cracks *end*. An end on the film's boundary is open and not an end in this sense. A crack without
two ends, or a straight one, has no flap.

Cracks, and bridges from end to end, are a network on the film. Its closed lines are those around
each of its meshes and around all of them, without the ways that lead nowhere: a cut that overruns
its own start leaves such ways. They are also looked for without the bridges, because ends that
overran may face each other across film beside a line that is closed already. The cut-out is inside
the line whose area, times the share of it that is cut, is largest.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import scipy

from shellcut.arrays import Bools, Floats, Ints, angles, cross, norm, unit
from shellcut.frame import Frame, is_corner
from shellcut.mesh.outline import within
from shellcut.mesh.quad_geometry import quad_vectors
from shellcut.numerics.connected_parts import connected_parts

# Smallest area of a flap, relative to the square of the hinge's length: less is round-off.
_LEAST_FLAP = 1e-6


@dataclass(frozen=True)
class Bridge:
    """Film between two crack ends that face each other."""

    ends: Floats
    """Reference positions of the two ends, shape (2, 3), [mm]."""
    width: float
    """Arc length between them [mm]."""


@dataclass(frozen=True)
class Part:
    """A flap or the cut-out."""

    quads: Ints
    """Its quads, ascending, shape (n,)."""
    line: Floats
    """The closed line around it in the reference, shape (n_point, 3), [mm]; for a flap the hinge
    joins the last point to the first."""
    area: float
    """Reference area [mm²]."""
    angle: float
    """Angle between its mean normal now and in the reference [deg]."""
    steepest: float
    """Largest angle of any of its quads [deg]."""


@dataclass(frozen=True)
class Piece:
    """Connected quads."""

    quads: Ints
    """Quad ids, ascending, shape (n,)."""
    area: float
    """Reference area [mm²]."""
    loose: bool


@dataclass(frozen=True)
class CutQuality:
    """Result of :func:`cut_quality` for a frame."""

    cracks: tuple[Floats, ...]
    """Reference places along each crack, from end to end, shape (n_place, 3), [mm]; for a branched
    crack along its longest path. A closed crack repeats its first place at the end."""
    crack_length: float
    """Length of all crack edges [mm], including pre-cuts."""
    slit_width: Floats
    """Present distance of the two flanks at the middle of each crack edge, shape (n_crack_edge,),
    [mm]."""
    slit_width_mean: float
    """Mean width of the slit, over the crack length [mm]."""
    bridges: tuple[Bridge, ...]
    flaps: tuple[Part, ...]
    """Largest first."""
    cutout: Part | None
    """The one with the largest area times cut share, if there are several closed lines."""
    cut_share: float
    """Cut share of the cut-out's line; 0 without such a line."""
    pieces: tuple[Piece, ...]
    """Largest first."""

    def figures(self) -> dict[str, float]:
        """Return the values by the names of :data:`UNITS`; 0 if a quantity does not exist."""
        return {name: figure(self) for name, (_, figure) in _FIGURES.items()}


_FIGURES: dict[str, tuple[str, Callable[[CutQuality], float]]] = {
    "crack_length": ("mm", lambda q: q.crack_length),
    "n_crack": ("-", lambda q: len(q.cracks)),
    "slit_width_mean": ("mm", lambda q: q.slit_width_mean),
    "slit_width_largest": ("mm", lambda q: float(q.slit_width.max(initial=0.0))),
    "n_bridge": ("-", lambda q: len(q.bridges)),
    "bridge_width": ("mm", lambda q: sum(one.width for one in q.bridges)),
    "bridge_width_least": ("mm", lambda q: min((one.width for one in q.bridges), default=0.0)),
    "n_flap": ("-", lambda q: len(q.flaps)),
    "flap_angle_largest": ("deg", lambda q: max((one.angle for one in q.flaps), default=0.0)),
    "flap_angle_steepest": ("deg", lambda q: max((one.steepest for one in q.flaps), default=0.0)),
    "cut_share": ("-", lambda q: q.cut_share),
    "cutout_area": ("mm^2", lambda q: q.cutout.area if q.cutout else 0.0),
    "cutout_angle": ("deg", lambda q: q.cutout.angle if q.cutout else 0.0),
    "n_piece": ("-", lambda q: len(q.pieces)),
    "n_loose": ("-", lambda q: sum(piece.loose for piece in q.pieces)),
    "loose_area": ("mm^2", lambda q: sum(piece.area for piece in q.pieces if piece.loose)),
}
UNITS = {name: unit for name, (unit, _) in _FIGURES.items()}
"""Names and units of :meth:`CutQuality.figures`."""
LABELS = {
    "crack_length": "crack length",
    "cut_share": "share of the line that is cut",
    "n_bridge": "uncut bridges",
    "bridge_width": "bridges, total width",
    "bridge_width_least": "narrowest bridge",
    "slit_width_mean": "slit, mean width",
    "n_flap": "flaps",
    "flap_angle_largest": "opening of a flap, largest",
    "cutout_angle": "tipping of the cut-out",
    "n_loose": "loose pieces",
    "loose_area": "loose area",
}
"""Words of those that reports show, in that order."""


def cut_quality(frame: Frame) -> CutQuality:
    """Return the quality of a cut at one frame; docs/howto/read-results.md defines the values.

    Examples
    --------
    >>> import shellcut
    >>> last = shellcut.read("out").frame(-1)  # doctest: +SKIP
    >>> found = cut_quality(last).figures()  # doctest: +SKIP
    >>> found["n_piece"], found["n_loose"]  # doctest: +SKIP
    (2, 1)
    """
    edges = frame.crack_edges
    lengths = np.linalg.norm(
        frame.reference[edges[:, 0, 1]] - frame.reference[edges[:, 0, 0]], axis=1
    )
    minus, plus = frame.points[edges].mean(axis=2).transpose(1, 0, 2)
    slit = np.linalg.norm(plus - minus, axis=1)
    total = float(lengths.sum())
    surface, place = _Surface(frame), _places(frame)
    cracks = list(_cracks(frame, place, lengths))
    bridges = list(_bridges(cracks))
    flaps = [surface.part(crack.line) for crack in cracks if crack.joins_ends]
    network = _network(frame, place, lengths, bridges)
    cutouts = ((surface.part(line), share) for line, share in _closed_lines(surface, network))
    cutout, share = next((found for found in cutouts if found[0] is not None), (None, 0.0))
    return CutQuality(
        cracks=tuple(crack.line for crack in cracks),
        crack_length=total,
        slit_width=slit,
        slit_width_mean=float(slit @ lengths) / total if total else 0.0,
        bridges=tuple(Bridge(np.stack([a.place, b.place]), width) for a, b, width in bridges),
        flaps=tuple(sorted(filter(None, flaps), key=lambda flap: -flap.area)),
        cutout=cutout,
        cut_share=share,
        pieces=tuple(_pieces(frame, surface)),
    )


# --- cracks --------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class _Tip:
    """An end of a crack, with the direction of its last edge."""

    node: int
    place: Floats
    ahead: Floats


@dataclass(frozen=True, eq=False)
class _Crack:
    line: Floats
    joins_ends: bool
    """Whether the line goes from an end to an end."""
    tips: list[_Tip]
    """All ends, also those of branches."""


def _places(frame: Frame) -> Ints:
    """Return the place of each node: flanks of a crack edge start, and end, at the same place."""
    flanks = frame.crack_edges.transpose(1, 0, 2).reshape(2, -1)
    return connected_parts(flanks[0], flanks[1], len(frame.points))


def _cracks(frame: Frame, place: Ints, lengths: Floats) -> Iterator[_Crack]:
    flank = frame.crack_edges[:, 0].ravel()
    if flank.size == 0:
        return
    n_node = len(frame.points)
    whole = np.bincount(place, minlength=n_node)[place[flank]] == 1
    # A node that is not split is an end of every crack that arrives: give each its own place.
    ends = np.where(whole, n_node + np.arange(whole.size), place[flank])
    names, first, ends = np.unique(ends, return_index=True, return_inverse=True)
    ends = ends.reshape(-1, 2)
    node = flank[first]
    is_tip = names >= n_node
    crack = connected_parts(ends[:, 0], ends[:, 1], names.size)
    for k in np.unique(crack):
        of_it = crack[ends[:, 0]] == k
        mine = ends[of_it]
        way = _way(mine, lengths[of_it], is_tip)
        tips = [
            _Tip(int(node[i]), at := frame.reference[node[i]], unit(at - frame.reference[node[j]]))
            for i, j in np.concatenate([mine, mine[:, ::-1]]).tolist()
            if is_tip[i]
        ]
        yield _Crack(frame.reference[node[way]], bool(is_tip[way[[0, -1]]].all()), tips)


def _way(edges: Ints, lengths: Floats, is_tip: Bools) -> Ints:
    """Return the places along a crack: from end to end, or around."""
    places, degree = np.unique(edges, return_counts=True)
    ends = places[degree == 1]
    if ends.size == 0:  # closed: remove one edge, join its ends by the remaining ones
        for k, (start, stop) in enumerate(edges.tolist()):
            way = _shortest(np.delete(edges, k, 0), np.delete(lengths, k), start, stop)
            if way.size:  # empty for an edge that joins two loops
                return np.append(way, start)
    tips = ends[is_tip[ends]]
    begins = tips if tips.size else ends
    stops = tips if tips.size > 1 else ends if ends.size > 1 else places
    distance = np.asarray(
        scipy.sparse.csgraph.dijkstra(_graph(edges, lengths), directed=False, indices=begins)
    )
    i, j = np.unravel_index(np.argmax(distance[:, stops]), (begins.size, stops.size))
    return _shortest(edges, lengths, int(begins[i]), int(stops[j]))


def _shortest(edges: Ints, lengths: Floats, begin: int, stop: int) -> Ints:
    """Return the places on the shortest path, empty if there is none."""
    graph = _graph(edges, lengths)
    _, before = scipy.sparse.csgraph.dijkstra(
        graph, directed=False, indices=begin, return_predecessors=True
    )
    way = [stop]
    while way[-1] != begin:
        if before[way[-1]] < 0:
            return np.zeros(0, np.int64)
        way.append(int(before[way[-1]]))
    return np.array(way[::-1])


def _graph(edges: Ints, lengths: Floats) -> Any:
    n = int(edges.max()) + 1
    return scipy.sparse.coo_array((lengths, tuple(edges.T)), (n, n)).tocsr()


# --- bridges -------------------------------------------------------------------------------------


def _bridges(cracks: list[_Crack]) -> Iterator[tuple[_Tip, _Tip, float]]:
    tips = [tip for crack in cracks for tip in crack.tips]
    pairs = [
        (width, i, j)
        for j in range(len(tips))
        for i in range(j)
        if (width := _width(tips[i], tips[j])) is not None
    ]
    taken: set[int] = set()
    for width, i, j in sorted(pairs):
        if not taken & {i, j}:
            taken |= {i, j}
            yield tips[i], tips[j], width


def _width(a: _Tip, b: _Tip) -> float | None:
    """Return the arc between two ends, None if they do not face each other."""
    way = b.place - a.place
    chord = float(np.linalg.norm(way))
    if chord == 0.0:
        return 0.0
    cosines = float(a.ahead @ way) / chord, -float(b.ahead @ way) / chord
    if min(cosines) <= 0.0:
        return None
    off = float(np.mean(np.arccos(np.minimum(cosines, 1.0))))
    return chord / float(np.sinc(off / np.pi))


# --- closed lines --------------------------------------------------------------------------------


class _Network(NamedTuple):
    """Cracks and bridges."""

    place: Ints
    """Of each node."""
    ways: Ints
    """Nodes at the ends of each crack edge, then of each bridge, shape (n_way, 2)."""
    lengths: Floats
    """[mm]"""
    n_edge: int
    """Number of crack edges."""


def _network(
    frame: Frame, place: Ints, lengths: Floats, bridges: list[tuple[_Tip, _Tip, float]]
) -> _Network:
    # A bridge between cracks that meet at a node is no way: it has no length.
    across = np.array([(a.node, b.node, w) for a, b, w in bridges if w > 0.0]).reshape(-1, 3)
    ways = np.concatenate([frame.crack_edges[:, 0], across[:, :2].astype(int)])
    return _Network(place, ways, np.concatenate([lengths, across[:, 2]]), len(lengths))


def _closed_lines(surface: _Surface, network: _Network) -> list[tuple[Floats, float]]:
    """Return the closed lines, and the share of each that is cut, in the order of the cut-out."""
    X, found = surface.reference, []
    for n in (network.n_edge, len(network.ways)):
        for around in _loops(surface, network.place, network.ways[:n]):
            line = X[network.ways[around >> 1, around & 1]]
            lengths = network.lengths[around >> 1]
            share = float(lengths[around >> 1 < network.n_edge].sum() / lengths.sum())
            arm = line - line[0]
            area = 0.5 * float(norm(cross(arm, np.roll(arm, -1, axis=0)).sum(axis=0)))
            found.append((area * share, line, share))
    return [(line, share) for _, line, share in sorted(found, key=lambda one: -one[0])]


def _loops(surface: _Surface, place: Ints, ways: Ints) -> Iterator[Ints]:
    """Yield the ways around each mesh of a network: 2 k for the k-th, 2 k + 1 for it backwards.

    From the end of a way a line goes on along the next one clockwise, so it stays beside one mesh.
    Where it comes back to a place, the part since then is a loop of its own; a way there and back
    is none.
    """
    onward = _clockwise(surface, place, ways).tolist()
    tail, left = place[ways].ravel().tolist(), [True] * len(onward)
    for way in range(len(onward)):
        walk: list[int] = []
        at: dict[int, int] = {}
        while True:
            if (start := at.get(tail[way])) is not None:
                loop = walk[start:]
                del walk[start:]
                for k in loop:
                    del at[tail[k]]
                if len(loop) > 2:
                    yield np.array(loop)
            if not left[way]:
                break
            left[way], at[tail[way]] = False, len(walk)
            walk.append(way)
            way = onward[way]


def _clockwise(surface: _Surface, place: Ints, ways: Ints) -> Ints:
    """Return the way after each way of :func:`_loops`, clockwise seen from the film's normal."""
    tail, X = place[ways].ravel(), surface.reference
    along = (X[ways[:, ::-1]] - X[ways]).reshape(-1, 3)
    normal = np.zeros((len(place), 3))
    np.add.at(normal, place[surface.quads], surface.before[:, None])
    up = unit(normal[tail])
    east = cross(up, np.eye(3)[np.abs(up).argmin(axis=1)])
    angle = np.arctan2((along * cross(up, east)).sum(axis=1), (along * east).sum(axis=1))
    order = np.lexsort((-angle, tail))
    last = np.flatnonzero(np.diff(tail[order], append=-1))
    after = np.roll(order, -1)
    after[last] = order[np.append(0, last[:-1] + 1)[: last.size]]
    onward = np.empty_like(order)
    onward[order ^ 1] = after
    return onward


# --- flaps, cut-out, pieces ----------------------------------------------------------------------


class _Surface:
    """Centres and area vectors of the quads."""

    def __init__(self, frame: Frame) -> None:
        own = is_corner(frame.quads)
        corners = frame.reference[frame.quads] * own[..., None]
        self.centre = corners.sum(axis=1) / own.sum(axis=1)[:, None]
        self.reference, self.quads = frame.reference, frame.quads
        self.before = quad_vectors(frame.reference, frame.quads)
        self.now = quad_vectors(frame.points, frame.quads)
        self.area = np.linalg.norm(self.before, axis=1)

    def part(self, line: Floats) -> Part | None:
        """Return the film inside a closed line; None if the enclosed area is almost zero."""
        middle = line.mean(axis=0)
        _, size, axes = np.linalg.svd(line - middle, full_matrices=False)
        if len(line) < 3 or size[1] ** 2 <= _LEAST_FLAP * size[0] ** 2:
            return None
        inside = within((self.centre - middle) @ axes[:2].T, (line - middle) @ axes[:2].T)
        # Other film may lie above and below the line's plane, such as the far side of a tube.
        near = np.abs((self.centre - middle) @ axes[2]) <= size[0]
        quads = np.flatnonzero(inside & near)
        if quads.size == 0:
            return None
        before, now = self.before[quads], self.now[quads]
        return Part(
            quads,
            line,
            float(self.area[quads].sum()),
            float(np.degrees(angles(before.sum(axis=0), now.sum(axis=0)))),
            float(np.degrees(angles(before, now)).max()),
        )


def _pieces(frame: Frame, surface: _Surface) -> list[Piece]:
    n_node, quads = len(frame.points), frame.quads
    others = quads[:, 1:]
    first = np.repeat(quads[:, 0], others.shape[1])
    piece_of_node = connected_parts(first, others.ravel(), n_node)
    of_quad = piece_of_node[quads[:, 0]]
    found = [
        Piece(mine, float(surface.area[mine].sum()), not frame.held[quads[mine]].any())
        for mine in (np.flatnonzero(of_quad == k) for k in np.unique(of_quad))
    ]
    found.sort(key=lambda piece: -piece.area)
    if found and not frame.held.any():
        found[0] = Piece(found[0].quads, found[0].area, loose=False)
    return found
