"""A hook: an edge with a concave corner parts the film as its straight parts do."""

from itertools import pairwise

import numpy as np
import pytest

from shellcut import CohesiveLaw, StraightMotion, Tool
from shellcut.meshing import rectangle
from shellcut.models.free_cut import free_cut
from shellcut.tool.cutting_edge import CuttingEdges, strip_coordinates

HALF, BACK = 0.2, 2.0


def knife(points):
    """Return a blade along x whose edge runs through points (x, z), from the lowest one."""
    x, z = np.array(points, float).T
    edge = np.stack([x, 0.0 * x, z], axis=1)
    sides = [
        np.stack([at, np.full(len(x), y), z], axis=1)
        for at in (x - BACK, np.full(len(x), -10.0))
        for y in (HALF, -HALF)
    ]
    ring = np.array([0, 1, 3, 4, 2]) * len(x)  # of a section
    faces = []
    for a, b in pairwise([*ring, ring[0]]):
        for k in range(len(x) - 1):
            faces += [(a + k, b + k, b + k + 1), (a + k, b + k + 1, a + k + 1)]
    for i, j in pairwise(ring[1:]):
        faces += [(ring[0], j, i), (ring[0] + len(x) - 1, i + len(x) - 1, j + len(x) - 1)]
    cuts = [(k + 1, k) for k in range(len(x) - 1)]
    return Tool.from_triangles(np.concatenate([edge, *sides]), faces, edges=cuts)


HOOKS = {
    "20°": [(0.45, -1.2), (0.0, 0.0), (0.45, 1.2)],
    "34°": [(0.8, -1.2), (0.0, 0.0), (0.8, 1.2)],
    "53°": [(1.6, -1.2), (0.0, 0.0), (1.6, 1.2)],
    "69°": [(3.2, -1.2), (0.0, 0.0), (3.2, 1.2)],
    "one side": [(1.6, -1.2), (0.0, 0.0), (0.1, 1.2)],
    "two corners": [(0.9, -1.5), (0.0, -0.6), (0.0, 0.6), (0.9, 1.5)],
}


@pytest.mark.parametrize("points", HOOKS.values(), ids=HOOKS)
def test_what_lies_behind_a_concave_corner_belongs_to_a_segment(points):
    tool = knife(points)
    segments = CuttingEdges.of(tool).segments
    for x, z in points[1:-1]:
        for angle in np.radians(np.linspace(-75.0, 75.0, 31)):
            for far in (1e-6, 0.1, 0.9):
                p = x - far * np.cos(angle), 0.05, z + far * np.sin(angle)
                assert any(strip_coordinates(p, k, segments, 3.0)[3] for k in range(len(segments)))


@pytest.mark.parametrize("points", HOOKS.values(), ids=HOOKS)
def test_a_corner_in_the_film_presses_no_flank_aside(points):
    tool = knife(points).translated((-0.05 - max(x for x, _ in points), 0.0, 0.0))
    case = free_cut(
        rectangle(10.0, 6.0, size=0.5),
        tool=tool,
        motion=StraightMotion((1.0, 0.0, 0.0), speed=6000.0, ramp=1e-4),
        duration=1.0e-3,
        notch=2.0,
        clamp=("bottom", "top"),
        law=CohesiveLaw(strength=18.0, plateau=12.0, opening_a=0.1, opening_p=0.8, opening_u=1.2),
    )
    sim, aside = case.simulation, []
    while sim.state.time < case.duration:
        sim.step()
        aside.append(sim.tooth_wrenches[0, 1])
    # Film and tool are their own mirror images: both flanks press alike, 13 N apart otherwise.
    assert np.abs(np.mean(aside[-2000:])) < 0.02
