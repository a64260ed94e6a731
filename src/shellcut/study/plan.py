"""The plan of a study: its runs, each with its inputs and the hash that names its folder.

``study.toml`` is a study as a file: model, settings, factors, design and the values of interest.
examples/study.toml shows all that it can say.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from typing import Any

from shellcut.arguments import guess
from shellcut.files.distribution import VERSION
from shellcut.files.whole_file import write_text
from shellcut.model_file import Model, ModelFileError
from shellcut.model_file.key import Kind, keys_of, written
from shellcut.model_file.model import digest_of
from shellcut.model_file.overrides import spelled
from shellcut.model_file.reader import ModelVariants, read_section, read_source
from shellcut.model_file.schema import DRAFT, quantities, schema_of, settings
from shellcut.model_file.section_table import ENTRY, along_path
from shellcut.model_file.source import Problem
from shellcut.numerics.threads import available_cores

from .factors import Design, Factor, factors_of

RUNS = "runs"
"""Folder of the runs in that of the study."""

FEW_FILES = {"output.snapshots": 0, "output.frames": 20, "output.curves": False}
"""What the runs of a study write unless told otherwise: nobody looks at thousands of films."""

_DIGITS = 16
"""Of a hash, in the name of a folder: no two of a billion studies share one."""

_NO_INPUT = ("name", "threads")
"""Keys before the first section that change no result."""


@dataclass(frozen=True)
class PlannedRun:
    """A run of a study."""

    number: int
    """In the design, from 0."""
    values: Mapping[str, object]
    """Of the factors."""
    key: str
    """Hash of all inputs, of the files too, and of shellcut's version; names the folder."""

    def folder(self, study: Path) -> Path:
        """Return the folder of the run."""
        return study / RUNS / self.key


@dataclass(frozen=True)
class Definition:
    """What a study is."""

    model: str
    """Model file, or name of a shipped model."""
    factors: Mapping[str, object]
    settings: Mapping[str, object] = field(default_factory=dict)
    """As of :func:`shellcut.sweep`."""
    design: Design = field(default_factory=Design)
    """Which values go together."""
    figures: tuple[str, ...] = ()
    """That the report shows; its own choice if empty."""

    def plan(self, settings: Mapping[str, object] | None = None) -> Plan:
        """Return the runs, with further settings; nothing is built or written.

        Every value of a list and both ends of a range are tried with the first values of the
        others. Raises ModelFileError with every problem of the file, and of values that a key
        cannot take, or if no combination can be run; one that cannot fails in its run.
        """
        factors, single = factors_of(self.factors)
        given = {**self.settings, **(settings or {}), **single}
        whole = replace(self, settings={spelled(key): value for key, value in given.items()})
        variants = _variants(self.model, whole.settings, factors)
        combined = self.design.runs(factors)
        _try_values(variants, factors, combined)
        runs = tuple(planned_runs(variants, combined))
        return Plan(variants, runs, tuple(factors), whole)


