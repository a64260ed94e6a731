"""List of all keys of model files, for the page of keys and for searching."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from shellcut.arguments import guess
from shellcut.unit import after

from .key import Key, Kind
from .section_table import ENTRY, HEAD, SECTIONS, titled

QUESTIONS = {
    "docs/howto/pierce.md": ("How hard must I press?", "pierce piercing puncture press push entry"),
    "docs/howto/optimise.md": ("Which tooth?", "tooth teeth cap best ranking compare optimise"),
    "docs/howto/loose.md": ("Does a piece come loose?", "piece loose flap bridge lid opening"),
    "docs/howto/seal.md": ("Will the seal hold while I cut?", "seal glue peel weld lid neck"),
    "docs/howto/sharp.md": ("How sharp must the edge be?", "sharp blunt radius edge wear sever"),
    "docs/howto/own-film.md": (
        "How do I model my film and mouth?",
        "film foil mouth neck border disc",
    ),
    "docs/howto/data-sheet.md": (
        "Which numbers does a data sheet give?",
        "sheet elmendorf trouser graves tear datasheet supplier",
    ),
    "docs/howto/own-tool.md": ("How do I model my tool?", "tool cap knife blade step stl cad"),
    "docs/howto/converge.md": ("How sure is the number?", "mesh converge error accuracy finer"),
}
"""By page: the question that it answers, and words under which it is found."""

_ALSO_SAID = {
    ("[membrane]", "radius"): "mouth neck rim",
    ("[membrane]", "outline"): "mouth neck",
    ("[membrane]", "clamp"): "mouth neck seal",
    ("[tool]", "file"): "cap knife",
    ("[tool]", "teeth"): "cap",
}
"""By title and key: other words that people use for it."""


@dataclass(frozen=True)
class Table:
    """The keys of one section, or of one kind of it.

    Examples
    --------
    >>> pitch = found(["pitch"])[0].keys["pitch"]
    >>> pitch.wants, pitch.option.unit, pitch.default_text, pitch.option.text
    ('number', 'mm', '12.0', 'advance per turn; 0 for a pure rotation')
    """

    path: str
    """As of :func:`.section_table.titled`; empty before the first section."""
    kind: Kind
    models: tuple[str, ...]
    """Models that have the section."""
    keys: Mapping[str, Key]

    @property
    def title(self) -> str:
        """As written in a model file, ``[tool]``; empty before the first section."""
        inner = self.path.replace(f".{ENTRY}", "")
        if self.path.endswith(f".{ENTRY}"):
            return f"[[{inner}]]"
        return f"[{inner}]" if inner else ""

    @property
    def where(self) -> str:
        """Models that have the section, in words."""
        if len(self.models) == len(SECTIONS):
            return "every model"
        return "model " + ", ".join(self.models)


def tables() -> Iterator[Table]:
    """Yield all sections and their kinds, in order."""
    yield Table("", HEAD, tuple(SECTIONS), HEAD.keys)
    models_of: dict[str, dict[Kind, list[str]]] = {}
    for model in SECTIONS:
        for path, kinds in titled(model).items():
            for kind in kinds:
                models_of.setdefault(path, {}).setdefault(kind, []).append(model)
    for path, kinds_there in models_of.items():
        for kind, models in kinds_there.items():
            yield Table(path, kind, tuple(models), kind.keys)


def found(words: Sequence[str]) -> list[Table]:
    """Return the tables with the keys that contain all the words, ignoring case.

    A word may be part of a key's name, section, unit, meaning or type. If the words are in a
    table's own title, kind or description, all its keys are returned.

    Examples
    --------
    >>> [(table.title, name) for table in found(["young"]) for name in table.keys]
    [('[material]', 'young'), ('[[material.layers]]', 'young')]
    """
    wanted = [word.lower() for word in words]
    chosen = []
    for table in tables():
        own = " ".join((table.title, table.kind.name, table.kind.doc)).lower()
        keys = {}
        for name, key in table.keys.items():
            also = _ALSO_SAID.get((table.title, name), "")
            texts = (name, key.also, key.wants, key.option.unit, key.option.text, also)
            if all(word in own or word in " ".join(texts).lower() for word in wanted):
                keys[name] = key
        if keys:
            chosen.append(replace(table, keys=keys))
    if not chosen:
        names = {name for table in tables() for name in table.keys}
        near = "".join(guess(word, sorted(names)) for word in words)
        raise ValueError(f"no key contains {' and '.join(map(repr, words))}{near}")
    return chosen


def questions(words: Sequence[str]) -> dict[str, str]:
    """Return the questions with all the words, by the page that answers each; none without words.

    Examples
    --------
    >>> questions(["flap"])
    {'docs/howto/loose.md': 'Does a piece come loose?'}
    """
    return {
        page: question
        for page, (question, said) in QUESTIONS.items()
        if words and all(word.lower() in f"{question} {said}".lower() for word in words)
    }


def unit_of_key(key: str) -> str:
    """Return the unit of a key of model files; "" for a pure number or an unknown key."""
    *section, name = key.split(".")
    path = ".".join(ENTRY if part.isdecimal() else part for part in section)
    for table in tables():
        if path and table.path != path:
            continue
        for known, found in table.keys.items():
            if name in (known, found.also):
                return found.option.unit
    return ""


def with_values(values: Mapping[str, object]) -> str:
    """Return keys with their values, as said of a run.

    Examples
    --------
    >>> with_values({"membrane.size": 1.0 / 3.0, "tool.teeth": 4})
    'membrane.size = 0.3333 mm, tool.teeth = 4'
    """
    texts = (
        f"{value:.4g}{after(unit_of_key(key))}" if isinstance(value, float) else f"{value}"
        for key, value in values.items()
    )
    return ", ".join(f"{key} = {text}" for key, text in zip(values, texts, strict=True))
