"""Vibration modes
===============

Compute the four lowest frequencies of a clamped square film and draw their mode shapes. Compare
them with a thin plate (Leissa, NASA SP-160, 1969, table 4.22). ::

    python examples/vibration_modes.py --out DIR
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import shellcut as sc
from shellcut.meshing import rectangle

parser = argparse.ArgumentParser(description="lowest modes of a clamped square film")
parser.add_argument("--out", type=Path, required=True, help="folder for the picture")
out = parser.parse_args().out

# %%
# Model
# -----

SIDE, THICKNESS = 10.0, 0.074  # mm
film = sc.Elastic(young=1678.0, poisson=0.3, density=1e-9)
mesh = rectangle(SIDE, SIDE, size=SIDE / 24)
sides = [sc.Support.clamped(name) for name in ("left", "right", "bottom", "top")]
square = sc.Statics(mesh, sc.ShellMaterial([sc.Layer(film, THICKNESS)]), supports=sides)

# %%
# Run
# ---

modes = square.modes(4)

# %%
# Picture
# -------

figure, all_axes = plt.subplots(1, 4, figsize=(10.0, 2.9), layout="constrained", dpi=120)
for axes, frequency, shape in zip(all_axes, modes.frequency, modes.shape, strict=True):
    levels = np.linspace(-1.0, 1.0, 21)
    axes.tricontourf(*mesh.nodes[:, :2].T, shape[:, 2], levels=levels, cmap="RdBu_r")
    axes.set(aspect="equal", xticks=[], yticks=[], title=f"{frequency:.0f} Hz")
out.mkdir(parents=True, exist_ok=True)
figure.savefig(out / "modes.png")

# %%
# Check
# -----
# The frequencies of a thin plate are f = c / (2 pi a²) sqrt(D / rho h), with c by the table.

PLATE = (35.99, 73.41, 73.41, 108.27)
D = film.young * THICKNESS**3 / (12.0 * (1.0 - film.poisson**2))
unit = np.sqrt(D / (film.density * THICKNESS)) / (2.0 * np.pi * SIDE**2)
for k, (frequency, plate) in enumerate(zip(modes.frequency, PLATE, strict=True)):
    print(f"mode {k + 1}: {frequency:.1f} Hz, thin plate {plate * unit:.1f} Hz")
    assert abs(frequency / (plate * unit) - 1.0) < 5e-3
