"""A laminate
==========

Load a strip of aluminium on polyethylene, clamped at one end, by a line load at the other end.
Compare its deflection and the stress at both faces with the theory of composite beams. ::

    python examples/laminate.py --out DIR
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import shellcut as sc
from shellcut.meshing import rectangle

parser = argparse.ArgumentParser(description="bend a strip of aluminium on polyethylene")
parser.add_argument("--out", type=Path, required=True, help="folder for the picture")
out = parser.parse_args().out

# %%
# Model
# -----

LENGTH, WIDTH = 10.0, 1.0  # mm
LOAD = 1e-5  # N/mm, along z at the free end
LINER = sc.Layer(sc.Elastic(young=200.0, poisson=0.3, density=0.92e-9), thickness=0.065)
FOIL = sc.Layer(sc.Elastic(young=70_000.0, poisson=0.3, density=2.7e-9), thickness=0.009)

mesh = rectangle(LENGTH, WIDTH, size=0.25)
strip = sc.Statics(
    mesh,
    sc.ShellMaterial([LINER, FOIL]),  # from the bottom to the top
    supports=[sc.Support.clamped("left")],
    loads=[sc.EdgeTraction("right", (0.0, 0.0, LOAD))],
)

# %%
# Run
# ---
# The deflection of the free end, and the stress along the middle of the strip at both faces.

solution = strip.linear()
tip = solution.displacement[mesh.node_set("right"), 2].mean()
quads = np.flatnonzero(np.abs(mesh.nodes[mesh.quads, 1].mean(axis=1)) < 0.25)
x = mesh.nodes[mesh.quads[quads], 0].mean(axis=1)
faces = {place: solution.stress(quads, place=place)[:, 0, 0] for place in ("top", "bottom")}

# %%
# The same by the theory of composite beams.


def beam(layers: list[sc.Layer]) -> tuple[float, float]:
    """Return the bending stiffness [N·mm²] and the height of the neutral axis [mm]."""
    top = np.cumsum([layer.thickness for layer in layers])
    h = np.array([layer.thickness for layer in layers])
    middle, stretch = top - 0.5 * h, WIDTH * h * [layer.material.young for layer in layers]
    neutral = float(stretch @ middle / stretch.sum())
    return float(stretch @ (h**2 / 12.0 + (middle - neutral) ** 2)), neutral


bending, neutral = beam([LINER, FOIL])
deflection = LOAD * WIDTH * LENGTH**3 / (3.0 * bending)
moment = LOAD * WIDTH * (LENGTH - x)
height = {"top": FOIL.thickness + LINER.thickness - neutral, "bottom": -neutral}
young = {"top": FOIL.material.young, "bottom": LINER.material.young}
by_beam = {place: -moment * height[place] * young[place] / bending for place in faces}

# %%
# Picture
# -------
# The bent strip; deflections are drawn larger than they are.

out.mkdir(parents=True, exist_ok=True)
figure, film = plt.subplots(figsize=(7.0, 3.6), dpi=120, subplot_kw={"projection": "3d"})
x_y = mesh.nodes[:, :2].T
film.plot_trisurf(*x_y, solution.displacement[:, 2], cmap="viridis", clip_on=False)
film.set(xlabel="x [mm]", yticks=[-0.5, 0.5], zlabel="deflection [mm]")
film.set_box_aspect((10.0, 4.0, 4.0), zoom=1.4)
figure.savefig(out / "strip.png")

# %%
# The stress at both faces.

figure, axes = plt.subplots(figsize=(7.0, 3.6), layout="constrained", dpi=120)
for place in faces:
    (line,) = axes.plot(x, faces[place], ".", label=f"{place} face")
    axes.plot(x, by_beam[place], color=line.get_color(), lw=0.8)
axes.set(xlabel="x [mm]", ylabel="stress along x [MPa]", title="points: shell; lines: beam")
axes.legend()
figure.savefig(out / "stress.png")

# %%
# Check
# -----
# The clamp keeps the strip from curving across, of which beams know nothing: 1.1 % of the
# deflection. At the middle the stresses are those of the beam.

print(f"deflection {tip:.4f} mm, composite beam {deflection:.4f} mm")
assert abs(tip / deflection - 1.0) < 0.02
middle = np.argmin(np.abs(x - 0.5 * LENGTH))
for place in faces:
    shell, theory = faces[place][middle], by_beam[place][middle]
    print(f"{place} face at the middle: {shell:.4f} MPa, composite beam {theory:.4f} MPa")
    assert abs(shell / theory - 1.0) < 5e-3
