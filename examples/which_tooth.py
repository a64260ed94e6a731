"""Which tooth?
=============

Two caps of one's own, written as STEP files, cut a laminate over a mouth of 30 mm: which takes the
smaller torque? The film is meshed along the path of the teeth, and the answer is asked again on a
finer film. Needs Gmsh and Optuna. ::

    python examples/which_tooth.py --out DIR

writes the teeth, all runs and which_tooth.png into DIR. In theory the steeper edge takes less: the
cables' work per radian is n G h (r + (p/2 pi) cot eta). A laminate with a foil stiffens the flanks,
so only a run can say by how much.
"""

import argparse
from math import cos, pi, radians, sin, tan
from pathlib import Path

import gmsh
import matplotlib.pyplot as plt

import shellcut as sc

parser = argparse.ArgumentParser(description="the better of two caps from a CAD program")
parser.add_argument("--out", type=Path, required=True, help="folder for the results")
parser.add_argument("--size", type=float, default=0.4, help="quads along the path [mm]")
parser.add_argument("--angle", type=float, default=40.0, help="of the motion [deg]")
parser.add_argument("--film", default="laminate", choices=["laminate", "elastic"])
options = parser.parse_args()
options.out.mkdir(parents=True, exist_ok=True)

# %%
# Teeth
# -----
# A wedge with a back, drawn in the plane and extruded along its cutting edge, which stands at the
# angle ``edge_deg`` to the film; below, it is cut off at 30°, so that its tip comes first. Four of
# them go round a circle of 13.4 mm.

RADIUS, PITCH, N_TEETH = 13.4, 12.0, 4
HALF_THICKNESS, HALF_ANGLE, RELIEF = 0.35, radians(12.0), radians(30.0)


def write_cap(path, edge_deg, length=1.5, height=5.0):
    """Write the solid of four teeth as a STEP file; the tips are 0.02 mm over z = 0."""
    edge, shoulder = radians(edge_deg), HALF_THICKNESS / tan(HALF_ANGLE)
    gmsh.initialize(readConfigFiles=False, interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("General.Verbosity", 0)
    occ = gmsh.model.occ
    a, back = HALF_THICKNESS, -shoulder - length
    corners = [(0.0, 0.0), (a, -shoulder), (a, back), (-a, back), (-a, -shoulder)]
    points = [occ.addPoint(x, y, 0.0) for x, y in corners]
    sides = [occ.addLine(p, q) for p, q in zip(points, [*points[1:], points[0]], strict=True)]
    face = occ.addPlaneSurface([occ.addCurveLoop(sides)])
    rise = height / sin(edge)
    solids = occ.extrude([(2, face)], 0.0, rise * cos(edge), height)
    tooth = [part for part in solids if part[0] == 3]
    box = [(3, occ.addBox(-5.0, -50.0, -100.0, 10.0, 100.0, 100.0))]
    occ.rotate(box, 0, 0, 0, 1, 0, 0, -RELIEF)
    tooth, _ = occ.cut(tooth, box)
    occ.translate(tooth, RADIUS, 0.0, 0.02)
    every = [tooth, *(occ.copy(tooth) for _ in range(N_TEETH - 1))]
    for k, one in enumerate(every):
        occ.rotate(one, 0, 0, 0, 0, 0, 1, 2.0 * pi * k / N_TEETH)
    occ.synchronize()
    gmsh.write(str(path))
    gmsh.finalize()


caps = [options.out / f"cap_{edge_deg}.step" for edge_deg in (55, 70)]
for cap, edge_deg in zip(caps, (55, 70), strict=True):
    write_cap(cap, edge_deg)

# %%
# Model
# -----
# Polyethylene, aluminium and polyethylene on a mouth of 30 mm, clamped at its rim.

LAYER = "[[material.layers]]\nyoung = {}\npoisson = {}\ndensity = {}\nthickness = {}\n"
LAMINATE = (
    LAYER.format(300.0, 0.4, 0.95e-9, 0.03)
    + LAYER.format(70e3, 0.33, 2.7e-9, 0.007)
    + LAYER.format(300.0, 0.4, 0.95e-9, 0.02)
)
MODEL = f"""model = "opening"
name = "cap"
[membrane]
radius = 15.0
size_at_path = {options.size}
[tool]
file = "{caps[0].name}"
unit = "mm"
[motion]
pitch = {PITCH}
angle_deg = {options.angle}
duration = {options.angle / 95.0 * 6e-3}
{LAMINATE if options.film == "laminate" else ""}"""
model = options.out / "cap.toml"
model.write_text(MODEL)

# %%
# Search
# ------
# Both caps are run on one film, which is fine under the paths of both, and both again on a finer
# film: one is better only if both say so.

found = sc.optimise(
    model,
    options.out / "search",
    settings={"tool.file": [str(cap) for cap in caps]},
    minimise="torque_plateau",
    max_runs=3,
    allow_doubts=True,
)
print(found)

# %%
# Picture
# -------

figure, axes = plt.subplots(figsize=(7.0, 4.0), layout="constrained", dpi=110)
for trial in found.confirmed:
    results = sc.read(trial.folder)
    label = Path(trial.values.get("tool.file", caps[0])).stem
    axes.plot(results.history["angle"], results.history["torque"], label=label)
axes.set(xlabel="angle [deg]", ylabel="torque [N·mm]")
axes.legend(frameon=False)
figure.savefig(options.out / "which_tooth.png")
