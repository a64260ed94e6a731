"""Read a model file: find it, check it, fill in the defaults."""

from __future__ import annotations

import logging
import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from importlib.resources import files
from pathlib import Path
from typing import Any

from shellcut.arguments import guess, listed
from shellcut.files.regular_file import read_regular
from shellcut.files.text_content import in_one_form
from shellcut.material.shell_material import ShellMaterial

from .key import REQUIRED, Key, Kind, Section, kind_of
from .material_keys import named_material, presets, with_presets
from .model import FILES, Model
from .overrides import overridden
from .section_table import GONE, HEAD, LISTS, OF_OUTLINES, SECTIONS, Kinds
from .source import KeyPath, ModelFileError, Problem, Source, is_refusal, parse, titled_path

_log = logging.getLogger(__name__)

_LARGEST = 10_000_000  # bytes of a model file; the shipped ones have a few thousand

_ENDINGS = {"step", "stp", "iges", "igs", "obj", "ply", "msh", "inp", "k", "vtu", "csv"}
"""Suffixes of files; users try them as keys, as ``stl``."""

_LONGEST_TEXT = 1000  # characters of a problem; it may quote a value of any length


def read_model(
    name_or_path: str | os.PathLike[str], overrides: Mapping[str, object] | None = None
) -> Model:
    """Read a model file, or a model of the package by its name.

    Parameters
    ----------
    name_or_path : str or path
        Name of a shipped model, as ``"opening"`` or ``"trouser"``, or the path of a TOML file.
        Paths in the file are relative to it.
    overrides : mapping from key to value, optional
        Replaces values of the file: ``{"membrane.mesh": "quick"}``, or ``{"mesh": "quick"}`` if
        only one section has such a key. Paths here are relative to the working directory.

    Returns
    -------
    Model

    Raises
    ------
    ModelFileError
        Lists every problem with its line.

    Examples
    --------
    >>> model = read_model("opening", {"mesh": "quick", "motion.angle_deg": 5})
    >>> case = model.build()
    >>> case.name, round(1e3 * case.duration, 3)
    ('opening', 6.0)
    """
    source = _source(name_or_path)
    return _Reading(overridden(source, overrides or {}, _log.warning)).model()


def model_of_text(text: str, name: str) -> Model:
    """Return the model of a text from :func:`.model.model_text`, whose paths are absolute.

    ``name`` is used for the file in a ModelFileError.
    """
    return _Reading(parse(text, name, Path.cwd())).model()


def read_section(source: Source, kind: Kind, title: str) -> Section:
    """Return a section of another file than a model; ModelFileError lists every problem."""
    reading = _Reading(source)
    section = reading.section((kind,), reading.table(title), (title,), "")
    reading.raise_if_wrong()
    assert section is not None
    return section


class ModelVariants:
    """One model file, read with many overrides; those given here hold in all variants.

    ModelFileError if the file cannot be read, or an override has no key.
    """

    def __init__(
        self, name_or_path: str | os.PathLike[str], overrides: Mapping[str, object] | None = None
    ) -> None:
        self._source = _source(name_or_path)
        self._overrides = dict(overrides or {})
        overridden(self._source, self._overrides, _log.warning)

    def read(self, overrides: Mapping[str, object], *, try_out: bool = True) -> Model:
        """Return the model with further overrides.

        Without ``try_out`` the values of a section are read, but not tried together: that is a
        hundred times faster for a tool, which is built for the trial. ModelFileError lists every
        problem.
        """
        together = self._overrides | dict(overrides)
        return _Reading(overridden(self._source, together), try_out=try_out).model()


def preset_film(name: str, **keys: object) -> ShellMaterial:
    """Return a film with published numbers.

    Parameters
    ----------
    name : str
        As in ``[material] preset``, see docs/materials.md.
    **keys
        Other keys of ``[material]``, as ``thickness="12 um"``.

    Raises
    ------
    ValueError
        If there is no such film, or a key is wrong.

    Examples
    --------
    >>> preset_film("pet", thickness="12 um").thickness
    0.012
    """
    if name not in presets():
        raise ValueError(f"there is no film {name!r}{guess(name, presets()) or listed(presets())}")
    overrides = {f"material.{key}": value for key, value in keys.items()}
    model = read_model("opening", {"material": name, **overrides})
    film: ShellMaterial = model.sections["material"].made()
    return film


def shipped_models() -> dict[str, str]:
    """Return the text of each model file of the package, by name."""
    folder = files("shellcut.models")
    entries = sorted(folder.iterdir(), key=lambda entry: entry.name)
    found = [entry for entry in entries if entry.name.endswith(".toml")]
    return {entry.name.removesuffix(".toml"): entry.read_text(encoding="utf-8") for entry in found}


