"""Memory a quad: the slope of the resident set between two meshes, each in a fresh process."""

from __future__ import annotations

import gc
import json
import os
import resource
import sys
from dataclasses import asdict, dataclass
from pathlib import Path

from benchmarks.discs import SIZES, build_mesh, pressurised_disc
from benchmarks.harness import child


@dataclass(frozen=True)
class Footprint:
    """Resident memory of one process with one disc [bytes]."""

    n_quad: int
    set_up: float
    """After set-up and a first step."""
    after_run: float
    """After more steps."""
    peak: float
    """Largest so far, set-up included."""


@dataclass(frozen=True)
class Memory:
    """Slopes between the two discs [bytes a quad], and the growth of the larger one over a run."""

    small: Footprint
    large: Footprint

    @property
    def set_up_slope(self) -> float:
        """Of the memory that stays."""
        return self._slope("set_up")

    @property
    def peak_slope(self) -> float:
        """Of the peak, which the set-up makes."""
        return self._slope("peak")

    @property
    def growth(self) -> float:
        """Change of the larger disc's memory over a run [bytes a quad]."""
        return (self.large.after_run - self.large.set_up) / self.large.n_quad

    def _slope(self, figure: str) -> float:
        rise = getattr(self.large, figure) - getattr(self.small, figure)
        return float(rise / (self.large.n_quad - self.small.n_quad))


def resident() -> float:
    """Return the resident set of this process [bytes]; its peak where the system lacks /proc."""
    gc.collect()
    try:
        pages = int(Path("/proc/self/statm").read_text().split()[1])
    except OSError:
        return peak()
    return float(pages * os.sysconf("SC_PAGE_SIZE"))


def peak() -> float:
    """Return the largest resident set of this process so far [bytes]."""
    try:
        # getrusage would count what this process was before it became Python: its parent's copy.
        status = Path("/proc/self/status").read_text()
        return 1024.0 * float(status.split("VmHWM:")[1].split()[0])
    except (OSError, IndexError):
        pass
    largest = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return float(largest if sys.platform == "darwin" else largest * 1024)


def footprint(name: str, steps: int) -> Footprint:
    """Measure this process with one disc set up and run for some steps."""
    mesh = build_mesh(SIZES[name])
    sim = pressurised_disc(mesh, "linear")
    sim.step()
    set_up = resident()
    for _ in range(steps):
        sim.step()
    return Footprint(mesh.n_quad, set_up, resident(), peak())


def measure(small: str = "1e5", large: str = "1e6", steps: int = 20) -> Memory:
    """Measure two discs, each in a process of its own."""
    return Memory(
        *(Footprint(**child("memory", name, str(steps))) for name in (small, large)),
    )


if __name__ == "__main__":
    print(json.dumps(asdict(footprint(sys.argv[1], int(sys.argv[2])))))
