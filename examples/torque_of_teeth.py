"""Torque over edge inclination and pitch
======================================

A study of the opening test: the torque while it cuts steadily, for every combination of two
inclinations of the edges and pitches of the screw, beside the theory of the paper,

    T = n G h (r + p / (2 pi) cot eta),

with n teeth, the fracture energy G, thickness h, radius r of the cut, pitch p and inclination eta.
::

    python examples/torque_of_teeth.py --inclinations 40,60,80 --pitches 8,12,20 --out DIR

writes a folder for each run, table.csv and torque_of_teeth.png. ``shellcut sweep opening --set
tool.edge_inclination_deg=40,60,80 --set motion.pitch=8,12,20 -o DIR`` makes the same table.
"""

import argparse
from math import pi, radians, tan
from pathlib import Path

import matplotlib.pyplot as plt

from shellcut import sweep

parser = argparse.ArgumentParser(description="torque over inclination and pitch")
parser.add_argument("--mesh", default="quick", choices=("quick", "M1", "M2"))
parser.add_argument("--inclinations", default="40,60,80", help="[deg], with commas")
parser.add_argument("--pitches", default="8,12,20", help="[mm], with commas")
parser.add_argument("--angle", type=float, default=60.0, help="of the whole turn [deg]")
parser.add_argument("--jobs", type=int, help="processes; one a core by default")
parser.add_argument("--out", type=Path, required=True, help="folder for the results")
options = parser.parse_args()

# %%
# Model
# -----
# The opening test, at the speed of the whole test, and its theory.

INCLINATION, PITCH = "tool.edge_inclination_deg", "motion.pitch"
SETTINGS = {
    "membrane.mesh": options.mesh,
    "motion.angle_deg": options.angle,
    "motion.duration": 6e-3 * options.angle / 95.0,
}
TEETH, ENERGY, THICKNESS, RADIUS = 4, 43.5, 0.074, 9.4  # -, N/mm, mm, mm


def theory(inclination_deg: float, pitch: float) -> float:
    """Return the torque [N·mm]."""
    lever = RADIUS + pitch / (2.0 * pi) / tan(radians(inclination_deg))
    return TEETH * ENERGY * THICKNESS * lever


# %%
# Run
# ---
# Every combination of the two keys.

keys = {INCLINATION: options.inclinations, PITCH: options.pitches}
found = sweep("opening", keys, options.out, settings=SETTINGS, executor=options.jobs)
rows = []
for run in found.plan.runs:
    figures = found.outcomes[run.number].figures
    values = {**found.plan.definition.settings, **run.values}
    if "torque_plateau_Nmm" not in figures:
        raise SystemExit(f"run {run.number} is never steady: turn farther, with --angle")
    torque = float(figures["torque_plateau_Nmm"])
    rows.append((float(values[INCLINATION]), float(values[PITCH]), torque))

# %%
# Picture
# -------

figure, axes = plt.subplots(figsize=(7.0, 4.5), layout="constrained", dpi=120)
for k, inclination in enumerate(sorted({row[0] for row in rows})):
    points = sorted((pitch, torque) for eta, pitch, torque in rows if eta == inclination)
    pitches, torques = zip(*points, strict=True)
    label = f"inclination {inclination:g}°"
    axes.plot(pitches, torques, "o", color=f"C{k}", label=label)
    axes.plot(pitches, [theory(inclination, p) for p in pitches], color=f"C{k}", lw=1.0)
axes.set(xlabel="pitch [mm]", ylabel="torque, mean while cutting steadily [N·mm]")
axes.legend(title="points: runs, lines: theory", frameon=False)
figure.savefig(options.out / "torque_of_teeth.png")

# %%
# Check
# -----
# Theory is the work of the cables. Damping and the film that is bent take 4 to 12 % of so fast a
# cut, and no run may take less than theory.

print("inclination [deg]  pitch [mm]  torque [N*mm]  theory [N*mm]")
for inclination, pitch, torque in rows:
    print(f"{inclination:17g}{pitch:12g}{torque:15.1f}{theory(inclination, pitch):15.1f}")
    assert 1.0 < torque / theory(inclination, pitch) < 1.14
