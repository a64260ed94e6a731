"""A single tooth in its straight coordinates: its points, and the strips of its sides.

The picture of :mod:`shellcut.tool.shapes` shows the names of its points.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from math import ceil, cos, sin, tan
from typing import TypeAlias

import numpy as np

from shellcut.arrays import Floats

Triangle: TypeAlias = tuple[int, int, int]


@dataclass(frozen=True)
class Tooth:
    """In straight coordinates (s, n, z), with the tip at the origin."""

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
        """Of the inclination of the edge."""
        return cos(self.eta) / sin(self.eta)

    @property
    def d_corner(self) -> float:
        """Of K, behind the edge [mm]."""
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
