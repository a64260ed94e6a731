"""How a value is written in a model file: a kind of value, with units and in the words of TOML."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass
from numbers import Real
from types import NoneType, UnionType
from typing import Any, Literal, Union, get_args, get_origin

from shellcut.arguments import Option, fits, is_number

from .quantity import quantity

# No quantity of a film and its cut is near these limits in mm, N, s and t, and their fourth
# powers are still within the range of a double.
_SMALLEST, _LARGEST = 1e-18, 1e18

_SHOWN = 200  # letters of a value in a message
_LARGEST_COUNT = 10**9  # of anything: quads, teeth, rows, steps between two checks


@dataclass(frozen=True)
class Form:
    """How a value is written.

    Examples
    --------
    >>> FORMS["3 numbers"].read([1, "2 cm", 0], Option("mm", "a place"))
    (1.0, 20.0, 0.0)
    """

    words: str
    """What the value must be, as in "must be a number"."""
    kind: Any
    """Its type in Python, with arrays as tuples."""
    pattern: str = ".+"
    """Regular expression of a text."""

    @property
    def wants(self) -> str:
        """The words as in a table of keys."""
        return re.sub("^(an?|one of) ", "", self.words)

    def read(self, value: Any, option: Option) -> Any:
        """Return a value of TOML, with units converted; ValueError "must be ..., got ..."."""
        words = self.words
        if self.kind is float and option.unit:
            words += f" in {option.unit}"
        least = 0.0 if _is_array(self.kind) else _SMALLEST  # of a sine, as small as round-off
        read = _converted(value, self.kind, option.unit, least)
        is_other_text = isinstance(read, str) and not re.fullmatch(self.pattern, read, re.DOTALL)
        if is_other_text or not fits(read, self.kind):
            parts = get_args(self.kind)
            is_fixed = _is_array(self.kind) and Ellipsis not in parts
            comma = ""
            if is_fixed and isinstance(read, tuple) and len(read) > len(parts):
                comma = ": a comma separates numbers, the decimal sign is a point"
            got = repr(value)
            if len(got) > _SHOWN:
                got = f"{got[:_SHOWN]}..."
            raise ValueError(f"must be {words}, got {got}{comma}")
        if is_number(read) and (beyond := option.problem(read)):
            raise ValueError(beyond)
        return read

    def schema(self) -> dict[str, Any]:
        """Return its JSON Schema, without unit and bounds."""
        found = _schema(self.kind)
        if self.pattern != ".+":
            found["pattern"] = f"^{self.pattern}$"
        return found


def form_of(kind: Any, option: Option) -> Form:
    """Return the form of an argument from its type, or by the name that the option gives."""
    if option.form:
        return FORMS[option.form]
    literals = [literal for literal in get_args(kind) or (kind,) if literal is not NoneType]
    if isinstance(literals[0], str):
        return choice(*literals)
    first = literals[0]
    return choice(*get_args(first)) if get_origin(first) is Literal else _PLAIN[first]


def choice(*allowed: str) -> Form:
    """Return the form of a name out of several."""
    return Form(f"one of {', '.join(map(written, allowed))}", Literal[allowed])


_PLAIN: dict[Any, Form] = {
    float: Form("a number", float),
    int: Form("a whole number", int),
    bool: Form("true or false", bool),
    str: Form("a text", str),
}
_3_NUMBERS = tuple[float, float, float]
_POLYGON = tuple[tuple[float, float], ...]
FORMS = {
    "stem": Form("letters, digits, '.', '_', '-'", str, r"[\w.-]+"),
    "number": _PLAIN[float],
    "path": Form("a path", str),
    "paths": Form("an array of paths", tuple[str, ...]),
    "numbers": Form("an array of numbers", tuple[float, ...]),
    "3 numbers": Form("an array of 3 numbers", _3_NUMBERS),
    "whole numbers": Form("an array of whole numbers", tuple[int, ...]),
    "names": Form("a name or an array of names", str | tuple[str, ...]),
    "nodes": Form("the name of a node set or an array of node ids", str | tuple[int, ...]),
    "quads": Form("the name of a quad set or an array of quad ids", str | tuple[int, ...]),
    "axes": Form("of the letters x, y, z", str, "[xyz]*"),
    "unit": Form("a name of a unit, or its length in mm", str | float),
    "direction": Form('"x", "y", "z", "-x", ... or 3 numbers', str | _3_NUMBERS),
    "polygon": Form("an array of points [x, y]", _POLYGON),
    "polygons": Form("an array of polygons, arrays of points [x, y]", tuple[_POLYGON, ...]),
    "rates": Form("a table of numbers for x, y, z", dict[Literal["x", "y", "z"], float]),
    "table": Form("a table", dict[str, Any]),
    "tables": Form("an array of tables", tuple[dict[str, Any], ...]),
}
"""Forms that types do not tell, by the names in :class:`~shellcut.arguments.Option`."""


def _converted(value: Any, kind: Any, unit: str, least: float) -> Any:
    """Return a value with numbers in ``unit`` where the kind has some, and arrays as tuples.

    What a number can be is checked; whether the value is of the kind is not.
    """
    kinds = get_args(kind) if get_origin(kind) in (Union, UnionType) else (kind,)
    if isinstance(value, str) and float in kinds and str not in kinds:
        return _number(quantity(value, unit), unit, least)
    if isinstance(value, str) and tuple[str, ...] in kinds:
        return (value,)
    if isinstance(value, Real) and not isinstance(value, bool):
        if float in kinds:
            return _number(float(value), unit, least)
        if isinstance(value, int) and abs(value) > _LARGEST_COUNT:
            raise ValueError(f"must be a whole number up to {_LARGEST_COUNT:,}, got a larger one")
    if isinstance(value, list | tuple):
        parts = next((get_args(item) for item in kinds if _is_array(item)), (Any,))
        return tuple(_converted(item, parts[0], unit, least) for item in value)
    if isinstance(value, Mapping) and float in get_args(kind):
        return {name: _converted(item, float, unit, least) for name, item in value.items()}
    return value


def _number(value: float, unit: str, least: float) -> float:
    if value and not least <= abs(value) <= _LARGEST:
        within = f"0 or from {_SMALLEST:g} to {_LARGEST:g} in magnitude"
        raise ValueError(
            f"must be a number{f' in {unit}' if unit else ''}, {within}, got {value!r}"
        )
    return value


def _is_array(kind: Any) -> bool:
    return get_origin(kind) is tuple


NUMBER: dict[str, Any] = {"type": ["number", "string"]}
"""The form of a number, which may be a text with a unit."""


def _schema(kind: Any) -> dict[str, Any]:
    origin, parts = get_origin(kind), get_args(kind)
    if origin is Literal:
        return {"enum": list(parts)}
    if origin is tuple:
        size = {} if Ellipsis in parts else {"minItems": len(parts), "maxItems": len(parts)}
        items = {} if get_origin(parts[0]) is dict else {"items": _schema(parts[0])}
        return {"type": "array", **items, **size}
    if origin in (Union, UnionType):
        several = [_schema(part) for part in parts]
        names = ["number" if form == NUMBER else form["type"] for form in several]
        return {**several[0], **several[1], "type": names}
    if kind is float:
        return dict(NUMBER)
    plain = {int: "integer", bool: "boolean", str: "string"}
    return {"type": plain.get(kind, "object")}


def written(value: Any) -> str:
    """Return a value in TOML."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int | float):
        return repr(value)
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{name} = {written(item)}" for name, item in value.items()) + " }"
    return "[" + ", ".join(written(item) for item in value) + "]"
