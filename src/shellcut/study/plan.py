"""The plan of a study: its runs, each with its inputs and the hash that names its folder."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path

from shellcut.files.distribution import VERSION
from shellcut.model_file import Model, ModelFileError
from shellcut.model_file.errors import Problem
from shellcut.model_file.model import digest_of
from shellcut.model_file.overrides import spelled
from shellcut.model_file.reader import ModelVariants
from shellcut.model_file.section_table import along_path
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
