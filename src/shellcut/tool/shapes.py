"""Tools built from parameters: a ring of teeth, a straight blade and a blunt round bar.

The first two are wedges: a section parallel to the sheet widens from the cutting edge with the
half-angle a to the half thickness w and continues with parallel flanks,

    half width(d) = min(d tan a, w),    d = distance behind the edge along the motion,

and the cutting edge rises forward at an angle eta to the sheet. Seen along the edge the wedge is
blunter, tan(a_edge) = tan(a) / sin(eta); a_edge is kept below 40° so that the angle between them
tells flanks, top and bottom apart.

A tooth in its straight coordinates, s forward along the motion and z up::

        B ----------- F        F: top of the cutting edge      B: top of the back
        |            /
        |           /  eta     d-lines run parallel to the edge T F; the mesh of each flank is
        K          /           the strips between neighbouring d-lines
          `-.     /
       relief `- T             T: tip at s = 0, z = tip_clearance      K: end of the relief
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from math import atan, ceil, cos, degrees, pi, radians, sin, sqrt, tan
from typing import Annotated, TypeAlias

import numpy as np

from shellcut.arguments import Option, checked
from shellcut.arrays import Floats, Ints, each, product

from .rounded_edge import EdgeRadius, with_edge_radius
from .tool import Tool, ToolError

EDGE_DEVIATION = 1.0 / 350.0
"""Largest distance of a chord of the cutting edge from its cylinder, over the half thickness of the
tooth (1e-3 mm for the default): a cut beside the line of quad sides costs energy (0.02 mm on sides
of 0.4 mm: 3.5 %), and sides of the quads of a film to be cut are of the order of its thickness."""

DEFAULT_DEVIATION = 1.0 / 700.0
"""Target for this distance, likewise, if the number of segments is not given."""

BLUNTEST_EDGE = 40.0
"""Largest half-angle of the wedge seen along the edge [deg]."""

FLANK_MARGIN = 5.0
"""A flank may turn by the half-angle plus this [deg]; facets of a cylinder turn by less."""

LONGEST_TRIANGLE = 8.0 / 7.0
"""Longest cutting segment of a tooth over its half thickness (0.4 mm for the default): keeps the
lists of the contact grid short, whose cells are a third of the thickness."""

MOST_TRIANGLES = 1_000_000
"""Most triangles of a ring; the default one has 4,112."""

Triangle: TypeAlias = tuple[int, int, int]
HalfAngle: TypeAlias = Annotated[
    float,
    Option("deg", "of the wedge, in the section parallel to the film", above=0, most=BLUNTEST_EDGE),
]
HalfThickness: TypeAlias = Annotated[
    float, Option("mm", "half the distance of the parallel flanks", above=0)
]
Diameter: TypeAlias = Annotated[float, Option("mm", "diameter of the bar", above=0)]
Tilt: TypeAlias = Annotated[
    float,
    Option("deg", "from the vertical to its axis; the top leans forward", above=-60, below=60),
]


@checked
def tooth_ring(
    *,
    n_teeth: Annotated[int, Option("", "number of teeth", least=1)] = 4,
    radius: Annotated[float, Option("mm", "radius of the cutting circle", above=0)] = 9.4,
    edge_inclination_deg: Annotated[
        float, Option("deg", "inclination of the cutting edge; it rises forward", above=0, most=90)
    ] = 60.0,
    wedge_half_angle_deg: HalfAngle = 12.0,
    half_thickness: HalfThickness = 0.35,
    length: Annotated[
        float, Option("mm", "length from the tip to the vertical back, along the arc", above=0)
    ] = 1.5,
    relief_deg: Annotated[
        float, Option("deg", "rise of the bottom from the tip backwards", least=0, below=90)
    ] = 30.0,
    height: Annotated[float, Option("mm", "height from the tip to the top", above=0)] = 5.0,
    tip_clearance: Annotated[float, Option("mm", "of the tip above the film at the start")] = 0.02,
    phase_deg: Annotated[float, Option("deg", "angle of the first tip")] = 0.0,
    edge_radius: EdgeRadius = 0.0,
    n_arc: Annotated[
        int | None,
        Option(
            "", "segments of each cutting edge", unset="1/700 of half_thickness off the cylinder"
        ),
    ] = None,
) -> Tool:
    """Return a ring of equal teeth around the z axis that cuts the circle r = ``radius``.

    Body frame = world frame at the start: the sheet is z = 0, the teeth move counter-clockwise
    seen from +z, and downwards. Plus is outside (r > ``radius``); the cutting edges run from the
    tip up, tooth k has its tip at the angle ``phase_deg`` + 360 k / ``n_teeth``. A tooth is
    described in straight coordinates and wrapped on the cylinder, angle = s / radius and
    r = radius + n, so that the vertices of the cutting edge lie exactly on it.

    The rounded edge lies where the sharp one would. If chords of the edge deviate from the cylinder
    by more than 1/350 of the half thickness, ``n_arc`` is refused; by default its segments stay
    below 8/7 of the half thickness too.

    Returns
    -------
    Tool
        With one body and one chain of cutting segments per tooth.

    Raises
    ------
    ToolError
        If teeth overlap, or parameters do not fit each other.

    Examples
    --------
    >>> ring = tooth_ring(n_teeth=2)
    >>> ring.n_body, ring.n_chain
    (2, 2)
    """
    problems = _angle_problems(edge_inclination_deg, wedge_half_angle_deg, "edge_inclination_deg")
    if (rise := length * tan(radians(relief_deg))) >= height:
        problems.append(
            f"the relief rises by length * tan(relief_deg) = {rise:.4g} mm, above height = "
            f"{height:g} mm: shorten the tooth or lower relief_deg"
        )
    if half_thickness >= radius:
        problems.append(f"half_thickness = {half_thickness:g} must be below radius = {radius:g}")
    if problems:
        raise _refused(*problems)
    tooth = Tooth(
        eta=radians(edge_inclination_deg),
        slope=tan(radians(wedge_half_angle_deg)),
        half_thickness=half_thickness,
        length=length,
        relief=radians(relief_deg),
        height=height,
    )
    n_arc, spacing = _arc_pieces(tooth, n_teeth, radius, n_arc)
    straight, strips, line = tooth.mesh(n_arc, spacing)
    triangles, edges = np.array(strips), np.array(line)
    flank_angle = _edge_half_angle(edge_inclination_deg, wedge_half_angle_deg) + FLANK_MARGIN
    if edge_radius != 0.0:
        mirror = np.array([1.0, -1.0, 1.0])  # (s, n, z) is left-handed
        tooth_tool = Tool.from_triangles(
            mirror * straight, triangles, edges=edges, flank_angle_deg=flank_angle
        )
        tooth_tool = with_edge_radius(tooth_tool, edge_radius)
        straight = mirror * tooth_tool.vertices - [_ahead_of_nose(tooth_tool, tooth.cot), 0.0, 0.0]
        triangles, edges = tooth_tool.triangles, tooth_tool.edges
    phases = radians(phase_deg) + 2.0 * pi * np.arange(n_teeth) / n_teeth
    s, n, z = (straight + np.array([0.0, 0.0, tip_clearance])).T
    angle, out = phases[:, None] + s / radius, radius + n
    around = out * each(cos, angle), out * each(sin, angle), np.broadcast_to(z, angle.shape)
    vertices = np.stack(around, axis=-1)  # of all teeth, (n_teeth, n, 3)
    offsets = straight.shape[0] * np.arange(n_teeth)[:, None, None]
    ring = Tool.from_triangles(
        vertices.reshape(-1, 3),
        (triangles + offsets).reshape(-1, 3),
        edges=(edges + offsets).reshape(-1, 2),
        flank_angle_deg=flank_angle,
        name="tooth ring",
    )
    return replace(ring, edge_radius=edge_radius)


def _ahead_of_nose(tool: Tool, cot: float) -> float:
    """Return the place at height 0 of an edge that rises by 1 over ``cot`` along x [mm]."""
    x, _, z = tool.vertices[tool.edges[0, 0]]
    return float(x - z * cot)


def _arc_pieces(tooth: Tooth, n_teeth: int, radius: float, n_arc: int | None) -> tuple[int, float]:
    """Return the segments of each cutting edge, and the distance of the d-lines [mm].

    ToolError if teeth overlap, or the segments are too few or too many.
    """
    span = (tooth.forward + tooth.length) / radius
    if span * n_teeth >= 2.0 * pi:
        raise _refused(
            f"{n_teeth} teeth overlap: each takes {degrees(span):.1f} of {360.0 / n_teeth:.1f} "
            "degrees; use fewer or shorter teeth, a steeper edge or a larger radius"
        )
    farthest = EDGE_DEVIATION * tooth.half_thickness
    aimed_at = DEFAULT_DEVIATION * tooth.half_thickness
    least = max(1, ceil(tooth.forward / sqrt(8.0 * radius * farthest)))
    spacing = min(sqrt(8.0 * radius * aimed_at), radius * radians(0.5 * FLANK_MARGIN))
    if n_arc is None:
        longest = LONGEST_TRIANGLE * tooth.half_thickness
        n_arc = max(ceil(tooth.forward / spacing), ceil(tooth.height / sin(tooth.eta) / longest))
    elif n_arc < least:
        raise _refused(
            f"n_arc = {n_arc} leaves the cutting edge {farthest:.4g} mm or more beside the "
            f"cylinder: use at least {least}"
        )
    # two sides, each with strips between d-lines of at most n_arc pieces
    n_triangle = 4.0 * n_teeth * n_arc * ((tooth.length + tooth.forward) / spacing + 3.0)
    if not n_triangle <= MOST_TRIANGLES:
        raise _refused(
            f"{n_teeth} teeth with n_arc = {n_arc:g} would have about {n_triangle:.2g} triangles, "
            f"{MOST_TRIANGLES:,} at most: lower n_arc, the height or the length, enlarge the radius"
        )
    return n_arc, spacing


def _refused(*problems: str) -> ToolError:
    return ToolError([*problems], what="tooth ring")


@checked
def straight_blade(
    *,
    edge_angle_deg: Annotated[
        float,
        Option("deg", "inclination of the edge; below 90 it rises forward", above=0, most=90),
    ] = 90.0,
    wedge_half_angle_deg: HalfAngle = 10.0,
    half_thickness: HalfThickness = 0.3,
    length: Annotated[
        float, Option("mm", "from the edge to the back; a longer wedge is cut off there", above=0)
    ] = 3.0,
    height: Annotated[float, Option("mm", "height from the bottom to the top", above=0)] = 6.0,
    edge_radius: EdgeRadius = 0.0,
) -> Tool:
    """Return a blade that moves along +x in the plane y = 0 and cuts the sheet z = 0.

    Body frame = world frame at the start: the cutting edge runs through the origin and from
    z = height/2 down to -height/2, so that plus is y > 0. Each section parallel to the sheet is
    the same, shifted along the edge: the back is parallel to the edge.

    The rounded edge, too, runs through the origin.

    Returns
    -------
    Tool
        With one body and one cutting segment.

    Raises
    ------
    ToolError
        If the wedge is too blunt along its edge.
    """
    problems = _angle_problems(edge_angle_deg, wedge_half_angle_deg, "edge_angle_deg")
    if problems:
        raise ToolError(problems, what="straight blade")

    slope = tan(radians(wedge_half_angle_deg))
    shoulder = half_thickness / slope
    behind = [0.0, shoulder, length] if shoulder < length else [0.0, length]
    # section counter-clockwise seen from above: edge, plus side to the back, minus side to the edge
    section = [(-d, min(slope * d, half_thickness)) for d in behind]
    section += [(x, -y) for x, y in section[:0:-1]]
    n = len(section)
    shift = 0.5 * height / tan(radians(edge_angle_deg))
    low = [(x - shift, y, -0.5 * height) for x, y in section]
    high = [(x + shift, y, 0.5 * height) for x, y in section]
    triangles = []
    for i in range(n):
        j = (i + 1) % n
        triangles += [(i, j, n + j), (i, n + j, n + i)]
    caps = [(0, 1, n - 1)] + ([(1, 2, 3), (1, 3, 4)] if n == 5 else [])
    triangles += [(k, j, i) for i, j, k in caps]
    triangles += [(n + i, n + j, n + k) for i, j, k in caps]
    blade = Tool.from_triangles(
        np.array(low + high),
        np.array(triangles),
        edges=[(n, 0)],
        flank_angle_deg=_edge_half_angle(edge_angle_deg, wedge_half_angle_deg) + FLANK_MARGIN,
        name="straight blade",
    )
    if edge_radius == 0.0:
        return blade
    blunt = with_edge_radius(blade, edge_radius)
    return blunt.translated((-_ahead_of_nose(blunt, 2.0 * shift / height), 0.0, 0.0))


def _edge_half_angle(inclination_deg: float, half_angle_deg: float) -> float:
    # half-angle of the wedge in the plane normal to its edge [deg]
    return degrees(atan(tan(radians(half_angle_deg)) / sin(radians(inclination_deg))))


def _angle_problems(inclination_deg: float, half_angle_deg: float, name: str) -> list[str]:
    seen = _edge_half_angle(inclination_deg, half_angle_deg)
    if seen <= BLUNTEST_EDGE * (1.0 + 1e-12):
        return []
    return [
        f"wedge_half_angle_deg = {half_angle_deg:g} is {seen:.1f} seen along an edge at "
        f"{name} = {inclination_deg:g}, above {BLUNTEST_EDGE:g}: sharpen the wedge or raise the "
        "edge"
    ]


@checked
def round_bar(
    *,
    diameter: Diameter = 6.0,
    height: Annotated[float, Option("mm", "along the axis; the sheet is halfway", above=0)] = 48.0,
    tilt_deg: Tilt = 10.0,
    n_around: Annotated[int, Option("", "facets around it", least=12)] = 72,
) -> Tool:
    """Return a round bar that moves along +x through the sheet z = 0; it cuts nothing.

    Its foremost point in the sheet is the origin. Its axis leans forward with its top, so that it
    presses the film beside its crack down.

    Returns
    -------
    Tool
        With one body and no cutting edge.

    Examples
    --------
    >>> round_bar(diameter=4.0).n_edge
    0
    """
    corners, triangles = _upright(0.5 * diameter, height, n_around)
    c, s = cos(radians(tilt_deg)), sin(radians(tilt_deg))
    leaning = product(corners, np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]]).T)
    return Tool.from_triangles(
        leaning - [0.5 * diameter / c, 0.0, 0.0],
        triangles,
        edges=np.zeros((0, 2), np.int64),
        name="round bar",
    )


def _upright(radius: float, height: float, n: int) -> tuple[Floats, Ints]:
    """Return corners (n_vertex, 3) and triangles (n_triangle, 3) of a bar along z."""
    angle = 2.0 * np.pi * np.arange(n) / n
    ring = radius * np.stack([each(cos, angle), each(sin, angle)], axis=1)
    levels = np.linspace(-0.5 * height, 0.5 * height, max(2, round(3.0 * height / radius)) + 1)
    rows = [np.column_stack([ring, np.full(n, z)]) for z in levels]
    ends = np.array([[0.0, 0.0, levels[0]], [0.0, 0.0, levels[-1]]])
    here, there = np.arange(n), np.roll(np.arange(n), -1)
    faces = []
    for k in range(len(levels) - 1):
        a, b = k * n + here, k * n + there
        faces += [np.stack([a, b, b + n], axis=1), np.stack([a, b + n, a + n], axis=1)]
    bottom = np.full(n, len(levels) * n)
    top = (len(levels) - 1) * n
    faces.append(np.stack([bottom, there, here], axis=1))
    faces.append(np.stack([bottom + 1, top + here, top + there], axis=1))
    return np.concatenate([*rows, ends]), np.concatenate(faces)


# --- a tooth --------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Tooth:
    """A tooth in straight coordinates (s, n, z), the tip at the origin; the picture is above."""

    eta: float  # inclination of the cutting edge [rad]
    slope: float  # of the half width over d
    half_thickness: float  # [mm]
    length: float  # [mm]
    relief: float  # [rad]
    height: float  # [mm]

    @property
    def forward(self) -> float:
        """From the tip to the top of the edge, along s [mm]."""
        return self.height / tan(self.eta)

    @property
    def cot(self) -> float:
        """Cotangent of the inclination of the edge."""
        return cos(self.eta) / sin(self.eta)

    @property
    def d_corner(self) -> float:
        """Distance of K behind the edge [mm]."""
        return self.length * (1.0 + tan(self.relief) * self.cot)

    def mesh(
        self, n_edge: int, spacing: float
    ) -> tuple[Floats, list[Triangle], list[tuple[int, int]]]:
        """Return vertices (s, n, z), triangles with outward normals, and the cutting edge."""
        points: list[tuple[float, float, float]] = []
        plus_lines: list[list[int]] = []
        minus_lines: list[list[int]] = []
        for d in self._stations(spacing):
            levels = self._levels(d, n_edge)
            half_width = min(self.slope * d, self.half_thickness)
            plus_lines.append(list(range(len(points), len(points) + len(levels))))
            points += [(z * self.cot - d, half_width, z) for z in levels]
            if d == 0.0:
                minus_lines.append(plus_lines[-1])
                continue
            minus_lines.append(list(range(len(points), len(points) + len(levels))))
            points += [(z * self.cot - d, -half_width, z) for z in levels]

        triangles: list[Triangle] = []
        for plus, minus in zip(pairwise(plus_lines), pairwise(minus_lines), strict=True):
            triangles += _strip(points, *plus)
            triangles += [(a, c, b) for a, b, c in _strip(points, *minus)]
        triangles += _walls(plus_lines, minus_lines)
        return np.array(points), triangles, list(pairwise(plus_lines[0]))

    def _stations(self, spacing: float) -> list[float]:
        # d of the d-lines, corners among them
        d_back = self.length + self.height * self.cot  # of B
        d_shoulder = self.half_thickness / self.slope
        stations = [0.0]
        for d in sorted({self.d_corner, d_back, *((d_shoulder,) if d_shoulder < d_back else ())}):
            # K and B share their d-line when the edge is vertical
            if d - stations[-1] > 1e-9 * d_back:
                count = ceil((d - stations[-1]) / spacing)
                stations += np.linspace(stations[-1], d, count + 1)[1:].tolist()
        return stations

    def _levels(self, d: float, n_edge: int) -> list[float]:
        # z of the vertices on a d-line, from low to high
        height = self.height
        if d <= self.d_corner * (1.0 + 1e-12):
            low = d * tan(self.relief) / (1.0 + self.cot * tan(self.relief))
        else:
            low = min((d - self.length) / self.cot, height)
        count = max(1, round((height - low) * n_edge / height))
        if height - low < 1e-9 * height:
            count = 0
        return [height - (height - low) * (1.0 - i / count) for i in range(count)] + [height]


def _walls(plus_lines: list[list[int]], minus_lines: list[list[int]]) -> list[Triangle]:
    # Between the two sides: below and behind (lower ends of the d-lines, then up the last one), and
    # on top (their upper ends).
    both = list(zip(plus_lines, minus_lines, strict=True))
    lower = [(p[0], m[0]) for p, m in both]
    lower += zip(plus_lines[-1][1:], minus_lines[-1][1:], strict=True)
    upper = [(p[-1], m[-1]) for p, m in both]
    walls = []
    for (p, m), (p_next, m_next) in pairwise(lower):
        walls += [(p, p_next, m_next), (p, m_next, m)]
    for (p, m), (p_next, m_next) in pairwise(upper):
        walls += [(p_next, p, m), (p_next, m, m_next)]
    return [(a, b, c) for a, b, c in walls if a != b and b != c and c != a]


def _strip(
    points: list[tuple[float, float, float]], right: list[int], left: list[int]
) -> list[Triangle]:
    # Join two neighbouring d-lines, both from low to high, by the shorter diagonal; the triangles
    # are counter-clockwise with s to the right and z up, which is outward on the plus side.
    def squared(i: int, j: int) -> float:
        (a, b, c), (d, e, f) = points[i], points[j]
        return (a - d) ** 2 + (b - e) ** 2 + (c - f) ** 2

    triangles = []
    a = b = 0
    while a + 1 < len(right) or b + 1 < len(left):
        climb_right = b + 1 == len(left) or (
            a + 1 < len(right) and squared(left[b], right[a + 1]) <= squared(left[b + 1], right[a])
        )
        if climb_right:
            triangles.append((left[b], right[a], right[a + 1]))
            a += 1
        else:
            triangles.append((left[b], right[a], left[b + 1]))
            b += 1
    return triangles
