"""A flat film with quads that are small along the path of the cutting edges."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated

import numpy as np

from shellcut.arguments import Option, checked
from shellcut.arrays import ArrayLike, Floats
from shellcut.cables.cohesive_law import CohesiveLaw, CohesiveTable
from shellcut.checks.path import side_needed
from shellcut.checks.sweep import Sweep
from shellcut.fracture.puncture import bending_length
from shellcut.material.shell_material import ShellMaterial
from shellcut.mesh.mesh import Mesh, MeshError
from shellcut.mesh.outline import mesh_from_outline, polygon, shapely_or_error
from shellcut.mesh.structured import circle, rectangle
from shellcut.tool.motion import Motion
from shellcut.tool.tool import Tool

AHEAD = 2.0
"""Distance beyond each end of the path along which quads are small [mm]: a crack leads the edge."""

FAR = 8.0
"""Sides far from the path over those under it, if nothing else is said."""

BAND, MOST_ROWS = 2.0, 5.0
"""Distance from the path up to which quads are as small as there, since the film folds within it:
in bending lengths, and at most in sides."""

_ROUND = 1024  # sides of the polygon of a disc: 5e-6 of the radius off the circle
_SEARCHED = 100  # quads along the film in which the path is looked for, at most


@checked
def film_along_path(
    outline: Annotated[
        ArrayLike, Option("mm", "vertices in order, or the radius of a disc", form="polygon")
    ],
    *,
    tool: Tool | Sequence[Tool],
    motion: Motion,
    duration: Annotated[float, Option("s", "duration of the motion", above=0)],
    size_at_path: Annotated[
        float | None,
        Option(
            "mm",
            "side length of the quads under the path of the cutting edges, by Gmsh",
            above=0,
            unset="5 bending lengths or opening_u / 10",
        ),
    ] = None,
    size: Annotated[
        float | None,
        Option(
            "mm",
            "side length far from it; given alone, of all quads",
            above=0,
            unset="8 times size_at_path",
        ),
    ] = None,
    holes: Annotated[Sequence[ArrayLike], Option("mm", "polygons inside", form="polygons")] = (),
    material: ShellMaterial | None = None,
    law: CohesiveTable | None = None,
) -> Mesh:
    """Return a flat film, z = 0, with small quads where the cutting edges pass, by Gmsh.

    They are small along the path of the cutting edges during the motion and 2 mm beyond its ends,
    and grow away from it by a quarter of the distance.

    Parameters
    ----------
    tool : Tool, or sequence of Tool
        Several tools give one film that is fine under the paths of all: their runs then do not
        differ by the mesh.
    motion : Motion
        How they move.
    material, law : ShellMaterial, CohesiveTable, optional
        They give the default of ``size_at_path``; the paper's film by default.

    Returns
    -------
    Mesh
        As from :func:`mesh_from_outline`, with the node sets ``rim``, ``hole_1``, ...

    Raises
    ------
    MeshError
        If no cutting edge passes through the film, or Gmsh makes no film of quads.
    ImportError
        If Gmsh is missing or cannot be loaded.

    Examples
    --------
    >>> from shellcut import ScrewMotion, film_along_path
    >>> from shellcut.tool_shapes import tooth_ring
    >>> screw = ScrewMotion.over(angle_deg=30.0, duration=2e-3)
    >>> film = film_along_path(
    ...     15.0, tool=tooth_ring(radius=13.4), motion=screw, duration=2e-3, size_at_path=0.4
    ... )  # doctest: +SKIP
    """
    if np.ndim(outline) == 0:
        outline = disc_outline(float(np.asarray(outline)))
    film, cables = material or ShellMaterial.homogeneous(), law or CohesiveLaw()
    near = path_size(film, cables) if size_at_path is None else size_at_path
    tools = (tool,) if isinstance(tool, Tool) else tuple(tool)
    around = polygon(outline, "outline")
    inner = [polygon(hole, f"hole_{k}") for k, hole in enumerate(holes, start=1)]
    points = _path(around, inner, tools, motion, duration, near)
    far = FAR * near if size is None else size
    if far < near:
        raise MeshError(
            f"size must be size_at_path or more, {near:.4g} mm, got {far:.4g} mm: enlarge size, or "
            "lower size_at_path"
        )
    band = float(np.clip(BAND * bending_length(film, cables), near, MOST_ROWS * near))
    return mesh_from_outline(around, holes=inner, size=far, near=points, size_near=near, band=band)


def disc_outline(radius: float) -> Floats:
    """Return the outline of a disc about the origin, shape (n, 2)."""
    if not 0.0 < radius < math.inf:
        raise MeshError(f"the radius must be positive and finite, got {radius:g} mm")
    return radius * circle(_ROUND)


def path_size(material: ShellMaterial, law: CohesiveTable) -> float:
    """Return the length of sides under the path that a film needs for its torque [mm].

    Examples
    --------
    >>> path_size(ShellMaterial.homogeneous(), CohesiveLaw())
    0.4
    """
    return side_needed(bending_length(material, law), law)


def _path(
    outline: Floats,
    holes: Sequence[Floats],
    tools: Sequence[Tool],
    motion: Motion,
    duration: float,
    size: float,
) -> Floats:
    """Return points of the path within an outline, shape (n, 2) [mm]."""
    low, extent = outline.min(axis=0), np.ptp(outline, axis=0)
    sheet = rectangle(*extent.tolist(), size=max(size, float(extent.max()) / _SEARCHED))
    corner = np.array([low[0], low[1] + 0.5 * extent[1], 0.0])
    around = Mesh.from_arrays(sheet.nodes + corner, sheet.quads)
    found = [np.zeros((0, 2))]
    for cutter in tools:
        if cutter.n_edge:
            sweep = Sweep.of(around, cutter, motion, duration)
            found.append(sweep.path_points(AHEAD)[:, :2])
    points = np.concatenate(found)
    shapely = shapely_or_error()
    film = shapely.Polygon(outline, holes)
    inside: Floats = points[shapely.contains_xy(film, *points.T)]
    if not len(inside):
        raise MeshError(
            "quads are small along the path of the cutting edges, but no cutting edge passes "
            "through the film during the motion: check place, unit and motion of the tool, or "
            "give size alone"
        )
    return inside
