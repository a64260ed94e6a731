"""The outline of a film from a DXF drawing, by ezdxf and shapely: :func:`read_drawing`.

ezdxf (``pip install 'shellcut-fem[outline]'``, MIT) reads the curves and flattens them. Those whose
ends meet are joined into closed loops; the largest loop is the outline, the others are its holes.
Assumptions are logged as warnings of the logger ``shellcut.drawing``.
"""

from __future__ import annotations

import logging
from collections import Counter
from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, TypeAlias

import numpy as np
import scipy

from shellcut.arguments import Option, checked
from shellcut.arrays import Floats
from shellcut.files.distribution import optional
from shellcut.formats.budget import Budget
from shellcut.formats.errors import (
    FileError,
    as_file,
    check_finite,
    named,
    naming,
    point_text,
    read_bytes,
)
from shellcut.formats.length_unit import FileUnit, unit_in_mm
from shellcut.numerics.connected_parts import close_parts
from shellcut.unit import LENGTH

from .mesh import Mesh
from .outline import QuadSize, area_of, mesh_from_outline, not_one_film, shapely_or_error

_log = logging.getLogger("shellcut.drawing")

LARGEST_FILE = 50_000_000
"""Largest size of a drawing [bytes]."""

_CURVES = {"LINE", "LWPOLYLINE", "POLYLINE", "ARC", "CIRCLE", "ELLIPSE", "SPLINE", "HELIX"}
_CUBICS = 8  # of an arc: those of a circle are 4e-6 of the radius off
_SIDES = 8  # of each cubic at least: a turn of 6 degrees
# $INSUNITS [mm]; 0 is without a unit, others (miles, light years) are no films
_UNITS = {
    **{code: float(LENGTH[unit]) for code, unit in ((1, "in"), (2, "ft"), (9, "mil"), (13, "um"))},
    **{4: 1.0, 5: 10.0, 6: 1000.0, 8: 25.4e-6, 14: 100.0},
}

# Lengths over the drawing's diagonal.
_DEVIATION = 1e-4  # default of chord_deviation: 2 um for a film of 20 mm
_FINEST = 1e-8  # chord_deviation: finer is lost in round-off
_JOIN = 1e-6  # default of join: round-off of six digits
_FLAT = 1e-6  # heights of points in one plane differ by less
_GAP = 0.005  # a wider one is a missing curve: no end was drawn to meet there


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
    Option("mm", "most distance of polygons from curves", above=0, unset="1e-4 of the diagonal"),
]
Join: TypeAlias = Annotated[
    float | None,
    Option("mm", "ends of curves closer than this meet", above=0, unset="1e-6 of the diagonal"),
]


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

    Curves are those of the model space and of its blocks. Case of layer names does not matter.
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
    document, millimetres = _document(path)
    from ezdxf.path import bbox

    left_out: Counter[str] = Counter()
    chosen = _chosen(path, document, (layers,) if isinstance(layers, str) else layers)
    curves = list(_curves(path, document, chosen, left_out))
    listed = ", ".join(f"{n} {kind}" for kind, n in sorted(left_out.items()))
    if not curves:
        raise FileError(path, f"there must be curves, got none; left out: {listed or 'nothing'}")
    box = bbox(curve for _, curve in curves)
    if box.size.z > _FLAT * box.size.vec2.magnitude:
        raise FileError(
            path,
            f"the drawing must be flat, got heights z of {box.extmin.z:g} to {box.extmax.z:g}; "
            "project it in the CAD program, or choose layers",
        )
    with naming(path):
        factor, note = unit_in_mm(
            unit, max(box.size.x, box.size.y), "the drawing", stated=millimetres
        )
    extent = factor * box.size.vec2.magnitude
    fine = _DEVIATION * extent if chord_deviation is None else chord_deviation
    if not fine >= _FINEST * extent:
        raise FileError(
            path,
            f"chord_deviation must be {_FINEST * extent:.2g} mm or more for a drawing of "
            f"{extent:.4g} mm across, got {chord_deviation:g}",
        )
    if listed:
        _log.warning("%s: left out: %s", path, listed)
    if note:
        _log.warning("%s: %s", path, note)
    budget = Budget(path)
    polygons = []
    for where, curve in curves:
        points = np.array([list(p.vec2) for p in curve.flattening(fine / factor, segments=_SIDES)])
        budget.take("points of curves", len(points), "enlarge chord_deviation, choose layers")
        polygons.append((where, factor * points))
    reach = join or _JOIN * extent
    return _with_holes(path, _loops(path, polygons, reach, extent), reach + 2.0 * fine)


