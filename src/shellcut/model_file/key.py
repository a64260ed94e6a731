"""Keys of a model file (type, unit, meaning), and sections made of keys.

A section is a frozen dataclass whose fields carry their :class:`Key` as metadata. If the section
holds arguments of a constructor, the defaults come from its signature.
"""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable
from dataclasses import MISSING, dataclass, field, fields
from numbers import Real
from typing import Any, ClassVar, TypeVar

from .quantity import quantity

# No quantity of a film and its cut comes near these limits in mm, N, s and t, and their fourth
# powers are still within the range of a double.
_SMALLEST, _LARGEST = 1e-18, 1e18

_LARGEST_COUNT = 10**9  # of anything: quads, teeth, rows, steps between two checks

T = TypeVar("T")
Constructor = Callable[..., Any]


@dataclass(frozen=True)
class Kind:
    """Type of a value."""

    wants: str
    """Description for the table of keys."""
    read: Callable[[Any], Any]
    """Converts the TOML value; raises ValueError with "must be ..., got ..."."""
    unit: str = ""
    is_file: bool = False
    tables: type[Section] | None = None
    """Section class of the tables, if the value is an array of tables."""


@dataclass(frozen=True)
class Key:
    """A key of a section."""

    kind: Kind
    doc: str
    default: Any = MISSING
    """If missing, the constructor's default; a key with neither must be given."""
    parameter: str = ""
    """Name in the constructor, if different."""
    also: str = ""
    """A second accepted name."""
    unset: str = ""
    """Meaning of leaving out a key whose default is None."""


def key(
    kind: Kind,
    doc: str,
    *,
    default: Any = MISSING,
    parameter: str = "",
    also: str = "",
    unset: str = "",
) -> Any:
    """Return a :class:`Key`, as the default of a field of any type."""
    return Key(kind, doc, default, parameter, also, unset)


class Section:
    """A section of a model file, or one kind of it."""

    title: ClassVar[str] = ""
    kind: ClassVar[str] = ""
    """Value of its key ``kind``; empty if the section has only one kind."""
    sign: ClassVar[str] = ""
    """A key that identifies the kind if ``kind`` is not given."""
    constructor: ClassVar[Constructor | None] = None
    deferred: ClassVar[bool] = False
    """Whether it is constructed only when the model is built, because that reads a file."""

    @classmethod
    def keys(cls) -> dict[str, Key]:
        """Return the keys by name."""
        return {f.name: f.metadata["key"] for f in fields(cls)}  # type: ignore[arg-type]

    @classmethod
    def names(cls) -> list[str]:
        """Return all names allowed in the section, including second names."""
        keys = cls.keys()
        own = ["kind"] if cls.kind else []
        return [*own, *keys, *(key.also for key in keys.values() if key.also)]

    def arguments(self) -> dict[str, Any]:
        """Return the values of the constructor's arguments."""
        assert self.constructor is not None
        known = inspect.signature(self.constructor).parameters
        given = {key.parameter or name: getattr(self, name) for name, key in self.keys().items()}
        return {name: value for name, value in given.items() if name in known}

    def made(self) -> Any:
        """Call the constructor with the values.

        Raises
        ------
        ValueError
            If the values do not fit together.
        """
        assert self.constructor is not None
        return self.constructor(**self.arguments())


def section(
    title: str,
    *,
    of: Constructor | None = None,
    kind: str = "",
    sign: str = "",
    deferred: bool = False,
) -> Callable[[type[T]], type[T]]:
    """Make a section from a class whose attributes are keys."""

    def make(cls: type[T]) -> type[T]:
        for name, key in list(vars(cls).items()):
            if isinstance(key, Key):
                default = key.default
                if default is MISSING and of is not None:
                    default = _default(of, key.parameter or name)
                setattr(cls, name, field(default=default, metadata={"key": key}))
        for name, value in (
            ("title", title),
            ("kind", kind),
            ("sign", sign),
            ("constructor", None if of is None else staticmethod(of)),
            ("deferred", deferred),
        ):
            setattr(cls, name, value)
        return dataclass(frozen=True, kw_only=True)(cls)

    return make


def default_of(constructor: Constructor, parameter: str) -> Any:
    """Return the default of a parameter."""
    return inspect.signature(constructor).parameters[parameter].default


def _default(constructor: Constructor, parameter: str) -> Any:
    parameters = inspect.signature(constructor).parameters
    found = parameters[parameter].default if parameter in parameters else inspect.Parameter.empty
    return MISSING if found is inspect.Parameter.empty else found


# --- kinds of values -----------------------------------------------------------------------------


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


def number(unit: str = "", *, least: float | None = None, above: float | None = None) -> Kind:
    """Return the kind of a number; with a unit it may be a text such as "12 um".

    Give bounds only where no constructor checks the value before the model is built.
    """

    def read(value: Any) -> float:
        x = _number(value, unit)
        if least is not None and x < least:
            raise ValueError(f"must be {least:g} or more, got {value!r}")
        if above is not None and x <= above:
            raise ValueError(f"must be above {above:g}, got {value!r}")
        return x

    return Kind("number", read, unit)


