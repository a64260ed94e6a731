"""Coverage: ``python tests/predictions/band_coverage.py``; do error bars contain the fine answer?

Draws small models at random within the documented ranges, runs each with its companions and once
much finer and slower, and counts how often the figures of the fine run lie within the bands. Writes
``docs/error-bars.md`` and its picture. The runs take some 25 minutes of a core; their figures are
kept in a file, so the script continues after it was stopped.
"""

import argparse
import json
import math
import sys
import tempfile
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import scipy

from shellcut import ErrorBar, read_model, sweep
from shellcut.results.error_bars import PARTS, Run, error_bar
from shellcut.results.summary_figures import with_unit
from shellcut.study.converge import companions_of
from shellcut.view import Curve, Diagram, draw_curves

DOCS = Path(__file__).resolve().parents[2] / "docs"

N_MODEL = 210
FIGURES = (
    *("torque_plateau_Nmm", "force_plateau_N", "torque_peak_Nmm", "force_peak_N"),
    *("axial_force_plateau_N", "crack_length_mm", "tool_work_Nmm", "support_work_Nmm"),
)
"""Headline figures, as ``shellcut converge`` chooses them."""
KINETIC = 0.05
SPEEDS = {
    False: "kinetic energy of the model as given up to 5 %",
    True: "above 5 %, which a verdict distrusts",
}
LABELS = {"chance": "run-to-run scatter"}
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
    keys = {run.name: keys for run, keys in runs.items()}
    given, finer = keys["as given"], keys["finer mesh"]
    other = {key: value for key, value in finer.items() if value != given[key]}
    return {**{name: keys["slower"].get(name, given[name]) for name in names}, **other}


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
    names = list(next(iter(runs.values())))
    rows = [list(keys.values()) for keys in runs.values()] + [list(fine(model, names).values())]
    linked = {", ".join(names): rows}
    found = sweep(name, linked, folder, settings=settings, executor=1, say=lambda line: None)
    each = [found.outcomes[k] for k in range(len(rows))]
    numbers = [{n: v for n, v in one.figures.items() if isinstance(v, int | float)} for one in each]
    return {
        "number": number,
        "kind": kind,
        "runs": [[run.name, run.part, run.size] for run in runs],
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


@dataclass(frozen=True)
class Case:
    """A figure of a model, with its error bar and the fine answer."""

    number: int
    kind: str
    runs: list[Run]
    bar: ErrorBar
    fine: float
    by_half: bool
    """Whether the band would hold it if a crack's length were known to half an edge."""
    fast: bool
    """Whether the kinetic energy of the model as given passes the limit of the verdict."""

    @property
    def off(self):
        """How far the fine answer lies from the value, over the half-width."""
        return (self.fine - self.bar.value) / self.bar.half_width

    @property
    def covered(self):
        """Whether it lies within the band."""
        return abs(self.off) <= 1.0


def cases_of(one):
    """Yield the headline figures of a model that both the run as given and the fine run have."""
    runs = [Run(*run) for run in one["runs"]]
    *each, fine = one["figures"]
    for name in FIGURES:
        if name in each[0] and name in fine:
            values = [figures.get(name) for figures in each]
            edge = each[0]["edge_length_mm"]
            bar, narrow = (error_bar(name, runs, values, c * edge) for c in (1.0, 0.5))
            by_half = abs(fine[name] - narrow.value) <= narrow.half_width
            fast = each[0].get("kinetic_rel", 0.0) > KINETIC
            yield Case(one["number"], one["kind"], runs, bar, fine[name], by_half, fast)


def median_band(case):
    """Whether the median of all runs and t s, or the largest difference, hold the fine answer."""
    values = np.array([v for v in case.bar.values if v is not None])
    middle, t = np.median(values), scipy.stats.t.ppf(0.975, len(values) - 1)
    spread = t * values.std(ddof=1) / np.sqrt(len(values))
    return abs(case.fine - middle) <= max(spread, abs(values - middle).max())


def second_order(case):
    """Whether the band would hold the fine answer if the mesh's error were of second order."""
    sizes = [run.size for run in case.runs if run.name == "finer mesh"]
    parts = dict(case.bar.parts)
    if sizes and "mesh" in parts:
        parts["mesh"] *= sizes[0] / (1.0 + sizes[0])  # q^2 / (1 - q^2) over q / (1 - q)
    return abs(case.fine - case.bar.value) <= math.hypot(*parts.values())


def shares(cases, name):
    """Yield rows of a table: share covered and median half-width, of each group and of all."""
    groups = {}
    for case in cases:
        groups.setdefault(name(case), []).append(case)
    for group, some in groups.items():
        yield _row(group, some)
    yield _row("**all**", cases)


def _row(group, some):
    n, hit = len(some), sum(case.covered for case in some)
    width = np.median([abs(case.bar.half_width / case.fine) for case in some])
    return f"| {group} | {n} | {hit} | {100.0 * hit / n:.1f} % | {100.0 * width:.2g} % |"


def interval(cases):
    """Return the share covered and its 95 % interval over resampled models, in per cent."""
    by_model = {}
    for case in cases:
        by_model.setdefault(case.number, []).append(case.covered)
    sums = np.array([[sum(c), len(c)] for c in by_model.values()])
    chosen = np.random.default_rng(0).integers(len(sums), size=(4000, len(sums)))
    drawn_again = sums[chosen].sum(axis=1)
    ratios = 100.0 * drawn_again[:, 0] / drawn_again[:, 1]
    low, high = np.quantile(ratios, (0.025, 0.975))
    return 100.0 * sums[:, 0].sum() / sums[:, 1].sum(), low, high


def page(found):
    """Return the text of the page."""
    cases = [case for one in found for case in cases_of(one)]
    share, low, high = interval(cases)
    kinds = Counter(one["kind"] for one in found)
    failed = sum(bool(one["failed"]) for one in found)
    missed = sorted((c for c in cases if not c.covered), key=lambda case: -abs(case.off))
    minutes = sum(sum(one["seconds"]) for one in found) / 60.0
    rows = [
        f"| {c.number} | {c.kind} | {c.bar.name} | {with_unit(c.bar.figure, c.bar.value)} ± "
        f"{c.bar.half_width:.2g} | {with_unit(c.bar.figure, c.fine)} | {abs(c.off):.2f} |"
        for c in missed
    ]
    head = (
        "| | values | covered | share | median half-width over value |\n|---|---:|---:|---:|---:|"
    )
    by_median = 100.0 * np.mean([median_band(case) for case in cases])
    return TEXT.format(
        n=len(found),
        n_figure=len(cases),
        share=share,
        low=low,
        high=high,
        kinds=", ".join(f"{n} of the kind *{kind}*" for kind, n in kinds.items()),
        finer=FINER,
        slower=SLOWER,
        minutes=minutes,
        failed=f"A run failed in {failed} models; it is missing in their error bars."
        if failed
        else "No run failed.",
        figures="\n".join([head, *shares(cases, lambda case: case.bar.name)]),
        by_kind="\n".join([head, *shares(cases, lambda case: case.kind)]),
        by_speed="\n".join([head, *shares(cases, lambda case: SPEEDS[case.fast])]),
        parts="\n".join(_parts(cases)),
        by_median=by_median,
        by_half=100.0 * np.mean([case.by_half for case in cases]),
        by_second=100.0 * np.mean([second_order(case) for case in cases]),
        fast=len({case.number for case in cases if case.fast}),
        width=100.0 * np.median([abs(c.bar.half_width / c.fine) for c in cases]),
        n_missed=len(missed),
        missed="\n".join(rows),
    )


def _parts(cases):
    """Yield rows: the share that would be covered without a part."""
    yield "| without | share covered |"
    yield "|---|---:|"
    for part in PARTS:
        left = [
            math.hypot(*(w for name, w in case.bar.parts.items() if name != part)) for case in cases
        ]
        inside = [abs(c.fine - c.bar.value) <= w for c, w in zip(cases, left, strict=True)]
        yield f"| {LABELS.get(part, part)} | {100.0 * np.mean(inside):.1f} % |"


def picture(found, path):
    """Draw how far the fine answers lie from the values, over the half-widths."""
    names = {figure: k for k, figure in enumerate(FIGURES)}
    cases = sorted(
        (case for one in found for case in cases_of(one)), key=lambda case: names[case.bar.figure]
    )
    groups = {}
    for k, case in enumerate(cases):
        groups.setdefault(case.bar.name, []).append((k, np.clip(case.off, -3.0, 3.0)))
    curves = [
        Curve(name, [off for _, off in some], f"p{n % 7}", x=[k for k, _ in some])
        for n, (name, some) in enumerate(groups.items())
    ]
    ends = [0.0, len(cases) - 1.0]
    curves += [Curve("the band", [at, at], "mean", x=ends) for at in (-1.0, 1.0)]
    name = "(fine answer - value) / half-width"
    draw_curves(path, [Diagram(ends, curves, "values of all models", "", name, "")], size=(10, 5))


def main():
    """Run what is not kept yet, and write page and picture."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--kept", type=Path, default=Path("coverage.jsonl"), help="figures of runs")
    parser.add_argument("--first", type=int, default=0, help="number of the first model")
    parser.add_argument("--models", type=int, default=N_MODEL)
    options = parser.parse_args()
    found = list(gather(options.kept, options.first, options.models))
    (DOCS / "error-bars.md").write_text(page(found), encoding="utf-8")
    picture(found, DOCS / "img" / "error_bars.png")
    share, low, high = interval([case for one in found for case in cases_of(one)])
    print(f"{share:.1f} % covered ({low:.1f} to {high:.1f} %), {len(found)} models")


TEXT = """# Do error bars contain the fine answer?

This page shows how far you can trust the [error bars](howto/converge.md) of `shellcut converge`:
do 95 % of them contain the result of a much finer and slower run?
`python tests/predictions/band_coverage.py` makes it.

{n} small models are drawn at random with fixed seeds: {kinds}. They differ in modulus,
thickness, strength, shape of the law, length of the process zone (3.2 to 4.5 sides of quads),
widths, angles of the blade, friction and speed. Each model is run as `shellcut converge` runs
it: as given, and with changed mesh, speed and details. It is run once more on a mesh {finer:g}
times finer (the finest of the others: 1.5) at 1/{slower:g} of the speed (the slowest of the
others: 1/2). The last run is the fine answer. It has run-to-run scatter, too, which the error
bar must contain.

**{share:.1f} % of {n_figure} values lie within their error bar** (95 % interval over the models:
{low:.1f} to {high:.1f} %). The aim is 93 to 97 %.

{figures}

{by_kind}

{by_speed}

![How far fine answers lie from the values](img/error_bars.png)

Beyond ±3 the points are drawn at ±3.

## Each part of the error bar is needed

{parts}

The median of all runs is a simpler choice, with the t interval of their mean or their largest
difference, whichever is larger. Its bar would contain {by_median:.0f} % of the fine answers,
because it leaves out what a finer mesh still changes.

No number in the error bar is fitted. Two choices are made:

- The error of the mesh is of first order. With second order the bars would contain
  {by_second:.1f} %, because cracks and sawteeth do not converge as shells do.
- The length of a crack is known to one side of a quad. With half a side the bars would contain
  {by_half:.1f} %.

## What it does not show

- The models have only 50 to 250 quads and are coarse and fast, so that 1700 runs are possible.
  The kinetic energy of {fast} models as given exceeds the [5 %](howto/trust.md) of the verdict.
  Their error bars are wide, {width:.0f} % of the value in the median. Finer and slower models
  have narrower ones.
- Errors that all runs share are not in the bars: the law, the material, the friction, the shell
  theory.
- {failed}

## Values outside their error bar

These are {n_missed} values. The last column is the distance between the fine answer and the
value, divided by the half-width.

| model | kind | quantity | value ± half-width | fine answer | distance |
|---:|---|---|---:|---:|---:|
{missed}

The runs took {minutes:.0f} minutes on a machine with other work.
"""


if __name__ == "__main__":
    main()