def _document(path: Path) -> tuple[Any, float | None]:
    """Return what ezdxf makes of a file, and the length of its unit [mm], None if not stated."""
    needed = f"{path}: reading DXF needs ezdxf, an optional extra"
    readfile = optional("ezdxf.filemanagement", needed, "outline").readfile
    if path.suffix.lower() != ".dxf":
        raise FileError(path, "the name must end in .dxf; save the drawing as DXF")
    content = read_bytes(path, LARGEST_FILE)
    if content.startswith(b"AC10"):
        raise FileError(path, "this is a DWG file under another name; save it as DXF")
    if content.startswith(b"AutoCAD Binary DXF"):
        whole, end, rest = content.rpartition(b"EOF\0")
        content = whole + end or rest  # ezdxf stumbles over what follows the end
    try:
        encoding = "utf-8" if content.decode() else None
    except UnicodeDecodeError:
        encoding = None  # that of $DWGCODEPAGE
    try:
        with as_file(path, content) as file:
            document = readfile(file, encoding=encoding)
        document.modelspace()  # not there in some damaged files
        for insert in document.query("INSERT"):
            if not insert.dxf.zscale:  # flattens a flat block, but has no inverse
                insert.dxf.zscale = abs(insert.dxf.xscale)
    except Exception as reason:  # a damaged file makes ezdxf raise errors of all kinds
        raise FileError(path, f"ezdxf cannot read it: {_in_a_line(reason)}") from None
    # ezdxf takes metres where the file has no header, or no unit in it
    stated = document.header.get("$INSUNITS", 0) if b"$INSUNITS" in content else 0
    return document, _UNITS.get(stated)


def _in_a_line(reason: Exception) -> str:
    return " ".join(str(reason).split()) or type(reason).__name__


def _layer(entity: Any) -> str:
    """Return the layer of an entity; one of a kind that ezdxf does not know may have none."""
    return str(entity.dxf.layer) if entity.dxf.hasattr("layer") else "0"


def _chosen(path: Path, document: Any, wanted: Collection[str]) -> set[str]:
    """Return the names of layers to read, in lower case, as DXF compares them."""
    used = {_layer(entity) for entity in document.modelspace()}
    present = {name.lower() for name in used}
    if lost := [name for name in wanted if name.lower() not in present]:
        raise FileError(
            path,
            f"there is nothing on the layers {named(lost)}; layers in use: {named(sorted(used))}",
        )
    hidden = {x.dxf.name.lower() for x in document.layers if not x.is_on() or x.is_frozen()}
    return {name.lower() for name in wanted} or present - hidden


def _curves(
    path: Path, document: Any, layers: set[str], left_out: Counter[str]
) -> Iterator[tuple[str, Any]]:
    """Yield kind and layer, and path, of each curve; what is no curve is counted."""
    from ezdxf.disassemble import recursive_decompose
    from ezdxf.path import make_path

    for layout in document.layouts:
        if n := sum(e.dxftype() != "VIEWPORT" for e in layout if not layout.is_modelspace):
            left_out[f"entities in paper space {layout.name!r}"] = n
    budget = Budget(path)
    for outer in document.modelspace():
        layer = _layer(outer)
        if layer.lower() not in layers:
            left_out[f"entities on layer {layer!r}"] += 1
            continue
        try:
            _count(outer, document, budget)  # ezdxf follows blocks of blocks without a limit
            drawn: list[Any] = list(recursive_decompose([outer]))
            if not drawn:
                left_out[outer.dxftype()] += 1
            for entity in drawn:
                if entity.dxftype() not in _CURVES:
                    left_out[entity.dxftype()] += 1
                    continue
                if entity.dxftype() == "SPLINE":
                    entity.apply_construction_tool(_clamped(entity.construction_tool()))
                where = f"{entity.dxftype()} on layer {layer!r}"
                curve = make_path(entity, segments=_CUBICS)
                points = np.array([list(point) for point in curve.control_vertices()])
                if len(points):
                    check_finite(path, points, f"point {{}} of {where}".format)
                    yield where, curve
        except FileError:
            raise
        except Exception as reason:  # numbers that make no curve raise errors of all kinds
            raise FileError(
                path,
                f"{outer.dxftype()} #{outer.dxf.handle} on layer {layer!r} is no curve: "
                f"{_in_a_line(reason)}",
            ) from None


def _count(entity: Any, document: Any, budget: Budget, times: int = 1, level: int = 1) -> None:
    """Count the elements of an entity: of a block, with those of the blocks in it."""
    budget.descend("blocks", level)
    inner: Iterable[Any] = ()
    if entity.dxftype() == "INSERT":
        times *= max(entity.dxf.row_count, 1) * max(entity.dxf.column_count, 1)
        inner = document.blocks.get(entity.dxf.name) or ()
    budget.take("elements drawn", times, "choose layers, or draw without blocks of blocks")
    for member in inner:
        _count(member, document, budget, times, level + 1)


