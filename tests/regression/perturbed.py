"""What hangs on chance in a run: ``python tests/regression/perturbed.py [MODEL ...]``.

Runs a model again and again, each time with all nodes of its film moved in its plane at random by
up to 1e-9 mm. Nobody would call that another model, but round-off differs as on another processor,
and once a node touches or a crack advances a step sooner, the runs part. Prints mean, standard
deviation and range of each figure, as in docs/limits.md. The bound of a regression test should lie
four standard deviations beyond the mean or farther.
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
from shellcut.models.guillotine import strip_of

MOVED = 1e-9
"""[mm], a picometre."""

MODELS = {
    "quick": (lambda: opening_disc("quick"), opening_test),
    "guillotine": (lambda: strip_of(30.0, 8.0, 0.8), lambda mesh: guillotine(mesh=mesh)),
    "free": (unstructured_disc, opening_test),
}
"""Film and case: the quick opening; the guillotine on 0.8 mm quads; the opening through the quads
of a raw disc."""

FIGURES = {
    "window_from": "steady window, from",
    "window_to": "steady window, to",
    "torque_plateau": "torque, mean",
    "axial_force_plateau": "axial force, mean",
    "force_plateau": "force, mean",
    "dWcoh": "cables' work per radian or mm",
    "dW_": "tool's work per radian or mm",
    "torque_peak_N": "torque, peak",
    "force_peak_N": "force, peak",
    "broken_ratio": "work of a broken cable over G A, largest difference from 1",
    "imbalance_rel": "largest imbalance over the tool's work",
    "kinetic_rel": "largest kinetic energy over it",
    "unfelt_film_edge": "unfelt penetration of film edges",
}
"""How names of figures begin, and what they are called; units are in the names."""


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
    summary["broken_ratio"] = float(abs(broken_ratio(case) - 1.0).max())
    means = [n for n in summary if "_half_width_" not in n]
    names = [n for begin in FIGURES for n in means if n.startswith(begin)]
    return {name: summary[name] for name in names}


def table(rows):
    """Yield the lines of a table of figures."""
    yield "| figure | mean | standard deviation | smallest | largest |"
    yield "|---|---:|---:|---:|---:|"
    for name in rows[0]:
        values = np.array([row[name] for row in rows])
        told = next(words for begin, words in FIGURES.items() if name.startswith(begin))
        spread, size = float(values.std(ddof=1)), float(abs(values).max())
        digits = min(6, 2 + int(np.log10(size / spread)) if spread > 0.0 else 6)
        mean, low, high = (f"{v:.{digits}g}" for v in (values.mean(), values.min(), values.max()))
        yield f"| {told} (`{name}`) | {mean} | {spread:.2g} | {low} | {high} |"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("models", nargs="*", metavar="MODEL", help=f"of {', '.join(MODELS)}")
    parser.add_argument("--runs", type=int, default=20, help="of each model")
    parser.add_argument("--json", type=Path, help="also write the figures of every run")
    options = parser.parse_args()
    found = {}
    for model in options.models or MODELS:
        rows = found[model] = []
        for number in range(1, options.runs + 1):
            rows.append(figures(model, number))
            print(f"{model} {number}: {rows[-1]}", file=sys.stderr, flush=True)
            if options.json is not None:
                options.json.write_text(json.dumps(found, indent=1) + "\n")
        print(f"\n{model}, {len(rows)} runs\n")
        print(*table(rows), sep="\n", flush=True)


if __name__ == "__main__":
    main()
