"""The outline of a film from a DXF drawing: :func:`read_drawing`.

Curves whose ends meet are joined into closed loops; the largest loop is the outline, the others are
its holes. Assumptions are logged as warnings of the logger ``shellcut.drawing``.
"""

from __future__ import annotations

import logging
from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, TypeAlias

import numpy as np
import scipy

from shellcut.arguments import Option, checked
from shellcut.arrays import Floats
from shellcut.formats.dxf import extent_of, read_dxf
from shellcut.formats.errors import FileError, named, naming, point_text
from shellcut.formats.length_unit import FileUnit, unit_in_mm
from shellcut.numerics.connected_parts import close_parts

from .loops import area_of, not_one_film, shapely_or_error
from .mesh import Mesh
from .outline import QuadSize, mesh_from_outline

_log = logging.getLogger("shellcut.drawing")

_DEVIATION = 1e-4
"""Default chord deviation over the diagonal: 2 um for a film of 20 mm."""

_JOIN = 1e-6
"""Ends of curves closer than this part of the drawing's diagonal meet: round-off of six digits."""

_FINEST = 1e-8  # chord deviation over the diagonal: finer is lost in round-off

_NAMED = 4  # gaps named in a message
_GAP = 0.005
"""A wider one, over the drawing's diagonal, is a missing curve: no end was drawn to meet there."""


@dataclass(frozen=True, eq=False)
class FilmOutline:
    """The outline of a film and its holes, polygons without repeated points [mm].

    Examples
    --------
    >>> square = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]])
    >>> FilmOutline(10.0 * square, (square + 5.0,)).area
    396.0
    """

    outline: Floats
    """Shape (n, 2)."""
    holes: tuple[Floats, ...]
    """In the order of the file."""

    @property
    def area(self) -> float:
        """Area of the film [mm²]."""
        return area_of(self.outline) - sum(area_of(hole) for hole in self.holes)


DrawingFile: TypeAlias = Annotated[str | Path, Option("", "the DXF drawing", form="path")]
Layers: TypeAlias = Annotated[
    str | Collection[str],
    Option("", "layers to read; all shown if there are none", form="names"),
]
ChordDeviation: TypeAlias = Annotated[
    float | None,
    Option("mm", "of polygons from arcs and splines", above=0, unset="1e-4 of the diagonal"),
]
Join: TypeAlias = Annotated[
    float | None,
    Option("mm", "ends of curves closer than this meet", above=0, unset="1e-6 of the diagonal"),
]


@checked
def read_drawing(
    path: DrawingFile,
    *,
    unit: FileUnit = None,
    layers: Layers = (),
    chord_deviation: ChordDeviation = None,
    join: Join = None,
) -> FilmOutline:
    """Read the outline of a film with its holes from DXF (extra ``outline``).

    ``$INSUNITS`` states the unit of the file. Polygons turn by 10 degrees at most in each point.

    Returns
    -------
    FilmOutline

    Raises
    ------
    FileError
        If the file cannot be read, or its curves form no outline: lists ends that meet nothing,
        with the gap to the next end, places where more than two curves meet, and loops that cross,
        touch, are drawn twice, or lie in a hole.
    ImportError
        If ezdxf or shapely is missing.

    Examples
    --------
    >>> import ezdxf
    >>> drawing = ezdxf.new(units=4)  # mm
    >>> space = drawing.modelspace()
    >>> _ = space.add_lwpolyline([(0, 0), (20, 0), (20, 12), (0, 12)], close=True)
    >>> _ = space.add_circle((6, 6), 2.0)
    >>> drawing.saveas("plate.dxf")
    >>> plate = read_drawing("plate.dxf")
    >>> len(plate.outline), len(plate.holes), round(plate.area, 2)
    (4, 1, 227.44)
    """
    path = Path(path)
    if path.suffix.lower() != ".dxf":
        raise FileError(path, "the name must end in .dxf; save the drawing as DXF")
    drawing = read_dxf(path, (layers,) if isinstance(layers, str) else tuple(layers))
    coarse = [points for _, points in drawing.polygons()]
    if not coarse:
        raise FileError(
            path, f"there must be curves, got none; left out: {drawing.left_out or 'nothing'}"
        )
    points = np.concatenate(coarse)
    with naming(path):
        factor, note = unit_in_mm(
            unit, float(np.ptp(points, axis=0).max()), "the drawing", stated=drawing.unit_mm
        )
    extent = factor * extent_of(points)
    fine = _DEVIATION * extent if chord_deviation is None else chord_deviation
    if not fine >= _FINEST * extent:
        raise FileError(
            path,
            f"chord_deviation must be {_FINEST * extent:.2g} mm or more for a drawing of "
            f"{extent:.4g} mm across, got {chord_deviation:g}",
        )
    for said in (f"left out: {drawing.left_out}" if drawing.left_out else "", note):
        if said:
            _log.warning("%s: %s", path, said)
    curves = [(where, factor * points) for where, points in drawing.polygons(fine / factor)]
    reach = join or _JOIN * extent
    return _with_holes(path, _loops(path, curves, reach), reach + 2.0 * fine)


