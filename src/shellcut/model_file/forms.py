"""How a value is written in a model file: what it wants, and what comes of it."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from numbers import Real
from types import NoneType
from typing import Any, Literal, get_args, get_origin

from shellcut.arguments import Option

from .quantity import quantity

# No quantity of a film and its cut comes near these limits in mm, N, s and t, and their fourth
# powers are still within the range of a double.
_SMALLEST, _LARGEST = 1e-18, 1e18

_STEM = re.compile(r"[\w.-]+")
_LARGEST_COUNT = 10**9  # of anything: quads, teeth, rows, steps between two checks


@dataclass(frozen=True)
class Form:
    """How a value is written."""

    wants: str
    """Description for the table of keys."""
    read: Callable[[Any, str], Any]
    """Converts the TOML value, in a unit; raises ValueError with "must be ..., got ..."."""
    schema: dict[str, Any]
    """Of JSON, without unit and bounds."""


def form_of(kind: Any, option: Option) -> Form:
    """Return the form of an argument from its type, or by the name that the option gives."""
    if option.form:
        return FORMS[option.form]
    first = next(one for one in get_args(kind) or (kind,) if one is not NoneType)
    if isinstance(first, str):  # of a Literal
        return choice(*get_args(kind))
    return choice(*get_args(first)) if get_origin(first) is Literal else _PLAIN[first]


def choice(*allowed: str) -> Form:
    """Return the form of a name out of several."""
    listed = ", ".join(f'"{name}"' for name in allowed)

    def read(value: Any, _unit: str) -> str:
        if value not in allowed:
            raise ValueError(f"must be one of {listed}, got {value!r}")
        return str(value)

    return Form(listed, read, {"enum": list(allowed)})


def _number(value: Any, unit: str, *, smallest: float = _SMALLEST) -> float:
    wants = f"a number in {unit}" if unit else "a number"
    if isinstance(value, str):
        x = quantity(value, unit)
    elif isinstance(value, bool) or not isinstance(value, Real) or not math.isfinite(value):
        raise ValueError(f"must be {wants}, got {value!r}")
    else:
        x = float(value)
    if x and not smallest <= abs(x) <= _LARGEST:
        raise ValueError(
            f"must be {wants}, 0 or from {_SMALLEST:g} to {_LARGEST:g} in magnitude, got {value!r}"
        )
    return x


def _whole(value: Any, _unit: str = "") -> int:
    if isinstance(value, bool) or not isinstance(value, int):
        raise ValueError(f"must be a whole number, got {value!r}")
    if abs(value) > _LARGEST_COUNT:
        raise ValueError(f"must be a whole number up to {_LARGEST_COUNT:,}, got a larger one")
    return value


def _flag(value: Any, _unit: str) -> bool:
    if not isinstance(value, bool):
        raise ValueError(f"must be true or false, got {value!r}")
    return value


def _text(value: Any, _unit: str = "") -> str:
    if not isinstance(value, str) or not value:
        raise ValueError(f"must be a text, got {value!r}")
    return value


def _stem(value: Any, _unit: str) -> str:
    if not _STEM.fullmatch(_text(value)):
        raise ValueError(f"must be letters, digits, '.', '_', '-', got {value!r}")
    return str(value)


def _several(wants: str, one: Callable[[Any, str], Any], count: int | None = None) -> Any:
    """Return what reads an array."""

    def read(value: Any, unit: str) -> tuple[Any, ...]:
        if not isinstance(value, list | tuple) or (count is not None and len(value) != count):
            raise ValueError(f"must be an array of {wants}, got {value!r}")
        return tuple(one(part, unit) for part in value)

    return read


def _or_text(other: Callable[[Any, str], Any], wants: str = "") -> Any:
    """Return what reads a text, or else something else."""

    def read(value: Any, unit: str) -> Any:
        if isinstance(value, str):
            return _text(value)
        if wants and not isinstance(value, list | tuple):
            raise ValueError(f"must be {wants}, got {value!r}")
        return other(value, unit)

    return read


def _component(value: Any, unit: str) -> float:
    return _number(value, unit, smallest=0.0)  # as small as the round-off of a sine


def _axes(value: Any, _unit: str) -> str:
    if not isinstance(value, str) or set(value) - set("xyz"):
        raise ValueError(f"must be made of the letters x, y, z, got {value!r}")
    return value


def _names(value: Any, _unit: str) -> tuple[str, ...]:
    if isinstance(value, str):
        return (_text(value),)
    if not isinstance(value, list | tuple):
        raise ValueError(f"must be a name or an array of names, got {value!r}")
    return tuple(_text(one) for one in value)


def _rates(value: Any, unit: str) -> tuple[tuple[str, float], ...]:
    pairs = value.items() if isinstance(value, dict) else value
    if not isinstance(value, dict | tuple) or {axis for axis, _ in pairs} - set("xyz"):
        raise ValueError(f"must be a table of numbers for x, y, z, got {value!r}")
    return tuple((axis, _number(one, unit)) for axis, one in pairs)


_ARRAY = {"type": "array"}
_TEXT = {"type": "string"}
NUMBER = {"type": ["number", "string"]}
_NUMBERS = {"type": "array", "items": NUMBER}
_WHOLES = {"type": "array", "items": {"type": "integer"}}
_3_NUMBERS = _several("3 numbers", _component, 3)
_WHOLE_NUMBERS = _several("whole numbers", _whole)
_POLYGON = _several("points [x, y] in mm", _several("2 numbers", _component, 2))

_PLAIN: dict[Any, Form] = {
    float: Form("number", _number, {"type": "number"}),
    int: Form("whole number", _whole, {"type": "integer"}),
    bool: Form("true or false", _flag, {"type": "boolean"}),
    str: Form("text", _text, _TEXT),
}
FORMS = {
    "stem": Form("text", _stem, {"type": "string", "pattern": f"^{_STEM.pattern}$"}),
    "number": _PLAIN[float],
    "path": Form("path", _text, _TEXT),
    "numbers": Form("array of numbers", _several("numbers", _component), _NUMBERS),
    "3 numbers": Form("array of 3 numbers", _3_NUMBERS, {**_NUMBERS, "minItems": 3, "maxItems": 3}),
    "whole numbers": Form("array of whole numbers", _WHOLE_NUMBERS, _WHOLES),
    "names": Form("name or names", _names, {"type": ["string", "array"], "items": _TEXT}),
    "nodes": Form(
        "node set or ids",
        _or_text(_WHOLE_NUMBERS, "the name of a node set or an array of node ids"),
        {**_WHOLES, "type": ["string", "array"]},
    ),
    "axes": Form("of the letters x, y, z", _axes, {"type": "string", "pattern": "^[xyz]*$"}),
    "unit": Form(
        "name of a unit, or its length in mm",
        _or_text(lambda value, _: _number(value, "mm")),
        {"type": ["string", "number"]},
    ),
    "direction": Form(
        '"x", "y", "z", "-x", ... or 3 numbers',
        _or_text(_3_NUMBERS),
        {"type": ["string", "array"]},
    ),
    "polygon": Form("array of [x, y]", _POLYGON, _ARRAY),
    "polygons": Form("array of polygons", _several("polygons", _POLYGON), _ARRAY),
    "rates": Form("table of x, y, z", _rates, {"type": "object"}),
    "tables": Form("array of tables", lambda value, _: value, _ARRAY),
}
"""Forms that types do not tell, by the names in :class:`~shellcut.arguments.Option`."""


def written(value: Any) -> str:
    """Return a value in TOML."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int | float):
        return repr(value)
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if value and all(isinstance(one, tuple) and isinstance(one[0], str) for one in value):
        return "{ " + ", ".join(f"{axis} = {rate!r}" for axis, rate in value) + " }"
    return "[" + ", ".join(written(one) for one in value) + "]"