def _clamped(spline: Any) -> Any:
    """Return a spline with full end knots: CAD programs write closed ones with simple knots.

    ezdxf 1.4 flattens those beyond the range in which they are defined.
    """
    if spline.is_clamped:
        return spline
    degree, n = spline.degree, spline.count
    knots, weights = np.array(spline.knots()), np.array(spline.weights() or [1.0] * n)
    points = weights[:, None] * np.array([list(point) for point in spline.control_points])
    curve = scipy.interpolate.BSpline(knots, np.column_stack([points, weights]), degree)
    first, last = knots[degree], knots[n]
    for end in (first, last):
        if missing := max(degree - int((curve.t == end).sum()), 0):
            curve = curve.insert_knot(end, missing)
    begin, stop = np.flatnonzero(curve.t == first)[-1], np.flatnonzero(curve.t == last)[0]
    inner = curve.t[begin + 1 : stop] - first
    full = [*[0.0] * (degree + 1), *inner.tolist(), *[last - first] * (degree + 1)]
    kept = curve.c[begin - degree : stop]
    rational = kept[:, 3].tolist() if spline.is_rational else None
    return type(spline)(kept[:, :3] / kept[:, 3:], degree + 1, full, rational)


def _loops(
    path: Path, curves: list[tuple[str, Floats]], reach: float, extent: float
) -> list[Floats]:
    """Return chains of curves that close, in the order of the first curve of each."""
    shapely = shapely_or_error()
    ends = np.array([points[k] for _, points in curves for k in (0, -1)])
    with naming(path):
        spot = close_parts(ends, reach)
    _, first = np.unique(spot, return_index=True)
    ends = ends[first[spot]]  # those that meet are at one place
    lines = []
    number: dict[tuple[float, ...], int] = {}  # of the first curve that ends at a place
    for k, (where, points) in enumerate(curves):
        if np.hypot(*np.ptp(points, axis=0)) <= reach:
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
        raise FileError(path, f"curves must form closed loops: {_open_ends(places, names, extent)}")
    loops.sort(key=lambda points: min(number[tuple(p)] for p in points if tuple(p) in number))
    return [points[:-1] for points in loops]


def _open_ends(ends: Floats, names: list[str], extent: float) -> str:
    """Return where chains end, and what closes the gaps."""
    # An end finds itself, or one at its place, and the next.
    gaps, near = scipy.spatial.cKDTree(ends).query(ends, k=2)
    problems = {}
    for k, gap in enumerate(gaps[:, 1].tolist()):
        place = point_text(ends[k])
        if gap:
            problems[
                f"an end of {names[k]} at {place} meets no other, {gap:.3g} mm from the end at "
                f"{point_text(ends[near[k, 1]])} of {names[near[k, 1]]}"
            ] = gap
        else:
            problems[
                f"more than two ends meet at {place}: choose layers, or remove lines drawn twice"
            ] = gap
    said = named(problems)
    widest = max(problems.values())
    if 0.0 in problems.values():
        return said
    if widest <= _GAP * extent:
        return f"{said}; join={1.01 * widest:.3g} (mm) closes gaps"
    return f"{said}; a curve is missing, or lies on a layer that was not chosen"


def _with_holes(path: Path, loops: list[Floats], apart: float) -> FilmOutline:
    """Return the largest loop with the others as its holes; all are ``apart`` at least."""
    if not loops:
        raise FileError(path, "curves must form closed loops with an area, got none")
    if flat := [p for p in loops if len(p) < 3]:
        listed = named(flat, lambda p: " to ".join(map(point_text, p[:2])))
        raise FileError(
            path,
            f"closed loops must have an area, got a line there and back at {listed}: is it drawn "
            "twice? Remove it; a slit is cut in the mesh, by Mesh.cut",
        )
    name = [f"the loop of {area_of(p):.4g} mm² around {point_text(p.mean(axis=0))}" for p in loops]
    largest = max(range(len(loops)), key=lambda k: area_of(loops[k]))
    if problems := not_one_film(loops, name, outer=largest, apart=apart):
        raise FileError(
            path,
            f"all loops must lie in the largest, of {area_of(loops[largest]):.4g} mm², apart, and "
            f"not in each other: {'; '.join(problems)}; choose the layers of one film, or correct "
            "the drawing",
        )
    return FilmOutline(loops[largest], tuple(p for k, p in enumerate(loops) if k != largest))
