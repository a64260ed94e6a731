"""``study.toml``: a study as a file. Model, settings, factors, design and the figures of interest.

model = "opening"
figures = ["torque_plateau_Nmm"]     # for the report; its own choice, if left out

[set]
"membrane.mesh" = "quick"

[factors]
"tool.edge_inclination_deg" = [40, 60, 80]
"motion.pitch" = "12 mm : 20 mm"
"cohesive.plateau, cohesive.strength" = [[12, 18], [10, 15]]     # values that go together

[design]
kind = "sobol"
n = 32
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from shellcut.files.regular_file import read_regular
from shellcut.files.whole_file import write_text
from shellcut.model_file.errors import ModelFileError, Problem, guess
from shellcut.model_file.forms import written
from shellcut.model_file.key import Kind, keys_of
from shellcut.model_file.reader import read_section
from shellcut.model_file.source import parse

from .design import Design
from .factors import Factor, factors_of
from .plan import Plan, plan

STUDY = "study.toml"

_LARGEST = 10_000_000  # bytes
_SECTIONS = {"set": dict, "factors": dict, "design": dict, "model": str, "figures": list}
_DESIGN = Kind("Which values go together.", keys_of(Design), Design)


@dataclass(frozen=True)
class StudyFile:
    """Content of a study file.

    Attributes
    ----------
    model : str
        Model file, its path relative to the study file, or name of a shipped model.
    settings, factors : mapping
        As of :func:`shellcut.sweep`.
    design : Design
    figures : tuple of str
        Figures that the report shows; its own choice if empty.
    """

    model: str
    settings: Mapping[str, object]
    factors: Mapping[str, object]
    design: Design = field(default_factory=Design)
    figures: tuple[str, ...] = ()

    def plan(self, settings: Mapping[str, object] | None = None) -> Plan:
        """Return the runs, with further settings.

        Raises
        ------
        ModelFileError, ValueError
            As of :func:`shellcut.study.plan.plan`.
        """
        several, single = factors_of(self.factors)
        together = {**self.settings, **(settings or {}), **single}
        return replace(plan(self.model, together, several, self.design), figures=self.figures)


def is_study(path: str | os.PathLike[str]) -> bool:
    """Whether a file is a study rather than a model: it has factors."""
    try:
        text = read_regular(Path(path), _LARGEST).decode("utf-8-sig")
        return "factors" in parse(text, str(path), Path()).values
    except (OSError, ValueError):
        return False


def read_study(path: str | os.PathLike[str]) -> StudyFile:
    """Read a study file.

    Raises
    ------
    ModelFileError
        With all that is wrong with the file itself.
    OSError
        If it cannot be read.
    """
    text = read_regular(Path(path), _LARGEST).decode("utf-8-sig")
    source = parse(text, str(path), Path(path).resolve().parent)
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
    model = _beside(source.folder, values["model"])
    figures = tuple(str(name) for name in values.get("figures", ()))
    return StudyFile(model, values.get("set", {}), values["factors"], design, figures)


def _beside(folder: Path, model: str) -> str:
    there = folder / model
    return str(there) if there.is_file() else model


def write_study(path: Path, planned: Plan) -> None:
    """Write the study file of a plan, from which the same runs follow."""
    model = Path(planned.model)
    lines = [
        "# The study whose runs are beside this file: `shellcut sweep` finds them again by it.",
        f"model = {written(str(model.resolve()) if model.is_file() else planned.model)}",
        *_figures_line(path, planned),
        "",
        "[set]",
        *(f"{written(key)} = {written(value)}" for key, value in planned.settings.items()),
        "",
        "[factors]",
        *(f"{written(f.name)} = {_values(f)}" for f in planned.factors),
        "",
        "[design]",
        f"kind = {written(planned.design.kind)}",
    ]
    if planned.design.n is not None:
        lines += [f"n = {planned.design.n}", f"seed = {planned.design.seed}"]
    write_text(path, "\n".join(lines) + "\n")


def _figures_line(path: Path, planned: Plan) -> list[str]:
    """Return the line of the figures, those of an earlier file at this place if none are given."""
    figures = planned.figures
    try:
        figures = figures or read_study(path).figures
    except (OSError, ValueError):
        return []
    return [f"figures = {written(list(figures))}"] if figures else []


def _values(factor: Factor) -> str:
    if factor.ends is None:
        # Lists of lists, not of tuples: those are the way to write a table.
        return written([list(v) if factor.is_linked else v for v in factor.values])
    low, high = (f"{end!r} {factor.unit}".strip() for end in factor.ends)
    return written(f"{low} : {high}")
