"""List of all keys of model files, for the page of keys and for searching."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from .errors import guess
from .key import REQUIRED, Key, Kind
from .section_table import HEAD, LISTS, SECTIONS
from .writer import written


@dataclass(frozen=True)
class Entry:
    """Description of a key.

    Examples
    --------
    >>> pitch = found(["pitch"])[0].entries[0]
    >>> pitch.wants, pitch.unit, pitch.default, pitch.doc
    ('number', 'mm', '12.0', 'advance a turn')
    """

    name: str
    also: str
    """A second name, or ""."""
    wants: str
    """Type of the value."""
    unit: str
    default: str
    """As in a model file if :attr:`has_default`; otherwise the meaning of leaving it out."""
    has_default: bool
    doc: str


@dataclass(frozen=True)
class Table:
    """The keys of one section, or of one kind of it."""

    title: str
    """As written in a model file, ``[tool]``; empty before the first section."""
    kind: str
    """Value of its key ``kind``, or ""."""
    sign: str
    """Key that identifies the kind without ``kind``, or ""."""
    models: tuple[str, ...]
    """Models that have the section."""
    doc: str
    entries: tuple[Entry, ...]

    @property
    def where(self) -> str:
        """Models that have the section, in words."""
        if len(self.models) == len(SECTIONS):
            return "every model"
        return "model " + ", ".join(self.models)


def tables() -> Iterator[Table]:
    """Yield all sections and their kinds, in order."""
    every = tuple(SECTIONS)
    yield _table("", HEAD, every)
    for title, kinds in _owners().items():
        brackets = f"[[{title}]]" if title in LISTS["free"] else f"[{title}]"
        for kind, models in kinds.items():
            yield _table(brackets, kind, tuple(models))
            for name, key in kind.keys.items():
                if key.tables is not None:
                    yield _table(f"[[{title}.{name}]]", key.tables, tuple(models))


def found(words: Sequence[str]) -> list[Table]:
    """Return the tables with the keys that contain all the words, ignoring case.

    A word may be part of a key's name, section, unit, meaning or type. If the words are in a
    table's own title, kind or description, all its keys are returned.

    Raises
    ------
    ValueError
        If no key matches, with the most similar name.

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
        raise ValueError(f"no key contains {' and '.join(map(repr, words))}{near}")
    return chosen


def _has(own: str, entry: Entry, wanted: Sequence[str]) -> bool:
    text = " ".join((entry.name, entry.also, entry.wants, entry.unit, entry.doc)).lower()
    return all(word in own or word in text for word in wanted)


def _owners() -> dict[str, dict[Kind, list[str]]]:
    """Return the kinds of each section, each with the models that have it."""
    owners: dict[str, dict[Kind, list[str]]] = {}
    for layout in (SECTIONS, LISTS):
        for model, sections in layout.items():
            for title, kinds in sections.items():
                for kind in kinds:
                    owners.setdefault(title, {}).setdefault(kind, []).append(model)
    return owners


def _table(title: str, kind: Kind, models: tuple[str, ...]) -> Table:
    entries = tuple(_entry(name, key) for name, key in kind.keys.items())
    return Table(title, kind.name, kind.sign, models, kind.doc, entries)


def _entry(name: str, key: Key) -> Entry:
    option, has_default = key.option, key.default is not REQUIRED and key.default is not None
    wants = f"{key.form.wants}, {option.bounds}" if option.bounds else key.form.wants
    without = "required" if key.default is REQUIRED else option.unset
    default = written(key.default) if has_default else without
    return Entry(name, key.also, wants, option.unit, default, has_default, option.text)
