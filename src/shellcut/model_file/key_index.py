"""All keys of model files as a list: for the page of the keys, and to look for them by words."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import MISSING, dataclass
from typing import Any

from .errors import guess
from .key import Key, Section
from .run_sections import Head
from .section_table import LISTS, SECTIONS
from .writer import written


@dataclass(frozen=True)
class Entry:
    """A key in words.

    Examples
    --------
    >>> pitch = found(["pitch"])[0].entries[0]
    >>> pitch.wants, pitch.unit, pitch.default, pitch.doc
    ('number', 'mm', '12.0', 'advance a turn')
    """

    name: str
    also: str
    """A second name, or nothing."""
    wants: str
    """What the value may be."""
    unit: str
    default: str
    """As it is written in a model file, where :attr:`has_default`; else what holds without it."""
    has_default: bool
    doc: str


@dataclass(frozen=True)
class Table:
    """The keys of one section, or of one kind of it."""

    title: str
    """As it is written in a model file, ``[tool]``; empty before the first section."""
    kind: str
    """Value of its key ``kind``, or nothing."""
    sign: str
    """Key that tells the kind without it, or nothing."""
    models: tuple[str, ...]
    """Those that have it."""
    doc: str
    entries: tuple[Entry, ...]

    @property
    def where(self) -> str:
        """Which models have it, in words."""
        if len(self.models) == len(SECTIONS):
            return "every model"
        return "model " + ", ".join(self.models)


def tables() -> Iterator[Table]:
    """Yield all sections in their order, and their kinds."""
    every = tuple(SECTIONS)
    yield _table("", Head, every)
    for title, kinds in _owners().items():
        brackets = f"[[{title}]]" if title in LISTS["free"] else f"[{title}]"
        for kind, models in kinds.items():
            yield _table(brackets, kind, tuple(models))
            for name, key in kind.keys().items():
                if key.kind.tables is not None:
                    yield _table(f"[[{title}.{name}]]", key.kind.tables, tuple(models))


def found(words: Sequence[str]) -> list[Table]:
    """Return the tables with the keys in which all the words are, in whatever capitals.

    A word may be part of a key's name, section, unit, meaning or of what the value may be. The
    keys of a table are all there if the words are in its own title, kind or description.

    Raises
    ------
    ValueError
        If there is none, with the nearest name.

    Examples
    --------
    >>> [(table.title, entry.name) for table in found(["young"]) for entry in table.entries]
    [('[material]', 'young'), ('[[material.layers]]', 'young')]
    """
    wanted = [word.lower() for word in words]
    chosen = []
    for table in tables():
        own = " ".join((table.title, table.kind, table.doc)).lower()
        entries = [entry for entry in table.entries if _has(own, entry, wanted)]
        if entries:
            chosen.append(
                Table(table.title, table.kind, table.sign, table.models, table.doc, tuple(entries))
            )
    if not chosen:
        names = {entry.name for table in tables() for entry in table.entries}
        near = "".join(guess(word, sorted(names)) for word in words)
        raise ValueError(f"no key has {' and '.join(map(repr, words))} in it{near}")
    return chosen


def _has(own: str, entry: Entry, wanted: Sequence[str]) -> bool:
    text = " ".join((entry.name, entry.also, entry.wants, entry.unit, entry.doc)).lower()
    return all(word in own or word in text for word in wanted)


def _owners() -> dict[str, dict[type[Section], list[str]]]:
    """Return by section its kinds, each with the models that have it."""
    owners: dict[str, dict[type[Section], list[str]]] = {}
    for layout in (SECTIONS, LISTS):
        for model, sections in layout.items():
            for title, kinds in sections.items():
                for kind in kinds:
                    owners.setdefault(title, {}).setdefault(kind, []).append(model)
    return owners


def _table(title: str, kind: type[Section], models: tuple[str, ...]) -> Table:
    doc = (kind.__doc__ or "").split("\n")[0]
    entries = tuple(_entry(kind, name, key) for name, key in kind.keys().items())
    return Table(title, kind.kind, kind.sign, models, doc, entries)


def _entry(kind: type[Section], name: str, key: Key) -> Entry:
    default: Any = kind.__dataclass_fields__[name].default  # type: ignore[attr-defined]
    without = {True: "to be given", False: key.unset}
    has_default = default is not MISSING and default is not None
    text = written(default) if has_default else without[default is MISSING]
    return Entry(name, key.also, key.kind.wants, key.kind.unit, text, has_default, key.doc)