@dataclass(frozen=True)
class Plan:
    """All runs of a study."""

    variants: ModelVariants
    """The model, to be read with the values of a run."""
    runs: tuple[PlannedRun, ...]
    """In the order of the design."""
    factors: tuple[Factor, ...] = ()
    """Keys that differ from run to run, alone or together."""
    definition: Definition = Definition("", {})
    """Of the study, with the settings of all runs."""

    def model_of(self, run: PlannedRun, jobs: int = 1) -> Model:
        """Return the model of a run, with its share of the cores if several run at a time.

        A model that gives its threads keeps them. A run that is alone takes what its film can use.
        Whether its values fit together shows when it is built.
        """
        model = self.variants.read(run.values, try_out=False)
        if model.head.threads is None and jobs > 1:
            model = model.with_threads(max(1, available_cores() // jobs))
        return model


def planned_runs(
    variants: ModelVariants, combined: Sequence[Mapping[str, object]]
) -> Iterator[PlannedRun]:
    """Yield a run for each set of values."""
    digest = cache(digest_of)
    for number, values in enumerate(combined):
        yield PlannedRun(number, values, _key(variants.read(values, try_out=False), digest))


def sought(
    model: str | os.PathLike[str], settings: Mapping[str, object] | None
) -> tuple[list[Factor], ModelVariants]:
    """Return the factors among the settings of a search, and its model with the other settings.

    Raises ValueError if there are no factors, and ModelFileError as :meth:`Definition.plan` does.
    """
    factors, single = factors_of({**FEW_FILES, **(settings or {})})
    if not factors:
        raise ValueError("nothing varies: give at least one key a range, KEY=LOW:HIGH")
    variants = _variants(model, single, factors)
    _try_values(variants, factors, [{}])
    return factors, variants


def _variants(
    model: str | os.PathLike[str], settings: Mapping[str, object], factors: Sequence[Factor]
) -> ModelVariants:
    """Return a model with settings.

    If tools from files are compared on a film that is meshed along their paths, all get one film,
    fine under every path: else the runs would differ by the mesh, too.
    """
    variants = ModelVariants(model, settings)
    each = [factor.settings(value) for factor in factors for value in factor.probes()]
    tools = [one["tool.file"] for one in each if "tool.file" in one]
    with suppress(ModelFileError):  # told when the values are tried
        film = variants.read(each[0] if tools else {}, try_out=False).sections["membrane"]
        if tools and along_path(film) and not film.values.get("tools"):
            return ModelVariants(model, {**settings, "membrane.tools": tools})
    return variants


def _try_values(
    variants: ModelVariants, factors: Sequence[Factor], combined: Sequence[Mapping[str, object]]
) -> None:
    """Read the model with every single value of the factors.

    What a key cannot take is refused. Values that do not go together fail in their run, as long as
    there is a run without them.
    """
    first = dict(combined[0])
    each = [first | factor.settings(value) for factor in factors for value in factor.probes()]
    for try_out in (False, True):
        refused = [_refused(variants, values, try_out) for values in (first, *each)]
        wrong = dict.fromkeys(problem for problems in refused for problem in problems)
        is_wrong = all(refused) and all(_refused(variants, values) for values in combined)
        if wrong and (is_wrong or not try_out):
            raise ModelFileError(list(wrong))


def _refused(
    variants: ModelVariants, values: Mapping[str, object], try_out: bool = True
) -> Sequence[Problem]:
    """Return the problems of a model with some values."""
    try:
        variants.read(values, try_out=try_out)
    except ModelFileError as error:
        return error.problems
    return ()


def _key(model: Model, digest: Callable[[str], str]) -> str:
    """Return the hash of all that makes the results what they are."""
    head = {name: value for name, value in model.head.values.items() if name not in _NO_INPUT}
    inputs = {
        "version": VERSION,
        "head": head,
        "sections": {t: s.content() for t, s in model.sections.items() if t != "output"},
        # The means of a curve are those of its rows; the other outputs change no figure.
        "rows": model.sections["output"].rows,
        "lists": {t: [s.content() for s in several] for t, several in model.lists.items()},
        "files": {path: digest(path) for path in model.files()},
    }
    text = json.dumps(inputs, sort_keys=True, default=str)
    return hashlib.sha256(text.encode()).hexdigest()[:_DIGITS]


# --- a study as a file ----------------------------------------------------------------------------

STUDY = "study.toml"

_SECTIONS = {"set": dict, "factors": dict, "design": dict, "model": str, "figures": list}
_DESIGN = Kind("Which values go together.", keys_of(Design), Design)


def is_study(path: str | os.PathLike[str]) -> bool:
    """Whether a file is a study rather than a model: it has factors."""
    try:
        return "factors" in read_source(path).values
    except ModelFileError:
        return False


def read_study(path: str | os.PathLike[str]) -> Definition:
    """Read a study file; ModelFileError tells all that is wrong with the file itself."""
    source = read_source(path)
    values, problems = source.values, []
    for name, value in values.items():
        wanted = _SECTIONS.get(name)
        if wanted is None:
            problems.append(
                Problem(source.place((name,)), f"unknown {name}{guess(name, _SECTIONS)}")
            )
        elif not isinstance(value, wanted):
            kind = {dict: "a section", str: "a text", list: "a list"}[wanted]
            problems.append(Problem(source.place((name,)), f"{name} must be {kind}"))
    for name in ("model", "factors"):
        if name not in values:
            problems.append(Problem(str(path), f"{name} must be given"))
    design = Design()
    if isinstance(values.get("design", {}), dict):
        try:
            design = read_section(source, _DESIGN, "design").made()
        except ModelFileError as wrong:
            problems += wrong.problems
    if problems:
        raise ModelFileError(problems)
    beside = source.folder / values["model"]
    model = str(beside) if beside.is_file() else values["model"]
    figures = tuple(str(name) for name in values.get("figures", ()))
    return Definition(model, values["factors"], values.get("set", {}), design, figures)


def study_schema() -> dict[str, Any]:
    """Return a JSON Schema of study files, of draft 7."""
    keys = settings()
    refers = {key: {"$ref": f"#/definitions/{key}"} for key in keys}
    several = {
        key: {"if": {"type": "array"}, "then": {"items": one}} for key, one in refers.items()
    }
    together = {",": {"type": ["array", "string"]}}  # keys whose values go together
    return {
        "$schema": DRAFT,
        "title": "Study file of shellcut",
        "type": "object",
        "required": ["model", "factors"],
        "properties": {
            "model": {"type": "string"},
            "figures": {"type": "array", "items": {"type": "string"}},
            "set": _keyed(refers, {}),
            "factors": _keyed(several, together),
            "design": schema_of(_DESIGN),
        },
        "additionalProperties": False,
        "definitions": quantities() | keys,
    }


def _keyed(schemas: Mapping[str, Any], more: Mapping[str, Any]) -> dict[str, Any]:
    """Return the schema of a section with these keys; a place in an array is any number."""
    place = f".{ENTRY}."
    arrays = {key: one for key, one in schemas.items() if place in key}
    patterns = {f"^{key.replace(place, '[.][0-9]+[.]')}$": one for key, one in arrays.items()}
    return {
        "type": "object",
        "properties": {key: one for key, one in schemas.items() if key not in arrays},
        "patternProperties": {**patterns, **more},
        "additionalProperties": False,
    }


def write_study(path: Path, planned: Plan) -> None:
    """Write the study file of a plan, from which the same runs follow."""
    study, figures = planned.definition, planned.definition.figures
    with suppress(ValueError):  # those of an earlier file at this place, if none are given
        figures = figures or read_study(path).figures
    model = Path(study.model)
    lines = [
        "#:schema ./shellcut-study.schema.json",
        "# The study whose runs are beside this file: `shellcut sweep` finds them again by it.",
        f"model = {written(str(model.resolve()) if model.is_file() else study.model)}",
        *([f"figures = {written(list(figures))}"] if figures else []),
        "",
        "[set]",
        *(f"{written(key)} = {written(value)}" for key, value in study.settings.items()),
        "",
        "[factors]",
        *(f"{written(f.name)} = {_values(f)}" for f in planned.factors),
        "",
        "[design]",
        f"kind = {written(study.design.kind)}",
    ]
    if study.design.n is not None:
        lines += [f"n = {study.design.n}", f"seed = {study.design.seed}"]
    write_text(path, "\n".join(lines) + "\n")


def _values(factor: Factor) -> str:
    if factor.ends is None:
        # Lists of lists, not of tuples: those are the way to write a table.
        return written([list(v) if factor.is_linked else v for v in factor.values])
    low, high = (f"{end!r} {factor.unit}".strip() for end in factor.ends)
    return written(f"{low} : {high}")
