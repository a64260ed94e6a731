"""``study.toml``: a study as a file. Model, settings, factors, design and the values of interest.

examples/study.toml shows all that it can say.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from shellcut.arguments import guess
from shellcut.files.whole_file import write_text
from shellcut.model_file.errors import ModelFileError, Problem
from shellcut.model_file.forms import written
from shellcut.model_file.key import Kind, keys_of
from shellcut.model_file.reader import read_section, read_source
from shellcut.model_file.schema import DRAFT, quantities, schema_of, settings
from shellcut.model_file.section_table import ENTRY

from .factors import Design, Factor
from .plan import Definition, Plan

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
