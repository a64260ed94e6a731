r"""A cutting edge with a radius: the wedge behind the edge rounded by an inscribed cylinder.

Seen along the edge the wedge has the half-angle a; z is the depth behind the sharp edge and y the
distance from the mid-plane. The cylinder of radius r that touches both flanks has

    its axis at z_c = r / sin a,  its nose at z_n = z_c - r,  and leaves them at z_T = z_c cos² a.

The flanks, and with them the thickness, stay as they are behind z_T; the edge moves back by z_n, as
in grinding. (The tool grown by r on all sides would be thicker than its drawing, and its wedge
would stand r / sin a - r before the round.) The surface is cut along lines of equal depth, and what
lies before z_T is moved on to the round,

    z' = z_n + (z_T - z_n) z/z_T,    y' = y W(z') / (z tan a),    W(z') = sqrt(r² - (z_c - z')²),

end faces between the flanks with it. The nose line is the cutting edge of the rounded tool; the
facets of the round belong to the flanks. So contact and the search for joints work as on a sharp
edge, and only the cables must know of r, which bend around the cylinder itself, not its facets
(:mod:`shellcut.cables.around_edge`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import asin, cos, isfinite, tan
from typing import Annotated, TypeAlias

import numpy as np

from shellcut.arguments import Option, checked
from shellcut.arrays import Bools, Floats, Ints, each, norm, off_segments, unit

from .tool import Tool, ToolError

_FACET = np.radians(10.0)  # turn from facet to facet, about

# A flank may leave the plane of its wedge by this part of its distance from the mid-plane: those of
# a tooth are wrapped on a cylinder.
_UNEVEN = 0.15

# An end face may lean along the edge by this many depths.
_LEANING = 4.0

# Least radius over the tool's diagonal: the surface merges what is closer than a hundredth of that.
_LEAST = 1e-5

_ON_LEVEL = 1e-9

EdgeRadius: TypeAlias = Annotated[float, Option("mm", "of the cutting edges; 0: as they are")]


@checked
def with_edge_radius(tool: Tool, radius: float) -> Tool:
    """Return a tool with all its cutting edges rounded by a radius [mm]; 0 leaves them sharp.

    The cutting edges of the rounded tool are the nose lines, its ``edge_radius`` is the radius. The
    round must fit between plane flanks.

    Examples
    --------
    >>> from shellcut.tool.shapes import straight_blade
    >>> blunt = with_edge_radius(straight_blade(), 0.05)
    >>> blunt.edge_radius, round(float(blunt.vertices[blunt.edges].max(axis=(0, 1))[0]), 4)
    (0.05, -0.2379)
    """
    _check(tool, radius)
    if radius == 0.0:
        return tool
    wedges = [(body, _Wedge.of(tool, body, radius)) for body in np.unique(tool.edge_body)]
    depth = np.full(tool.n_vertex, np.inf)
    for body, wedge in wedges:
        mine = np.unique(tool.triangles[tool.triangle_body == body])
        depth[mine] = wedge.depths(tool.vertices[mine])
    half_angle = _half_angles(tool)
    levels = _levels(float(half_angle.min()), float(half_angle.mean()))
    vertices, triangles, depth, parent = _cut(tool.vertices, tool.triangles, depth, levels)
    moved, worst = vertices.copy(), 1.0
    body_of, on_flank = np.zeros(len(vertices), np.int64), np.zeros(len(vertices), np.bool_)
    body_of[triangles] = tool.triangle_body[parent][:, None]
    on_flank[triangles[tool.flank[parent] != 0]] = True
    for body, wedge in wedges:
        zone = np.flatnonzero((body_of == body) & (depth < 1.0 - _ON_LEVEL))
        moved[zone], fits = wedge.rounded(vertices[zone], on_flank[zone])
        worst = min(worst, float(depth[zone][~fits].min(initial=1.0)))
    if worst < 1.0:
        why = (
            f"edge_radius = {radius:g} mm does not fit the tool: the round must lie between "
            f"plane flanks, which is so up to about {worst * radius:.3g} mm"
        )
        raise ToolError([why], what="rounded tool")
    rounded = Tool.from_triangles(
        moved,
        triangles,
        edges=tool.edges,
        flank_angle_deg=tool.flank_angle_deg,
        name=tool.name,
    )
    return replace(rounded, edge_radius=radius)


def _check(tool: Tool, radius: float) -> None:
    problems = []
    if not (isfinite(radius) and radius >= 0.0):
        problems.append(f"edge_radius must be a length in mm, 0 for a sharp edge, got {radius!r}")
    elif 0.0 < radius < _LEAST * (size := float(norm(np.ptp(tool.vertices, axis=0)))):
        problems.append(
            f"edge_radius must be at least {_LEAST * size:.2g} mm in a tool of {size:.4g} mm, so "
            f"that the facets of the round stay distinct, got {radius:g} mm; for a sharp edge "
            "take 0"
        )
    elif radius and not tool.n_edge:
        problems.append(f"edge_radius = {radius:g} mm needs a cutting edge, and this tool has none")
    if tool.edge_radius:
        problems.append(f"the edge is rounded already, by {tool.edge_radius:g} mm")
    if problems:
        raise ToolError(problems, what="rounded tool")


def _half_angles(tool: Tool) -> Floats:
    """Return half the angle between the flanks at each segment, shape (n_edge,) [rad]."""
    forward = -np.einsum("ic,ic->i", tool.triangle_normals[tool.edge_flank_plus], tool.edge_back)
    return each(asin, np.clip(forward, -1.0, 1.0))


def _levels(sharpest: float, half_angle: float) -> list[float]:
    """Return the depths over z_T at which facets that turn by equal angles end, the last one 1."""
    n = int(np.ceil((0.5 * np.pi - sharpest) / _FACET))
    turns = (0.5 * np.pi - half_angle) * np.arange(1, n + 1) / n
    whole = 1.0 - cos(turns[-1])
    levels: list[float] = ((1.0 - each(cos, turns)) / whole).tolist()
    return levels


@dataclass(frozen=True)
class _Wedge:
    """The wedge behind the edges of a body, with its inscribed cylinder."""

    start: Floats
    vector: Floats
    frames: Floats
    """b, k and tan a at the start and the end of each segment, shape (n_edge, 2, 7)."""
    radius: float

    @classmethod
    def of(cls, tool: Tool, body: int, radius: float) -> _Wedge:
        """Collect the edges of a body."""
        rows = np.flatnonzero(tool.edge_body == body)
        slope = each(tan, _half_angles(tool))
        own = np.column_stack([tool.edge_normal, tool.edge_back, slope])
        at_vertex = np.zeros((tool.n_vertex, 7))
        np.add.at(at_vertex, tool.edges.ravel(), np.repeat(own, 2, axis=0))
        count = np.bincount(tool.edges.ravel(), minlength=tool.n_vertex)
        at_vertex /= np.maximum(count, 1)[:, None]
        frames = at_vertex[tool.edges[rows]]
        for part in (slice(0, 3), slice(3, 6)):
            frames[..., part] = unit(frames[..., part])
        ends = tool.vertices[tool.edges[rows]]
        return cls(ends[:, 0], ends[:, 1] - ends[:, 0], frames, radius)

    def _seen(self, points: Floats) -> tuple[Floats, Floats, Floats, Floats, Floats, Floats]:
        """Return y, z, tan a, distance along the edge beyond its ends, b and k at points."""
        gap, share = off_segments(points[:, None], self.start, self.vector)
        k = np.argmin(np.einsum("pic,pic->pi", gap, gap), axis=1)
        rows = np.arange(len(points))
        share, gap = share[rows, k, None], gap[rows, k]
        frame = (1.0 - share) * self.frames[k, 0] + share * self.frames[k, 1]
        b, back, slope = frame[:, 0:3], frame[:, 3:6], frame[:, 6]
        y, z = np.einsum("pc,pc->p", gap, b), np.einsum("pc,pc->p", gap, back)
        beyond = np.linalg.norm(gap - y[:, None] * b - z[:, None] * back, axis=1)
        return y, z, slope, beyond, b, back

    def depths(self, points: Floats) -> Floats:
        """Return the depth of points over z_T, infinite outside the wedge, shape (n,)."""
        y, z, slope, beyond, _, _ = self._seen(points)
        close = 1e-9 * float(np.abs(points).max())
        within = (np.abs(y) <= (1.0 + _UNEVEN) * z * slope + close) & (z >= -close)
        within &= beyond <= _LEANING * np.maximum(z, 0.0) + close
        # 1 / z_T = sin a / (r cos² a) = tan a sqrt(1 + tan² a) / r
        depth = z * slope * np.sqrt(1.0 + slope * slope) / self.radius
        return np.where(within, np.maximum(depth, 0.0), 2.0)

    def rounded(self, points: Floats, on_flank: Bools) -> tuple[Floats, Bools]:
        """Return points of the wedge before z_T on the round, and which of them do fit there."""
        y, z, slope, beyond, b, back = self._seen(points)
        half_width = np.maximum(z, 0.0) * slope
        close = 1e-9 * float(np.abs(points).max())
        fits = np.abs(y) <= (1.0 + _UNEVEN) * half_width + close
        fits &= beyond <= _LEANING * np.maximum(z, 0.0) + close
        fits &= ~on_flank | (np.abs(y) >= (1.0 - _UNEVEN) * half_width - close)
        sine = slope / np.sqrt(1.0 + slope * slope)
        axis = self.radius / sine
        nose, leaves = axis - self.radius, axis * (1.0 - sine * sine)
        new_z = nose + (leaves - nose) * z / leaves
        width = np.sqrt(np.maximum(self.radius**2 - (axis - new_z) ** 2, 0.0))
        sharp = half_width <= close
        new_y = np.where(sharp, 0.0, y * width / np.where(sharp, 1.0, half_width))
        return points + (new_y - y)[:, None] * b + (new_z - z)[:, None] * back, fits


def _cut(
    vertices: Floats, triangles: Ints, depth: Floats, levels: list[float]
) -> tuple[Floats, Ints, Floats, Ints]:
    """Return the surface cut along lines of equal depth, with the depths and parent triangles."""
    points, depths = vertices.tolist(), depth.tolist()
    rows = [(*corners, t) for t, corners in enumerate(triangles.tolist())]
    for level in levels:
        line = _Line(level, points, depths)
        rows = [part for row in rows for part in line.parts(*row)]
    table = np.array(rows, dtype=np.int64)
    return np.array(points), table[:, :3], np.array(depths), table[:, 3]


class _Line:
    """A line of equal depth that cuts triangles; appends its points."""

    def __init__(self, level: float, points: list[list[float]], depths: list[float]) -> None:
        self._level, self._points, self._depths = level, points, depths
        self._on_edge: dict[tuple[int, int], int] = {}

    def parts(self, a: int, b: int, c: int, t: int) -> Iterator[tuple[int, int, int, int]]:
        """Yield the parts of triangle t with corners a, b, c."""
        sides = [self._side(i) for i in (a, b, c)]
        if not (1 in sides and -1 in sides):
            yield a, b, c, t
            return
        # Turn the corners so that the first one is on the line, or alone on its side of it.
        first = sides.index(0) if 0 in sides else sides.index(-sum(sides))
        a, b, c = ((a, b, c) * 2)[first : first + 3]
        if 0 in sides:
            p = self._crossing(b, c)
            yield from ((a, b, p, t), (a, p, c, t))
        else:
            p, q = self._crossing(a, b), self._crossing(a, c)
            yield from ((a, p, q, t), (p, b, c, t), (p, c, q, t))

    def _side(self, vertex: int) -> int:
        beyond = self._depths[vertex] - self._level
        return 0 if abs(beyond) < _ON_LEVEL else (1 if beyond > 0.0 else -1)

    def _crossing(self, i: int, j: int) -> int:
        lo, hi = key = (min(i, j), max(i, j))
        if key not in self._on_edge:
            depths, points = self._depths, self._points
            s = (self._level - depths[lo]) / (depths[hi] - depths[lo])
            self._on_edge[key] = len(points)
            ends = zip(points[lo], points[hi], strict=True)
            points.append([(1.0 - s) * p + s * q for p, q in ends])
            depths.append(self._level)
        return self._on_edge[key]
