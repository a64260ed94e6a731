"""What a verification case is, and how cases are found and run.

A case is one file in ``cases/``: a docstring (problem, source, what it measures), ``ID``,
``TITLE``, ``FAST`` (whether pytest runs it too) and a function ``checks()`` that computes and
returns :class:`Check` rows. It uses public functions of the library only.
"""

from __future__ import annotations

import importlib
import json
import math
import sys
import time
from dataclasses import asdict, dataclass, field
from pathlib import Path
from types import ModuleType

CASES = Path(__file__).parent / "cases"


@dataclass(frozen=True)
class Check:
    """One number against a reference.

    Attributes
    ----------
    quantity : str
        What is measured, with mesh and unit.
    reference, ours : float
        The published or exact value, and what the library gives.
    band : float
        Largest relative error, or absolute if ``absolute``.
    reason : str
        Why this band: the kind of tolerance.
    gate : bool
        False: printed beside, does not decide.
    absolute : bool
        Whether the error is taken as a difference.
    """

    quantity: str
    reference: float
    ours: float
    band: float
    reason: str
    gate: bool = True
    absolute: bool = False

    @property
    def error(self) -> float:
        """Relative error, or the difference."""
        difference = self.ours - self.reference
        return difference if self.absolute else difference / abs(self.reference)

    @property
    def passed(self) -> bool:
        """Whether the error lies within the band; nan never does."""
        return math.isfinite(self.error) and abs(self.error) <= self.band


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
    def passed(self) -> bool:
        """Whether all gates hold."""
        return all(check.passed for check in self.checks if check.gate)


def load_cases(only: str | None = None, *, fast_only: bool = False) -> list[ModuleType]:
    """Import the cases, all or one, in the order of their ids."""
    if str(CASES.parent) not in sys.path:
        sys.path.insert(0, str(CASES.parent))
    modules = [
        importlib.import_module(f"cases.{path.stem}")
        for path in sorted(CASES.glob("[a-z][0-9]*.py"))
    ]
    chosen = [m for m in modules if (only is None or only == m.ID) and (m.FAST or not fast_only)]
    if not chosen:
        raise SystemExit(f"no case {only!r}; there are {', '.join(m.ID for m in modules)}")
    return chosen


def run_case(module: ModuleType) -> Result:
    """Run one case."""
    began = time.process_time()
    checks = module.checks()
    curves = getattr(module, "CURVES", {})
    seconds = time.process_time() - began
    axes = module.AXES if curves else None
    return Result(module.ID, module.TITLE, seconds, checks, dict(curves), axes)


def as_json(results: list[Result]) -> str:
    """Return results as the text from which ``report.py`` makes the page."""
    table = [
        asdict(result)
        | {"passed": result.passed}
        | {"checks": [asdict(c) | {"error": c.error, "passed": c.passed} for c in result.checks]}
        for result in results
    ]
    return json.dumps(table, indent=1, default=lambda value: value.item()) + "\n"