def read_source(path: str | os.PathLike[str]) -> Source:
    """Return the content of a TOML file; ModelFileError if it cannot be read, or is none."""
    try:
        text = in_one_form(read_regular(path, _LARGEST)).decode()
    except OSError as error:
        said = f"cannot be read: {error.strerror or error}"
        raise ModelFileError([Problem(str(path), said)]) from None
    except UnicodeDecodeError:
        wants = "must be text in UTF-8, as TOML requires: save it so in the editor"
        raise ModelFileError([Problem(str(path), wants)]) from None
    return parse(text, str(path), Path(path).resolve().parent)


def _source(name_or_path: str | os.PathLike[str]) -> Source:
    # not of a name that is too long for the system, or of a folder with a model's name
    if os.path.exists(name_or_path) and not os.path.isdir(name_or_path):
        return read_source(name_or_path)
    shipped = shipped_models()
    if str(name_or_path) in shipped:
        source = parse(shipped[str(name_or_path)], f"model {name_or_path}", Path.cwd())
        return replace(source, lines={})  # of no file that a user has
    text = f"no such file; the models by name are {', '.join(shipped)}"
    raise ModelFileError([Problem(str(name_or_path), text + guess(str(name_or_path), shipped))])


class _Reading:
    """One reading of a file; collects the problems."""

    def __init__(self, source: Source, *, try_out: bool = True) -> None:
        self.source = with_presets(named_material(source))
        self._tries = try_out
        self.problems: list[Problem] = []

    def model(self) -> Model:
        values = self.source.values
        tables = {k: v for k, v in values.items() if isinstance(v, dict | list)}
        misplaced = {k: v for k, v in tables.items() if k in HEAD.keys}
        head_table = {k: v for k, v in values.items() if k not in tables} | misplaced
        model = head_table.get("model")
        known = model if isinstance(model, str) and model in SECTIONS else ""
        head = self.section((HEAD,), head_table, (), known)
        if not known:
            self.raise_if_wrong()
        sections, lists = SECTIONS[known], LISTS[known]
        titles = [*sections, *lists]
        for title in tables:
            if title in LISTS["free"] and title not in titles:
                has_own = f'belongs to model = "free"; the {known} model has its own supports'
                self.say((title,), f"[[{title}]] {has_own}")
            elif title not in (*titles, *misplaced, FILES):
                hint = guess(title, titles) or listed(titles)
                self.say((title,), f"unknown section [{title}]{hint}")
        read = {
            title: self.section(kinds, self.table(title), (title,), known)
            for title, kinds in sections.items()
        }
        several = {
            title: tuple(
                self.section(kinds, table, (title, n), known)
                for n, table in enumerate(self.array(title))
            )
            for title, kinds in lists.items()
        }
        recorded = {str(k): str(v) for k, v in self.table(FILES).items()}
        if self.problems:
            whole = {title: section for title, section in read.items() if section is not None}
            those = {title: tuple(filter(None, each)) for title, each in several.items()}
            self.raise_if_wrong(Model(HEAD(model=known), whole, those, {}, self.source))
        assert head is not None
        return Model(head, read, several, recorded, self.source)  # type: ignore[arg-type]

    def say(self, path: KeyPath, text: str) -> None:
        shown = text if len(text) <= _LONGEST_TEXT else f"{text[:_LONGEST_TEXT]} ..."
        self.problems.append(Problem(self.source.place(path), shown))

    def raise_if_wrong(self, partial: Model | None = None) -> None:
        if self.problems:
            error = ModelFileError(sorted(self.problems, key=_line))
            error.partial = partial
            raise error

    def table(self, title: str) -> dict[str, Any]:
        table = self.source.values.get(title, {})
        if isinstance(table, dict):
            return table
        self.say((title,), f"[{title}] can occur only once: write it with single brackets")
        return {}

    def array(self, title: str) -> list[dict[str, Any]]:
        array = self.source.values.get(title, [])
        if isinstance(array, list) and all(isinstance(table, dict) for table in array):
            return array
        self.say((title,), f"[[{title}]] must be written with double brackets")
        return []

    def section(
        self, kinds: Kinds, table: dict[str, Any], path: KeyPath, model: str
    ) -> Section | None:
        """Return the section, or None if it has a problem, which is then recorded."""
        before = len(self.problems)
        cls = self.choose(kinds, table, path)
        if cls is None:
            return None
        keys, title = cls.keys, _shown(path)
        values: dict[str, Any] = {}
        aliases = {key.also: name for name, key in keys.items() if key.also}
        for given, value in table.items():
            if given == "kind" and cls.name:
                continue
            name = aliases.get(given, given)
            if name not in keys:
                why = _why_unknown(given, cls, kinds, table, path, model)
                self.say((*path, given), why)
            elif name in values:
                self.say((*path, given), f"{title}{given} repeats {name}: leave one out")
            else:
                values[name] = self.value(keys[name], value, (*path, given), f"{title}{given}")
        names = [kind.name for kind in kinds if kind.name]
        assumed = ""
        if len(names) > 1 and cls.name and "kind" not in table:
            assumed = f"; without {title}kind, one of {', '.join(names)}, it is a {cls.name}"
        for name, key in keys.items():
            if name not in values and key.default is REQUIRED:
                self.say(path, f"{title}{name} must be given: {key.option.text}{assumed}")
        if len(self.problems) > before:
            return None
        made = cls(**values)
        if self._tries:
            self.try_out(made, path)
        return made

    def choose(self, kinds: Kinds, table: dict[str, Any], path: KeyPath) -> Kind | None:
        if found := kind_of(kinds, table):
            return found
        by_name = [kind.name for kind in kinds if kind.name]
        if by_name and "kind" in table:
            given = str(table["kind"])
            hint = guess(given, by_name) or listed(by_name)
            self.say((*path, "kind"), f"{_shown(path)}kind {given!r} is unknown{hint}")
            return None
        if len(path) > 1 and len(kinds) > 1:
            self.say(path, f"{_shown(path)}kind must be given: one of {', '.join(by_name)}")
            return None
        return kinds[0]

    def value(self, key: Key, value: Any, path: KeyPath, shown: str) -> Any:
        try:
            read = key.read(value)
        except ValueError as problem:
            instead = GONE.get((str(path[0]), f"{path[-1]} = {value}"), "")
            self.say(path, f"{shown} {problem}{instead and f'; {instead}'}")
            return None
        if key.is_several:
            return tuple(
                self.section(key.kinds, entry, (*path, n), "") for n, entry in enumerate(read)
            )
        if key.kinds:
            return self.section(key.kinds, read, path, "")
        if not key.is_file:
            return read
        if isinstance(read, tuple):
            return tuple(self.file(one, path, shown) for one in read)
        return self.file(read, path, shown)

    def file(self, name: str, path: KeyPath, shown: str) -> str | None:
        """Return the absolute path of a file; record it if there is none."""
        try:
            found = (self.source.base(path) / Path(name).expanduser()).resolve()
            if not found.exists():
                self.say(path, f"{shown}: there is no file {found}")
            elif not found.is_file():
                self.say(path, f"{shown} must be a regular file, but {found} is not")
        except (OSError, ValueError, RuntimeError) as problem:  # invalid as a file name
            self.say(path, f"{shown} must name a file, got {name!r}: {problem}")
            return None
        return str(found)

    def try_out(self, made: Section, path: KeyPath) -> None:
        """Record an error of the constructor, at the line of the first key that it names."""
        if made.of.constructor is None or made.of.deferred:
            return
        try:
            made.made()
        except ValueError as problem:
            if not is_refusal(problem):
                raise
            reasons: Sequence[str] = getattr(problem, "problems", None) or [str(problem)]
            for reason in reasons:
                words = re.findall(r"\w+", reason)
                keys = made.of.keys.items()
                named = [n for word in words for n, key in keys if word in (n, key.parameter)]
                self.say((*path, *named[:1]), f"{_shown(path)[:-1]}: {reason}")


