"""What every benchmark shares: gates, children, and how busy the machine was otherwise."""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

TESTS = Path(__file__).resolve().parents[1]


@dataclass(frozen=True)
class Gate:
    """A figure against its target.

    Attributes
    ----------
    what : str
        What is measured, with mesh and unit.
    target : float
        Largest allowed value, or least if ``at_least``.
    figure : float, optional
        What was measured; None if it was not.
    at_least : bool
        Which side of the target is the good one.
    why_not : str
        Why there is no figure.
    """

    what: str
    target: float
    figure: float | None
    at_least: bool = False
    why_not: str = ""

    @property
    def met(self) -> bool | None:
        """Whether the target is met; None if nothing was measured."""
        if self.figure is None:
            return None
        good = self.figure >= self.target if self.at_least else self.figure <= self.target
        return math.isfinite(self.figure) and good

    @property
    def verdict(self) -> str:
        """The outcome in words."""
        if self.met is None:
            return f"not measured: {self.why_not}"
        return "met" if self.met else "not met"


def child(module: str, *arguments: str, cache: Path | None = None) -> dict[str, Any]:
    """Run a module of this package in a fresh process; return the JSON of its last line.

    Raises
    ------
    RuntimeError
        If the process fails, with the end of what it said.
    """
    environment = dict(os.environ, OMP_NUM_THREADS="1")
    paths = [str(TESTS), *filter(None, [os.environ.get("PYTHONPATH")])]
    environment["PYTHONPATH"] = os.pathsep.join(paths)
    if cache is not None:
        environment["NUMBA_CACHE_DIR"] = str(cache)
    done = subprocess.run(
        [sys.executable, "-m", f"benchmarks.{module}", *arguments],
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    lines = done.stdout.strip().splitlines()
    if done.returncode or not lines:
        said = (done.stderr or done.stdout)[-600:]
        raise RuntimeError(f"benchmarks.{module} ended with {done.returncode}: {said}")
    result: dict[str, Any] = json.loads(lines[-1])
    return result


def _busy_seconds() -> float | None:
    # Of all cores since boot, all processes; Linux only.
    try:
        fields = Path("/proc/stat").read_text().split("\n", 1)[0].split()[1:]
    except OSError:
        return None
    user, nice, system, _, _, irq, softirq, steal = (float(f) for f in fields[:8])
    return (user + nice + system + irq + softirq + steal) / os.sysconf("SC_CLK_TCK")


def _own_seconds() -> float:
    times = os.times()
    return times.user + times.system + times.children_user + times.children_system


class Neighbours:
    """Tells how much of the machine others used between its making and :meth:`report`."""

    def __init__(self) -> None:
        self._load = os.getloadavg() if hasattr(os, "getloadavg") else (math.nan,) * 3
        self._busy, self._own = _busy_seconds(), _own_seconds()
        self._began = time.perf_counter()

    def report(self) -> dict[str, float | None]:
        """Return the seconds, the load average at the start and the cores used by others."""
        seconds = time.perf_counter() - self._began
        busy = _busy_seconds()
        others = None
        if busy is not None and self._busy is not None:
            others = max(0.0, busy - self._busy - (_own_seconds() - self._own)) / seconds
        return {"seconds": seconds, "load_average": self._load[0], "cores_used_by_others": others}
