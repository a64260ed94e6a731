"""Override values of a model file, by section and key or by key alone."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from typing import Any

from shellcut.arguments import guess, listed

from .errors import ModelFileError, Problem
from .key import kind_of
from .material_keys import named_material
from .section_table import HEAD, LISTS, SECTIONS, Kinds, titled
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
        kinds = titled(str(values.get("model", "")))
        try:
            path = path_of(name, str(values.get("model", "")))
        except ValueError as problem:
            problems.append(Problem(place, str(problem)))
            continue
        if path == ("material", "preset"):
            values["material"] = {"preset": value}
        else:
            set_before = {str(known[-1]) for known in settings if known[:-1] == path[:-1]}
            try:
                gone = _set(values, path, value, kinds.get(".".join(path[:-1]), ()), set_before)
            except ValueError as problem:
                problems.append(Problem(source.place((path[0],)), str(problem)))
                continue
            if told := [name for name in gone if (*path[:-1], name) in source.lines]:
                where = source.place((*path[:-1], told[0]))
                title = ".".join(path[:-1])
                say(f"{place}: takes the place of {', '.join(told)} in [{title}] ({where})")
        settings[path] = place
    if problems:
        raise ModelFileError(problems)
    return replace(source, values=values, settings=settings)


def _set(
    values: dict[str, Any], path: Sequence[str], value: object, kinds: Kinds, keep: Collection[str]
) -> list[str]:
    """Set a key of a section or table, and return the keys that give way to it.

    Those are the keys of other kinds only, if the key identifies a kind: the present one, if that
    has the key. Unknown keys and those to ``keep`` remain, and are refused later. Raises ValueError
    if there is something else in the place of a table.
    """
    table = values
    for title in path[:-1]:
        inner = table.get(title, {})
        if not isinstance(inner, dict):
            raise ValueError(f"[{title}] must be a section")
        table[title] = dict(inner)
        table = table[title]
    key = path[-1]
    identified = [kind for kind in kinds if key in (kind.sign, kind.also_sign)]
    present = kind_of(kinds, table)
    gone: list[str] = []
    if identified:
        stays = present is not None and key in present.names()
        chosen = present if present is not None and stays else identified[0]
        known = {name for kind in kinds for name in kind.names()}
        foreign = known - set(chosen.names()) | (set() if stays else {"kind"})
        sizes = [kind.keys.get("size") for kind in (present, chosen) if kind is not None]
        if not stays and None not in sizes and sizes[0] != sizes[-1]:
            foreign.add("size")  # of structured sheets, and of quads by Gmsh
        gone = [name for name in table if name in foreign and name not in keep]
    for name in gone:
        del table[name]
    table[key] = value
    return gone


def path_of(name: str, model: str) -> tuple[str, ...]:
    """Return section and key that a setting means in a model; ValueError if there is no such."""
    if name in HEAD.keys:
        return (name,)
    if name == "material":
        return ("material", "preset")
    layout = titled(model)
    if "." in name:
        title = name.partition(".")[0]
        if title in LISTS.get(model, {}):
            raise ValueError(f"[[{title}]] can occur several times: write it in the file")
        if title not in layout:
            hint = guess(title, layout) or listed(SECTIONS.get(model, {}))
            raise ValueError(f"there is no section [{title}]{hint}")
        return tuple(name.split("."))
    names = {title: [n for kind in kinds for n in kind.names()] for title, kinds in layout.items()}
    owners = [title for title, known in names.items() if name in known]
    owners = [title for title in owners if "." not in title] or owners  # not in tables of sections
    if len(owners) == 1:
        return (*owners[0].split("."), name)
    if owners:
        candidates = ", ".join(f"{owner}.{name}" for owner in owners)
        raise ValueError(f"several sections have this key: write one of {candidates}")
    everything = {*HEAD.keys, *(n for known in names.values() for n in known)}
    raise ValueError(f"no section has this key{guess(name, sorted(everything))}")
