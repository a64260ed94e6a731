"""A study as its folder holds it: the factors, and the table of inputs and values."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from shellcut.arrays import Bools, Floats
from shellcut.model_file.key_index import unit_of_key
from shellcut.model_file.quantity import quantity
from shellcut.results.summary_figures import label_of, unit_of
from shellcut.study.factors import Factor, factors_of
from shellcut.study.plan import RUNS, STUDY, Definition, read_study
from shellcut.study.table import TABLE
from shellcut.unit import after, shown

_MAIN = (
    ("torque_plateau_Nmm", "force_plateau_N"),
    ("torque_peak_Nmm", "force_peak_N"),
    ("axial_force_plateau_N",),
    ("crack_length_mm",),
    ("tool_work_Nmm", "support_work_Nmm"),
)
"""Figures shown of a study that names none: of each row the first that it has."""


@dataclass(frozen=True, kw_only=True)
class Studied:
    """A key, or a factor, with its value in each run: a number, or a name out of a list."""

    name: str
    ends: tuple[float, float]
    """Least and largest value of the study, run or not; of a list (0, number of names - 1)."""
    names: tuple[str, ...] = ()
    """The names, two or more; empty for numbers."""
    key: str
    """As in the study file; of a factor of several keys all of them."""
    unit: str
    """As printed."""
    values: Floats
    """Numbers, shape (n_run,); of a list of names the place in ``names``."""
    texts: tuple[str, ...]
    """The values as they are in the table."""

    @property
    def shown(self) -> tuple[str, ...]:
        """The values as they are read: numbers of four digits with their unit."""
        with_units = tuple(f"{value:.4g}{after(self.unit)}" for value in self.values.tolist())
        return self.texts if self.names else with_units

    @property
    def varies(self) -> bool:
        """Whether it has two values or more."""
        return self.ends[0] < self.ends[1]


@dataclass(frozen=True)
class FigureOfRuns:
    """A value of interest: NaN in runs that have none."""

    key: str
    name: str
    unit: str
    values: Floats


@dataclass(frozen=True)
class Study:
    """What the folder of a study holds."""

    folder: Path
    file: Definition
    numbers: tuple[str, ...]
    status: tuple[str, ...]
    keys: tuple[str, ...]
    reasons: tuple[str, ...]
    """Of each run: its number, ``done``, ``failed``, ``stopped`` or ``waits``, the name of its
    folder, and why it failed."""
    inputs: tuple[Studied, ...]
    """Every key of the factors."""
    factors: tuple[Studied, ...]
    """What varies independently: of keys that change together the first represents all, where its
    numbers tell the runs apart, else the values as names."""
    figures: tuple[FigureOfRuns, ...]
    """Those of interest."""
    all_figures: Mapping[str, Floats]
    """All of the table, shape (n_run,)."""
    lacking: tuple[str, ...]
    """Figures that the study asks for and no run has."""

    @property
    def done(self) -> Bools:
        """Which runs are done, shape (n_run,)."""
        return np.array([status == "done" for status in self.status], bool)

    @property
    def doubted(self) -> Bools:
        """Which runs their verdicts distrust, shape (n_run,)."""
        none = np.zeros(len(self.status))
        return np.asarray(self.all_figures.get("doubts", none) > 0.0)

    @property
    def name(self) -> str:
        """Of the folder."""
        return self.folder.resolve().name

    def run_folder(self, row: int) -> Path:
        """Return the folder of the run in a row of the table."""
        return self.folder / RUNS / self.keys[row]

    def count(self, status: str) -> int:
        """Return the number of runs with a status."""
        return self.status.count(status)


def read_folder(folder: Path) -> Study:
    """Read a study."""
    if not (folder / STUDY).is_file():
        raise FileNotFoundError(f"{folder} must be the folder of a study, with {STUDY}")
    if not (folder / TABLE).is_file():
        raise FileNotFoundError(
            f"{folder} must have {TABLE}, and has none yet: shellcut sweep writes it a few seconds "
            "after the first run has ended"
        )
    file = read_study(folder / STUDY)
    with (folder / TABLE).open(encoding="utf-8-sig", newline="") as text:
        head, *rows = list(csv.reader(text)) or [[]]
    if head[:1] != ["run"] or "status" not in head or head[-2:] != ["folder", "reason"]:
        raise ValueError(
            f"{folder / TABLE} must have the columns run ... status ... folder, reason"
        )
    if any(len(row) != len(head) for row in rows):
        raise ValueError(f"{folder / TABLE} must have {len(head)} cells in every row")
    columns = {name: tuple(row[k] for row in rows) for k, name in enumerate(head)}
    first = head.index("status")
    figures = {name: _numbers(columns[name]) for name in head[first + 1 : -2]}
    chosen, lacking = of_interest(file.figures, figures)
    planned, _ = factors_of(file.factors)
    inputs = _inputs(planned, {key: columns[key] for key in head[1:first]})
    return Study(
        folder,
        file,
        columns["run"],
        columns["status"],
        columns["folder"],
        columns["reason"],
        inputs,
        _factors(planned, inputs),
        tuple(_figure(name, figures[name]) for name in chosen),
        figures,
        lacking,
    )


def _figure(name: str, values: Floats) -> FigureOfRuns:
    unit, factor = shown(unit_of(name))
    return FigureOfRuns(name, label_of(name), unit, factor * values)


def of_interest(
    chosen: Sequence[str], there: Mapping[str, object]
) -> tuple[list[str], tuple[str, ...]]:
    """Return the chosen values that are there, or the usual ones, and those that are not."""
    if chosen:
        lacking = tuple(name for name in chosen if name not in there)
        return [name for name in chosen if name in there], lacking
    found = (next((name for name in names if name in there), None) for names in _MAIN)
    return [name for name in found if name is not None], ()


def _inputs(planned: Sequence[Factor], columns: Mapping[str, Sequence[str]]) -> tuple[Studied, ...]:
    """Return every key of the table with its values."""
    units = {key: unit_of_key(key) for key in columns}
    short = [key.rpartition(".")[2] for key in columns]
    found = []
    for key, cells in columns.items():
        texts, (unit, factor) = tuple(cells), shown(units[key])
        plain = key.rpartition(".")[2]
        name = plain if short.count(plain) == 1 else key
        name = name.removesuffix("_deg").replace("_", " ")
        probes = [
            str(one.settings(value)[key])
            for one in planned
            if key in one.keys
            for value in one.probes()
        ]
        numbers = [_number(text, units[key]) for text in (*texts, *probes)]
        if all(number is not None for number in numbers):
            values = factor * np.array(numbers, float)
            ends = float(values.min()), float(values.max())
            values = values[: len(texts)]
            one = Studied(name=name, ends=ends, key=key, unit=unit, values=values, texts=texts)
        else:
            one = _of_names(name, key, unit, texts, (*probes, *texts))
        found.append(one)
    return tuple(found)


def _factors(planned: Sequence[Factor], inputs: Sequence[Studied]) -> tuple[Studied, ...]:
    """Return what varies independently, in the order of the table."""
    by_key = {one.key: one for one in inputs}
    linked = {
        key: [by_key[other] for other in factor.keys]
        for factor in planned
        if factor.is_linked and all(other in by_key for other in factor.keys)
        for key in factor.keys
    }
    return tuple(
        _as_one(linked[one.key]) if one.key in linked else one
        for one in inputs
        if one.key not in linked or linked[one.key][0] is one
    )


def _as_one(inputs: Sequence[Studied]) -> Studied:
    """Return keys that change together as one factor."""
    first = inputs[0]
    key, name = ", ".join(one.key for one in inputs), " and ".join(one.name for one in inputs)
    texts = tuple(", ".join(each) for each in zip(*(one.shown for one in inputs), strict=True))
    if not first.names and len(np.unique(first.values)) == len(set(texts)):
        return replace(first, key=key, name=name)
    return _of_names(name, key, "", texts, texts)


def _of_names(
    name: str, key: str, unit: str, texts: tuple[str, ...], every: Sequence[str]
) -> Studied:
    names = tuple(dict.fromkeys(every))
    values = np.array([names.index(text) for text in texts], float)
    ends = 0.0, len(names) - 1.0
    return Studied(
        name=name, ends=ends, names=names, key=key, unit=unit, values=values, texts=texts
    )


def _number(text: str, unit: str) -> float | None:
    """Return the number of a cell in the unit of its key, None if it is a name."""
    try:
        return quantity(text, unit)
    except ValueError:
        return None


def _numbers(cells: Sequence[str]) -> Floats:
    """Return the values of a column, NaN where a run has none."""
    found = np.full(len(cells), np.nan)
    for k, cell in enumerate(cells):
        try:
            found[k] = float(cell)
        except ValueError:
            continue
    return np.where(np.isfinite(found), found, np.nan)
