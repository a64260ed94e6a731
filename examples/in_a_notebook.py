"""In a notebook
=============

The last line of a cell shows what it names: mesh, film, tool, simulation and results have a card
with a small picture, figures with units and, where there is one, a verdict. This page is a
notebook; its file stands at the end. It is also a script::

    python examples/in_a_notebook.py --out DIR
"""

import argparse
from pathlib import Path

import shellcut as sc
from shellcut.meshing import rectangle
from shellcut.tool_shapes import straight_blade

parser = argparse.ArgumentParser(description="a cut, cell by cell")
parser.add_argument("--out", type=Path, default=Path("out"), help="folder for the run")
OUT = parser.parse_known_args()[0].out  # a notebook has arguments of its own

# %%
# Model
# -----
# The film, with a notch for the blade, clamped at both sides.

mesh = rectangle(12.0, 8.0, size=0.5)  # mm
mesh = mesh.cut(mesh.nodes_where(lambda x, y, z: (abs(y) < 1e-9) & (x < 2.0)))
mesh

# %%
# What it is made of: the defaults are those of the paper.

film = sc.ShellMaterial.homogeneous(young=1678.0, poisson=0.3, density=1e-9, thickness=0.074)
film

# %%
# A knife, whose edge is red.

blade = straight_blade(length=12.0, height=4.0).translated((-0.05, 0.0, 0.0))
blade

# %%
# All of it together. Nothing has moved yet.

sim = sc.Simulation(
    mesh,
    film,
    supports=[sc.Support.clamped("bottom"), sc.Support.clamped("top")],
    tool=blade,
    motion=sc.StraightMotion((1.0, 0.0, 0.0), speed=6000.0, ramp=1e-4),
    law=sc.CohesiveLaw(),
)
sim

# %%
# Run
# ---
# The same simulation, at its end:

until = 1.2e-3  # s
sim.run(until, hooks=[sc.Recorder(sim, OUT, until=until, name="cut", progress=False)])
sim

# %%
# Picture
# -------
# The results, with what the run says of their trust.

results = sc.read(OUT)
results

# %%
# A page to turn the run, written beside the notebook; open it in a browser.

page = sc.view_html(results, OUT / "cut.html")
print(page)

# %%
# Check
# -----
# Any number, by name. The largest force of so short a cut is G h and the peak where the blade meets
# the notch; and the energies must balance.

theory = sim.law.fracture_energy * film.thickness
largest, imbalance = results.history["force"].max(), results.summary["imbalance_rel"]
print(f"largest force {largest:.2f} {results.units['force']}, G h = {theory:.2f} N")
print(f"largest imbalance {imbalance:.1e} of the work")
assert abs(largest / theory - 1.0) < 0.25
assert imbalance < 5e-3
