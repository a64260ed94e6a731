"""Curves of a DXF file, read by ezdxf (``pip install 'shellcut[outline]'``, MIT)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import scipy

from shellcut.arrays import Floats
from shellcut.unit import LENGTH

from .budget import LIMITS, Budget
from .drawing import DEVIATION, FEWER_POINTS, LARGEST_FILE, Curve, Drawing, extent_of
from .errors import FileError, as_file, named, read_bytes

# $INSUNITS; 0 is without a unit, others (miles, light years) are no films
_UNITS = {
    1: float(LENGTH["in"]),
    2: float(LENGTH["ft"]),
    4: 1.0,
    5: float(LENGTH["cm"]),
    6: float(LENGTH["m"]),
    8: float(LENGTH["in"]) * 1e-6,
    9: float(LENGTH["mil"]),
    13: float(LENGTH["um"]),
    14: 100.0,
}
_BINARY, _BINARY_END = b"AutoCAD Binary DXF", b"EOF\0"
_CURVES = {"LINE", "LWPOLYLINE", "POLYLINE", "ARC", "CIRCLE", "ELLIPSE", "SPLINE", "HELIX"}
_ARC = 45.0  # degrees of an arc that become a cubic, which is then 4e-6 of the radius off
_FEWEST = 8  # sides of each cubic: a turn of 6 degrees
_FLAT = 1e-6  # over the diagonal: heights of points in one plane differ by less


def read_dxf(
    path: str | Path, layers: Collection[str] = (), chord_deviation: float | None = None
) -> Drawing:
    """Read the curves of the model space: lines, polylines, arcs, ellipses, splines, blocks.

    Layers are named in any case; by default those that are switched on are read. The chord
    deviation is in the file's unit, by default :data:`drawing.DEVIATION` of the diagonal.
    """
    path = Path(path)
    content = read_bytes(path, LARGEST_FILE)
    document = _document(path, content)
    chosen = _layers(path, document, layers)
    kinds: Counter[str] = Counter()
    budget = Budget(path)
    paths = list(_paths(path, document, chosen, kinds, budget))
    if chord_deviation is None:
        corners = [list(p)[:2] for _, c in paths for p in c.control_vertices()]
        box = np.array(corners or [[0.0, 0.0]])
        chord_deviation = DEVIATION * (extent_of(box) or 1.0)
    curves, heights = [], [0.0]
    for where, curve in paths:
        points = np.array([list(p) for p in curve.flattening(chord_deviation, segments=_FEWEST)])
        budget.take("points of curves", len(points), FEWER_POINTS)
        if len(points) > 1:
            curves.append(Curve(points[:, :2], where))
            heights += points[:, 2].tolist()
    if curves:
        flat = _FLAT * extent_of(np.concatenate([curve.points for curve in curves]))
        if np.ptp(heights[1:]) > flat:
            raise FileError(
                path,
                f"the drawing must be flat, got heights z of {min(heights[1:]):g} to "
                f"{max(heights[1:]):g}; project it in the CAD program, or choose layers",
            )
    # ezdxf takes metres where the file has no header, or no unit in it
    stated = document.header.get("$INSUNITS", 0) if b"$INSUNITS" in content else 0
    drawing = Drawing(path, curves, _UNITS.get(stated))
    drawing.left_out(kinds)
    return drawing


def _document(path: Path, content: bytes) -> Any:
    try:
        from ezdxf.filemanagement import readfile
    except ImportError:
        raise ImportError(
            f"{path}: reading DXF needs ezdxf, an optional extra: pip install 'shellcut[outline]'"
        ) from None
    if content.startswith(b"AC10"):
        raise FileError(path, "this is a DWG file under another name; save it as DXF")
    if content.startswith(_BINARY) and (end := content.rfind(_BINARY_END)) > 0:
        content = content[: end + len(_BINARY_END)]  # ezdxf stumbles over what follows
    try:
        with as_file(path, content) as file:
            # the encoding that a file states is not that of its copy in UTF-8
            document = readfile(file, encoding=None if file == path else _encoding(content))
        document.modelspace()  # not there in some damaged files
        return document
    except Exception as reason:  # a damaged file makes ezdxf raise errors of all kinds
        raise FileError(path, f"ezdxf cannot read it: {_told(reason)}") from None


def _encoding(content: bytes) -> str | None:
    try:
        content.decode()
    except UnicodeDecodeError:
        return None  # that of $DWGCODEPAGE
    return "utf-8"


def _told(reason: Exception) -> str:
    # in one line; some errors have no words
    return " ".join(str(reason).split()) or type(reason).__name__


def _layers(path: Path, document: Any, wanted: Collection[str]) -> set[str]:
    # names in lower case, as DXF compares them
    on = {one.dxf.name.lower(): one.is_on() and not one.is_frozen() for one in document.layers}
    used = {entity.dxf.layer for entity in document.modelspace()}
    if not wanted:
        return {name.lower() for name in used if on.get(name.lower(), True)}
    present = {name.lower() for name in used}
    if lost := [name for name in wanted if name.lower() not in present]:
        raise FileError(
            path,
            f"there is nothing on the layers {named(lost)}; layers in use: {named(sorted(used))}",
        )
    return {name.lower() for name in wanted}


def _paths(
    path: Path, document: Any, layers: set[str], others: Counter[str], budget: Budget
) -> Iterator[tuple[str, Any]]:
    # paths of ezdxf with their place; entities that are no curves are counted
    from ezdxf.path import make_path

    for layout in document.layouts:
        if n := sum(one.dxftype() != "VIEWPORT" for one in layout if not layout.is_modelspace):
            others[f"entities in paper space {layout.name!r}"] = n
    for outer in document.modelspace():
        if outer.dxf.layer.lower() not in layers:
            others[f"entities on layer {outer.dxf.layer!r}"] += 1
            continue
        try:
            entity: Any  # each kind has attributes of its own
            for entity in _decomposed([outer], others, budget):
                kind = entity.dxftype()
                if kind not in _CURVES:
                    others[kind] += 1
                    continue
                where = f"{kind} on layer {outer.dxf.layer!r}"
                if kind == "SPLINE" and len(entity.control_points) and not _is_clamped(entity):
                    yield where, _OpenSpline(entity)
                else:
                    yield where, make_path(entity, segments=_n_cubic(entity, kind))
        except FileError:
            raise
        except Exception as reason:  # numbers that make no curve raise errors of all kinds
            raise FileError(
                path,
                f"{outer.dxftype()} #{outer.dxf.handle} on layer {outer.dxf.layer!r} is no curve: "
                f"{_told(reason)}",
            ) from None


def _decomposed(
    entities: Iterable[Any], others: Counter[str], budget: Budget, level: int = 0
) -> Iterator[Any]:
    # ezdxf.disassemble.recursive_decompose, which follows blocks of blocks without a limit
    from ezdxf.entities.insert import Insert
    from ezdxf.protocols import SupportsVirtualEntities, virtual_entities

    def skip(entity: Any, reason: str) -> None:
        others[f"{entity.dxftype()} ({reason})"] += 1

    budget.descend("blocks", level)
    for entity in entities:
        budget.take("elements drawn", remedy="choose layers, or draw without blocks of blocks")
        inner: Iterable[Any] = ()
        if isinstance(entity, Insert):
            if not entity.dxf.zscale:  # flattens a flat block, but has no inverse
                entity.dxf.zscale = abs(entity.dxf.xscale)
            rows, columns = max(entity.dxf.row_count, 1), max(entity.dxf.column_count, 1)
            if rows * columns > 1:
                budget.take("elements drawn", rows * columns, "choose layers, or fewer copies")
                inner = entity.multi_insert()
            else:
                yield from entity.attribs
                inner = entity.virtual_entities(skipped_entity_callback=skip)
        elif isinstance(entity, SupportsVirtualEntities):
            inner = virtual_entities(entity)
        else:
            yield entity
            continue
        yield from _decomposed(inner, others, budget, level + 1)


def _n_cubic(entity: Any, kind: str) -> int:
    if kind == "ARC":
        angle = (entity.dxf.end_angle - entity.dxf.start_angle) % 360.0 or 360.0
        return int(np.ceil(angle / _ARC))
    return int(360.0 / _ARC) if kind in ("CIRCLE", "ELLIPSE") else int(180.0 / _ARC)


def _is_clamped(entity: Any) -> bool:
    # whether the curve begins and ends in its first and last control points
    order, knots = entity.dxf.degree + 1, np.array(entity.knots)
    return len(knots) < 2 * order or not (np.ptp(knots[:order]) or np.ptp(knots[-order:]))


class _OpenSpline:
    """A spline whose end knots are simple, as CAD programs write closed ones.

    ezdxf 1.4 draws it beyond the range in which it is defined.
    """

    def __init__(self, entity: Any) -> None:
        points = np.array([list(p) for p in entity.control_points], dtype=np.float64)
        weights = np.array(entity.weights if len(entity.weights) else np.ones(len(points)))
        self._points, self._degree = points, int(entity.dxf.degree)
        homogeneous = np.column_stack([points * weights[:, None], weights])
        self._spline = scipy.interpolate.BSpline(
            np.array(entity.knots), homogeneous, self._degree, extrapolate=False
        )
        self._range = self._spline.t[self._degree : len(points) + 1]

    def control_vertices(self) -> Floats:
        """Return the control points, shape (n, 3)."""
        return self._points

    def flattening(self, deviation: float, segments: int) -> Floats:
        """Return points on the curve, shape (n, 3), between which no chord is farther off."""
        spans = np.unique(self._range)
        while True:
            at = np.concatenate([np.linspace(a, b, segments + 1)[:-1] for a, b in pairwise(spans)])
            at = np.append(at, spans[-1])
            points, middles = self._at(at), self._at(0.5 * (at[1:] + at[:-1]))
            off = np.linalg.norm(middles - 0.5 * (points[1:] + points[:-1]), axis=1)
            if off.max() <= deviation or len(at) > LIMITS["points of curves"]:
                return points
            segments *= 2

    def _at(self, parameter: Floats) -> Floats:
        values = self._spline(parameter)
        points: Floats = values[:, :3] / values[:, 3:]
        return points
