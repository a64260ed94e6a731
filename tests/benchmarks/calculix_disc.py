"""The pressurised disc in CalculiX: input deck, run, and what it printed.

S4R shells, expanded by CalculiX to solids, by ``*DYNAMIC, EXPLICIT``, one thread. CalculiX chooses
the step from the smallest height, which is the thickness.

The pressure is given as the body force of the same sum: that is dead, while a pressure follows the
surface, and nodal forces act on an expanded shell through constraints (half the deflection came
out). The CPU a step is the difference of a whole and a short run, so that reading and set-up drop
out.
"""

from __future__ import annotations

import math
import os
import re
import resource
import subprocess
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from shellcut.mesh.mesh import Mesh

Array = np.ndarray[Any, Any]

_SHORT = 0.05  # of the whole time
_PRINT_EVERY = 20  # steps, seldom enough to cost nothing


@dataclass(frozen=True)
class CalculixRun:
    """What a run printed."""

    n_step: int
    step: float
    """[s]"""
    cpu_ns: float
    """A step."""
    times: Array
    heights: Array
    """Of the middle node [mm], up positive."""


def deck(
    mesh: Mesh, pressure: float, middle: int, section: tuple[float, float, float, float], end: float
) -> str:
    """Return the input deck; section is (E, nu, density, thickness)."""
    young, poisson, density, thickness = section
    acceleration = pressure / (density * thickness)

    def numbered(rows: Sequence[Any] | Array, shown: str) -> Iterator[str]:
        for number, row in enumerate(rows, start=1):
            yield ", ".join([str(number), *(format(value, shown) for value in row)])

    lines = [
        "*NODE, NSET=ALL",
        *numbered(mesh.nodes, ".12g"),
        "*ELEMENT, TYPE=S4R, ELSET=FILM",
        *numbered(mesh.quads + 1, "d"),
        "*NSET, NSET=RIM",
        *(f"{node + 1}," for node in mesh.node_set("rim")),
        "*NSET, NSET=MIDDLE",
        f"{middle + 1},",
        "*MATERIAL, NAME=FILM",
        "*ELASTIC",
        f"{young}, {poisson}",
        "*DENSITY",
        f"{density}",
        "*SHELL SECTION, ELSET=FILM, MATERIAL=FILM",
        f"{thickness}",
        "*BOUNDARY",
        "RIM, 1, 6",
        "*STEP, NLGEOM, INC=10000000",
        "*DYNAMIC, EXPLICIT",
        # First increment and end; the increment is cut to the stable one if it is longer.
        f"1e-7, {end}",
        "*DLOAD",
        f"FILM, GRAV, {acceleration:.12g}, 0, 0, 1",
        f"*NODE PRINT, NSET=MIDDLE, FREQUENCY={_PRINT_EVERY}",
        "U",
        "*END STEP",
    ]
    return "\n".join(lines) + "\n"


def run_deck(folder: Path, text: str) -> tuple[str, float]:
    """Run a deck; return the log and the CPU time [s].

    Raises
    ------
    RuntimeError
        If CalculiX does not finish.
    """
    (folder / "disc.inp").write_text(text)
    threads = {"OMP_NUM_THREADS": "1", "CCX_NPROC_RESULTS": "1", "CCX_NPROC_EQUATION_SOLVER": "1"}
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(
        ["ccx", "disc"],
        cwd=folder,
        env=dict(os.environ, **threads),
        capture_output=True,
        text=True,
        check=False,
    )
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode or "Job finished" not in done.stdout:
        raise RuntimeError(f"ccx ended with {done.returncode}: {done.stdout[-400:]}")
    return done.stdout, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def run_calculix(
    mesh: Mesh,
    pressure: float,
    middle: int,
    section: tuple[float, float, float, float],
    end: float,
    folder: Path,
) -> CalculixRun:
    """Run the disc to ``end`` and, for the cost of set-up, to a small part of it.

    Raises
    ------
    RuntimeError
        If CalculiX fails or does not say which step it took.
    """
    cpu, steps = [], []
    step = math.nan
    for until in (_SHORT * end, end):
        log, seconds = run_deck(folder, deck(mesh, pressure, middle, section, until))
        said = re.search(r"SELECTED time increment:\s*([0-9.eE+-]+)", log)
        if said is None:
            raise RuntimeError("ccx did not say which time increment it selected")
        step = float(said.group(1))
        cpu.append(seconds)
        steps.append(math.ceil(until / step))
    times, heights = read_middle((folder / "disc.dat").read_text())
    cost = 1e9 * (cpu[1] - cpu[0]) / (steps[1] - steps[0])
    return CalculixRun(steps[1], step, cost, times, heights)


def read_middle(text: str) -> tuple[Array, Array]:
    """Return times and heights of the one node in a .dat file."""
    blocks = re.findall(r"and time\s+(\S+)\s+\d+\s+\S+\s+\S+\s+(\S+)", text)
    times, heights = np.array(blocks, float).T
    return times, heights
