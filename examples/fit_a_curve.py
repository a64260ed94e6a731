"""Fit a law to a measured curve
=============================

A short cut by the guillotine plays the experiment: its force, with noise of 3 % of the peak, is
"measured". The fit then starts from the model's plateau of the cohesive law, and finds the one that
the experiment had. ::

    python examples/fit_a_curve.py --out DIR

writes cap.csv, the runs, fit.json and fit.png into DIR. With a curve of your own:
``shellcut fit MODEL cap.csv --set cohesive.plateau=6:24 -o DIR``.
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from shellcut import FitCurve, Search, fit, read, sweep

parser = argparse.ArgumentParser(description="fit a law to a measured curve")
parser.add_argument("--size", type=float, default=0.5, help="edge length of the quads [mm]")
parser.add_argument("--travel", type=float, default=3.0, help="of the blade [mm]")
parser.add_argument("--max-runs", type=int, default=12)
parser.add_argument("--jobs", type=int, help="processes; one a core by default")
parser.add_argument("--out", type=Path, required=True, help="folder for the results")
options = parser.parse_args()

# %%
# Model
# -----
# A short guillotine; the plateau of its law is 12 MPa, that of the experiment less.

KEY, TRUE = "cohesive.plateau", 9.5  # MPa
SETTINGS = {
    "membrane.length": options.travel + 4.0,
    "membrane.width": 4.0,
    "membrane.size": options.size,
    "notch": 1.0,
    "travel": options.travel,
    "output.frames": 2,
}

# %%
# Run
# ---
# First the experiment.

experiment = sweep("guillotine", {KEY: [TRUE]}, options.out, settings=SETTINGS, executor=1)
history = read(experiment.plan.runs[0].folder(experiment.folder)).history
noise = np.random.default_rng(0).standard_normal(history["path"].size)
force = history["force"] + 0.03 * history["force"].max() * noise
measured = options.out / "cap.csv"
columns = np.column_stack([history["path"], force])
np.savetxt(measured, columns, delimiter=",", header="path [mm],force [N]", comments="")

# %%
# Then the fit: a key with a range is fitted.

found = fit(
    "guillotine",
    [FitCurve(measured)],
    options.out,
    settings={**SETTINGS, KEY: "6:24"},
    search=Search(max_runs=options.max_runs),
    executor=options.jobs,
)

# %%
# Picture
# -------
# The fit has drawn the curves.

picture = plt.imread(options.out / "fit.png")
plt.figure(figsize=(picture.shape[1] / 100, picture.shape[0] / 100), dpi=100).figimage(picture)

# %%
# Check
# -----
# The plateau that was found, beside that of the experiment; the noise is 3 % at a point.

print(found)
(plateau,) = found.values
assert abs(plateau.value / TRUE - 1.0) < 0.03
