"""How much is cut
===============

Four teeth cut a circle of 9.4 mm, a quarter each. When do they meet and free the disc within, and
how long is the cut then? In theory it is as long as the circle, and no bridge is left. ::

    python examples/cut_quality.py --out DIR

writes the run and quality.png into DIR. ``shellcut.read(DIR)`` gives these figures for any run.
"""

import argparse
from math import pi
from pathlib import Path

import matplotlib.pyplot as plt

import shellcut

parser = argparse.ArgumentParser(description="how much is cut")
parser.add_argument("--out", type=Path, required=True, help="folder for the results")
parser.add_argument("--mesh", choices=["quick", "M1", "M2"], default="quick")
parser.add_argument("--duration", type=float, default=6e-3, help="of the run [s]")
options = parser.parse_args()

# %%
# Model
# -----

case = shellcut.opening_test(options.mesh, duration=options.duration)

# %%
# Run
# ---
# The figures of quality are made from the frames of the run.

case.run(options.out, n_snapshot=0, progress=False)
cut = shellcut.read(options.out).cut_quality()

# %%
# Picture
# -------

PANELS = (
    ("crack_length", "crack length"),
    ("bridge_width", "uncut bridges, all"),
    ("flap_angle_largest", "flaps, most bent"),
)
figure, panels = plt.subplots(len(PANELS), sharex=True, figsize=(9.0, 7.0), dpi=110)
for axes, (name, label) in zip(panels, PANELS, strict=True):
    axes.plot(cut["angle"], cut[name], color="#b2182b")
    axes.set_ylabel(f"{label} [{cut.units[name]}]")
    axes.grid(color="0.9")
    axes.spines[["top", "right"]].set_visible(False)
free = cut["angle"][cut["n_loose"] > 0]
if free.size:
    panels[0].axvline(free[0], color="black", ls=":")
    panels[0].annotate(f" free at {free[0]:.0f}°", (free[0], 0.0))
panels[-1].set_xlabel(f"angle [{cut.units['angle']}]")
figure.tight_layout()
figure.savefig(options.out / "quality.png")

# %%
# Check
# -----
# The cut follows chords of the circle, 72 on the quick mesh, which are 0.03 % shorter than it.

crack, circle = cut["crack_length"][-1], 2.0 * pi * 9.4  # mm
print(f"crack {crack:.1f} mm, {cut['n_bridge'][-1]:.0f} bridges left")
print(f"circle {circle:.1f} mm: {crack / circle - 1.0:+.2%}")
assert abs(crack / circle - 1.0) < 1e-3
assert cut["n_bridge"][-1] == 0