@checked
def mesh_from_drawing(
    path: DrawingFile,
    *,
    size: QuadSize,
    unit: FileUnit = None,
    layers: Layers = (),
    chord_deviation: ChordDeviation = None,
    join: Join = None,
) -> Mesh:
    """Return a mesh of quads within the outline of a drawing, with Gmsh.

    Returns
    -------
    Mesh
        See :func:`mesh_from_outline`: node sets "outline", "hole_1", ... in the file's order.

    Raises
    ------
    FileError, MeshError, ImportError
        See :func:`read_drawing` and :func:`mesh_from_outline`.

    Examples
    --------
    >>> mesh = mesh_from_drawing("plate.dxf", size=0.5, layers=["cut"])  # doctest: +SKIP
    """
    found = read_drawing(path, unit=unit, layers=layers, chord_deviation=chord_deviation, join=join)
    return mesh_from_outline(found.outline, holes=found.holes, size=size)


def _loops(path: Path, curves: list[tuple[str, Floats]], reach: float) -> list[Floats]:
    # chains of curves, in the order of the first curve of each
    shapely = shapely_or_error()
    ends = np.array([points[k] for _, points in curves for k in (0, -1)])
    with naming(path):
        spot = close_parts(ends, reach)
    _, first = np.unique(spot, return_index=True)
    ends = ends[first[spot]]  # those that meet are at one place
    lines = []
    number: dict[tuple[float, ...], int] = {}  # of the first curve that ends at a place
    for k, (where, points) in enumerate(curves):
        if extent_of(points) <= reach:
            _log.warning("%s: %s is shorter than %.3g mm and is left out", path, where, reach)
            continue
        start, stop = ends[2 * k : 2 * k + 2]
        number.setdefault(tuple(start), k)
        number.setdefault(tuple(stop), k)
        lines.append(shapely.LineString(np.vstack([start, points[1:-1], stop])))
    chains = shapely.get_parts(shapely.line_merge(shapely.MultiLineString(lines)))
    chains = shapely.remove_repeated_points(chains, reach)
    loops = [shapely.get_coordinates(chain) for chain in chains]
    if broken := [points for points in loops if (points[0] != points[-1]).any()]:
        places = np.array([points[k] for points in broken for k in (0, -1)])
        names = [curves[number[tuple(place)]][0] for place in places]
        raise FileError(
            path, f"curves must form closed loops: {_told(places, names, extent_of(ends))}"
        )
    loops.sort(key=lambda points: min(number[tuple(p)] for p in points if tuple(p) in number))
    return [points[:-1] for points in loops]


def _told(ends: Floats, names: list[str], extent: float) -> str:
    # where chains end, and what closes the gaps; where several end, each is named as one of two
    gap, near = scipy.spatial.cKDTree(ends).query(ends, k=2)  # an end finds itself or its like
    gap, near = gap[:, 1], np.where(near[:, 1] == np.arange(len(ends)), near[:, 0], near[:, 1])
    problems = dict.fromkeys(
        f"an end of {names[k]} at {point_text(ends[k])} meets no other, {gap[k]:.3g} mm from the "
        f"end at {point_text(ends[near[k]])} of {names[near[k]]}"
        if gap[k]
        else f"more than two ends meet at {point_text(ends[k])}: choose layers, or remove lines "
        "drawn twice"
        for k in range(len(ends))
    )
    said = "; ".join([*problems][:_NAMED])
    if len(problems) > _NAMED:
        said += f"; and {len(problems) - _NAMED} more"
    if not gap.all():
        return said
    if gap.max() <= _GAP * extent:
        return f"{said}; join={1.01 * gap.max():.3g} (mm) closes gaps"
    return f"{said}; a curve is missing, or lies on a layer that was not chosen"


def _with_holes(path: Path, loops: list[Floats], apart: float) -> FilmOutline:
    # `apart`: least distance of two loops by which their curves are sure not to touch
    if not loops:
        raise FileError(path, "curves must form closed loops with an area, got none")
    if flat := [p for p in loops if len(p) < 3]:
        told = named(flat, lambda p: " to ".join(map(point_text, p[:2])))
        raise FileError(
            path,
            f"closed loops must have an area, got a line there and back at {told}: is it drawn "
            "twice? Remove it; a slit is cut in the mesh, by Mesh.cut",
        )
    name = [f"the loop of {area_of(p):.4g} mm² around {point_text(p.mean(axis=0))}" for p in loops]
    largest = max(range(len(loops)), key=lambda k: area_of(loops[k]))
    if problems := not_one_film(loops, name, outer=largest, apart=apart):
        raise FileError(
            path,
            f"all loops must lie in the largest, of {area_of(loops[largest]):.4g} mm², apart, and "
            f"not in each other: {'; '.join(problems[:_NAMED])}; choose the layers of one film, or "
            "mend the drawing",
        )
    return FilmOutline(loops[largest], tuple(p for k, p in enumerate(loops) if k != largest))
