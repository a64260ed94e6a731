"""Keys of a model file, how their values are written, and the kinds of sections that they make.

A key is an argument of a constructor with its :class:`~shellcut.arguments.Option`: type, unit,
bounds, meaning and default are declared there, and nowhere else. A model file may call it by
another name, or give it the default of a ready model. Its form says how a value is written: a kind
of value, with units and in the words of TOML.
"""

from __future__ import annotations

import functools
import inspect
import json
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from numbers import Real
from types import NoneType, UnionType
from typing import Any, Literal, Union, get_args, get_origin

from shellcut.arguments import Option, declared, fits, is_number
from shellcut.mesh.drawing import FilmOutline

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
    match value:
        case bool():
            return str(value).lower()
        case int() | float():
            return repr(value)
        case str():
            return json.dumps(value, ensure_ascii=False)
        case Mapping():
            items = (f"{name} = {written(item)}" for name, item in value.items())
            return f"{{ {', '.join(items)} }}"
    return f"[{', '.join(map(written, value))}]"


# --- keys -----------------------------------------------------------------------------------------

_signature = functools.cache(inspect.signature)

Constructor = Callable[..., Any]
REQUIRED = inspect.Parameter.empty
"""Default of a key that must be given."""


@dataclass(frozen=True)
class Key:
    """A key of a section."""

    form: Form
    option: Option
    default: Any = REQUIRED
    owner: Constructor | None = None
    """Whose argument it is."""
    parameter: str = ""
    """Its name there."""
    also: str = ""
    """A second accepted name."""
    kinds: tuple[Kind, ...] = ()
    """Kinds of the table, if the value is a table or an array of tables."""

    @property
    def is_several(self) -> bool:
        """Whether the value is an array of tables."""
        return self.form is FORMS["tables"]

    @property
    def wants(self) -> str:
        """Type and bounds of the value, in words."""
        return ", ".join(filter(None, (self.form.wants, self.option.bounds)))

    @property
    def has_default(self) -> bool:
        """Whether there is a value if none is given."""
        return self.default is not REQUIRED and self.default is not None

    @property
    def default_text(self) -> str:
        """The default as in a model file, or what holds without."""
        if self.has_default:
            return written(self.default)
        return "required" if self.default is REQUIRED else self.option.unset

    @property
    def is_file(self) -> bool:
        """Whether the value is the path of a file, or an array of paths."""
        return self.form in (FORMS["path"], FORMS["paths"])

    def read(self, value: Any) -> Any:
        """Return the value converted; raise ValueError with "must be ..., got ..."."""
        return self.form.read(value, self.option)


def keys_of(
    owner: Constructor,
    *only: str,
    renamed: Mapping[str, str] | None = None,
    defaults: Mapping[str, Any] | None = None,
    like: object = None,
    also: Mapping[str, str] | None = None,
) -> dict[str, Key]:
    """Return the keys that are arguments of a constructor, a class or function; some only, or all.

    The file may have other names than the parameters (``renamed``), second names (``also``), and
    other defaults: ``defaults`` by key, or the attributes of something ``like`` it that was made.
    """
    found = {}
    for parameter, (kind, option, default) in declared(owner).items():
        name = (renamed or {}).get(parameter, parameter)
        default = default if like is None else getattr(like, parameter)
        found[name] = Key(
            form_of(kind, option),
            option,
            (defaults or {}).get(name, default),
            owner,
            parameter,
            (also or {}).get(name, ""),
        )
    return {name: found[name] for name in only or found}


def own_key(form: Form, text: str, default: Any = REQUIRED, **of_option: Any) -> Key:
    """Return a key that is no argument of a constructor."""
    return Key(form, Option(of_option.pop("unit", ""), text, **of_option), default)


def table_key(text: str, kinds: tuple[Kind, ...], unset: str) -> Key:
    """Return a key that is a table of one of some kinds, and may be left out."""
    return Key(FORMS["table"], Option("", text, unset=unset), None, kinds=kinds)


def optional(key: Key, unset: str) -> Key:
    """Return a key that may be left out, and what holds then."""
    return replace(key, default=None, option=replace(key.option, unset=unset))


