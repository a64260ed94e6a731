"""What a verification case is, and how cases are found and run.

A case is a function under :func:`case` in a file of ``cases/``, which says the problem, its source
and what it measures, and yields :class:`Check` rows. Cases of one kind are in one file. They use
public functions of the library only.
"""

import importlib
import json
import math
import sys
import time
from collections.abc import Callable, Iterable
from dataclasses import asdict, dataclass, field
from pathlib import Path

CASES = Path(__file__).parent / "cases"


@dataclass(frozen=True)
class Check:
    """One number against a reference."""

    quantity: str
    """What is measured, with mesh and unit."""
    reference: float
    ours: float
    band: float
    """Largest relative error, or absolute if ``absolute``."""
    reason: str
    """Why this band: the kind of tolerance."""
    gate: bool = True
    """False: printed for information, does not decide."""
    absolute: bool = False

    @property
    def error(self):
        difference = self.ours - self.reference
        return difference if self.absolute else difference / abs(self.reference)

    @property
    def passed(self):
        # nan never does
        return math.isfinite(self.error) and abs(self.error) <= self.band


def zero(quantity, ours, band, reason, *, gate=True):
    """Return the check of a number that must be zero."""
    return Check(quantity, 0.0, ours, band, reason, gate, absolute=True)


@dataclass(frozen=True)
class Result:
    """A case that has been run; its seconds are those of the processor, whatever else it did."""

    id: str
    title: str
    seconds: float
    checks: list[Check]
    curves: dict[str, dict[str, list[float]]] = field(default_factory=dict)
    axes: tuple[str, str] | None = None
    """Labels of the axes of its picture, with units; None without curves."""

    @property
    def passed(self):
        return all(check.passed for check in self.checks if check.gate)


@dataclass
class Case:
    """A case. Its rows are computed by ``checks``, which may fill ``CURVES`` for its picture."""

    ID: str
    TITLE: str
    checks: Callable[[], Iterable[Check]]
    FAST: bool
    """Whether pytest runs it too."""
    AXES: tuple[str, str] | None
    CURVES: dict[str, dict[str, list[float]]] = field(default_factory=dict)


def case(name, title, *, fast=True, axes=None):
    """Make a case of a function that yields or returns its rows."""
    return lambda checks: Case(name, title, checks, fast, axes)


def load_cases(only=None, *, fast_only=False):
    """Import the cases, all or one, in the order of their ids."""
    for folder in CASES.parents[:2]:  # of the cases, and of what all tests share
        if str(folder) not in sys.path:
            sys.path.insert(0, str(folder))
    modules = [importlib.import_module(f"cases.{path.stem}") for path in CASES.glob("[a-z]*.py")]
    found = [one for module in modules for one in vars(module).values() if isinstance(one, Case)]
    cases = sorted({one.ID: one for one in found}.values(), key=lambda one: one.ID)
    chosen = [c for c in cases if (only is None or only == c.ID) and (c.FAST or not fast_only)]
    if not chosen:
        raise SystemExit(f"no case {only!r}; there are {', '.join(c.ID for c in cases)}")
    return chosen


def run_case(one):
    """Run one case."""
    began = time.process_time()
    checks = list(one.checks())
    seconds = time.process_time() - began
    axes = one.AXES if one.CURVES else None
    return Result(one.ID, one.TITLE, seconds, checks, dict(one.CURVES), axes)


def as_json(results):
    """Return results as the text from which ``report.py`` makes the page."""
    table = [
        asdict(result)
        | {"passed": result.passed}
        | {"checks": [asdict(c) | {"error": c.error, "passed": c.passed} for c in result.checks]}
        for result in results
    ]
    return json.dumps(table, indent=1, default=lambda value: value.item()) + "\n"
