"""A tool of your own
==================

Make a knife with a curved edge from vertices and triangles, name its cutting edge, and cut a strip
with it. The knife is a wedge; its edge is a circular arc. ::

    python examples/tool_of_triangles.py --out DIR
"""

import argparse
from math import asin
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import shellcut as sc
from shellcut.meshing import rectangle

parser = argparse.ArgumentParser(description="cut a strip by a knife made of triangles")
parser.add_argument("--out", type=Path, required=True, help="folder for the results")
out = parser.parse_args().out

# %%
# Model
# -----
# The knife.

N = 12  # segments of the edge
RADIUS, HEIGHT = 8.0, 4.0  # of the arc, of the knife [mm]
LENGTH, HALF_THICKNESS = 14.0, 0.3  # mm


def knife() -> sc.Tool:
    """Return a knife that moves along +x, its edge through the origin."""
    z = np.linspace(-0.5 * HEIGHT, 0.5 * HEIGHT, N + 1)
    x = np.sqrt(RADIUS**2 - z**2) - RADIUS  # foremost at the height of the film
    edge = np.stack([x, 0.0 * z, z], axis=1)
    sides = [
        np.stack([np.full(N + 1, back), np.full(N + 1, y), z], axis=1)
        for back in (-2.0, -LENGTH)
        for y in (HALF_THICKNESS, -HALF_THICKNESS)
    ]
    left, right, left_back, right_back = (1 + np.arange(4)) * (N + 1)
    # Seen from above: edge, left, left_back, right_back, right, back to the edge.
    ring = [0, left, left_back, right_back, right]
    triangles = []
    for first, second in zip(ring, [*ring[1:], ring[0]], strict=True):
        for k in range(N):
            a, b, c, d = first + k, second + k, second + k + 1, first + k + 1
            triangles += [(a, b, c), (a, c, d)]
    for i, j in ((1, 2), (2, 3), (3, 4)):  # the ends, fans around the edge
        triangles += [(ring[0], ring[j], ring[i]), (ring[0] + N, ring[i] + N, ring[j] + N)]
    return sc.Tool.from_triangles(
        np.concatenate([edge, *sides]),
        triangles,
        edges=[(k + 1, k) for k in range(N)],  # from the top down: plus is y > 0
        name="knife",
    )


tool = knife()

# %%
# The strip, with a notch for the knife, clamped at both sides.

NOTCH = 1.6  # mm
mesh = rectangle(12.0, 8.0, size=0.8)
middle = mesh.nodes_where(lambda x, y, z: (abs(y) < 1e-9) & (x < 2.0))
sim = sc.Simulation(
    mesh.cut(middle),
    sc.ShellMaterial.homogeneous(),
    supports=[sc.Support.clamped("bottom"), sc.Support.clamped("top")],
    tool=tool.translated((-0.05, 0.0, 0.0)),
    motion=sc.StraightMotion((1.0, 0.0, 0.0), speed=6000.0, ramp=1e-4),
    law=sc.CohesiveLaw(),
)

# %%
# Run
# ---

until = 1.2e-3
recorder = sc.Recorder(sim, out, until=until, name="knife", n_snapshot=2, progress=False)
sim.run(until, hooks=[recorder])

# %%
# Picture
# -------

film = plt.imread(max(out.glob("snapshot_*.png")))
plt.figure(figsize=(film.shape[1] / 100, film.shape[0] / 100), dpi=100).figimage(film)

# %%
# Check
# -----
# The edge is an arc of the length 2 R asin(H / 2R), in chords. The crack ends at the edge, or up to
# two quads ahead of it.

(edge,) = tool.chains()
length = sum(float(np.linalg.norm(np.diff(tool.vertices[pair], axis=0))) for pair in tool.edges)
arc = 2.0 * RADIUS * asin(0.5 * HEIGHT / RADIUS)
print(f"edge {edge}; arc {arc:.3f} mm")
assert abs(length / arc - 1.0) < 1e-3

crack, way = sim.state.crack_length, float(sim.pose.translation[0]) - 0.05 - NOTCH
print(f"crack {crack:.1f} mm, knife {way:.1f} mm beyond the notch")
print(f"work {sim.ledger.tool_work:.2f} N*mm")
assert -0.8 < crack - way < 1.6
