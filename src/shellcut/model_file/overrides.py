"""Override values of a model file, by section and key or by key alone."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from shellcut.arguments import guess, listed

from .errors import ModelFileError, Problem
from .material_keys import named_material
from .section_table import HEAD, LISTS, SECTIONS, Kinds
from .source import KeyPath, Source, beyond_all

_LONGEST_PLACE = 80  # characters of a setting in a message


def overridden(
    source: Source, overrides: Mapping[str, object], say: Callable[[str], object] = str
) -> Source:
    """Return a source with keys replaced; each must be in one section, else a ModelFileError.

    ``say`` is told which keys of the user's file give way to another kind of section.
    """
    if not overrides:
        return source
    source = named_material(source)
    values = dict(source.values)
    settings: dict[KeyPath, str] = {}
    problems = []
    # The model first: it determines the available keys. Then the film, which replaces others.
    order = {"model": 0, "material": 1, "material.preset": 1, "preset": 1}
    for name, value in sorted(overrides.items(), key=lambda pair: order.get(pair[0], 2)):
        if beyond := beyond_all({name: value}):
            problems.append(Problem(f"set {name}", f"the value {beyond}"))
            continue
        if name not in HEAD.keys and str(values.get("model", "")) not in SECTIONS:
            continue  # the reader refuses the model, which determines the keys
        place = f"set {name}={value}"
        place = place if len(place) <= _LONGEST_PLACE else f"{place[:_LONGEST_PLACE]}..."
        try:
            path = path_of(name, str(values.get("model", "")))
        except ValueError as problem:
            problems.append(Problem(place, str(problem)))
            continue
        if path == ("material", "preset"):
            values["material"] = {"preset": value}
        elif len(path) == 1:
            values[str(path[0])] = value
        else:
            title, key = str(path[0]), str(path[1])
            kinds = SECTIONS.get(str(values.get("model", "")), {}).get(title, ())
            table = values.get(title, {})
            if not isinstance(table, dict):
                problems.append(Problem(source.place((title,)), f"[{title}] must be a section"))
                continue
            others = {str(path[1]) for path in settings if path[0] == title and len(path) == 2}
            rest = _fitting(table, key, kinds, others)
            if gone := [n for n in table if n not in rest and (title, n) in source.lines]:
                where = source.place((title, gone[0]))
                say(f"{place}: takes the place of {', '.join(gone)} in [{title}] ({where})")
            values[title] = {**rest, key: value}
        settings[path] = place
    if problems:
        raise ModelFileError(problems)
    return replace(source, values=values, settings=settings)


def _fitting(table: dict[str, Any], key: str, kinds: Kinds, others: set[str]) -> dict[str, Any]:
    """Return the keys of a section that remain when an overriding key changes its kind.

    Keys of other kinds only are dropped; unknown keys, and keys that were also overridden, remain
    and are refused later.
    """
    for kind in kinds:
        if key in (kind.sign, kind.also_sign):
            known = {name for other in kinds for name in other.names()}
            foreign = known - set(kind.names()) | {"kind"}
            return {n: v for n, v in table.items() if n in others or n not in foreign}
    return table


def path_of(name: str, model: str) -> tuple[str, ...]:
    """Return section and key that a setting means in a model; ValueError if there is no such."""
    if name in HEAD.keys:
        return (name,)
    if name == "material":
        return ("material", "preset")
    title, _, rest = name.partition(".")
    layout = SECTIONS.get(model, {})
    if rest:
        if title in LISTS.get(model, {}):
            raise ValueError(f"[[{title}]] can occur several times: write it in the file")
        if title not in layout:
            hint = guess(title, layout) or listed(layout)
            raise ValueError(f"there is no section [{title}]{hint}")
        return (title, rest)
    names = {title: [n for kind in kinds for n in kind.names()] for title, kinds in layout.items()}
    owners = [title for title, known in names.items() if name in known]
    if len(owners) == 1:
        return (owners[0], name)
    if owners:
        candidates = ", ".join(f"{owner}.{name}" for owner in owners)
        raise ValueError(f"several sections have this key: write one of {candidates}")
    everything = {*HEAD.keys, *(n for known in names.values() for n in known)}
    raise ValueError(f"no section has this key{guess(name, sorted(everything))}")
