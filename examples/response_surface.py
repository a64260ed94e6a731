"""A response surface through the runs of a study
==============================================

How a figure follows two keys between the runs of a study: a Gaussian process of scikit-learn
through ``table.csv``, its error at runs that it has not seen, and a map. Here the force of a
guillotine follows the thickness h of the film and the plateau of its law, for which the theory is

    F = G h,    G = (strength - plateau) l_A / 2 + plateau (l_P + l_U) / 2.

::

    python examples/response_surface.py --runs 12 --out DIR

needs ``pip install scikit-learn`` and writes a folder for each run, table.csv and surface.png.
"""

import argparse
import csv
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import ConstantKernel, Matern
from sklearn.model_selection import LeaveOneOut, cross_val_predict

from shellcut import CohesiveLaw, Design, sweep

parser = argparse.ArgumentParser(description="a surface through the runs of a study")
parser.add_argument("--runs", type=int, default=12)
parser.add_argument("--jobs", type=int, help="processes; one a core by default")
parser.add_argument("--out", type=Path, required=True, help="folder for the results")
options = parser.parse_args()

# %%
# Model
# -----
# A coarse, short guillotine, and the ranges of the two keys.

PLATEAU, THICKNESS, FORCE = "cohesive.plateau", "material.thickness", "force_plateau_N"
LOW, HIGH = np.array([8.0, 0.05]), np.array([16.0, 0.1])  # MPa, mm
SETTINGS = {"membrane.size": 0.8, "membrane.length": 14.0, "output.frames": 2}


def theory(plateau: float, thickness: float) -> float:
    """Return the force [N]."""
    law = CohesiveLaw(plateau=plateau)
    return law.fracture_energy * thickness


# %%
# Run
# ---
# Sobol' points fill the box of the ranges evenly. The table is a text file, one row for each run.

keys = {PLATEAU: f"{LOW[0]}:{HIGH[0]}", THICKNESS: f"{LOW[1]}:{HIGH[1]}"}
design = Design("sobol", options.runs)
sweep("guillotine", keys, options.out, settings=SETTINGS, design=design, executor=options.jobs)
with (options.out / "table.csv").open(encoding="utf-8-sig", newline="") as file:
    rows = list(csv.DictReader(file))
inputs = np.array([[float(row[PLATEAU]), float(row[THICKNESS])] for row in rows])
forces = np.array([float(row[FORCE]) for row in rows])

# %%
# The surface
# -----------
# Inputs from 0 to 1, a length for each, and a little noise. Every run is left out in turn and
# predicted from the others: that is the error to expect at runs that have not been made.

places = (inputs - LOW) / (HIGH - LOW)
kernel = ConstantKernel(100.0, "fixed") * Matern([2.0, 2.0], (0.5, 1e3), nu=2.5)
noise = 1e-4  # of the variance of the forces
surface = GaussianProcessRegressor(
    kernel, alpha=noise, normalize_y=True, n_restarts_optimizer=4, random_state=0
)
surface.fit(places, forces)
again = GaussianProcessRegressor(surface.kernel_, alpha=noise, optimizer=None, normalize_y=True)
unseen = cross_val_predict(again, places, forces, cv=LeaveOneOut())
error = float(np.sqrt(np.mean((unseen - forces) ** 2)))
spread = float(np.std(forces))

# %%
# Picture
# -------

x, y = (np.linspace(low, high, 40) for low, high in zip(LOW, HIGH, strict=True))
grid = np.stack(np.meshgrid(x, y), axis=-1)
found = surface.predict(((grid - LOW) / (HIGH - LOW)).reshape(-1, 2)).reshape(40, 40)
figure, axes = plt.subplots(figsize=(6.5, 4.5), layout="constrained", dpi=120)
drawn = axes.contourf(x, 1e3 * y, found, 12)
axes.scatter(inputs[:, 0], 1e3 * inputs[:, 1], c=forces, ec="white", norm=drawn.norm)
axes.set(xlabel="plateau [MPa]", ylabel="thickness [µm]")
figure.colorbar(drawn, label="force, mean while cutting steadily [N]")
figure.savefig(options.out / "surface.png")

# %%
# Check
# -----
# The surface predicts unseen runs far better than their mean does, and lies near the theory.

exact = np.array([[theory(p, h) for p in x] for h in y])
print(f"error at unseen runs {error:.3f} N, of their mean {spread:.3f} N")
print(f"largest distance to theory {100.0 * np.abs(found / exact - 1.0).max():.1f} %")
assert error < 0.3 * spread
assert np.abs(found / exact - 1.0).max() < 0.12
