"""Run-to-run scatter: ``python tests/regression/perturbed.py [MODEL ...]``.

Runs a model again and again, each time with all nodes of its film moved in its plane at random by
up to 1e-9 mm. Nobody would call that another model, but round-off differs as on another processor,
and once a node touches or a crack advances a step sooner, the runs differ. The values of all runs
are stored in ``perturbed.json`` beside this file, and the table of their means and standard
deviations in docs/limits.md. The bound of a regression test should lie four standard deviations
beyond the mean or farther.
"""

import argparse
import json
import sys
import tempfile
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

from films import unstructured_disc
from runs import broken_ratio, run
from shellcut import Mesh, guillotine, opening_test
from shellcut.mesh.structured import opening_disc
from shellcut.models.case import PAPER_DAMPING
from shellcut.models.guillotine import strip_of

MOVED = 1e-9
"""[mm], a picometre."""

DAMPED = {"damping_beta": PAPER_DAMPING}
"""As the package's disc and strip are that these films are, but for a picometre."""

MODELS = {
    "quick": (lambda: opening_disc("quick"), lambda mesh: opening_test(mesh, **DAMPED)),
    "guillotine": (
        lambda: strip_of(30.0, 8.0, 0.8),
        lambda mesh: guillotine(mesh=mesh, **DAMPED),
    ),
    "free": (unstructured_disc, opening_test),
}
"""Film and case: the quick opening; the guillotine on 0.8 mm quads; the opening through the quads
of a raw disc."""

FIGURES = {
    "window_from": "steady window, from [°, mm]",
    "window_to": "steady window, to [°, mm]",
    "torque_plateau": "mean torque [N·mm], force [N]",
    "force_plateau": "mean torque [N·mm], force [N]",
    "axial_force_plateau": "mean axial force [N]",
    "dWcoh": "cables' work a radian [N·mm], a mm [N]",
    "dW_": "tool's work a radian [N·mm], a mm [N]",
    "torque_peak_N": "peak torque [N·mm], force [N]",
    "force_peak_N": "peak torque [N·mm], force [N]",
    "broken_ratio": "work of a broken cable over G A, largest difference from 1 [%]",
    "imbalance_rel": "imbalance, at most [%]",
    "kinetic_rel": "kinetic energy, at most [%]",
    "unfelt_film_edge": "depth of borders in the tool without a force [mm]",
}
"""How names of figures begin, and their rows in the table; of shares in per cent."""

HEADS = {
    "quick": "quick",
    "guillotine": "guillotine, 0.8 mm",
    "free": "raw disc, cracks through quads",
}
FIGURES_FILE = Path(__file__).with_suffix(".json")
PAGE = Path(__file__).parents[2] / "docs" / "limits.md"
HEAD = "| value |"
"""How the table on the page begins."""


def moved(film, number):
    """Return a film with its nodes moved at random, 0 for not at all."""
    X = film.nodes.copy()
    shift = np.random.default_rng(number).uniform(-MOVED, MOVED, (len(X), 2))
    X[:, :2] += shift if number else 0.0
    return Mesh.from_arrays(X, film.quads, node_sets=film.node_sets)


def figures(model, number):
    """Return the figures of a run by their names in the summary."""
    film, case_of = MODELS[model]
    case = case_of(moved(film(), number))
    with tempfile.TemporaryDirectory() as folder:
        summary, _ = run(case, Path(folder))
    return figures_of(case, summary)


def figures_of(case, summary):
    """Return the figures of a case that has run."""
    summary["broken_ratio"] = float(abs(broken_ratio(case) - 1.0).max())
    means = [n for n in summary if "_half_width_" not in n]
    names = [n for begin in FIGURES for n in means if n.startswith(begin)]
    return {name: summary[name] for name in names}


def check_among_runs(model, found):
    """Check that the figures of the unmoved film are those of one of the model's runs."""
    runs = json.loads(FIGURES_FILE.read_text())[model]
    for name, value in found.items():
        mean, deviation = spread([run[name] for run in runs])
        # Five standard deviations; a figure that chance does not reach differs by what was moved.
        bound = 5.0 * deviation + 1e-7 * abs(mean)
        assert abs(value - mean) <= bound, (name, value, entry([run[name] for run in runs]))


def spread(values):
    """Return mean and standard deviation of a figure over the runs."""
    return float(np.mean(values)), float(np.std(values, ddof=1))


def entry(values):
    """Return a figure of some runs as the table shows it."""
    mean, deviation = spread(values)
    if len(values) < 5:
        return ", ".join(f"{value:.7g}" for value in values)
    # two digits of the standard deviation, at most nine of the mean
    digits = 9
    if deviation > 0.0 and mean:
        digits = int(np.clip(2 + np.log10(abs(mean) / deviation), 3, 9))
    return f"{mean:.{digits}g} ± {deviation:.2g}"


def table(found):
    """Yield the lines of the table of the figures of all runs, by model and name."""
    heads = (f"{HEADS[model]}, {len(runs)} runs" for model, runs in found.items())
    yield f"{HEAD} {' | '.join(heads)} |"
    yield "|---" * (len(found) + 1) + "|"
    for row in dict.fromkeys(FIGURES.values()):
        cells = []
        for runs in found.values():
            begins = [begin for begin, words in FIGURES.items() if words == row]
            names = [name for name in runs[0] if name.startswith(tuple(begins))]
            times = 100.0 if "%" in row else 1.0
            values = [times * run[name] for name in names for run in runs]
            cells.append(entry(values) if values else "-")
        yield f"| {row} | {' | '.join(cells)} |"


def as_json(found):
    """Return the figures of all runs as text, a line a run."""
    models = (
        f"{json.dumps(model)}: [\n" + ",\n".join(map(json.dumps, runs)) + "\n]"
        for model, runs in found.items()
    )
    return "{\n" + ",\n".join(models) + "\n}\n"


def page(text, found):
    """Return the page with the table of these figures in place of its own."""
    before, _, rest = text.partition(f"\n{HEAD}")
    lines = rest.split("\n")
    end = next(k for k, line in enumerate(lines) if k and not line.startswith("|"))
    return "\n".join([before, *table(found), *lines[end:]])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("models", nargs="*", metavar="MODEL", help=f"of {', '.join(MODELS)}")
    parser.add_argument("--runs", type=int, help="of each model, 20, of the raw disc 2")
    options = parser.parse_args()
    kept = json.loads(FIGURES_FILE.read_text()) if FIGURES_FILE.exists() else {}
    for model in options.models or MODELS:
        rows = []
        for number in range(1, (options.runs or (2 if model == "free" else 20)) + 1):
            rows.append(figures(model, number))
            print(f"{model} {number}: {rows[-1]}", flush=True)
        kept[model] = rows
        ordered = {name: kept[name] for name in MODELS if name in kept}
        FIGURES_FILE.write_text(as_json(ordered))
        PAGE.write_text(page(PAGE.read_text(), ordered))


if __name__ == "__main__":
    main()
