"""The trouser test
================

Two legs of a notched strip are pulled apart, out of its plane, and tear it. In theory the force on
each leg is G h / 2 = 1.148 N: each end moves by as much as the crack grows, so that they part by
twice as much. ::

    python examples/trouser.py --size 0.5 --out DIR

writes history.csv, summary.json, force.png, energy.png, snapshots and trouser.vtkhdf into DIR.
``shellcut run trouser -o DIR`` does the same.
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt

import shellcut as sc

parser = argparse.ArgumentParser(description="two legs of a strip are pulled apart")
parser.add_argument("--size", type=float, default=0.5, help="edge length of the quads [mm]")
parser.add_argument("--length", type=float, default=19.0, help="of the strip [mm]")
parser.add_argument("--out", type=Path, required=True, help="folder for the results")
options = parser.parse_args()

# %%
# Model
# -----
# No tool: the ends of the legs are supports that move. The tear finds its way by itself.

case = sc.trouser(options.size, length=options.length)
theory = 0.5 * case.simulation.law.fracture_energy * case.simulation.material.thickness  # N

# %%
# Run
# ---

case.run(options.out, progress=False)
results = sc.read(options.out)

# %%
# Picture
# -------
# The film at the end of the run.

film = plt.imread(max(options.out.glob("snapshot_*.png")))
plt.figure(figsize=(film.shape[1] / 100, film.shape[0] / 100), dpi=100).figimage(film)

# %%
# The force on each leg over the distance by which their ends have parted.

history = results.history
figure, axes = plt.subplots(figsize=(7.0, 4.0), layout="constrained", dpi=110)
axes.plot(history["way"], history["force"])
axes.axhline(theory, color="k", ls="--", lw=0.8, label="G h / 2")
axes.set(xlabel="way apart of the ends [mm]", ylabel="force on a leg [N]")
axes.legend(frameon=False)
figure.savefig(options.out / "force_and_theory.png")

# %%
# Check
# -----
# The mean force over the run's steady window, against theory.

force = results.summary["force_plateau_N"]
print(f"force {force:.3f} N, G h / 2 = {theory:.3f} N: {force / theory - 1.0:+.1%}")
assert abs(force / theory - 1.0) < 0.05
