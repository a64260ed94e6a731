"""The outline of a film from a drawing, DXF or SVG: :func:`read_drawing`.

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
from shellcut.arrays import Floats, norm
from shellcut.formats.drawing import DEVIATION, Curve, Drawing, extent_of
from shellcut.formats.dxf import read_dxf
from shellcut.formats.errors import FileError, check_finite, named, naming, point_text
from shellcut.formats.length_unit import FileUnit, unit_in_mm
from shellcut.formats.svg import read_svg
from shellcut.numerics.connected_parts import close_parts

from .loops import area_of, not_one_film
from .mesh import Mesh
from .outline import QuadSize, mesh_from_outline

_log = logging.getLogger("shellcut.drawing")

READERS = {".dxf": read_dxf, ".svg": read_svg}
"""Reader by suffix of the file name."""

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


DrawingFile: TypeAlias = Annotated[
    str | Path, Option("", "the drawing; its suffix gives the format", form="path")
]
Layers: TypeAlias = Annotated[
    str | Collection[str],
    Option("", "layers to read; of SVG labels and ids; all shown if there are none", form="names"),
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
    """Read the outline of a film with its holes: DXF, SVG (extra ``outline``).

    DXF states its unit as ``$INSUNITS``, SVG by ``width`` and ``viewBox``. Polygons turn by 10
    degrees at most in each point.

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
        If the reader of the format is missing.

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
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        raise FileError(path, f"the name must end in one of {', '.join(READERS)}")
    wanted = (layers,) if isinstance(layers, str) else tuple(layers)
    drawing = reader(path, wanted)  # coarse, for the size and the unit
    factor, extent, note = _factor(drawing, unit)
    fine = DEVIATION * extent if chord_deviation is None else chord_deviation / factor
    if not fine >= _FINEST * extent:
        raise FileError(
            path,
            f"chord_deviation must be {_FINEST * extent * factor:.2g} mm or more for a drawing of "
            f"{extent * factor:.4g} mm across, got {chord_deviation:g}",
        )
    drawing = reader(path, wanted, fine)
    for said in (*drawing.notes, note):
        if said:
            _log.warning("%s: %s", path, said)
    curves = [Curve(factor * curve.points, curve.where) for curve in drawing.curves]
    reach = join or _JOIN * factor * extent
    loops = _loops(path, curves, reach)
    return _with_holes(path, loops, reach + 2.0 * factor * fine)


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


def _factor(drawing: Drawing, unit: str | float | None) -> tuple[float, float, str]:
    # length of the unit [mm], diagonal in the unit, note
    if not drawing.curves:
        raise FileError(
            drawing.path,
            f"there must be curves, got none; {'; '.join(drawing.notes) or 'is it empty?'}",
        )
    points = np.concatenate([curve.points for curve in drawing.curves])
    check_finite(drawing.path, points, "point {}".format)
    if unit is None and drawing.unit_mm is None and drawing.no_unit:
        raise FileError(drawing.path, f"the unit must be given: {drawing.no_unit}")
    extent = float(np.ptp(points, axis=0).max())
    with naming(drawing.path):
        factor, note = unit_in_mm(unit, extent, "the drawing", stated=drawing.unit_mm)
    return factor, extent_of(points), note


def _loops(path: Path, curves: list[Curve], reach: float) -> list[Floats]:
    # closed curves, and chains of open ones, in the order of the first curve of each
    open_ones, loops = [], []
    for number, curve in enumerate(curves):
        if extent_of(curve.points) <= reach:
            _log.warning("%s: %s is shorter than %.3g mm and is left out", path, curve.where, reach)
        elif norm(curve.points[0] - curve.points[-1]) <= reach:
            loops.append((number, _cleaned(curve.points, reach)))
        else:
            open_ones.append((number, curve))
    if open_ones:
        loops += _chained(path, open_ones, reach)
    return [points for _, points in sorted(loops, key=lambda one: one[0])]


