"""The cutting tool: a rigid closed triangulated surface with its cutting edges, in its body frame.

Words: a *body* (tooth) is a connected component of the surface; a *cutting edge* is a chain of
*segments*, edges of the surface where it folds back sharply; the triangle that runs along a
segment in the direction of its chain is the *plus* flank there, the other one the *minus* flank.

=====================  ==================================================================
n+, n-                 outward unit normals of the two triangles at a segment
t                      unit vector along the segment, in the direction of its chain
b = (n+ - n-)/|..|     ``edge_normal``: of the mid-plane, which bisects the faces; towards plus
b x t                  ``edge_back``: in the mid-plane, normal to the segment, into the solid
=====================  ==================================================================

The 0.1 mm radius of a real edge is taken as sharp  # [Frangi2010] 5
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from math import degrees, radians

import numpy as np
import numpy.typing as npt
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components, dijkstra
from scipy.spatial import cKDTree

from ._jit import Floats, Ints, SmallInts

MERGE_TOLERANCE = 1e-7
"""Vertices nearer than this part of the surface's diagonal are one: the round-off of a
single-precision STL file."""

DEGENERATE_HEIGHT = 1e-7
"""Least height of a triangle as a part of its longest edge: below it the normal is noise."""

FLAT_TURN = radians(1.0)
"""A given cutting edge must turn by more than this [rad]: a flat one has no mid-plane."""

EXAMPLES_SHOWN = 3
"""How many places an error message lists of each kind of defect."""


class ToolError(ValueError):
    """A surface or a set of parameters that cannot be a tool; the message lists every reason."""

    def __init__(self, problems: list[str], *, what: str = "surface"):
        self.problems = tuple(problems)
        super().__init__(f"the {what} cannot be a tool:\n" + "\n".join(f"- {p}" for p in problems))


@dataclass(frozen=True, eq=False, repr=False)
class Tool:
    """A rigid cutter: closed surface, cutting edges and flanks in the body frame; read-only.

    Built by :meth:`from_triangles`, which checks the surface; the constructor itself does not.

    Examples
    --------
    >>> from shellcut.tool_shapes import straight_blade
    >>> blade = straight_blade()
    >>> blade.n_body, blade.n_edge
    (1, 1)
    >>> [round(float(b), 12) for b in blade.edge_normal[0]]
    [0.0, 1.0, 0.0]
    """

    vertices: Floats
    """Corners of the triangles, shape (n_vertex, 3), [mm]."""
    triangles: Ints
    """Vertex ids, counter-clockwise seen from outside, shape (n_triangle, 3)."""
    triangle_normals: Floats
    """Outward unit normals, shape (n_triangle, 3)."""
    triangle_body: Ints
    """Body (tooth) of each triangle, numbered by first appearance, shape (n_triangle,)."""
    flank: SmallInts
    """+1 and -1 on the flanks beside the cutting edges, 0 elsewhere, shape (n_triangle,), int8."""
    edges: Ints
    """Vertex ids of the cutting segments, chain after chain, in order, shape (n_edge, 2)."""
    edge_body: Ints
    """Body of each segment, shape (n_edge,)."""
    edge_chain: Ints
    """Chain of each segment, shape (n_edge,)."""
    edge_flank_plus: Ints
    """Triangle beside each segment on the plus side, shape (n_edge,)."""
    edge_flank_minus: Ints
    """Triangle beside each segment on the minus side, shape (n_edge,)."""
    edge_normal: Floats
    """Unit normal b of the mid-plane, towards the plus flank, shape (n_edge, 3)."""
    edge_back: Floats
    """Unit vector of the mid-plane, normal to the segment, into the solid, shape (n_edge, 3)."""
    name: str = "tool"
    """What reports call it."""
    parameters: Mapping[str, float] = field(default_factory=dict)
    """The numbers it was built from, for reports; empty for a surface that was read."""

    def __post_init__(self) -> None:
        for item in fields(self):
            value = getattr(self, item.name)
            if isinstance(value, np.ndarray):
                value.flags.writeable = False

    def __repr__(self) -> str:
        return (
            f"Tool({self.name!r}, {self.n_body} bodies, {self.n_triangle} triangles, "
            f"{self.n_edge} cutting segments in {self.n_chain} chains)"
        )

    @property
    def n_vertex(self) -> int:
        """Number of vertices."""
        return len(self.vertices)

    @property
    def n_triangle(self) -> int:
        """Number of triangles."""
        return len(self.triangles)

    @property
    def n_body(self) -> int:
        """Number of bodies (teeth)."""
        return int(self.triangle_body.max()) + 1

    @property
    def n_edge(self) -> int:
        """Number of cutting segments."""
        return len(self.edges)

    @property
    def n_chain(self) -> int:
        """Number of chains of cutting segments."""
        return int(self.edge_chain.max()) + 1

    @classmethod
    def from_triangles(
        cls,
        vertices: npt.ArrayLike,
        triangles: npt.ArrayLike,
        *,
        edges: npt.ArrayLike | None = None,
        sharp_angle_deg: float = 100.0,
        flank_angle_deg: float = 40.0,
        name: str = "tool",
        parameters: Mapping[str, float] | None = None,
    ) -> Tool:
        """Build a tool from a closed surface; merge duplicate vertices, find edges and flanks.

        Parameters
        ----------
        vertices : array_like, shape (n_vertex, 3), [mm]
            May hold duplicates (an STL file does); unused ones are dropped.
        triangles : array_like of int, shape (n_triangle, 3)
            Counter-clockwise seen from outside.
        edges : array_like of int, shape (n_edge, 2), optional
            The cutting segments, as ids into ``vertices``; each chain keeps the direction of its
            first segment, which decides what is plus. By default they are found by angle.
        sharp_angle_deg : float, [deg]
            Where no edges are given: the least angle between the two outward normals at a convex
            edge that cuts. A wedge of half-angle a turns by 180 - 2a. A chain found in this way
            starts in the direction of its smallest vertex id; further chains of a body are
            turned so that their plus sides face the same way as that of the first.
        flank_angle_deg : float, [deg]
            A flank extends from its cutting edge over all edges that turn by less. A triangle
            reached from both sides takes the side with the shorter way over triangle centres
            (plus where the ways are equal).
        name, parameters
            For reports.

        Raises
        ------
        ToolError
            Lists all that is wrong: shapes, non-finite coordinates, degenerate triangles, holes,
            non-manifold edges and vertices, orientation, cutting edges that are not there.

        Notes
        -----
        Whether the surface cuts through itself is not checked.
        """
        coordinates, ids, given = _cast(
            vertices, triangles, edges, sharp_angle_deg, flank_angle_deg
        )
        coordinates, ids, given = _merge_vertices(coordinates, ids, given)
        surface = _Surface(coordinates, ids)
        problems = surface.problems()
        if given is None:
            segments, missing = surface.sharp_segments(radians(sharp_angle_deg))
        else:
            segments, missing = given, surface.not_cutting(given)
        problems += missing
        if problems:
            raise ToolError(problems)

        segments, chain = _chains(segments)
        plus, minus = surface.sides(segments)
        normal, back = surface.mid_planes(segments, plus, minus)
        if given is None:
            body = surface.body[plus]
            reverse = _chains_facing_back(body, chain, normal)
            if reverse.any():
                segments = _reverse_chains(segments, chain, reverse)
                plus, minus = surface.sides(segments)
                normal, back = surface.mid_planes(segments, plus, minus)
        return cls(
            vertices=surface.vertices,
            triangles=surface.triangles,
            triangle_normals=surface.normals,
            triangle_body=surface.body,
            flank=surface.flanks(plus, minus, radians(flank_angle_deg)),
            edges=segments,
            edge_body=surface.body[plus],
            edge_chain=chain,
            edge_flank_plus=plus,
            edge_flank_minus=minus,
            edge_normal=normal,
            edge_back=back,
            name=name,
            parameters=dict(parameters or {}),
        )

    def volume(self) -> Floats:
        """Return the volume of each body, shape (n_body,), [mm³]."""
        six_volumes = _six_volumes(self.vertices, self.triangles)
        return np.bincount(self.triangle_body, weights=six_volumes) / 6.0

    def bounding_box(self) -> tuple[Floats, Floats]:
        """Return the least and greatest coordinates in the body frame, shape (3,) each, [mm]."""
        return self.vertices.min(axis=0), self.vertices.max(axis=0)

    def translated(self, shift: Sequence[float] | Floats) -> Tool:
        """Return the tool moved in its body frame by ``shift``, shape (3,), [mm]."""
        move = np.asarray(shift, dtype=np.float64)
        if move.shape != (3,) or not np.isfinite(move).all():
            raise ValueError(f"shift must be three finite numbers in mm, got {shift!r}")
        return replace(self, vertices=self.vertices + move)

    def point(self, edge: int, s: float) -> Floats:
        """Return the point of cutting segment ``edge`` at the part ``s`` in [0, 1] of its length.

        Parameters
        ----------
        edge : int
            Segment, in [0, n_edge).
        s : float
            0 at its first vertex, 1 at its second.

        Returns
        -------
        ndarray, shape (3,), [mm]
            In the body frame.
        """
        if not 0 <= edge < self.n_edge:
            raise ValueError(f"edge must be in [0, {self.n_edge}), got {edge}")
        if not 0.0 <= s <= 1.0:
            raise ValueError(f"s must be in [0, 1], got {s}")
        i, j = self.edges[edge]
        point: Floats = (1.0 - s) * self.vertices[i] + s * self.vertices[j]
        return point


class _Surface:
    # A merged surface with its edge table: what the checks, the edges and the flanks share.
    # Each undirected edge (lo < hi) is a row; `manifold` rows have one triangle that runs lo -> hi
    # (`forward`) and one that runs hi -> lo (`backward`).

    def __init__(self, vertices: Floats, triangles: Ints):
        self.vertices = vertices
        self.triangles = triangles
        n_triangle = triangles.shape[0]
        self.normals, self.height = _normals(vertices, triangles)

        start = triangles[:, (0, 1, 2)].ravel()
        end = triangles[:, (1, 2, 0)].ravel()
        key = np.minimum(start, end) * vertices.shape[0] + np.maximum(start, end)
        self.keys, row, self.uses = np.unique(key, return_inverse=True, return_counts=True)
        self.lo, self.hi = np.divmod(self.keys, vertices.shape[0])
        runs_up = start < end
        owner = np.repeat(np.arange(n_triangle), 3)
        up_uses = np.bincount(row[runs_up], minlength=self.keys.size)
        self.manifold = (self.uses == 2) & (up_uses == 1)
        self.twisted = (self.uses == 2) & (up_uses != 1)
        # where a direction is missing, any triangle of the edge stands in
        self.forward = np.zeros(self.keys.size, dtype=np.int64)
        self.forward[row] = owner
        self.backward = self.forward.copy()
        self.forward[row[runs_up]] = owner[runs_up]
        self.backward[row[~runs_up]] = owner[~runs_up]

        by_edge = np.argsort(row, kind="stable")
        same = np.flatnonzero(row[by_edge][1:] == row[by_edge][:-1])
        self.body = _first_come_labels(owner[by_edge][same], owner[by_edge][same + 1], n_triangle)
        self.twin_corners = (by_edge[same], by_edge[same + 1])
        self.turn = self._turning_angles()

    def _turning_angles(self) -> Floats:
        # Angle between the two normals, negative where the edge is concave; 0 off manifold edges.
        # The signs of an inside-out body are the wrong way round: its volume tells.
        turn = np.zeros(self.keys.size)
        rows = np.flatnonzero(self.manifold)
        first, second = self.normals[self.forward[rows]], self.normals[self.backward[rows]]
        sine = np.linalg.norm(np.cross(first, second), axis=1)
        cosine = np.einsum("ij,ij->i", first, second)
        centre = self.vertices[self.triangles[self.backward[rows]]].mean(axis=1)
        outward = np.einsum("ij,ij->i", centre - self.vertices[self.lo[rows]], first)
        outward *= np.where(self.body_volumes()[self.body[self.forward[rows]]] < 0.0, -1.0, 1.0)
        turn[rows] = np.where(outward > 0.0, -1.0, 1.0) * np.arctan2(sine, cosine)
        return turn

    def body_volumes(self) -> Floats:
        return np.bincount(self.body, weights=_six_volumes(self.vertices, self.triangles)) / 6.0

    def problems(self) -> list[str]:
        found = []
        flat = np.flatnonzero(self.height < DEGENERATE_HEIGHT)
        if flat.size:
            places = self._at(self.vertices[self.triangles[flat]].mean(axis=1))
            found.append(f"{_count(flat, 'degenerate triangle')} (no area), centred at {places}")
        holes = np.flatnonzero(self.uses == 1)
        if holes.size:
            found.append(
                f"{_count(holes, 'open edge')} (the surface has a hole): {self._segments(holes)}"
            )
        crowded = np.flatnonzero(self.uses > 2)
        if crowded.size:
            found.append(
                f"{_count(crowded, 'non-manifold edge')} (more than two triangles meet): "
                f"{self._segments(crowded)}"
            )
        twisted = np.flatnonzero(self.twisted)
        if twisted.size:
            found.append(
                f"{_count(twisted, 'edge')} between triangles of opposite orientation: "
                f"{self._segments(twisted)}; reverse one of the two: triangles[i] = "
                "triangles[i, ::-1]"
            )
        pinched = self._pinched_vertices()
        if pinched.size:
            found.append(
                f"{_count(pinched, 'non-manifold vertex', 'non-manifold vertices')} (parts of the "
                f"surface touch in a point), move them apart: {self._at(self.vertices[pinched])}"
            )
        unsound = np.zeros(self.body.max() + 1, dtype=bool)
        bad_edges = ~self.manifold
        unsound[self.body[self.forward[bad_edges]]] = True
        unsound[self.body[self.backward[bad_edges]]] = True
        inverted = np.flatnonzero((self.body_volumes() < 0.0) & ~unsound)
        if inverted.size:
            teeth = ", ".join(str(b) for b in inverted)
            found.append(
                f"inside-out surface: negative volume of tooth {teeth} (of {unsound.size}); its "
                "normals point inwards: give vertices, triangles[:, ::-1]"
                + ("" if inverted.size == unsound.size else " for the triangles of that tooth")
            )
        return found

    def _pinched_vertices(self) -> Ints:
        # A vertex whose corners (3 t + k) fall into more than one fan: two corners are of one fan
        # if their triangles share an edge at that vertex.
        near, far = self.twin_corners  # half-edges; half-edge 3 t + k starts at corner k of t
        links_a, links_b = [], []
        vertex = self.triangles.ravel()
        for a_start in (True, False):
            corner_a = near if a_start else _next_corner(near)
            for b_start in (True, False):
                corner_b = far if b_start else _next_corner(far)
                match = vertex[corner_a] == vertex[corner_b]
                links_a.append(corner_a[match])
                links_b.append(corner_b[match])
        fan = _first_come_labels(np.concatenate(links_a), np.concatenate(links_b), vertex.size)
        pairs = np.unique(np.column_stack([vertex, fan]), axis=0)
        # fans of an open surface are told by its holes already
        fans = np.bincount(pairs[:, 0], minlength=self.vertices.shape[0])
        on_bad_edge = np.zeros(self.vertices.shape[0], dtype=bool)
        on_bad_edge[self.lo[self.uses != 2]] = True
        on_bad_edge[self.hi[self.uses != 2]] = True
        return np.flatnonzero((fans > 1) & ~on_bad_edge)

    def sharp_segments(self, least_turn: float) -> tuple[Ints, list[str]]:
        rows = np.flatnonzero(self.turn >= least_turn)
        problems = []
        if rows.size == 0:
            sharpest = degrees(float(self.turn.max()))
            problems.append(
                f"no sharp edge found: none turns by sharp_angle_deg = {degrees(least_turn):g} or "
                f"more, the sharpest turns by {sharpest:.1f}; lower sharp_angle_deg or give edges"
            )
        return np.column_stack([self.lo[rows], self.hi[rows]]), problems

    def not_cutting(self, segments: Ints) -> list[str]:
        problems = []
        row, present = self._rows(segments)
        if not present.all():
            lost = np.flatnonzero(~present)
            problems.append(
                f"{_count(lost, 'given cutting edge')} not an edge of the surface: "
                + self._pairs(segments[lost])
            )
        flat = np.flatnonzero(present & self.manifold[row] & (self.turn[row] < FLAT_TURN))
        if flat.size:
            problems.append(
                f"{_count(flat, 'given cutting edge')} flat or concave, so without a wedge behind: "
                + self._pairs(segments[flat])
            )
        key = np.sort(segments, axis=1) @ np.array([self.vertices.shape[0], 1])
        if np.unique(key).size < key.size:
            problems.append(f"{key.size - np.unique(key).size} of the given cutting edges repeat")
        return problems

    def _rows(self, segments: Ints) -> tuple[Ints, npt.NDArray[np.bool_]]:
        ordered = np.sort(segments, axis=1)
        key = ordered[:, 0] * self.vertices.shape[0] + ordered[:, 1]
        row = np.minimum(np.searchsorted(self.keys, key), self.keys.size - 1)
        return row, (self.keys[row] == key) & (ordered[:, 0] >= 0)

    def sides(self, segments: Ints) -> tuple[Ints, Ints]:
        row, _ = self._rows(segments)
        runs_up = segments[:, 0] < segments[:, 1]
        plus = np.where(runs_up, self.forward[row], self.backward[row])
        minus = np.where(runs_up, self.backward[row], self.forward[row])
        return plus, minus

    def mid_planes(self, segments: Ints, plus: Ints, minus: Ints) -> tuple[Floats, Floats]:
        normal = _unit(self.normals[plus] - self.normals[minus])
        along = _unit(self.vertices[segments[:, 1]] - self.vertices[segments[:, 0]])
        return normal, _unit(np.cross(normal, along))

    def flanks(self, plus: Ints, minus: Ints, largest_turn: float) -> SmallInts:
        # a way across a cutting edge passes a seed of the other side first: no need to bar it
        smooth = self.manifold & (np.abs(self.turn) < largest_turn)
        a, b = self.forward[smooth], self.backward[smooth]
        centre = self.vertices[self.triangles].mean(axis=1)
        way = np.linalg.norm(centre[a] - centre[b], axis=1)
        n = self.triangles.shape[0]
        graph = coo_array((way, (a, b)), shape=(n, n)).tocsr()
        to_plus = dijkstra(graph, directed=False, indices=np.unique(plus), min_only=True)
        to_minus = dijkstra(graph, directed=False, indices=np.unique(minus), min_only=True)
        flank = np.zeros(n, dtype=np.int8)
        flank[np.isfinite(to_plus) & (to_plus <= to_minus)] = 1
        flank[to_minus < to_plus] = -1
        return flank

    def _segments(self, rows: Ints) -> str:
        return self._pairs(np.column_stack([self.lo[rows], self.hi[rows]]))

    def _pairs(self, segments: Ints) -> str:
        places = [
            f"{_place(self.vertices[i])} to {_place(self.vertices[j])}"
            if i >= 0 and j >= 0
            else "with a vertex that no triangle uses"
            for i, j in segments[:EXAMPLES_SHOWN]
        ]
        return "; ".join(places) + ("; ..." if len(segments) > EXAMPLES_SHOWN else "")

    def _at(self, points: Floats) -> str:
        places = [_place(point) for point in points[:EXAMPLES_SHOWN]]
        return "; ".join(places) + ("; ..." if len(points) > EXAMPLES_SHOWN else "")


def _cast(
    vertices: npt.ArrayLike,
    triangles: npt.ArrayLike,
    edges: npt.ArrayLike | None,
    sharp_angle_deg: float,
    flank_angle_deg: float,
) -> tuple[Floats, Ints, Ints | None]:
    problems = []
    coordinates = np.array(vertices, dtype=np.float64)
    if coordinates.ndim != 2 or coordinates.shape[1] != 3:
        problems.append(f"vertices must have shape (n_vertex, 3), got {coordinates.shape}")
    elif not np.isfinite(coordinates).all():
        bad = np.flatnonzero(~np.isfinite(coordinates).all(axis=1))
        problems.append(f"{_count(bad, 'vertex', 'vertices')} not finite, first id {bad[0]}")
    n_vertex = coordinates.shape[0] if coordinates.ndim else 0
    ids = _cast_ids(triangles, 3, "triangles", "(n_triangle, 3)", n_vertex, problems)
    given = None
    if edges is not None:
        given = _cast_ids(edges, 2, "edges", "(n_edge, 2)", n_vertex, problems)
    if not 0.0 < sharp_angle_deg < 180.0:
        problems.append(f"sharp_angle_deg must be between 0 and 180, got {sharp_angle_deg}")
    if not 0.0 < flank_angle_deg < 90.0:
        problems.append(f"flank_angle_deg must be between 0 and 90, got {flank_angle_deg}")
    if problems:
        raise ToolError(problems)
    return coordinates, ids, given


def _cast_ids(
    values: npt.ArrayLike, width: int, name: str, shape: str, n_vertex: int, problems: list[str]
) -> Ints:
    ids = np.asarray(values)
    if ids.ndim != 2 or ids.shape[1] != width or ids.shape[0] == 0:
        problems.append(f"{name} must have shape {shape} and at least one row, got {ids.shape}")
    elif not np.issubdtype(ids.dtype, np.integer):
        problems.append(f"{name} must hold integer vertex ids, got {ids.dtype}")
    elif ids.min() < 0 or ids.max() >= n_vertex:
        problems.append(
            f"{name} must hold vertex ids in [0, {n_vertex}), got {ids.min()} to {ids.max()}"
        )
    else:
        return np.array(ids, dtype=np.int64, order="C")
    return np.zeros((0, width), dtype=np.int64)


def _merge_vertices(
    vertices: Floats, triangles: Ints, edges: Ints | None
) -> tuple[Floats, Ints, Ints | None]:
    # One id for vertices that coincide; the first of them stays, unused ones go (id -1 in edges).
    tolerance = MERGE_TOLERANCE * float(np.linalg.norm(np.ptp(vertices, axis=0)))
    pairs = cKDTree(vertices).query_pairs(tolerance, output_type="ndarray")
    place = _first_come_labels(pairs[:, 0], pairs[:, 1], vertices.shape[0])
    _, first = np.unique(place, return_index=True)
    used = np.zeros(first.size, dtype=bool)
    used[place[triangles]] = True
    new_id = np.where(used, np.cumsum(used) - 1, -1)
    merged = np.ascontiguousarray(vertices[first][used])
    return merged, new_id[place[triangles]], None if edges is None else new_id[place[edges]]


def _first_come_labels(a: Ints, b: Ints, n: int) -> Ints:
    # Connected components of n things linked by the pairs a[i], b[i], numbered by first appearance.
    graph = coo_array((np.ones(a.size, dtype=np.int8), (a, b)), shape=(n, n))
    _, label = connected_components(graph, directed=False)
    _, first, inverse = np.unique(label, return_index=True, return_inverse=True)
    rank = np.empty(first.size, dtype=np.int64)
    rank[np.argsort(first)] = np.arange(first.size)
    ranks: Ints = rank[inverse]
    return ranks


def _chains(segments: Ints) -> tuple[Ints, Ints]:
    # Order segments into chains that break where not exactly two of them meet. A chain keeps the
    # direction of its first segment as given; chains are numbered by that segment.
    at_vertex: dict[int, list[int]] = {}
    for e, (i, j) in enumerate(segments.tolist()):
        at_vertex.setdefault(i, []).append(e)
        at_vertex.setdefault(j, []).append(e)

    def step(e: int, vertex: int) -> tuple[int, int] | None:
        # the segment that continues e at this vertex, and that segment's far vertex
        meeting = at_vertex[vertex]
        if len(meeting) != 2:
            return None
        other = meeting[0] if meeting[1] == e else meeting[1]
        i, j = segments[other].tolist()
        return other, j if i == vertex else i

    ordered: list[tuple[int, int]] = []
    chain: list[int] = []
    done = np.zeros(len(segments), dtype=bool)
    n_chain = 0
    for seed in range(len(segments)):
        if done[seed]:
            continue
        done[seed] = True
        tail, head = segments[seed].tolist()
        links = [(tail, head)]
        e, vertex = seed, head
        while (found := step(e, vertex)) is not None and not done[found[0]]:
            links.append((vertex, found[1]))
            e, vertex = found
            done[e] = True
        before = []
        e, vertex = seed, tail
        while (found := step(e, vertex)) is not None and not done[found[0]]:
            before.append((found[1], vertex))
            e, vertex = found
            done[e] = True
        links = before[::-1] + links
        ordered += links
        chain += [n_chain] * len(links)
        n_chain += 1
    return np.array(ordered, dtype=np.int64), np.array(chain, dtype=np.int64)


def _chains_facing_back(body: Ints, chain: Ints, normal: Floats) -> npt.NDArray[np.bool_]:
    # Chains found by angle whose plus side faces against that of the first chain of their body.
    reverse = np.zeros(chain.max() + 1, dtype=bool)
    facing: dict[int, Floats] = {}
    for c in range(reverse.size):
        mean = normal[chain == c].sum(axis=0)
        first = facing.setdefault(int(body[chain == c][0]), mean)
        reverse[c] = float(mean @ first) < 0.0
    return reverse


def _reverse_chains(segments: Ints, chain: Ints, reverse: npt.NDArray[np.bool_]) -> Ints:
    turned = segments.copy()
    for c in np.flatnonzero(reverse):
        turned[chain == c] = segments[chain == c][::-1, ::-1]
    return turned


def _normals(vertices: Floats, triangles: Ints) -> tuple[Floats, Floats]:
    # Unit normals (zero where degenerate) and least height over longest edge.
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    doubled = np.cross(b - a, c - a)
    area = np.linalg.norm(doubled, axis=1)
    longest = np.sqrt(
        np.maximum.reduce([((q - p) ** 2).sum(1) for p, q in ((a, b), (b, c), (c, a))])
    )
    safe = longest > 0.0
    height = np.zeros(area.size)
    height[safe] = area[safe] / longest[safe] ** 2
    normals = np.zeros_like(doubled)
    normals[area > 0.0] = doubled[area > 0.0] / area[area > 0.0, None]
    return normals, height


def _six_volumes(vertices: Floats, triangles: Ints) -> Floats:
    # Six times the signed volume between each triangle and the middle of the surface.
    a, b, c = (vertices[triangles[:, k]] - vertices.mean(axis=0) for k in range(3))
    volumes: Floats = np.einsum("ij,ij->i", a, np.cross(b, c))
    return volumes


def _unit(rows: Floats) -> Floats:
    unit: Floats = rows / np.linalg.norm(rows, axis=1)[:, None]
    return unit


def _next_corner(half_edges: Ints) -> Ints:
    corners: Ints = half_edges + 1 - 3 * (half_edges % 3 == 2)
    return corners


def _count(ids: Ints, singular: str, plural: str | None = None) -> str:
    return f"{ids.size} {singular if ids.size == 1 else plural or singular + 's'}"


def _place(point: Floats) -> str:
    return "(" + ", ".join(f"{value:.6g}" for value in point) + ")"
