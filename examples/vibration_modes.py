"""Vibration modes
===============

Compute the four lowest frequencies of a clamped square film and draw their mode shapes. Compare
them with a thin plate (Leissa, NASA SP-160, 1969, table 4.22). ::

    python examples/vibration_modes.py --out DIR
"""

import argparse
from pathlib import Path

import matplotlib
import numpy as np

import shellcut as sc
from shellcut.meshing import rectangle

matplotlib.use("Agg")
import matplotlib.pyplot as plt

SIDE = 10.0  # mm
PLATE = (35.99, 73.41, 73.41, 108.27)  # omega a² sqrt(rho h / D)


def main() -> None:
    parser = argparse.ArgumentParser(description="lowest modes of a clamped square film")
    parser.add_argument("--out", type=Path, required=True, help="folder for the picture")
    out = parser.parse_args().out

    film = sc.Elastic(young=1678.0, poisson=0.3, density=1e-9)
    h = 0.074
    mesh = rectangle(SIDE, SIDE, size=SIDE / 24)
    sides = [sc.Support.clamped(name) for name in ("left", "right", "bottom", "top")]
    modes = sc.Statics(mesh, sc.ShellMaterial([sc.Layer(film, h)]), supports=sides).modes(4)

    D = film.young * h**3 / (12.0 * (1.0 - film.poisson**2))
    unit = np.sqrt(D / (film.density * h)) / (2.0 * np.pi * SIDE**2)
    figure, all_axes = plt.subplots(1, 4, figsize=(10.0, 2.9), layout="constrained")
    for k, (axes, plate) in enumerate(zip(all_axes, PLATE, strict=True)):
        frequency = modes.frequency[k]
        print(f"mode {k + 1}: {frequency:.1f} Hz, thin plate {plate * unit:.1f} Hz")
        z = modes.shape[k][:, 2]
        axes.tricontourf(*mesh.nodes[:, :2].T, z, levels=np.linspace(-1.0, 1.0, 21), cmap="RdBu_r")
        axes.set(aspect="equal", xticks=[], yticks=[], title=f"{frequency:.0f} Hz")
    out.mkdir(parents=True, exist_ok=True)
    figure.savefig(out / "modes.png", dpi=120)


if __name__ == "__main__":
    main()
