"""Curves of an SVG file, read by svgpathtools (``pip install 'shellcut[outline]'``, MIT).

SVG measures downwards; here y goes up from the lower edge of the page. Lengths are those of the
page: its width and height against its viewBox, as drawing programs write them.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Iterator
from math import atan2, hypot
from pathlib import Path
from typing import Any, NamedTuple
from xml.etree import ElementTree

import numpy as np

from shellcut.arrays import Floats, each, product
from shellcut.unit import LENGTH

from .budget import Budget
from .drawing import DEVIATION, FEWER_POINTS, LARGEST_FILE, LARGEST_TURN, Curve, Drawing, n_of_arc
from .errors import FileError, named, read_bytes

_SPACE = "{http://www.w3.org/2000/svg}"
_LABEL = "{http://www.inkscape.org/namespaces/inkscape}label"
_LINK = "{http://www.w3.org/1999/xlink}href"
_UNITS = {
    **{unit: float(LENGTH[unit]) for unit in ("mm", "cm", "m", "in")},
    "pt": float(LENGTH["in"]) / 72,
    "pc": float(LENGTH["in"]) / 6,
    "Q": 0.25,
}
_LENGTH = re.compile(r"([+-]?[\d.]+(?:[eE][+-]?\d+)?)\s*([A-Za-z%]*)")
_HIDDEN = re.compile(r"(?:^|;)\s*(?:display\s*:\s*none|visibility\s*:\s*hidden)")
_SHAPES = ("path", "rect", "circle", "ellipse", "line", "polyline", "polygon")
_SILENT = ("defs", "metadata", "namedview", "title", "desc", "style", "symbol", "clipPath", "mask")
_SAME_SCALE = 1e-3  # x and y may differ by the rounding of the page's size


class _Place(NamedTuple):
    """Where an element stands."""

    matrix: Floats
    """(3, 3), from its coordinates to those of the page in mm (or px), y up."""
    names: tuple[str, ...]
    """Labels and ids of the groups around it, and its own."""
    level: int


def read_svg(
    path: str | Path, layers: Collection[str] = (), chord_deviation: float | None = None
) -> Drawing:
    """Read the curves of a page: paths, rectangles, ellipses, lines, polygons, uses of them.

    Layers are labels of Inkscape's layers, or labels and ids of groups and elements; by default all
    that are not hidden are read. The chord deviation is in the file's unit, by default
    :data:`drawing.DEVIATION` of the page.
    """
    path = Path(path)
    content = read_bytes(path, LARGEST_FILE)
    try:
        import svgpathtools  # noqa: F401
    except ImportError:
        raise ImportError(
            f"{path}: reading SVG needs svgpathtools, an optional extra: "
            "pip install 'shellcut[outline]'"
        ) from None
    try:
        root = ElementTree.fromstring(content)
    except (ElementTree.ParseError, LookupError, ValueError) as reason:  # also unknown encodings
        raise FileError(path, f"it is no XML: {reason}") from None
    if _tag(root) != "svg":
        raise FileError(path, f"an SVG file must begin with <svg>, got <{_tag(root)}>")
    page, unit_mm, size = _page(path, root)
    reader = _Reader(path, root, set(layers), chord_deviation or DEVIATION * size)
    reader.read(root, _Place(page, (), 0))
    if lost := [name for name in layers if name not in reader.names]:
        raise FileError(
            path, f"there are no layers {named(lost)}; there are {named(sorted(reader.labels))}"
        )
    drawing = Drawing(path, reader.curves, unit_mm)
    if unit_mm is None:
        drawing.no_unit = (
            "the page is in px, 1/96 inch by the standard, but 1/72 or 1/90 in some programs: "
            "unit= the length of a px in mm, such as 25.4 / 96"
        )
    drawing.left_out(reader.others)
    return drawing


def _page(path: Path, root: Any) -> tuple[Floats, float | None, float]:
    # matrix from user units to the page, y up; length of its unit; its diagonal
    sides = [_length(path, root.get(name)) for name in ("width", "height")]
    box = [float(x) for x in re.findall(r"[+-]?[\d.]+(?:[eE][+-]?\d+)?", root.get("viewBox", ""))]
    stated = all(unit in _UNITS for _, unit in sides)
    width, height = (value * _UNITS.get(unit, 1.0) for value, unit in sides)
    if len(box) != 4 or not (box[2] > 0.0 and box[3] > 0.0):
        if not width > 0.0 or not height > 0.0:
            width = height = 1000.0  # no page: y goes up from its origin
        box = [0.0, 0.0, width, height]
        stated = False  # without a viewBox a user unit is a px
        width, height = box[2:]
    elif not stated:
        width, height = box[2:]
    scale = width / box[2]
    if abs(height / box[3] - scale) > _SAME_SCALE * scale:
        raise FileError(
            path,
            f"width and height must scale the viewBox alike, got {scale:.6g} and "
            f"{height / box[3]:.6g}",
        )
    up = np.array(
        [[scale, 0.0, -scale * box[0]], [0.0, -scale, scale * (box[1] + box[3])], [0.0, 0.0, 1.0]]
    )
    return up, 1.0 if stated else None, float(np.hypot(width, height))


def _length(path: Path, text: str | None) -> tuple[float, str]:
    if text is None:
        return 0.0, ""
    found = _LENGTH.fullmatch(text.strip())
    if not found:
        raise FileError(path, f"width and height must be lengths, got {text!r}")
    return float(found[1]), found[2]


class _Reader:
    def __init__(self, path: Path, root: Any, layers: set[str], deviation: float) -> None:
        self.curves: list[Curve] = []
        self.others: Counter[str] = Counter()
        self.names: set[str] = set()
        self.labels: set[str] = set()
        self._path, self._layers, self._deviation = path, layers, deviation
        self._by_id = {one.get("id"): one for one in root.iter() if one.get("id")}
        self._budget = Budget(path)

    def read(self, element: Any, place: _Place) -> None:
        """Read an element and all within it."""
        self._budget.descend("groups", place.level)
        self._budget.take("elements drawn", remedy="choose layers, or draw without <use>")
        kind = _tag(element)
        own = [name for name in (element.get(_LABEL), element.get("id")) if name]
        if kind == "g" and own:
            self.labels.add(own[0])
        if _HIDDEN.search(element.get("style", "")) or element.get("display") == "none":
            self.others["hidden"] += 1
            return
        names = (*place.names, *own)
        self.names |= set(own)
        matrix = product(place.matrix, self._transform(element))
        inner = _Place(matrix, names, place.level + 1)
        if kind in ("svg", "g", "a", "switch"):
            if kind == "svg" and place.level:
                self.others["svg"] += 1
                return
            for child in element:
                self.read(child, inner)
        elif kind == "use":
            self._use(element, inner)
        elif kind in _SHAPES:
            if not self._layers or self._layers & set(names):
                self._shape(kind, element, inner)
        elif kind and kind not in _SILENT:
            self.others[kind] += 1

    def _transform(self, element: Any) -> Floats:
        from svgpathtools import parse_transform

        try:
            matrix: Floats = parse_transform(element.get("transform"), strict=True)
        except ValueError as reason:
            raise FileError(self._path, f"{_said(element)}: {reason}") from None
        return matrix

    def _use(self, element: Any, place: _Place) -> None:
        target = self._by_id.get((element.get("href") or element.get(_LINK) or "").lstrip("#"))
        if target is None or _tag(target) == "symbol":
            self.others["use of what is not drawn here"] += 1
            return
        shift = np.eye(3)
        try:
            shift[:2, 2] = float(element.get("x", 0.0)), float(element.get("y", 0.0))
        except ValueError:
            raise FileError(
                self._path, f"{_said(element)}: x and y must be numbers without a unit"
            ) from None
        self.read(target, place._replace(matrix=product(place.matrix, shift)))

    def _shape(self, kind: str, element: Any, place: _Place) -> None:
        (a, b), (c, d) = place.matrix[:2, :2].tolist()
        stretch = 0.5 * (hypot(a + d, b - c) + hypot(a - d, b + c))
        deviation = self._deviation / max(stretch, 1e-12)
        try:
            with np.errstate(all="ignore"):  # read_drawing reports what is not finite
                parts = [
                    _flattened(part, deviation, self._budget) for part in _subpaths(kind, element)
                ]
        except FileError:
            raise
        except Exception as reason:  # the parser raises errors of all kinds
            raise FileError(
                self._path,
                f"{_said(element)} is no curve: {reason or type(reason).__name__}; lengths must be "
                "numbers without a unit",
            ) from None
        for local in parts:
            points = np.column_stack([local.real, local.imag, np.ones(len(local))])
            self.curves.append(Curve(product(points, place.matrix.T)[:, :2], _said(element)))


def _tag(element: Any) -> str:
    # without the name space; empty for comments and elements of other name spaces
    tag = element.tag if isinstance(element.tag, str) else ""
    if tag.startswith("{") and not tag.startswith(_SPACE):
        return ""
    return tag.removeprefix(_SPACE)


def _said(element: Any) -> str:
    name = element.get(_LABEL) or element.get("id")
    return f"{_tag(element)} {name!r}" if name else _tag(element)


def _subpaths(kind: str, element: Any) -> Iterator[Any]:
    from svgpathtools import CONVERSIONS, parse_path

    values = dict(element.items())
    if kind == "rect":
        width, height = float(values.get("width", 0.0)), float(values.get("height", 0.0))
        given = [float(values[name]) for name in ("rx", "ry") if values.get(name, "auto") != "auto"]
        values = {name: value for name, value in values.items() if name not in ("rx", "ry")}
        if given and max(given) > 0.0:
            values["rx"] = str(min(given[0], 0.5 * width))
            values["ry"] = str(min(given[-1], 0.5 * height))
    if kind == "line":
        ends = [float(values.get(name, 0.0)) for name in ("x1", "y1", "x2", "y2")]
        text = "M {} {} L {} {}".format(*ends)
    else:
        text = values.get("d", "") if kind == "path" else CONVERSIONS[kind](values)
    for part in parse_path(text).continuous_subpaths():
        if len(part):
            yield part


def _flattened(part: Any, deviation: float, budget: Budget) -> Floats:
    # complex points along a path without jumps
    from svgpathtools import Arc, Line

    found = [np.array([part[0].start])]
    for piece in part:
        if isinstance(piece, Line):
            n = 1
        elif isinstance(piece, Arc):
            radius = max(abs(piece.radius.real), abs(piece.radius.imag))
            n = n_of_arc(radius, np.radians(piece.delta), deviation)
        else:
            corners = np.array(piece.bpoints())
            bend = np.abs(np.diff(corners, 2)).max(initial=0.0)
            degree = len(corners) - 1
            # chords of a Bezier curve lie within n^-2 of this
            n = int(np.ceil(np.sqrt(degree * (degree - 1) * bend / 8.0 / deviation)))
            sides = np.diff(corners)
            bends = sides[1:] * np.conj(sides[:-1])
            turns = np.abs(each(atan2, bends.imag, bends.real))
            n = max(n, int(np.ceil(turns.sum() / LARGEST_TURN)), 1)
        budget.take("points of curves", n, FEWER_POINTS)
        found.append(np.array([piece.point(t) for t in np.linspace(0.0, 1.0, n + 1)[1:]]))
    points = np.concatenate(found)
    if part.isclosed():
        points[-1] = points[0]
    return points