def _chained(
    path: Path, open_ones: list[tuple[int, Curve]], reach: float
) -> list[tuple[int, Floats]]:
    ends = np.array([curve.points[k] for _, curve in open_ones for k in (0, -1)])
    with naming(path):
        spot = close_parts(ends, reach)
    at: dict[int, list[int]] = {}
    for end, label in enumerate(spot.tolist()):
        at.setdefault(label, []).append(end)
    _check_ends(path, open_ones, ends, at)
    left = dict.fromkeys(range(len(open_ones)))
    found = []
    while left:
        first = end = 2 * next(iter(left))
        points = []
        while True:
            here, back = divmod(end, 2)
            del left[here]
            points.append(open_ones[here][1].points[:: -1 if back else 1])
            arrived = end ^ 1
            (end,) = (other for other in at[int(spot[arrived])] if other != arrived)
            if end == first:
                break
        found.append((open_ones[first // 2][0], _cleaned(np.concatenate(points), reach)))
    return found


def _check_ends(
    path: Path, open_ones: list[tuple[int, Curve]], ends: Floats, at: dict[int, list[int]]
) -> None:
    problems = []
    alone = [members[0] for members in at.values() if len(members) == 1]
    for end in alone[:_NAMED]:
        away = np.linalg.norm(ends[alone] - ends[end], axis=1)
        away[alone.index(end)] = np.inf
        gap = ""
        if len(alone) > 1:
            near = alone[int(np.argmin(away))]
            there = f"{point_text(ends[near])} of {_of(open_ones, near)}"
            gap = f", {away.min():.3g} mm from the end at {there}"
        here = f"{_of(open_ones, end)} at {point_text(ends[end])}"
        problems.append(f"an end of {here} meets no other{gap}")
    if len(alone) > _NAMED:
        problems.append(f"and {len(alone) - _NAMED} more open ends")
    for members in [members for members in at.values() if len(members) > 2][:_NAMED]:
        kinds = ", ".join(dict.fromkeys(_of(open_ones, end) for end in members))
        problems.append(
            f"{len(members)} ends meet at {point_text(ends[members[0]])} ({kinds}): choose "
            "layers, or remove lines drawn twice"
        )
    if problems:
        more = _closing(ends, alone) if alone else ""
        raise FileError(path, f"curves must form closed loops: {'; '.join(problems)}{more}")


def _closing(ends: Floats, alone: list[int]) -> str:
    # what closes the gaps between ends that meet no other; an end finds itself first
    distance, _ = scipy.spatial.cKDTree(ends[alone]).query(ends[alone], k=2)
    widest = float(distance[:, 1].max())
    if widest <= _GAP * extent_of(ends):
        return f"; join={1.01 * widest:.3g} (mm) closes gaps"
    return "; a curve is missing, or lies on a layer that was not chosen"


def _cleaned(points: Floats, reach: float) -> Floats:
    # without the repeated last point, and without points closer than `reach` to the one before
    kept = [0]
    for k in range(1, len(points)):
        if norm(points[k] - points[kept[-1]]) > reach:
            kept.append(k)
    while len(kept) > 1 and norm(points[kept[-1]] - points[0]) <= reach:
        kept.pop()
    return points[kept]


def _with_holes(path: Path, loops: list[Floats], apart: float) -> FilmOutline:
    # `apart`: least distance of two loops by which their curves are sure not to touch
    if not loops:
        raise FileError(path, "curves must form closed loops with an area, got none")
    if flat := [loop for loop in loops if len(loop) < 3]:
        told = named(flat, lambda loop: " to ".join(map(point_text, loop)))
        raise FileError(
            path,
            f"closed loops must have an area, got a line there and back at {told}: is it drawn "
            "twice? Remove it; a slit is cut in the mesh, by Mesh.cut",
        )
    name = [f"the loop of {area_of(p):.4g} mm² around {point_text(p.mean(axis=0))}" for p in loops]
    largest = max(range(len(loops)), key=lambda k: area_of(loops[k]))
    with naming(path):
        problems = not_one_film(loops, name, outer=largest, apart=apart)
    if problems:
        raise FileError(
            path,
            f"all loops must lie in the largest, of {area_of(loops[largest]):.4g} mm², apart, and "
            f"not in each other: {'; '.join(problems[:_NAMED])}; choose the layers of one film, or "
            "mend the drawing",
        )
    return FilmOutline(loops[largest], tuple(p for k, p in enumerate(loops) if k != largest))


def _of(open_ones: list[tuple[int, Curve]], end: int) -> str:
    return open_ones[end // 2][1].where
