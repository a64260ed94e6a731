"""The whole cut over the film alone: both take turns in one process, ratios of medians.

``python tests/benchmarks/film_and_cut.py --mesh quick M1 --turns 5`` runs, for each mesh, the film
without a tool, the opening test with its default output, the same without output, and, with
``--ldpe``, that of a film that yields. Its steps are longer, so the whole runs are compared. All
kernels are compiled before.
"""

from __future__ import annotations

import argparse
import statistics
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from shellcut import Simulation, opening_test, read_model

_FILM_STEPS = 20_000


def film_alone(mesh: str) -> tuple[float, int]:
    """Return the time of many steps of the film without a tool [s], and their number."""
    inputs = opening_test(mesh).simulation.inputs  # type: ignore[arg-type]
    names = "mesh", "material", "supports", "damping_alpha", "damping_beta"
    sim = Simulation(**{name: inputs[name] for name in names})  # type: ignore[arg-type]
    for _ in range(100):
        sim.step()
    began = time.perf_counter()
    for _ in range(_FILM_STEPS):
        sim.step()
    return time.perf_counter() - began, _FILM_STEPS


def whole(mesh: str, film: str | None, *, output: bool) -> tuple[float, int]:
    """Return the time of the whole opening test, set-up left out [s], and its steps."""
    keys = {"membrane.mesh": mesh} | ({} if film is None else {"material": film})
    case = read_model("opening", keys).build()
    began = time.perf_counter()
    if output:
        with tempfile.TemporaryDirectory() as folder:
            case.run(Path(folder) / "out", progress=False)
    else:
        case.simulation.run(case.duration)
    return time.perf_counter() - began, case.simulation.state.step


def main() -> None:
    """Print a table of ratios."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--mesh", nargs="+", default=["quick", "M1"])
    parser.add_argument("--turns", type=int, default=5)
    parser.add_argument("--ldpe", action="store_true", help="also a film that yields")
    asked = parser.parse_args()
    print("| mesh | film alone [us a step] | whole / film | without output / film | LDPE / whole |")
    print("|---|---|---|---|---|")
    for mesh in asked.mesh:
        parts: dict[str, Callable[[], tuple[float, int]]] = {
            "film": lambda m=mesh: film_alone(m),
            "whole": lambda m=mesh: whole(m, None, output=True),
            "bare": lambda m=mesh: whole(m, None, output=False),
        }
        if asked.ldpe:
            parts["ldpe"] = lambda m=mesh: whole(m, "ldpe", output=True)
        seconds: dict[str, list[float]] = {part: [] for part in parts}
        steps = {}
        for turn in range(asked.turns + 1):
            for part, measured in parts.items():
                took, steps[part] = measured()
                if turn:  # the first loads kernels and Matplotlib
                    seconds[part].append(took)
        median = {part: statistics.median(took) for part, took in seconds.items()}
        step = {part: median[part] / steps[part] for part in parts}
        ratio = [step[part] / step["film"] for part in ("whole", "bare")]
        ldpe = f"{median['ldpe'] / median['whole']:.2f}" if asked.ldpe else "–"
        print(f"| {mesh} | {1e6 * step['film']:.1f} | {ratio[0]:.2f} | {ratio[1]:.2f} | {ldpe} |")


if __name__ == "__main__":
    main()
