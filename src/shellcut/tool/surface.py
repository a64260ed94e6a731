"""A merged triangulated surface with its edge table, for checks, sharp edges and flanks.

An edge *turns* by the angle between the outward normals of its two triangles, positive where the
surface is convex: the exterior angle. A wedge of half-angle a turns by 180° - 2a.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from math import degrees, radians
from typing import NamedTuple

import numpy as np
import scipy

from shellcut.arrays import Bools, Floats, Ints, SmallInts, angles, norm, product, unit
from shellcut.formats.errors import counted, named, point_text
from shellcut.numerics.connected_parts import by_first_appearance, close_parts, connected_parts

from .touching_bodies import touching_bodies

MERGE_TOLERANCE = 1e-7
"""Vertices closer than this fraction of the surface's diagonal are merged: the round-off of a
single-precision STL file."""

DEGENERATE_HEIGHT = 1e-7
"""Least height of a triangle over its longest edge: below it the normal is noise."""

FLAT_TURN = radians(1.0)
"""A given cutting edge must turn by more than this [rad]: a flat one has no mid-plane."""


class Surface:
    """A surface with merged vertices and its edge table.

    Each undirected edge (lo < hi) is a row; ``manifold`` rows have one triangle that runs lo -> hi
    (``forward``) and one that runs hi -> lo (``backward``).
    """

    def __init__(self, vertices: Floats, triangles: Ints):
        self.vertices = vertices
        self.triangles = triangles
        n_triangle = triangles.shape[0]
        self.normals, self.height = normals_and_heights(vertices, triangles)

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
        # where a direction is missing, use any triangle of the edge
        self.forward = np.zeros(self.keys.size, dtype=np.int64)
        self.forward[row] = owner
        self.backward = self.forward.copy()
        self.forward[row[runs_up]] = owner[runs_up]
        self.backward[row[~runs_up]] = owner[~runs_up]

        by_edge = np.argsort(row, kind="stable")
        same = np.flatnonzero(row[by_edge][1:] == row[by_edge][:-1])
        self.body = by_first_appearance(
            connected_parts(owner[by_edge][same], owner[by_edge][same + 1], n_triangle)
        )
        self.opposite_half_edges = (by_edge[same], by_edge[same + 1])
        self.turn = self._turning_angles()

    def _turning_angles(self) -> Floats:
        # Angle between the two normals, negative where the edge is concave; 0 off manifold edges.
        # The signs of an inside-out body (negative volume) are reversed.
        turn = np.zeros(self.keys.size)
        rows = np.flatnonzero(self.manifold)
        first, second = self.normals[self.forward[rows]], self.normals[self.backward[rows]]
        centre = self.vertices[self.triangles[self.backward[rows]]].mean(axis=1)
        outward = np.einsum("ij,ij->i", centre - self.vertices[self.lo[rows]], first)
        outward *= np.where(self.body_volumes()[self.body[self.forward[rows]]] < 0.0, -1.0, 1.0)
        turn[rows] = np.where(outward > 0.0, -1.0, 1.0) * angles(first, second)
        return turn

    def body_volumes(self) -> Floats:
        """Return the signed volume of each body, shape (n_body,), [mm³]."""
        return np.bincount(self.body, weights=six_volumes(self.vertices, self.triangles)) / 6.0

    def problems(self) -> list[str]:
        """Return why this is not the surface of solid bodies: one line per kind of defect."""
        found = []
        flat = np.flatnonzero(self.height < DEGENERATE_HEIGHT)
        if flat.size:
            places = named(self.vertices[self.triangles[flat]].mean(axis=1), point_text)
            found.append(
                f"{counted(len(flat), 'degenerate triangle')} (no area), centred at {places}"
            )
        holes = np.flatnonzero(self.uses == 1)
        if holes.size:
            found.append(
                f"{counted(len(holes), 'open edge')}: the surface has {self._holes(holes)}; close "
                "it in the program that made it"
            )
        crowded = np.flatnonzero(self.uses > 2)
        if crowded.size:
            found.append(
                f"{counted(len(crowded), 'non-manifold edge')} (more than two triangles meet): "
                f"{self._segments(crowded)}; unite bodies that touch there"
            )
        twisted = np.flatnonzero(self.twisted)
        if twisted.size:
            found.append(
                f"{counted(len(twisted), 'edge')} between triangles of opposite orientation: "
                f"{self._segments(twisted)}; reverse one of the two: triangles[i] = "
                "triangles[i, ::-1]"
            )
        pinched = self._pinched_vertices()
        if pinched.size:
            found.append(
                f"{counted(len(pinched), 'non-manifold vertex', 'non-manifold vertices')} "
                f"(parts of the surface touch in a point), move them apart: "
                f"{named(self.vertices[pinched], point_text)}"
            )
        unsound = np.zeros(self.body.max() + 1, dtype=bool)
        for sides in (self.forward, self.backward):
            unsound[self.body[sides[~self.manifold]]] = True
        inverted = np.flatnonzero((self.body_volumes() < 0.0) & ~unsound)
        if inverted.size:
            teeth = ", ".join(str(b + 1) for b in inverted)
            found.append(
                f"inside-out surface: negative volume of tooth {teeth} (of {unsound.size}); its "
                "normals point inwards: give vertices, triangles[:, ::-1]"
                + ("" if inverted.size == unsound.size else " for the triangles of that tooth")
            )
        sound = ~unsound[self.body]
        touching = [
            f"{i + 1} and {j + 1} near {point_text(place)}"
            for i, j, place in touching_bodies(
                self.vertices[self.triangles[sound]],
                self.body[sound],
                MERGE_TOLERANCE * float(norm(np.ptp(self.vertices, axis=0))),
            )
        ]
        if touching:
            found.append(
                f"bodies touch or overlap: {named(touching)}; unite them in the program that made "
                "them, or move them apart; fill a cavity"
            )
        return found

    def _pinched_vertices(self) -> Ints:
        # A vertex whose corners (3 t + k) form more than one fan: two corners belong to one fan if
        # their triangles share an edge at that vertex.
        near, far = self.opposite_half_edges  # half-edge 3 t + k starts at corner k of t
        links_a, links_b = [], []
        vertex = self.triangles.ravel()
        ends = itertools.product((near, _next_corner(near)), (far, _next_corner(far)))
        for corner_a, corner_b in ends:
            match = vertex[corner_a] == vertex[corner_b]
            links_a.append(corner_a[match])
            links_b.append(corner_b[match])
        fan = by_first_appearance(
            connected_parts(np.concatenate(links_a), np.concatenate(links_b), vertex.size)
        )
        pairs = np.unique(np.column_stack([vertex, fan]), axis=0)
        # open surfaces are already reported by their holes
        fans = np.bincount(pairs[:, 0], minlength=self.vertices.shape[0])
        on_bad_edge = np.zeros(self.vertices.shape[0], dtype=bool)
        on_bad_edge[self.lo[self.uses != 2]] = True
        on_bad_edge[self.hi[self.uses != 2]] = True
        return np.flatnonzero((fans > 1) & ~on_bad_edge)

    def sharp_segments(self, least_turn: float) -> tuple[Ints, list[str]]:
        """Return the edges that turn by at least this [rad], (n, 2), or why there are none."""
        rows = np.flatnonzero(self.turn >= least_turn)
        problems = []
        if rows.size == 0:
            sharpest = degrees(float(self.turn.max()))
            problems.append(
                f"no sharp edge found: none turns by sharp_angle_deg = {degrees(least_turn):g} or "
                f"more, the sharpest turns by {sharpest:.1f}; lower sharp_angle_deg, or choose "
                'edges = "none" for a blunt tool, which only presses'
            )
        return np.column_stack([self.lo[rows], self.hi[rows]]), problems

    def not_cutting(self, segments: Ints) -> list[str]:
        """Return why some of the given segments cannot cut."""
        problems = []
        row, present = self._rows(segments)
        if not present.all():
            lost = np.flatnonzero(~present)
            problems.append(
                f"{counted(len(lost), 'given cutting edge')} not an edge of the surface: "
                + self._pairs(segments[lost])
            )
        flat = np.flatnonzero(present & self.manifold[row] & (self.turn[row] < FLAT_TURN))
        if flat.size:
            problems.append(
                f"{counted(len(flat), 'given cutting edge')} flat or concave, "
                "without a wedge behind: " + self._pairs(segments[flat])
            )
        key = product(np.sort(segments, axis=1), np.array([self.vertices.shape[0], 1]))
        if np.unique(key).size < key.size:
            problems.append(f"{key.size - np.unique(key).size} of the given cutting edges repeat")
        return problems

    def _rows(self, segments: Ints) -> tuple[Ints, Bools]:
        ordered = np.sort(segments, axis=1)
        key = ordered[:, 0] * self.vertices.shape[0] + ordered[:, 1]
        row = np.minimum(np.searchsorted(self.keys, key), self.keys.size - 1)
        return row, (self.keys[row] == key) & (ordered[:, 0] >= 0)

    def sides(self, segments: Ints) -> tuple[Ints, Ints]:
        """Return the triangles that run along each segment in its direction and against it."""
        row, _ = self._rows(segments)
        runs_up = segments[:, 0] < segments[:, 1]
        plus = np.where(runs_up, self.forward[row], self.backward[row])
        minus = np.where(runs_up, self.backward[row], self.forward[row])
        return plus, minus

    def mid_planes(self, segments: Ints, plus: Ints, minus: Ints) -> tuple[Floats, Floats]:
        """Return normals and backs of the planes that bisect the faces, shape (n, 3) each."""
        normal = unit(self.normals[plus] - self.normals[minus])
        along = unit(self.vertices[segments[:, 1]] - self.vertices[segments[:, 0]])
        return normal, unit(np.cross(normal, along))

    def flanks(self, plus: Ints, minus: Ints, largest_turn: float) -> SmallInts:
        """Return +1, -1 or 0 per triangle: its side of the nearest cutting edge."""
        # a path across a cutting edge meets a seed of the other side first: no need to block it
        graph = self._over_centres(self.manifold & (np.abs(self.turn) < largest_turn))
        to_plus, to_minus = (
            scipy.sparse.csgraph.dijkstra(
                graph, directed=False, indices=np.unique(side), min_only=True
            )
            for side in (plus, minus)
        )
        flank = np.zeros(len(self.triangles), dtype=np.int8)
        flank[np.isfinite(to_plus) & (to_plus <= to_minus)] = 1
        flank[to_minus < to_plus] = -1
        return flank

    def links(self, plus: Ints, minus: Ints, chain: Ints, largest_turn: float) -> ChainLinks:
        """Return which chains have flanks that meet, and with which sides.

        Flanks meet where a triangle is as close to one chain as its neighbour to another.
        """
        beside, of = np.concatenate([plus, minus]), np.concatenate([chain, chain])
        side = np.repeat(np.array([1, -1], np.int8), len(chain))
        order = np.argsort(beside, kind="stable")
        again = np.flatnonzero(np.diff(beside[order]) == 0)  # beside two segments
        smooth = self.manifold & (np.abs(self.turn) < largest_turn)
        seeds, seed = np.unique(beside, return_index=True)
        away, _, source = scipy.sparse.csgraph.dijkstra(
            self._over_centres(smooth),
            directed=False,
            indices=seeds,
            min_only=True,
            return_predecessors=True,
        )
        seed_of = np.full(len(self.triangles), -1)
        seed_of[seeds] = seed
        a, b = self.forward[smooth], self.backward[smooth]
        meets = np.isfinite(away[a] + away[b])
        a, b = a[meets], b[meets]
        one = np.concatenate([order[again], seed_of[source[a]]])
        other = np.concatenate([order[again + 1], seed_of[source[b]]])
        length = np.concatenate([np.zeros(len(again)), away[a] + away[b]])
        two = np.flatnonzero(of[one] != of[other])
        one, other, length = one[two], other[two], length[two]
        low, high = np.minimum(of[one], of[other]), np.maximum(of[one], of[other])
        # Rounded, so that round-off does not choose between equal ways.
        length = np.round(length / max(float(length.max(initial=0.0)), np.finfo(float).tiny), 6)
        closest = np.lexsort((-side[one] * side[other], high, low, length))
        _, first = np.unique(low[closest] * len(chain) + high[closest], return_index=True)
        rows = closest[np.sort(first)]
        return ChainLinks(low[rows], high[rows], side[one[rows]] * side[other[rows]])

    def facing_opposite(self, segments: Ints, chain: Ints, links: ChainLinks) -> list[str]:
        """Return which chains to reverse: those with opposite sides where their flanks meet."""
        turned, _ = links.alike(int(chain.max(initial=-1)) + 1)
        as_given = np.ones_like(turned)
        if links.disagree(turned).any() or not links.disagree(as_given).any():
            return []
        wrong = np.flatnonzero(turned < 0)
        _, first = np.unique(chain, return_index=True)
        return [
            "flanks that meet on a smooth surface must be on the same side of their cutting edges, "
            f"but {counted(len(wrong), 'cutting edge')} has the other side there, the first "
            f"segment from {self._pairs(segments[first[wrong]])}; reverse all segments of these: "
            "edges[i] = edges[i, ::-1]"
        ]

    def teeth(self, plus: Ints, minus: Ints, chain: Ints) -> tuple[Ints, Ints]:
        """Return the teeth of triangles and segments: the nearest chain, or a body without one."""
        beside, first = np.unique(np.concatenate([plus, minus]), return_index=True)
        nearest = np.full(len(self.triangles), -1)
        if beside.size:
            _, _, nearest = scipy.sparse.csgraph.dijkstra(
                self._over_centres(self.manifold),
                directed=False,
                indices=beside,
                min_only=True,
                return_predecessors=True,
            )
        tooth, reached = -1 - self.body, nearest >= 0
        of_triangle = np.zeros(len(self.triangles), np.int64)
        of_triangle[beside] = np.concatenate([chain, chain])[first]
        tooth[reached] = of_triangle[nearest[reached]]
        of_all = by_first_appearance(np.concatenate([tooth, chain]))
        return of_all[: len(tooth)], of_all[len(tooth) :]

    def _over_centres(self, rows: Bools) -> scipy.sparse.csr_array:
        """Return the distances between the centres of triangles over some edges [mm]."""
        a, b = self.forward[rows], self.backward[rows]
        centre = self.vertices[self.triangles].mean(axis=1)
        distance = np.linalg.norm(centre[a] - centre[b], axis=1)
        n = len(self.triangles)
        return scipy.sparse.coo_array((distance, (a, b)), shape=(n, n)).tocsr()

    def _holes(self, rows: Ints) -> str:
        # connected borders of open edges with middle and size, largest first
        n = self.vertices.shape[0]
        border_of_vertex = by_first_appearance(connected_parts(self.lo[rows], self.hi[rows], n))
        # vertices in the order of their borders
        vertices = np.unique([self.lo[rows], self.hi[rows]])
        vertices = vertices[np.argsort(border_of_vertex[vertices], kind="stable")]
        borders, first, n_vertex = np.unique(
            border_of_vertex[vertices], return_index=True, return_counts=True
        )
        points = self.vertices[vertices]
        low, high = (of.reduceat(points, first) for of in (np.minimum, np.maximum))
        middle = np.add.reduceat(points, first) / n_vertex[:, None]
        size = norm(high - low)
        n_edge = np.bincount(border_of_vertex[self.lo[rows]])[borders]
        listed = named(
            np.argsort(-size, kind="stable").tolist(),
            lambda k: (
                f"around {point_text(middle[k])}, {size[k]:.4g} mm across, with {n_edge[k]} edges"
            ),
        )
        return f"{'a hole' if len(borders) == 1 else f'{len(borders)} holes'} {listed}"

    def _segments(self, rows: Ints) -> str:
        return self._pairs(np.column_stack([self.lo[rows], self.hi[rows]]))

    def _pairs(self, segments: Ints) -> str:
        return named(
            f"{point_text(self.vertices[i])} to {point_text(self.vertices[j])}"
            if i >= 0 and j >= 0
            else "with a vertex that no triangle uses"
            for i, j in segments
        )


def merge_vertices(
    vertices: Floats, triangles: Ints, edges: Ints | None, tolerance: float | None = None
) -> tuple[Floats, Ints, Ints | None]:
    """Return vertices, triangles and edges with coinciding vertices merged.

    The first of them is kept, unused ones are dropped (id -1 in edges). Those closer than the
    tolerance coincide, by default :data:`MERGE_TOLERANCE` of the diagonal.
    """
    if tolerance is None:
        tolerance = MERGE_TOLERANCE * float(norm(np.ptp(vertices, axis=0)))
    place = close_parts(vertices, tolerance)
    _, first = np.unique(place, return_index=True)
    used = np.zeros(first.size, dtype=bool)
    used[place[triangles]] = True
    new_id = np.where(used, np.cumsum(used) - 1, -1)
    merged = np.ascontiguousarray(vertices[first][used])
    return merged, new_id[place[triangles]], None if edges is None else new_id[place[edges]]


def normals_and_heights(vertices: Floats, triangles: Ints) -> tuple[Floats, Floats]:
    """Return unit normals, zero where degenerate, and least heights over longest edges."""
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


def six_volumes(vertices: Floats, triangles: Ints) -> Floats:
    """Return six times the signed volume between each triangle and the mean vertex."""
    a, b, c = (vertices[triangles[:, k]] - vertices.mean(axis=0) for k in range(3))
    return np.asarray(np.einsum("ij,ij->i", a, np.cross(b, c)))


def _next_corner(half_edges: Ints) -> Ints:
    return np.asarray(half_edges + 1 - 3 * (half_edges % 3 == 2))


def chains_of(segments: Ints) -> tuple[Ints, Ints]:
    """Return segments ordered by chain, and the chain of each.

    A chain ends at a vertex unless exactly two segments meet there. It keeps the given direction of
    its first segment; chains are numbered in the order of these.
    """
    at_vertex: dict[int, list[int]] = {}
    for e, ends in enumerate(segments.tolist()):
        for vertex in ends:
            at_vertex.setdefault(vertex, []).append(e)
    left = set(range(len(segments)))  # in no chain yet

    def walk(vertex: int) -> Iterator[tuple[int, int]]:
        # the segments that continue a chain from a vertex on, each from the end that is met first
        while len(at_vertex[vertex]) == 2 and (following := left.intersection(at_vertex[vertex])):
            left.difference_update(following)
            (e,) = following  # the other one is in the chain
            i, j = segments[e].tolist()
            far = j if i == vertex else i
            yield vertex, far
            vertex = far

    chains: list[list[tuple[int, int]]] = []
    for seed, (tail, head) in enumerate(segments.tolist()):
        if seed in left:
            left.remove(seed)
            after = list(walk(head))
            before = [(far, near) for near, far in walk(tail)]
            chains.append([*before[::-1], (tail, head), *after])
    ordered = [link for links in chains for link in links]
    number = [k for k, links in enumerate(chains) for _ in links]
    return np.array(ordered, dtype=np.int64).reshape(-1, 2), np.array(number, dtype=np.int64)


def rows_of(chain: Ints) -> list[Ints]:
    """Return the rows of each chain, ascending.

    Examples
    --------
    >>> [rows.tolist() for rows in rows_of(np.array([0, 1, 1, 0]))]
    [[0, 3], [1, 2]]
    """
    n = np.bincount(chain)
    return np.split(np.argsort(chain, kind="stable"), np.cumsum(n)[:-1]) if len(n) else []


class ChainLinks(NamedTuple):
    """Pairs of chains whose flanks meet on a smooth surface, the closest pair first."""

    first: Ints
    """Chain, shape (n,)."""
    second: Ints
    """The other, shape (n,)."""
    sign: SmallInts
    """+1 where they meet with the same side, -1 with opposite sides, shape (n,)."""

    def alike(self, n_chain: int) -> tuple[SmallInts, Ints]:
        """Return -1 for chains to reverse, so that those that meet have the same side there.

        And the first of the chains with which each is connected, which is not reversed. If that
        cannot be had for all pairs, as on three edges around a spike, it holds for the closest.
        """
        turned, group = np.ones(n_chain, np.int8), np.arange(n_chain)
        for a, b, sign in zip(*map(np.ndarray.tolist, self), strict=True):
            low, high = sorted((int(group[a]), int(group[b])))
            if low != high:
                turned[group == high] *= turned[a] * turned[b] * sign
                group[group == high] = low
        return turned, group

    def disagree(self, turned: SmallInts) -> Bools:
        """Return at which pairs opposite sides meet if some chains are reversed, (n,)."""
        return np.asarray(turned[self.first] * turned[self.second] * self.sign < 0)


def facing_alike(
    segments: Ints, chain: Ints, body: Ints, normal: Floats, links: ChainLinks
) -> Ints:
    """Return segments with chains reversed so that flanks that meet are on the same side.

    Of chains whose flanks do not meet, those that face opposite to the first of their body.
    """
    turned, group = links.alike(int(chain.max(initial=-1)) + 1)
    facing: dict[int, Floats] = {}
    rows = rows_of(chain)
    for k, mine in enumerate(rows):
        mean = normal[mine].sum(axis=0)
        first = facing.setdefault(int(body[mine][0]), mean)
        if group[k] == k and float(product(mean, first)) < 0.0:
            turned[group == k] *= -1
    reversed_rows = [mine for k, mine in enumerate(rows) if turned[k] < 0]
    out = segments.copy()
    for mine in reversed_rows:
        out[mine] = segments[mine][::-1, ::-1]
    return out