@dataclass(frozen=True)
class Section:
    """A section of a model file; its values are attributes too."""

    of: Kind
    values: Mapping[str, Any]

    def __getattr__(self, name: str) -> Any:
        """Return the value of a key."""
        if name.startswith("__") or name not in self.values:
            raise AttributeError(name)
        return self.values[name]

    @property
    def kind(self) -> str:
        """Value of its key ``kind``, or ""."""
        return self.of.name

    def with_values(self, **values: Any) -> Section:
        """Return the section with other values."""
        return replace(self, values={**self.values, **values})

    def tables(self) -> Iterator[tuple[str, str, Section]]:
        """Yield the tables in it, with name and place: that in an array as ".0", else ""."""
        for name, key in self.of.keys.items():
            value = self.values[name]
            if key.is_several:
                yield from ((name, f".{n}", entry) for n, entry in enumerate(value or ()))
            elif key.kinds and value is not None:
                yield name, "", value

    def titled(self, title: str) -> Iterator[tuple[str, Section]]:
        """Yield the section, the tables in it and those in them, by title: ``loads.0``."""
        yield title, self
        for name, place, inner in self.tables():
            yield from inner.titled(f"{title}.{name}{place}")

    def content(self) -> dict[str, Any]:
        """Return kind and values; of a key for tables a list of their contents."""
        found = {"kind": self.kind, **self.values}
        for name, key in self.of.keys.items():
            if key.kinds:
                found[name] = [inner.content() for of, _, inner in self.tables() if of == name]
        return found

    def arguments(self) -> dict[str, Any]:
        """Return those values that are arguments of the constructor, and not None."""
        assert self.of.constructor is not None
        known = _signature(self.of.constructor).parameters
        takes_all = any(one.kind is one.VAR_KEYWORD for one in known.values())
        given = {key.parameter: self.values[name] for name, key in self.of.keys.items()}
        return {
            name: value
            for name, value in given.items()
            if value is not None and (takes_all or name in known)
        } | dict(self.of.fixed)

    def called(self, **more: Any) -> Any:
        """Call the constructor with the values."""
        assert self.of.constructor is not None
        return self.of.constructor(**self.arguments(), **more)

    def made(self) -> Any:
        """Return what the section describes; ValueError if the values do not fit together."""
        return self.called() if self.of.make is None else self.of.make(self)


@dataclass(eq=False, repr=False)
class Kind:
    """A section, or one kind of it: which keys it has, and what is made of them.

    Called with values, it returns a :class:`Section` with the defaults filled in.
    """

    doc: str
    keys: Mapping[str, Key]
    constructor: Constructor | None = None
    name: str = ""
    """Value of its key ``kind``; empty if the section has only one kind."""
    sign: str = ""
    """A key that identifies the kind if ``kind`` is not given."""
    deferred: bool = False
    """Whether it is made only when the model is built, because that reads a file."""
    spread: bool = False
    """Whether the model's builder takes the values, not what is made of them."""
    filled: bool = False
    """Whether a preset of the section around it may give its keys."""
    fixed: Mapping[str, Any] = field(default_factory=dict)
    """Further arguments of the constructor."""
    make: Callable[[Section], Any] | None = None
    """Makes it; by default the constructor does."""
    outline: Callable[[Section], FilmOutline] | None = None
    """Returns the outline of a film that can be meshed along the path of the tool."""

    def __call__(self, **values: Any) -> Section:
        """Return a section with the defaults filled in."""
        return Section(self, {name: key.default for name, key in self.keys.items()} | values)

    @property
    def also_sign(self) -> str:
        """Second name of the sign."""
        return self.keys[self.sign].also if self.sign else ""

    def names(self) -> list[str]:
        """Return all names allowed in the section, including second names."""
        own = ["kind"] if self.name else []
        return [*own, *self.keys, *(key.also for key in self.keys.values() if key.also)]

    def with_keys(self, keys: Mapping[str, Key] | None = None, **defaults: Any) -> Kind:
        """Return the kind with further keys, and with other defaults."""
        every = {**self.keys, **(keys or {})}
        own = {name: replace(every[name], default=value) for name, value in defaults.items()}
        return replace(self, keys=every | own)


def kind_of(kinds: Sequence[Kind], table: Mapping[str, Any]) -> Kind | None:
    """Return the kind that a table names, or by which of its keys it is recognised.

    None if it has neither, or a name that there is not.
    """
    for kind in kinds:
        signed = any(sign in table for sign in (kind.sign, kind.also_sign) if sign)
        if kind.name == table["kind"] if "kind" in table else signed:
            return kind
    return None
