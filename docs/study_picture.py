"""Draw the torque of a study of openings beside the theory of its plateau.

    python docs/study_picture.py STUDY [FILE.png]

STUDY is a folder of ``shellcut sweep opening`` with the factors tool.edge_inclination_deg and
motion.pitch; all else is that of the shipped model.
"""

import csv
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from shellcut.models.opening import steady_work_per_radian

PITCHES = (8.0, 16.0, 24.0)


def main(study, path="docs/img/study_torque.png"):
    """Draw the picture."""
    with (Path(study) / "table.csv").open(encoding="utf-8-sig", newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["status"] == "done"]

    def column(name):
        return np.array([float(row[name]) for row in rows])

    eta, pitch = column("tool.edge_inclination_deg"), column("motion.pitch")
    shown = {
        "torque_plateau_Nmm": "mean torque [N·mm]",
        "dWcoh_dtheta_Nmm": "cables' work per radian [N·mm]",
    }
    figure, axes = plt.subplots(1, 2, figsize=(9.0, 3.8), sharey=True, layout="constrained")
    colour = plt.get_cmap("viridis")
    for ax, (name, label) in zip(axes, shown.items(), strict=True):
        points = ax.scatter(eta, column(name), c=pitch, cmap=colour, vmin=8.0, vmax=24.0, zorder=3)
        for one in PITCHES:
            along = np.linspace(40.0, 80.0, 81)
            theory = [steady_work_per_radian(pitch=one, edge_inclination_deg=e) for e in along]
            ax.plot(along, theory, color=colour((one - 8.0) / 16.0), lw=1.2)
        ax.set(xlabel="edge inclination [°]", title=label)
        ax.grid(alpha=0.3)
    figure.colorbar(points, ax=axes, label="pitch [mm]", ticks=PITCHES)
    figure.savefig(path, dpi=110)


if __name__ == "__main__":
    main(*sys.argv[1:])
