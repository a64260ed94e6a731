"""Will the seal hold while I cut?
================================

A membrane is glued to a ring instead of clamped, and the teeth of the opening test cut it. One
glue holds, one begins to peel, and one lets go before the teeth are through: then the film turns
with the tool. ::

    python examples/glued_opening.py --out DIR

says of each glue what became of it, and draws the torques in glued_opening.png.
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import shellcut
from shellcut.meshing import disc

parser = argparse.ArgumentParser(description="an opening whose film is glued")
parser.add_argument("--angle", type=float, default=40.0, help="of the whole turn [deg]")
parser.add_argument("--out", type=Path, required=True, help="folder for the results")
options = parser.parse_args()

# %%
# Model
# -----
# The ring begins 1 mm outside the circle of the teeth, because the base is rigid and the teeth must
# not meet it.

GLUES = {"strong": 2.0, "weak": 0.1, "far too weak": 0.01}  # energies, N/mm
film = disc(12.2, n_side=18, ring_radii=[12.2, 11.6, 11.0, 10.4, 9.8, 9.4, 8.9])
centres = film.nodes[film.quads].mean(axis=1)
ring = np.flatnonzero(np.hypot(centres[:, 0], centres[:, 1]) > 10.4)

# %%
# Run
# ---

runs = {}
for name, energy in GLUES.items():
    glue = shellcut.Adhesion(quads=ring, energy=energy, name="seal")
    duration = 6e-3 * options.angle / 95.0
    case = shellcut.opening_test(
        film, angle_deg=options.angle, duration=duration, clamp=(), terms=[glue]
    )
    case.run(options.out / name.replace(" ", "_"), n_snapshot=0, progress=False)
    runs[name] = shellcut.read(options.out / name.replace(" ", "_"))

# %%
# Picture
# -------

figure, axes = plt.subplots(figsize=(8.0, 4.5), dpi=110)
for name, color in zip(runs, ("#2166ac", "#e08214", "#b2182b"), strict=True):
    history = runs[name].history
    axes.plot(history["angle"], history["torque"], color=color, label=f"{name} glue")
axes.set_xlabel("angle [°]")
axes.set_ylabel("torque [N·mm]")
axes.legend(frameon=False)
axes.grid(color="0.9")
axes.spines[["top", "right"]].set_visible(False)
figure.tight_layout()
figure.savefig(options.out / "glued_opening.png")

# %%
# Check
# -----

gone = {}
for name, run in runs.items():
    print(f"{name}: {dict(shellcut.results.answers.answers(run.summary))['seal']}")
    gone[name] = run.summary["seal_let_go_rel"]
assert gone["strong"] == gone["weak"] == 0.0
assert gone["far too weak"] > 0.5
