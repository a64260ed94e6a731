"""Content of a file of triangles, in one form for all formats."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from shellcut.arrays import Floats, Ints, product

from .errors import FileError, named

_CONCAVE = -1e-9  # round-off of a corner's signed area, relative to the polygon's area


@dataclass
class SurfaceFile:
    """Triangles as they are in the file."""

    path: Path
    vertices: Floats
    """In the file's own unit, shape (n_vertex, 3); duplicates are kept."""
    triangles: Ints
    """Vertex numbers from 0, shape (n_triangle, 3)."""
    notes: list[str] = field(default_factory=list)
    """Omissions and changes of the reader."""
    unit_mm: float | None = None
    """Length of the file's unit [mm], where the file states it; most formats cannot."""
    chord_deviation: float | None = None
    """Largest distance of the triangles from the faces for which they stand, in the file's unit;
    None where the file itself holds triangles."""


def surface_of_polygons(
    path: Path, vertices: Sequence[Sequence[float]], polygons: Sequence[Sequence[int]]
) -> SurfaceFile:
    """Return a surface, with polygons cut into triangles from their first corners.

    A polygon of more than three corners must be convex: the triangles of another would overlap.
    """
    points = np.array(vertices, dtype=np.float64).reshape(-1, 3)
    if not polygons:
        raise FileError(path, "there must be faces, got none")
    n = len(points)
    if lost := [k for k, face in enumerate(polygons) if max(face) >= n or min(face) < 0]:
        raise FileError(path, f"faces must name existing vertices, but faces {named(lost)} do not")
    many = [k for k, face in enumerate(polygons) if len(face) > 3]
    if folded := [k for k in many if not _is_convex(points[list(polygons[k])])]:
        raise FileError(
            path, f"faces must be convex, but faces {named(folded)} are not; save triangles"
        )
    triangles = [[face[0], *face[k : k + 2]] for face in polygons for k in range(1, len(face) - 1)]
    surface = SurfaceFile(path, points, np.array(triangles, dtype=np.int64))
    if unused := len(points) - len(np.unique(surface.triangles)):
        surface.notes.append(f"{unused} vertices belong to no face: is the file cut short?")
    if many:
        surface.notes.append(f"{len(many)} faces with more than three corners are triangulated")
    return surface


def _is_convex(corners: Floats) -> bool:
    ahead = np.roll(corners, -1, axis=0) - corners
    behind = corners - np.roll(corners, 1, axis=0)
    area = np.cross(corners - corners[0], ahead).sum(axis=0)  # twice, along the normal
    return bool((product(np.cross(behind, ahead), area) >= _CONCAVE * product(area, area)).all())
