"""The opening test
================

A ring of four teeth screws down through a clamped film and cuts a circle out of it. Which torque
does it take? In steady cutting the cables should take the work n G h (r + (p/2 pi) cot eta) by
radian: n teeth, fracture energy G, thickness h, radius r of the cut, pitch p, edges at the angle
eta to the film. ::

    python examples/opening_test.py --mesh {quick,M1,M2} --out DIR

writes history.csv, summary.json, splits.csv, torque.png, energy.png, snapshots and opening.vtkhdf
into DIR. ``shellcut run opening --set mesh=quick -o DIR`` does the same. ``--compare`` also runs
classical cables, which never meet the blade, in DIR/classical.
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt

import shellcut as sc
from shellcut.models.opening import steady_work_per_radian

parser = argparse.ArgumentParser(description="a ring of four teeth opens a film")
parser.add_argument("--mesh", choices=["quick", "M1", "M2"], default="quick")
parser.add_argument("--out", type=Path, required=True, help="folder for the results")
parser.add_argument("--angle", type=float, default=95.0, help="angle to turn by [deg]")
parser.add_argument("--duration", type=float, default=6.0e-3, help="time it takes [s]")
parser.add_argument("--compare", action="store_true", help="run classical cables too")
options = parser.parse_args()

# %%
# Model
# -----
# Film, teeth and cohesive law are those of the paper; the theory page of the opening test has
# their geometry.


def model(*, directional: bool = True):
    return sc.opening_test(
        options.mesh,
        angle_deg=options.angle,
        duration=options.duration,
        directional=directional,
    )


# %%
# Run
# ---
# Everything that the run finds is in its folder, and ``read`` gives it back by name.

model().run(options.out, progress=False)
results = sc.read(options.out)
if options.compare:
    model(directional=False).run(options.out / "classical", progress=False)

# %%
# Picture
# -------
# The film at the end of the run.

film = plt.imread(max(options.out.glob("snapshot_*.png")))
plt.figure(figsize=(film.shape[1] / 100, film.shape[0] / 100), dpi=100).figimage(film)

# %%
# The torque over the angle. What is not from contact comes from the cables that the edges drag
# along.

theory = steady_work_per_radian()
history = results.history
figure, axes = plt.subplots(figsize=(7.0, 4.0), layout="constrained", dpi=110)
axes.plot(history["angle"], history["torque"], label="total")
axes.plot(history["angle"], history["torque_joints"], label="from cables at the edge")
if options.compare:
    classical = sc.read(options.out / "classical").history
    axes.plot(classical["angle"], classical["torque"], label="classical cables")
axes.axhline(theory, color="k", ls="--", lw=0.8, label="theory, without losses")
axes.set(xlabel="angle [deg]", ylabel="torque [N·mm]")
axes.legend(frameon=False)
figure.savefig(options.out / "torque_and_theory.png")

# %%
# Check
# -----
# The work of the cables by radian over the run's steady window, against theory; and the energies
# must balance.

cables, imbalance = results.summary["dWcoh_dtheta_Nmm"], results.summary["imbalance_rel"]
print(f"window {results.steady_window.text('deg')}")
print(f"cables {cables:.1f} N*mm a radian, theory {theory:.1f} N*mm: {cables / theory - 1:+.1%}")
print(f"torque {results.summary['torque_plateau_Nmm']:.1f} N*mm")
print(f"largest imbalance {imbalance:.1e} of the work")
assert abs(cables / theory - 1.0) < 0.05
assert imbalance < 5e-3
