"""A film meshed from its outline by Gmsh: :func:`mesh_from_outline`.

Gmsh is an optional extra (``pip install 'shellcut-fem[mesh]'``, GPL), and has a process of its own.
The boundary is divided here, into an even number of sides per loop: with an odd number no mesh of
quads only exists. Inside, Blossom pairs Gmsh's frontal-Delaunay triangles to quads; on discs the
smallest scaled Jacobian was 0.71, with other settings 0.03 to 0.68.

With small quads near given points, the size s of the quads rises with the distance d from these,

    s = s_near + growth (d - band),   from s_near to the size far away,

and the boundary is divided evenly in the measure dl / s. Near a small loop s is low enough for some
sides around it, but not below s_near.
"""

from __future__ import annotations

import re
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from math import atan2
from pathlib import Path
from typing import Annotated, Any, TypeAlias

import numpy as np
import scipy

from shellcut.arguments import Option, checked
from shellcut.arrays import ArrayLike, Bools, Floats, each, product
from shellcut.files.distribution import optional
from shellcut.formats.errors import FileError, point_text
from shellcut.formats.own_process import GmshProcess

from . import outline_process
from .checks import check_film_size
from .mesh import Mesh, MeshError

CORNER_DEG = 30.0
"""A vertex at which the outline turns by more is a corner and becomes a node [deg]."""

_MOST_EDGES = 50_000
"""Limit along outline and holes."""

_GROWTH = 0.25
"""By which sides grow per length away from where they are small: the least scaled Jacobian of 60
random films is then 0.491."""

_AROUND = 16
"""Sides around a loop, at least, where the size may vary."""

_GMSH = GmshProcess(
    outline_process.__file__,
    "change size a little, or check narrow parts of the outline",
    "meshing an outline",
)

QuadSize: TypeAlias = Annotated[float, Option("mm", "side length of the quads, about", above=0)]


@checked
def mesh_from_outline(
    outline: Annotated[
        ArrayLike, Option("mm", "vertices in order; the first is not repeated", form="polygon")
    ],
    *,
    size: QuadSize,
    holes: Annotated[
        Sequence[ArrayLike], Option("mm", "polygons that are cut out", form="polygons")
    ] = (),
    near: Annotated[
        ArrayLike | None,
        Option("mm", "points about which quads are small", unset="none", form="polygon"),
    ] = None,
    size_near: Annotated[
        float | None, Option("mm", "side length of the quads there", above=0, unset="size")
    ] = None,
    band: Annotated[
        float | None,
        Option("mm", "distance from them where quads stay small", least=0, unset="size_near"),
    ] = None,
) -> Mesh:
    """Return a plane mesh of quads within a polygon, with Gmsh; its normals are along +z.

    Between corners (:data:`CORNER_DEG`) the polygon is read as a smooth curve: nodes lie on it, but
    not on its vertices. Away from the points ``near`` sides grow up to ``size``.

    Returns
    -------
    Mesh
        Node sets ``outline`` and, the same, ``rim``; ``hole_1``, ... in order along each loop.

    Raises
    ------
    MeshError
        If a polygon is invalid, or Gmsh leaves triangles.
    ImportError
        If Gmsh is missing or cannot be loaded.

    Examples
    --------
    >>> mesh = mesh_from_outline([(0, 0), (10, 0), (10, 6), (0, 6)], size=1.0)  # doctest: +SKIP
    """
    names = ["outline", *(f"hole_{k}" for k in range(1, len(holes) + 1))]
    polygons = [
        polygon(vertices, name) for vertices, name in zip((outline, *holes), names, strict=True)
    ]
    _check_apart(polygons, names)
    field = _Field.of(polygons, size, near, size_near, band)
    _check_count(polygons, size, field)
    loops = [_divided(polygon, size, field) for polygon in polygons]
    _check_apart(loops, names)  # the division may have bridged parts narrower than a side
    with tempfile.TemporaryDirectory() as folder:
        given = Path(folder) / "loops.npz"
        arrays: dict[str, Any] = {f"loop_{k}": loop for k, loop in enumerate(loops)}
        for k, (points, least, band_k) in enumerate(field.near):
            arrays |= {f"near_{k}": points, f"size_{k}": least, f"band_{k}": band_k}
        np.savez(given, size=size, growth=_GROWTH, **arrays)
        try:
            found = _GMSH.answer(given)
        except FileError as reason:
            raise MeshError(f"the outline cannot be meshed: {reason.problem}") from None
    if left := int(found["n_triangle"]):
        raise MeshError(
            f"Gmsh must find a mesh of quads only, but leaves {left} triangles; {_GMSH.remedy}"
        )
    sets = {name: found[f"loop_{k}"] for k, name in enumerate(names)}
    sets["rim"] = sets["outline"]
    # Gmsh's quads run around as the outline does.
    quads = found["quads"] if _signed_area(polygons[0]) > 0.0 else found["quads"][:, ::-1]
    return Mesh.from_arrays(found["nodes"], quads, node_sets=sets)


