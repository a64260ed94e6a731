"""The guillotine
==============

A straight blade cuts a clamped strip from its notch on. In theory its force is G h = 3.219 N, the
fracture energy times the thickness: what the blade works on its way goes into the cut. ::

    python examples/guillotine.py --size 0.4 --out DIR

writes history.csv, summary.json, force.png, energy.png, snapshots and guillotine.vtkhdf into DIR.
``shellcut run guillotine -o DIR`` does the same.
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt

import shellcut as sc

parser = argparse.ArgumentParser(description="a straight blade cuts a clamped strip")
parser.add_argument("--size", type=float, default=0.4, help="edge length of the quads [mm]")
parser.add_argument("--length", type=float, default=30.0, help="of the strip [mm]")
parser.add_argument("--out", type=Path, required=True, help="folder for the results")
parser.add_argument("--classical", action="store_true", help="cables never meet the blade")
options = parser.parse_args()

# %%
# Model
# -----
# Film and cohesive law are those of the paper.

case = sc.guillotine(options.size, length=options.length, directional=not options.classical)
theory = case.simulation.law.fracture_energy * case.simulation.material.thickness  # N

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
# The force over the way of the blade.

history = results.history
figure, axes = plt.subplots(figsize=(7.0, 4.0), layout="constrained", dpi=110)
axes.plot(history["path"], history["force"])
axes.axhline(theory, color="k", ls="--", lw=0.8, label="G h")
axes.set(xlabel="way of the blade [mm]", ylabel="force on the blade [N]")
axes.legend(frameon=False)
figure.savefig(options.out / "force_and_theory.png")

# %%
# Check
# -----
# Over the run's steady window the cables take G h by way, and the force is that and what is
# damped. Classical cables do not hold the blade back and take no such work.

cables, force = results.summary["dWcoh_ds_N"], results.summary["force_plateau_N"]
print(f"window {results.steady_window.text('mm')}, G h = {theory:.3f} N")
print(f"cables {cables:.3f} N*mm/mm, {cables / theory - 1.0:+.1%}")
print(f"force {force:.3f} N, {force / theory - 1.0:+.1%}")
if not options.classical:
    assert abs(cables / theory - 1.0) < 0.05
    assert abs(force / theory - 1.0) < 0.10
