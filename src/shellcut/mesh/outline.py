"""A film meshed from its outline by Gmsh: :func:`mesh_from_outline`.

Gmsh is an optional extra (``pip install 'shellcut[mesh]'``, GPL), and has a process of its own.
The boundary is divided here, into an even number of edges per loop: with an odd number no mesh of
quads only exists. Inside, Blossom pairs Gmsh's frontal-Delaunay triangles to quads; on discs the
smallest scaled Jacobian was 0.71, with other settings 0.03 to 0.68.
"""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from math import atan2
from pathlib import Path
from typing import Annotated, Any, TypeAlias

import numpy as np
import numpy.typing as npt

from shellcut.arguments import Option, checked
from shellcut.arrays import Floats, each
from shellcut.formats.errors import FileError
from shellcut.formats.own_process import GmshProcess

from . import outline_process
from .checks import check_film_size
from .loops import area_of, not_one_film
from .mesh import Mesh, MeshError

CORNER_DEG = 30.0
"""A vertex at which the outline turns by more is a corner and becomes a node [deg]."""

_MOST_EDGES = 50_000
"""Limit along outline and holes."""

_GMSH = GmshProcess(
    outline_process.__file__,
    "change size a little, or check narrow parts of the outline",
    "meshing an outline",
)

QuadSize: TypeAlias = Annotated[float, Option("mm", "edge length of the quads, about", above=0)]


@checked
def mesh_from_outline(
    outline: Annotated[
        npt.ArrayLike, Option("mm", "vertices in order, without the first again", form="polygon")
    ],
    *,
    size: QuadSize,
    holes: Annotated[
        Sequence[npt.ArrayLike], Option("mm", "polygons inside", form="polygons")
    ] = (),
) -> Mesh:
    """Return a plane mesh of quads within a polygon, with Gmsh.

    Between corners (:data:`CORNER_DEG`) the polygon stands for a smooth curve: nodes lie on it, but
    not on its vertices.

    Returns
    -------
    Mesh
        Node sets "outline", "hole_1", "hole_2", ... in order along each loop.

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
        _polygon(vertices, name) for vertices, name in zip((outline, *holes), names, strict=True)
    ]
    _check_apart(polygons, names)
    _check_count(polygons, size)
    loops = [_divided(polygon, size) for polygon in polygons]
    _check_apart(loops, names)  # the division may have bridged parts narrower than an edge
    with tempfile.TemporaryDirectory() as folder:
        given = Path(folder) / "loops.npz"
        arrays: dict[str, Any] = {f"loop_{k}": loop for k, loop in enumerate(loops)}
        np.savez(given, size=size, **arrays)
        try:
            found = _GMSH.answer(given)
        except FileError as reason:
            raise MeshError(f"the outline cannot be meshed: {reason.problem}") from None
    if left := int(found["n_triangle"]):
        raise MeshError(
            f"Gmsh must find a mesh of quads only, but leaves {left} triangles; {_GMSH.remedy}"
        )
    rims = {name: found[f"rim_{k}"] for k, name in enumerate(names)}
    return Mesh.from_arrays(found["nodes"], found["quads"], node_sets=rims)


def _check_count(polygons: list[Floats], size: float) -> None:
    # check the number of quads by area, and of edges along the outlines, which are passed to Gmsh
    area = area_of(polygons[0]) - sum(area_of(hole) for hole in polygons[1:])
    check_film_size(area / size / size, "enlarge size, or shrink the outline")
    around = sum(float(np.hypot(*(np.roll(p, -1, axis=0) - p).T).sum()) for p in polygons)
    if not around / size <= _MOST_EDGES:
        raise MeshError(
            f"outline and holes must be {_MOST_EDGES:,} edges of a size around at most, got "
            f"{around:.4g} mm at size {size:g} mm, {around / size:,.0f} edges: enlarge size"
        )


def _polygon(vertices: npt.ArrayLike, name: str) -> Floats:
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
        raise MeshError(f"{name} must have different vertices, {at} is where the next one is")
    return points


def _check_apart(loops: list[Floats], names: list[str]) -> None:
    # Gmsh hangs on crossing outlines
    if problems := not_one_film(loops, names):
        raise MeshError(
            "holes must lie inside the outline, apart, and no loop may cross or touch itself or "
            f"another: {'; '.join(problems)}"
        )


def _divided(points: Floats, size: float) -> Floats:
    # nodes along the polygon: all corners, evenly spaced by arc length between them
    sides = np.roll(points, -1, axis=0) - points
    length = np.hypot(*sides.T)
    before = np.roll(sides, 1, axis=0)
    cross = before[:, 0] * sides[:, 1] - before[:, 1] * sides[:, 0]
    turn = each(atan2, np.abs(cross), (before * sides).sum(axis=1))
    corners = np.flatnonzero(np.degrees(turn) > CORNER_DEG)
    start = corners if len(corners) else np.array([0])
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
