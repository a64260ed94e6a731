"""Keys of a model file, and the kinds of sections that they make.

A key is an argument of a constructor with its :class:`~shellcut.arguments.Option`: type, unit,
bounds, meaning and default are declared there, and nowhere else. A model file may call it by
another name, or give it the default of a ready model.
"""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from shellcut.arguments import Option, declared
from shellcut.mesh.drawing import FilmOutline

from .forms import FORMS, Form, form_of, written

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
