"""Coverage: ``python tests/predictions/band_coverage.py``; do error bars hold the fine answer?

Draws small models at random within the documented ranges, runs each with its companions and once
much finer and slower, and counts how often the figures of the fine run lie within the bands. Writes
``docs/error-bars.md`` and its picture. The runs take some 25 minutes of a core; their figures are
kept in a file, so a run that was ended goes on.
"""

import argparse
import json
import sys
import tempfile
from pathlib import Path

import numpy as np

from shellcut import read_model, sweep
from shellcut.study.companions import companions_of

N_MODEL = 210
FINER, SLOWER = 2.2, 2.5
"""Of the fine answer: the mesh of the finest companion is 1.5 times finer, the slowest half as
fast."""

OUTPUT = {
    "output.frames": 2,
    "output.snapshots": 0,
    "output.curves": False,
    "output.rows": 120,
    "threads": 1,
}
DISC = """model = "free"
[membrane]
radius = 4
n_side = 10
clamp = ["rim"]
[tool]
teeth = 3
radius = 3
length = 0.7
height = 2
phase_deg = 5
[motion]
kind = "screw"
angle_deg = 100
duration = 1e-3
"""


def drawn(rng, low, high):
    """Return a number between two, evenly drawn in its logarithm, of three digits."""
    return float(f"{np.exp(rng.uniform(np.log(low), np.log(high))):.3g}")


def film(rng, edge, strength=1.0):
    """Return film and law: the process zone is 3.2 to 4.5 edges long."""
    u, top = float(f"{edge * rng.uniform(3.2, 4.5):.3g}"), drawn(rng, 12.0, 30.0) * strength
    return {
        "material.young": drawn(rng, 800.0, 3000.0),
        "material.poisson": drawn(rng, 0.2, 0.45),
        "material.thickness": drawn(rng, 0.04, 0.15),
        "cohesive.strength": top,
        "cohesive.plateau": float(f"{top * rng.uniform(0.5, 0.9):.3g}"),
        "cohesive.opening_a": float(f"{u * rng.uniform(0.08, 0.2):.3g}"),
        "cohesive.opening_p": float(f"{u * rng.uniform(0.6, 0.85):.3g}"),
        "cohesive.opening_u": u,
    }


def guillotine(rng, path):
    """Return a strip cut along its edges, or through its quads."""
    width, n = drawn(rng, 2.0, 2.6), int(rng.choice([6, 8] if path == "edges" else [5, 6, 7]))
    own, notch = film(rng, width / n), float(f"{2.1 * width / n:.3g}")
    return "guillotine", own | {
        "membrane.width": width,
        "membrane.size": width / n,
        "membrane.length": float(
            f"{max(6.0 * own['cohesive.opening_u'], 2.1 * width) + notch:.3g}"
        ),
        "notch": notch,
        "fracture.path": path,
        "wedge_half_angle_deg": drawn(rng, 6.0, 18.0),
        "half_thickness": drawn(rng, 0.1, 0.3),
        "contact.friction": drawn(rng, 0.05, 0.3) if rng.random() < 0.5 else 0.0,
        "motion.speed": drawn(rng, 22e3, 45e3),
    }


def trouser(rng):
    """Return a strip whose legs are pulled apart."""
    width, n = drawn(rng, 2.2, 3.0), int(rng.choice([5, 6]))
    return "trouser", film(rng, width / n, 0.4) | {
        "material.thickness": drawn(rng, 0.12, 0.25),
        "membrane.width": width,
        "membrane.size": width / n,
        "membrane.length": float(f"{3.2 * width:.3g}"),
        "notch": float(f"{0.9 * width:.3g}"),
        "motion.speed": drawn(rng, 8e3, 15e3),
        "motion.ramp": 1e-4,
    }


def disc(rng):
    """Return a disc into which teeth screw."""
    n, teeth = int(rng.choice([10, 12])), int(rng.choice([2, 3, 4]))
    angle = {2: 150.0, 3: 100.0, 4: 80.0}[teeth]
    return "disc", film(rng, 5.0 / n) | {
        "membrane.n_side": n,
        "fracture.path": "free",
        "tool.teeth": teeth,
        "tool.half_thickness": drawn(rng, 0.1, 0.25),
        "tool.edge_inclination_deg": drawn(rng, 45.0, 75.0),
        "tool.wedge_half_angle_deg": drawn(rng, 8.0, 16.0),
        "motion.angle_deg": angle,
        "motion.pitch": drawn(rng, 3.0, 6.0),
        "motion.duration": float(f"{np.radians(angle) * 3.0 / drawn(rng, 16e3, 30e3):.3g}"),
    }


KINDS = {
    "strip, along edges": lambda rng: guillotine(rng, "edges"),
    "strip, through quads": lambda rng: guillotine(rng, "free"),
    "tear": trouser,
    "disc, teeth": disc,
}
ORDER = (0, 1, 3, 0, 1, 0, 1, 3, 0, 1, 0, 1, 3, 0, 1, 2, 0, 1, 0, 1)
"""Kinds of models, one after the other: tears are the dearest."""


def fine(model, names):
    """Return the settings of the fine answer, with the keys of the companions."""
    runs, _ = companions_of(model, FINER, SLOWER)
    (finer,) = (one for one in runs if one.run.name == "finer mesh")
    (slower,) = (one for one in runs if one.run.name == "slower")
    given = runs[0].settings
    other = {key: value for key, value in finer.settings.items() if value != given[key]}
    return {**{name: slower.settings.get(name, given[name]) for name in names}, **other}


def figures_of(number, folder):
    """Return kind, runs (name, part, size), their figures, and those of the fine run."""
    kind = list(KINDS)[ORDER[number % len(ORDER)]]
    name, settings = KINDS[kind](np.random.default_rng(number))
    if name == "disc":
        name = folder / "disc.toml"
        name.write_text(DISC)
    settings |= OUTPUT
    model = read_model(name, settings)
    runs, _ = companions_of(model)
    names = list(runs[0].settings)
    rows = [list(one.settings.values()) for one in runs] + [list(fine(model, names).values())]
    linked = {", ".join(names): rows}
    found = sweep(name, linked, folder, settings=settings, executor=1, say=lambda line: None)
    each = [found.outcomes[k] for k in range(len(rows))]
    numbers = [{n: v for n, v in one.figures.items() if isinstance(v, int | float)} for one in each]
    return {
        "number": number,
        "kind": kind,
        "runs": [[one.run.name, one.run.part, one.run.size] for one in runs],
        "figures": numbers,
        "seconds": [round(one.seconds, 2) for one in each],
        "failed": [one.reason for one in each if one.status != "done"],
    }


def gather(path, first, n):
    """Yield what the runs of all models gave, from the file as far as it goes."""
    kept = {}
    if path.exists():
        kept = {one["number"]: one for one in map(json.loads, path.read_text().splitlines())}
    for number in range(first, first + n):
        if number not in kept:
            with tempfile.TemporaryDirectory() as folder:
                kept[number] = figures_of(number, Path(folder))
            with path.open("a") as file:
                file.write(json.dumps(kept[number]) + "\n")
            print(
                number, kept[number]["kind"], kept[number]["seconds"], file=sys.stderr, flush=True
            )
        yield kept[number]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--kept", type=Path, default=Path("coverage.jsonl"), help="figures of runs")
    parser.add_argument("--first", type=int, default=0, help="number of the first model")
    parser.add_argument("--models", type=int, default=N_MODEL)
    options = parser.parse_args()
    list(gather(options.kept, options.first, options.models))


if __name__ == "__main__":
    main()
