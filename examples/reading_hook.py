"""A hook that reads the force
===========================

Build a strip, a blade and a cohesive law by hand, and read the force on the blade with a hook of
your own. The simulation calls the hook after every step; the hook ends the run after 7 mm.
In steady cutting the force should be G h. ::

    python examples/reading_hook.py --out DIR
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import shellcut as sc
from shellcut.meshing import rectangle
from shellcut.tool_shapes import straight_blade

parser = argparse.ArgumentParser(description="read the force on a blade by a hook")
parser.add_argument("--out", type=Path, required=True, help="folder for the picture")
out = parser.parse_args().out

# %%
# Model
# -----
# A strip with a notch for the blade, clamped at both sides.

film = sc.ShellMaterial.homogeneous(young=1678.0, poisson=0.3, density=1e-9, thickness=0.074)
law = sc.CohesiveLaw(strength=18.0, plateau=12.0, opening_a=0.5, opening_p=3.0, opening_u=4.0)
mesh = rectangle(12.0, 8.0, size=0.8)
middle = mesh.nodes_where(lambda x, y, z: (abs(y) < 1e-9) & (x < 2.0))
sim = sc.Simulation(
    mesh.cut(middle),
    film,
    supports=[sc.Support.clamped("bottom"), sc.Support.clamped("top")],
    tool=straight_blade(length=12.0, height=6.0).translated((-0.05, 0.0, 0.0)),
    motion=sc.StraightMotion((1.0, 0.0, 0.0), speed=6000.0, ramp=1e-4),
    law=law,
)

# %%
# A hook is any object with these three methods.

WAY = 7.0  # mm


class ForceOnBlade:
    """Record the place of the blade [mm] and the force on it [N], every ten steps."""

    def __init__(self) -> None:
        self.place: list[float] = []
        self.force: list[float] = []

    def due(self, sim: sc.Simulation) -> bool:
        return sim.state.step % 10 == 0

    def __call__(self, sim: sc.Simulation) -> None:
        force = sim.tooth_wrenches[:, :3].sum(axis=0)  # contact and cables, all bodies of the tool
        self.place.append(float(sim.pose.translation[0]))
        self.force.append(-float(force[0]))  # the film pushes the blade back
        if self.place[-1] > WAY:
            raise sc.StopRun

    def close(self) -> None:
        """Do nothing: there is nothing to release."""


# %%
# Run
# ---

hook = ForceOnBlade()
sim.run(until=1.0, hooks=[hook])  # the hook ends it long before
place, force = np.array(hook.place), np.array(hook.force)

# %%
# Picture
# -------

theory = law.fracture_energy * film.thickness  # N
out.mkdir(parents=True, exist_ok=True)
figure, axes = plt.subplots(figsize=(7.0, 3.6), layout="constrained", dpi=120)
axes.plot(place, force, lw=0.6, color="0.6", label="every ten steps")
n = 40
axes.plot(place[n - 1 :], np.convolve(force, np.full(n, 1.0 / n), "valid"), label="mean of 40")
axes.axhline(theory, color="k", ls="--", lw=0.8, label="G h")
axes.set(xlabel="way of the blade [mm]", ylabel="force on the blade [N]")
axes.legend()
figure.savefig(out / "force.png")

# %%
# Check
# -----
# The mean over two and a half quads of this coarse strip lies within a tenth of theory.

steady = force[place > 5.0].mean()
print(f"force {steady:.2f} N from 5 to {place[-1]:.1f} mm, G h = {theory:.2f} N")
assert abs(steady / theory - 1.0) < 0.1
