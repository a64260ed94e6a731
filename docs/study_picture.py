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
from matplotlib.colors import ListedColormap

from shellcut.models.opening import steady_work_per_radian

ENDS = (8.0, 24.0)
"""Least and largest pitch of the study [mm]."""
PITCHES = (8.0, 16.0, 24.0)
"""Pitches of the lines [mm]."""
SHOWN = {
    "torque_plateau_Nmm": "mean torque",
    "dWcoh_dtheta_Nmm": "cables' work per radian",
}
# The end of the scale is a yellow that cannot be seen on white.
COLOURS = ListedColormap(plt.get_cmap("viridis")(np.linspace(0.0, 0.8, 256)))


def main(study, path="docs/img/study_torque.png"):
    """Draw the picture."""
    with (Path(study) / "table.csv").open(encoding="utf-8-sig", newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["status"] == "done"]

    def column(name):
        return np.array([float(row[name]) for row in rows])

    eta, pitch = column("tool.edge_inclination_deg"), column("motion.pitch")
    figure, axes = plt.subplots(1, 2, figsize=(9.6, 4.0), sharey=True, layout="constrained")
    for ax, (name, title) in zip(axes, SHOWN.items(), strict=True):
        theory(ax)
        points = ax.scatter(
            *(eta, column(name)),
            c=pitch,
            cmap=COLOURS,
            vmin=ENDS[0],
            vmax=ENDS[1],
            edgecolors="0.2",
            linewidths=0.5,
            zorder=3,
            label=f"{len(rows)} runs",
        )
        ax.set(xlabel="edge inclination η [°]", title=title, xlim=(39.0, 86.0))
        ax.grid(alpha=0.3)
    axes[0].set_ylabel("N·mm")
    axes[0].legend(frameon=False, loc="upper right")
    figure.colorbar(points, ax=axes, label="pitch p [mm]", ticks=PITCHES)
    figure.savefig(path, dpi=110)


def theory(ax):
    """Draw a line for each of some pitches, named at its end."""
    along = np.linspace(40.0, 80.0, 81)
    for one in PITCHES:
        work = [steady_work_per_radian(pitch=one, edge_inclination_deg=e) for e in along]
        colour = COLOURS((one - ENDS[0]) / (ENDS[1] - ENDS[0]))
        label = "n G h (r + (p/2π) cot η)" if one == PITCHES[0] else None
        ax.plot(along, work, color=colour, lw=1.4, label=label)
        ax.annotate(
            f"{one:g} mm",
            (along[-1], work[-1]),
            (4, 0),
            textcoords="offset points",
            va="center",
            fontsize=8.5,
            color=colour,
        )


if __name__ == "__main__":
    main(*sys.argv[1:])