def _why_unknown(
    name: str, cls: Kind, kinds: Kinds, table: dict[str, Any], path: KeyPath, model: str
) -> str:
    """Return what is wrong with a key that a kind of section does not have."""
    shown = f"{_shown(path)}{name}"
    section = ".".join(part for part in path if isinstance(part, str))
    if gone := GONE.get((section, name)):
        return f"unknown key {shown}; {gone}"
    for kind in kinds:
        if kind is cls or name not in kind.names():
            continue
        chosen = f'kind = "{cls.name}"' if cls.name else "this one"
        if name in (kind.sign, kind.also_sign) and {cls.sign, "kind"} & set(table):
            other = f"{_shown(path)}{cls.sign}" if cls.sign in table else chosen
            fits = set(kind.names()) - {"kind"}
            rest = ", ".join(other_key for other_key in table if other_key not in fits)
            return f"{shown} and {other} exclude each other: leave out {name}, or {rest}"
        theirs = f'kind = "{kind.name}"' if kind.name else f"one with {kind.sign}"
        belongs = f"key {shown} belongs to {theirs}, not to {chosen}: leave it out"
        return OF_OUTLINES.get((cls.name, name), belongs)
    hint = guess(name, cls.names())
    if name in _ENDINGS and any("file" in kind.keys for kind in kinds):
        hint = "; did you mean file?"
    for title, others in SECTIONS.get(model, {}).items():
        if (title,) != path[:1] and any(name in kind.names() for kind in others):
            hint = hint or f"; there is [{title}].{name}"
    return f"unknown key {shown}{hint or listed(cls.names())}"


def _line(problem: Problem) -> int:
    # in the order of the file, overrides first
    number = problem.place.rpartition(":")[2]
    return int(number) if number.isdigit() else 0


def _shown(path: KeyPath) -> str:
    """Return "[tool]." for a section, "" at the top."""
    return f"{titled_path(path)}." if path else ""
