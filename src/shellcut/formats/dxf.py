"""Curves of a DXF file, read and flattened by ezdxf (``pip install 'shellcut[outline]'``, MIT)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass
from math import inf
from pathlib import Path
from typing import Any

import numpy as np

from shellcut.arrays import Floats, norm
from shellcut.unit import LENGTH

from .budget import LIMITS, Budget
from .errors import FileError, as_file, check_finite, named, read_bytes

LARGEST_FILE = 50_000_000
"""Largest size of a drawing [bytes]."""

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


@dataclass(frozen=True)
class DxfDrawing:
    """Curves as they are in the file."""

    path: Path
    curves: list[tuple[str, Any]]
    """Kind and layer, and the path of ezdxf."""
    unit_mm: float | None
    """Length of the file's unit [mm]; None if the file does not state it."""
    left_out: str
    """What the reader has left out, with numbers; empty if nothing."""

    def polygons(self, deviation: float = inf) -> list[tuple[str, Floats]]:
        """Return kind and layer, and points of each curve, shape (n, 2), in the file's unit.

        A chord is ``deviation`` off the curve at most; by default the turn alone counts.
        """
        budget, found = Budget(self.path), []
        for where, curve in self.curves:
            points = np.array([list(p) for p in curve.flattening(deviation, segments=_FEWEST)])
            budget.take("points of curves", len(points), "enlarge chord_deviation, choose layers")
            check_finite(self.path, points, f"point {{}} of {where}".format)
            if len(points) > 1:
                found.append((where, points))
        if found:
            places = np.concatenate([points for _, points in found])
            low, high = places[:, 2].min(), places[:, 2].max()
            if high - low > _FLAT * extent_of(places[:, :2]):
                raise FileError(
                    self.path,
                    f"the drawing must be flat, got heights z of {low:g} to {high:g}; project it "
                    "in the CAD program, or choose layers",
                )
        return [(where, points[:, :2]) for where, points in found]


def extent_of(points: Floats) -> float:
    """Return the diagonal of the box around points, shape (n, 2)."""
    return float(norm(np.ptp(points, axis=0)))


def read_dxf(path: Path, layers: Collection[str] = ()) -> DxfDrawing:
    """Read the curves of the model space: lines, polylines, arcs, ellipses, splines, blocks.

    Layers are named in any case; by default those that are switched on are read.
    """
    content = read_bytes(path, LARGEST_FILE)
    document = _document(path, content)
    others: Counter[str] = Counter()
    curves = list(_curves(path, document, _layers(path, document, layers), others))
    # ezdxf takes metres where the file has no header, or no unit in it
    stated = document.header.get("$INSUNITS", 0) if b"$INSUNITS" in content else 0
    left_out = ", ".join(f"{n} {kind}" for kind, n in sorted(others.items()))
    return DxfDrawing(path, curves, _UNITS.get(stated), left_out)


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


def _curves(
    path: Path, document: Any, layers: set[str], others: Counter[str]
) -> Iterator[tuple[str, Any]]:
    # entities that are no curves are counted
    from ezdxf.path import make_path

    budget = Budget(path)
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
                if kind == "SPLINE" and not (spline := entity.construction_tool()).is_clamped:
                    yield where, _OpenSpline(spline)
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


@dataclass(frozen=True)
class _OpenSpline:
    """A spline whose end knots are simple, as CAD programs write closed ones.

    ezdxf 1.4 flattens it beyond the range in which it is defined.
    """

    spline: Any

    def flattening(self, deviation: float, segments: int) -> list[Any]:
        """Return points on the curve between which no chord is farther off."""
        knots = np.array(self.spline.knots())
        spans = np.unique(knots[self.spline.degree : self.spline.count + 1])
        while True:
            parameters = np.interp(
                np.arange(segments * (len(spans) - 1) + 1) / segments, np.arange(len(spans)), spans
            )
            points = list(self.spline.points(parameters))
            middles = self.spline.points(0.5 * (parameters[1:] + parameters[:-1]))
            off = (
                middle.distance(a.lerp(b))
                for a, b, middle in zip(points[:-1], points[1:], middles, strict=True)
            )
            if max(off) <= deviation or len(points) > LIMITS["points of curves"]:
                return points
            segments *= 2
