"""Another tooth
=============

Compare the torque of four teeth whose edges stand at 60° to the film with that of three at 40°. In
theory it grows as n (r + (p/2 pi) cot eta), by 39 %. ::

    python examples/own_tooth.py --out DIR

writes both runs and torque.png into DIR. The three teeth from the command line::

    shellcut run opening --set mesh=quick --set teeth=3 --set edge_inclination_deg=40 -o DIR
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt

import shellcut as sc
from shellcut.models.opening import steady_work_per_radian

parser = argparse.ArgumentParser(description="four teeth and three of another shape")
parser.add_argument("--out", type=Path, required=True, help="folder for the results")
options = parser.parse_args()

# %%
# Model
# -----
# Keys of the model ``opening``; what is not named keeps its default.

SETTINGS = {"membrane.mesh": "quick", "motion.angle_deg": 58.0, "motion.duration": "3.6 ms"}
TOOLS = {"four": {}, "three": {"tool.teeth": 3, "tool.edge_inclination_deg": 40.0}}

# %%
# Run
# ---

runs = {}
for name, tool in TOOLS.items():
    case = sc.read_model("opening", SETTINGS | tool).build()
    case.run(options.out / name, n_snapshot=0, progress=False)
    runs[name] = sc.read(options.out / name)

# %%
# Picture
# -------

figure, axes = plt.subplots(figsize=(7.0, 4.0), layout="constrained", dpi=110)
for name, results in runs.items():
    axes.plot(results.history["angle"], results.history["torque"], label=f"{name} teeth")
axes.set(xlabel="angle [deg]", ylabel="torque [N·mm]")
axes.legend(frameon=False)
figure.savefig(options.out / "torque.png")

# %%
# Check
# -----
# The ratio of the mean torques over the steady windows, against theory.

torque = {name: results.summary["torque_plateau_Nmm"] for name, results in runs.items()}
for name, results in runs.items():
    print(f"{name} teeth: {torque[name]:.0f} N*mm over {results.steady_window.text('deg')}")
theory = steady_work_per_radian(n_teeth=3, edge_inclination_deg=40.0) / steady_work_per_radian()
found = torque["three"] / torque["four"]
print(f"three over four: {found:.3f}, theory {theory:.3f}")
assert abs(found / theory - 1.0) < 0.05
