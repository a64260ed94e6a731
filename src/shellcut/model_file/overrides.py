"""Override values of a model file, by section and key or by key alone.

A key names a table of an array by its number from 0 on, between dots or in brackets:
``material.layers.0.thickness``, ``layers[0].thickness``, ``loads[1].value``. :func:`spelled` gives
all of them one spelling, with dots, that of messages, tables and files.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Mapping
from dataclasses import replace
from typing import Any

from shellcut.arguments import guess, listed

from .key import kind_of
from .material_keys import filled_in, named_material
from .section_table import ENTRY, HEAD, LISTS, SECTIONS, Kinds, titled
from .source import KeyPath, ModelFileError, Problem, Source, beyond_all, titled_path

_LONGEST_PLACE = 80  # characters of a setting in a message
_IN_BRACKETS = re.compile(r"\[\s*([^\[\]]*?)\s*\]")
_SECTION_OF = {"layers": "material"}
"""Section of an array of tables in it: its number tells it from other keys of the name."""


def spelled(name: str) -> str:
    """Return a key as messages, tables and files spell it, if it names one of several tables.

    Examples
    --------
    >>> spelled("layers[0].thickness"), spelled("loads[1].value"), spelled("teeth")
    ('material.layers.0.thickness', 'loads.1.value', 'teeth')
    """
    name = _IN_BRACKETS.sub(r".\1", name)
    first, dot, _ = name.partition(".")
    return f"{_SECTION_OF[first]}.{name}" if dot and first in _SECTION_OF else name


def overridden(
    source: Source, overrides: Mapping[str, object], say: Callable[[str], object] = str
) -> Source:
    """Return a source with keys replaced; each must be in one section, else a ModelFileError.

    ``say`` is called with the keys of the user's file that another kind of section replaces.
    """
    if not overrides:
        return source
    source = named_material(source)
    values = dict(source.values)
    settings: dict[KeyPath, str] = {}
    problems = []
    # The model first: it determines the available keys. Then the film, which replaces others.
    order = {"model": 0, "material": 1, "preset": 2}
    given = [(spelled(name), value) for name, value in overrides.items()]
    for name, value in sorted(given, key=lambda pair: order.get(pair[0].rpartition(".")[2], 3)):
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
            table = path[:-1]
            set_before = {str(known[-1]) for known in settings if known[:-1] == table}
            of = ".".join(ENTRY if isinstance(part, int) else part for part in table)
            if path[-1] == "preset":  # the keys of another film do not stay
                _set(values, table, {"preset": value}, (), ())
                gone = []
            else:
                gone = _set(values, path, value, kinds.get(of, ()), set_before)
        except ValueError as problem:
            problems.append(Problem(place, str(problem)))
            continue
        if replaced := [name for name in gone if (*table, name) in source.lines]:
            where = source.place((*table, replaced[0]))
            say(f"{place}: replaces {', '.join(replaced)} in {titled_path(table)} ({where})")
        settings[path] = place
    if problems:
        raise ModelFileError(problems)
    return replace(source, values=values, settings=settings)


def _set(
    values: dict[str, Any], path: KeyPath, value: object, kinds: Kinds, keep: Collection[str]
) -> list[str]:
    """Set a key of a section or table, and return the keys that it replaces.

    Those are the keys of other kinds only, if the key identifies a kind, or names it: the present
    one, if that has the key. Unknown keys and those to ``keep`` remain, and are refused later.
    Raises ValueError if there is something else in the place of a table, or no table at a place.
    """
    table: Any = values
    for end in range(1, len(path)):
        table = _copied(table, path[:end], path[end])
    key = path[-1]
    gone: list[str] = []
    present = kind_of(kinds, table)
    identified = [kind for kind in kinds if key in (kind.sign, kind.also_sign)]
    if key == "kind":
        present, identified = None, [kind for kind in kinds if kind.name == value]
    if identified:
        stays = present is not None and key in present.names()
        chosen = present if present is not None and stays else identified[0]
        known = {name for kind in kinds for name in kind.names()}
        foreign = known - set(chosen.names()) | (set() if stays else {"kind"})
        sizes = [kind.keys.get("size") for kind in (present, chosen) if kind is not None]
        if not stays and None not in sizes and sizes[0] != sizes[-1]:
            foreign.add("size")  # of structured sheets, and of quads by Gmsh
        gone = [name for name in table if name in foreign and name not in {*keep, key}]
    for name in gone:
        del table[name]
    table[key] = value
    return gone


def _copied(around: Any, path: KeyPath, step: str | int) -> Any:
    """Put a copy of the table or array at a path into what is around it; return the copy.

    ``step`` is the next part of the path: a place in an array, or a key of a table.
    """
    key, title = path[-1], titled_path(path)
    if isinstance(key, str) and isinstance(step, int) and key not in around:
        around[key] = filled_in(around).get(key, [])  # of a preset
    wanted = list if isinstance(step, int) else dict
    inner = around[key] if isinstance(key, int) else around.get(key, wanted())
    if not isinstance(inner, wanted):
        raise ValueError(f"{title} must be {'a section' if wanted is dict else 'several tables'}")
    if isinstance(step, int) and step >= len(inner):
        known = f"the file has {len(inner)}, from 0 on" if inner else "the file has none"
        raise ValueError(f"{title} has no table {step}: {known}; write it in the file")
    around[key] = inner.copy()
    return around[key]


def path_of(name: str, model: str) -> KeyPath:
    """Return section and key that a setting means in a model; ValueError if there is no such."""
    name = spelled(name)
    if name in HEAD.keys:
        return (name,)
    if name == "material":
        return ("material", "preset")
    layout = titled(model)
    if "." in name:
        return _dotted(name, layout, model)
    names = {title: [n for kind in kinds for n in kind.names()] for title, kinds in layout.items()}
    names = {title: known for title, known in names.items() if ENTRY not in title.split(".")}
    owners = [title for title, known in names.items() if name in known]
    owners = [title for title in owners if "." not in title] or owners  # not in tables of sections
    if len(owners) == 1:
        return (*owners[0].split("."), name)
    if owners:
        candidates = ", ".join(f"{owner}.{name}" for owner in owners)
        raise ValueError(f"several sections have this key: write one of {candidates}")
    everything = {*HEAD.keys, *(n for known in names.values() for n in known)}
    raise ValueError(f"no section has this key{guess(name, sorted(everything))}")


def _dotted(name: str, layout: Mapping[str, Kinds], model: str) -> KeyPath:
    """Return the parts of a key with dots, its places in arrays as numbers."""
    first, *parts = name.split(".")
    if first not in layout and first not in LISTS.get(model, {}):
        hint = guess(first, layout) or listed(SECTIONS.get(model, {}))
        raise ValueError(f"there is no section [{first}]{hint}")
    path: list[str | int] = [first]
    of = first  # the path with ENTRY for each place
    for part in parts:
        is_array, is_place = f"{of}.{ENTRY}" in layout, part.isdecimal()
        whole = ".".join(map(str, path))
        if is_array and not is_place:
            rest = f".{part}" if part.isidentifier() else ""
            raise ValueError(
                f"{whole} has several tables: choose one by its number from 0 on, {whole}.0{rest}"
            )
        if is_place and not is_array:
            raise ValueError(f"{whole} is set as a whole: {whole}=...")
        path.append(int(part) if is_place else part)
        of = f"{of}.{ENTRY if is_place else part}"
    return tuple(path)