@dataclass(frozen=True)
class _Field:
    # sizes of quads that rise with the distance from points
    size: float
    near: list[tuple[Floats, float, float]]
    """Points, the size there, and how far it holds; none if it is the same everywhere."""

    @classmethod
    def of(
        cls,
        polygons: list[Floats],
        size: float,
        near: ArrayLike | None,
        least: float | None,
        band: float | None,
    ) -> _Field:
        if (near is None) != (least is None):
            raise MeshError("near and size_near belong together, got one of them; give both")
        if near is None or least is None:
            return cls(size, [])
        points = np.asarray(near, dtype=np.float64)
        if points.ndim != 2 or points.shape[1] != 2 or not len(points):
            raise MeshError(f"near must be points of shape (n, 2), got shape {points.shape}")
        if not np.isfinite(points).all():
            raise MeshError("near must be finite")
        if not least <= size:
            raise MeshError(
                f"size_near must be at most size, {size:g} mm, got {least:g} mm: enlarge size"
            )
        _, first = np.unique(np.round(2.0 * points / least), axis=0, return_index=True)
        found = [(points[first], least, least if band is None else band)]
        for polygon in polygons:
            around = _length(polygon)
            if around < _AROUND * size:
                side = max(around / _AROUND, least)
                found.append((_filled(polygon, side), side, side))
        return cls(size, found)

    def at(self, points: Floats) -> Floats:
        """Return the size of the quads at points, shape (n,) [mm]."""
        found = np.full(len(points), self.size)
        for near, least, band in self.near:
            distance, _ = scipy.spatial.cKDTree(near).query(points)
            found = np.minimum(found, least + _GROWTH * np.maximum(distance - band, 0.0))
        return found


def _length(polygon: Floats) -> float:
    return float(np.hypot(*(np.roll(polygon, -1, axis=0) - polygon).T).sum())


def _filled(polygon: Floats, spacing: float) -> Floats:
    # the vertices with points between them, no farther apart than this
    found = []
    for start, end in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
        n = int(np.ceil(np.hypot(*(end - start)) / spacing))
        found.append(start + np.arange(n)[:, None] / n * (end - start))
    return np.concatenate(found)


def _check_count(polygons: list[Floats], size: float, field: _Field) -> None:
    # check the number of quads by area, and of sides along the outlines, which are passed to Gmsh
    area = area_of(polygons[0]) - sum(area_of(hole) for hole in polygons[1:])
    check_film_size(area / size / size, "enlarge size, or shrink the outline")
    for points, least, _ in field.near:
        check_film_size(float(len(points)), f"enlarge the size near them, {least:g} mm")
    least = min([size, *(near_size for _, near_size, _ in field.near)])
    around = sum(map(_length, polygons))
    if not around / least <= _MOST_EDGES:
        raise MeshError(
            f"outline and holes must have {_MOST_EDGES:,} quad sides around them at most, got "
            f"{around:.4g} mm at size {least:g} mm, {around / least:,.0f} sides: enlarge size"
        )


def polygon(vertices: ArrayLike, name: str) -> Floats:
    """Return the vertices of a loop as an array, shape (n, 2); MeshError by its name."""
    try:
        points = np.array(vertices, dtype=np.float64)
    except (TypeError, ValueError):
        points = np.empty(0)
    if points.ndim != 2 or points.shape[1] != 2 or len(points) < 3:
        raise MeshError(f"{name} must be three points or more of shape (n, 2), got {points.shape}")
    if not np.isfinite(points).all():
        raise MeshError(f"{name} must be finite")
    sides = np.roll(points, -1, axis=0) - points
    if (np.hypot(*sides.T) == 0.0).any():
        at = int(np.flatnonzero(np.hypot(*sides.T) == 0.0)[0])
        raise MeshError(f"{name} must have different vertices, vertex {at} is equal to the next")
    return points


def _check_apart(loops: list[Floats], names: list[str]) -> None:
    # Gmsh hangs on crossing outlines
    if problems := not_one_film(loops, names):
        raise MeshError(
            "holes must lie inside the outline, apart, and no loop may cross or touch itself or "
            f"another: {'; '.join(problems)}"
        )


def _divided(points: Floats, size: float, field: _Field) -> Floats:
    # nodes along the polygon: all corners, between them evenly spaced, by arc length in sizes
    if field.near:
        points = _filled(points, 0.5 * min(least for _, least, _ in field.near))
    sides = np.roll(points, -1, axis=0) - points
    length = np.hypot(*sides.T)
    before = np.roll(sides, 1, axis=0)
    cross = before[:, 0] * sides[:, 1] - before[:, 1] * sides[:, 0]
    turn = each(atan2, np.abs(cross), (before * sides).sum(axis=1))
    corners = np.flatnonzero(np.degrees(turn) > CORNER_DEG)
    start = corners if len(corners) else np.array([0])
    if field.near:
        many = size / field.at(points)
        length = 0.5 * length * (many + np.roll(many, -1))
    arc = np.concatenate([[0.0], np.cumsum(length)])
    total = arc[-1]
    ends = np.append(arc[start], arc[start[0]] + total)
    pieces = np.diff(ends)
    counts = np.maximum(1, np.round(pieces / size)).astype(int)
    counts[int(np.argmax(pieces / counts))] += int(counts.sum() % 2)
    while counts.sum() < 4:
        counts[int(np.argmax(pieces / counts))] += 2
    at = np.concatenate(
        [
            first + piece * np.arange(n) / n
            for first, piece, n in zip(ends[:-1], pieces, counts, strict=True)
        ]
    )
    closed = np.concatenate([points, points[:1]])
    twice = np.concatenate([arc, total + arc[1:]])
    xy = [np.interp(at, twice, np.concatenate([c, c[1:]])) for c in closed.T]
    return np.stack(xy, axis=1)


# --- loops ----------------------------------------------------------------------------------------

_NAMED = 4


def area_of(polygon: Floats) -> float:
    """Return the area within a polygon, shape (n, 2)."""
    return abs(_signed_area(polygon))


def _signed_area(polygon: Floats) -> float:
    """Return the area within a polygon, shape (n, 2), negative of one that runs clockwise."""
    x, y = (polygon - polygon[0]).T
    return 0.5 * float(product(x, np.roll(y, -1)) - product(y, np.roll(x, -1)))


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
    ['outline crosses hole_1 at (...)']
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
