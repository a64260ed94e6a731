"""A blade that enters over the border: the force is that of the cables drawn around its edge.

At the advance a from the border the cable of the place s has the length 2 (a - s), so the force is
h A(2 a), A(l) the area below the law up to l. The strip is narrow, or its corners fold forward.
"""

import numpy as np
import pytest

import shellcut as sc
from courses import course, growth, moved_by
from films import cut_by
from shellcut.mesh.structured import rectangle
from shellcut.tool.shapes import straight_blade

LAW = sc.CohesiveLaw()
AHEAD = 0.02  # mm


def drawn(a, film):
    """The work up to an advance of a mm, a < opening_u / 2."""
    corners = [0.0, LAW.opening_a, LAW.opening_p, LAW.opening_u]
    way = np.linspace(0.0, a, 2001)
    stress = np.interp(2.0 * way, corners, [LAW.strength, LAW.plateau, LAW.plateau, 0.0])
    area = np.concatenate([[0.0], np.cumsum(stress[1:] + stress[:-1]) * (way[1] - way[0])])
    return film.thickness * np.trapezoid(area, way)


@pytest.mark.parametrize(
    ("size", "tolerance", "beside"), [(0.4, 0.10, 0.0), (0.4, 0.10, 0.3), (0.2, 0.05, 0.03)]
)
def test_the_force_over_the_rim_is_that_of_the_drawn_cables(size, tolerance, beside):
    film = sc.ShellMaterial.homogeneous()
    mesh = rectangle(4.0, 2.4, size=size)
    middle = 0.5 * (mesh.nodes.min(axis=0) + mesh.nodes.max(axis=0))
    blade = straight_blade(half_thickness=0.05, length=4.0, height=3.0).translated(
        (mesh.nodes[:, 0].min() - AHEAD, middle[1] + beside * size, 0.0)
    )
    sim = cut_by(blade, mesh, 6000.0, ramp=5e-5, law=LAW)
    way, work = course(sim, moved_by(AHEAD + 1.85), "tool_work", every=1, close=False)
    # Below 0.6 mm the faces of the blade push the film aside, and the cut is shorter than an edge.
    for a, b in ((0.6, 1.0), (1.0, 1.4), (1.4, 1.8)):
        expected = growth([a, b], [drawn(a, film), drawn(b, film)], a, b)
        assert growth(way - AHEAD, work, a, b) == pytest.approx(expected, rel=tolerance)


@pytest.mark.parametrize("beside", [-0.45, -0.25, -0.05, 0.15, 0.35])
def test_wide_quads_are_entered_wherever_the_edge_comes_upon_them(beside):
    size, wide = 0.4, 3.0
    mesh = rectangle(2.0, 2.4, size=size)
    nodes = mesh.nodes * np.array([1.0, wide, 1.0])
    low, high = nodes.min(axis=0), nodes.max(axis=0)
    blade = straight_blade(half_thickness=0.05, length=4.0, height=3.0).translated(
        (low[0] - AHEAD, 0.5 * (low[1] + high[1]) + beside * wide * size, 0.0)
    )
    clamp = sc.Support.clamped(np.flatnonzero(np.isin(nodes[:, 1], (low[1], high[1]))))
    sim = cut_by(
        blade,
        sc.Mesh.from_arrays(nodes, mesh.quads),
        6000.0,
        ramp=5e-5,
        law=LAW,
        supports=[clamp],
    )
    reached = moved_by(AHEAD + 0.1)
    while not reached(sim):
        sim.step()
    assert sim.state.crack_length > 0.0