def _whole(value: Any) -> int:
    if isinstance(value, bool) or not isinstance(value, int):
        raise ValueError(f"must be a whole number, got {value!r}")
    if abs(value) > _LARGEST_COUNT:
        raise ValueError(f"must be a whole number up to {_LARGEST_COUNT:,}, got a larger one")
    return value


def _flag(value: Any) -> bool:
    if not isinstance(value, bool):
        raise ValueError(f"must be true or false, got {value!r}")
    return value


def _text(value: Any) -> str:
    if not isinstance(value, str) or not value:
        raise ValueError(f"must be a text, got {value!r}")
    return value


whole = Kind("whole number", _whole)
flag = Kind("true or false", _flag)
text = Kind("text", _text)
file = Kind("path", _text, is_file=True)


def count(least: int) -> Kind:
    """Return the kind of a whole number with a lower bound."""

    def read(value: Any) -> int:
        if _whole(value) < least:
            raise ValueError(f"must be {least} or more, got {value!r}")
        return _whole(value)

    return Kind(f"whole number from {least} on", read)


def choice(*allowed: str, instead_of: Callable[[Any], str] = lambda _: "") -> Kind:
    """Return the kind of a name out of several; a refusal ends with what to write instead."""
    listed = ", ".join(f'"{name}"' for name in allowed)

    def read(value: Any) -> str:
        if value not in allowed:
            raise ValueError(f"must be one of {listed}, got {value!r}{instead_of(value)}")
        return str(value)

    return Kind(listed, read)


def numbers(unit: str = "", *, count: int | None = None) -> Kind:
    """Return the kind of an array of numbers."""
    wants = "numbers" if count is None else f"{count} numbers"

    def read(value: Any) -> tuple[float, ...]:
        if not isinstance(value, list | tuple) or (count is not None and len(value) != count):
            raise ValueError(f"must be an array of {wants}, got {value!r}")
        # components may be as small as the round-off of a sine
        return tuple(_number(one, unit, smallest=0.0) for one in value)

    return Kind(f"array of {wants}", read, unit)


def _whole_numbers(value: Any) -> tuple[int, ...]:
    if not isinstance(value, list | tuple):
        raise ValueError(f"must be an array of whole numbers, got {value!r}")
    return tuple(_whole(one) for one in value)


def _names(value: Any) -> tuple[str, ...]:
    if isinstance(value, str):
        return (_text(value),)
    if not isinstance(value, list | tuple):
        raise ValueError(f"must be a name or an array of names, got {value!r}")
    return tuple(_text(one) for one in value)


def _set_or_ids(value: Any) -> str | tuple[int, ...]:
    if isinstance(value, str):
        return _text(value)
    if not isinstance(value, list | tuple):
        raise ValueError(f"must be the name of a node set or an array of node ids, got {value!r}")
    return _whole_numbers(value)


def _axes(value: Any) -> str:
    if not isinstance(value, str) or set(value) - set("xyz"):
        raise ValueError(f"must be made of the letters x, y, z, got {value!r}")
    return value


axes = Kind("of the letters x, y, z", _axes)
whole_numbers = Kind("array of whole numbers", _whole_numbers)
names = Kind("name or names", _names)
set_or_ids = Kind("node set or ids", _set_or_ids)


def polygon() -> Kind:
    """Return the kind of a polygon, an array of points [mm]."""
    return Kind("array of [x, y]", _polygon, "mm")


def polygons() -> Kind:
    """Return the kind of an array of polygons [mm]."""

    def read(value: Any) -> tuple[Any, ...]:
        if not isinstance(value, list | tuple):
            raise ValueError(f"must be an array of polygons, got {value!r}")
        return tuple(_polygon(one) for one in value)

    return Kind("array of polygons", read, "mm")


def _polygon(value: Any) -> tuple[tuple[float, ...], ...]:
    if not isinstance(value, list | tuple):
        raise ValueError(f"must be an array of points [x, y] in mm, got {value!r}")
    point = numbers("mm", count=2).read
    return tuple(point(one) for one in value)


def _length_unit(value: Any) -> str | float:
    return _text(value) if isinstance(value, str) else _number(value, "mm")


def _direction(value: Any) -> str | tuple[float, ...]:
    if isinstance(value, str):
        return _text(value)
    read: Callable[[Any], tuple[float, ...]] = numbers(count=3).read
    return read(value)


length_unit = Kind("name of a unit, or its length in mm", _length_unit)
direction = Kind('"x", "y", "z", "-x", ... or 3 numbers', _direction)


def rates(unit: str) -> Kind:
    """Return the kind of a table from axes to constant rates, as {x = 3.0}."""

    def read(value: Any) -> tuple[tuple[str, float], ...]:
        pairs = value.items() if isinstance(value, dict) else value
        if not isinstance(value, dict | tuple) or {axis for axis, _ in pairs} - set("xyz"):
            raise ValueError(f"must be a table of numbers for x, y, z, got {value!r}")
        return tuple((axis, _number(one, unit)) for axis, one in pairs)

    return Kind("table of x, y, z", read, unit)


def tables(of: type[Section]) -> Kind:
    """Return the kind of an array of tables."""
    return Kind("array of tables", lambda value: value, tables=of)
