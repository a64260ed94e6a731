"""Closed polygons in the plane: area, what lies within them, and where they meet, by shapely."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

import numpy as np

from shellcut.arrays import Bools, Floats, product
from shellcut.files.distribution import optional
from shellcut.formats.errors import point_text

_NAMED = 4


def area_of(polygon: Floats) -> float:
    """Return the area within a polygon, shape (n, 2)."""
    x, y = (polygon - polygon[0]).T
    return 0.5 * abs(float(product(x, np.roll(y, -1)) - product(y, np.roll(x, -1))))


def within(points: Floats, polygon: Floats) -> Bools:
    """Return which points, shape (n, 2), lie in a polygon: odd crossings of a ray along +x."""
    x, y = points.T[:, :, None]
    (x1, y1), (x2, y2) = polygon.T, np.roll(polygon, -1, axis=0).T
    spans = (y1 > y) != (y2 > y)
    rise = np.where(y1 == y2, 1.0, y2 - y1)
    crossed = spans & (x < x1 + (y - y1) * (x2 - x1) / rise)
    return np.asarray(crossed.sum(axis=1) % 2 == 1)


def not_one_film(
    loops: Sequence[Floats], names: Sequence[str], *, outer: int = 0, apart: float = 0.0
) -> list[str]:
    """Return why loops are not an outline, that of number ``outer``, with holes inside.

    Loops have names in the sentences; they are ``apart`` at least.

    Examples
    --------
    >>> square = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]])
    >>> not_one_film([square, square + 1.0, square + 4.0], ["outline", "hole_1", "hole_2"])
    ['outline crosses hole_1 at (1, 2)']
    """
    shapely = shapely_or_error()
    polygons = np.array([shapely.Polygon(loop) for loop in loops])
    problems = []
    for name, reason in zip(names, shapely.is_valid_reason(polygons), strict=True):
        if place := re.search(r"\[(\S+) (\S+)\]", reason):
            how = "touches" if reason.startswith("Ring") else "crosses"
            problems.append(f"{name} {how} itself at {point_text(np.array(place.groups(), float))}")
    if problems:
        return problems[:_NAMED]
    rings = shapely.get_exterior_ring(polygons)
    pairs = shapely.STRtree(rings).query(rings, predicate="dwithin", distance=apart)
    for k, j in pairs.T[pairs[0] < pairs[1]][:_NAMED].tolist():
        place = shapely.get_coordinates(shapely.shortest_line(rings[k], rings[j]))[0]
        if shapely.hausdorff_distance(rings[k], rings[j]) <= apart:
            problems.append(f"{names[k]} is drawn twice")
            continue
        how = "crosses" if shapely.overlaps(polygons[k], polygons[j]) else "touches"
        if how == "touches" and apart:
            how += f" (or lies within {apart:.2g} mm of)"
        problems.append(f"{names[k]} {how} {names[j]} at {point_text(place)}")
    if problems:
        return problems
    corners = shapely.points([loop[0] for loop in loops])
    inner, _ = shapely.STRtree(polygons).query(corners, predicate="within")
    level = np.bincount(inner, minlength=len(loops))
    problems = [
        f"{names[k]} lies outside" for k in np.flatnonzero(level == 0).tolist() if k != outer
    ]
    return problems + [f"{names[k]} lies in a hole" for k in np.flatnonzero(level > 1).tolist()]


def shapely_or_error() -> Any:
    """Return the package shapely, part of the extras ``outline`` and ``mesh``."""
    return optional("shapely", "outlines need shapely, an optional extra", "outline", "mesh")
