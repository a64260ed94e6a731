"""A notch follows its line, around all its bends, and ends where that ends."""

import numpy as np
import pytest

from free_strip import cut_strip, slanted_strip
from shellcut import CohesiveLaw, Fracture, Mesh, ShellMaterial, Simulation
from shellcut.arrays import off_segments
from shellcut.mesh.structured import rectangle

SIZE = 0.4
LINES = {
    "straight": [(-1.0, 0.17), (2.3, 0.17)],
    "slanted": [(-1.0, -0.9), (3.7, 0.7)],
    "a bend": [(-1.0, 0.17), (2.3, 0.17), (4.1, 1.0)],
    "back and forth": [(-1.0, 0.17), (1.3, -0.9), (2.5, 0.9), (4.1, -0.6)],
    "a sharp bend at its end": [(-1.0, 0.17), (2.3, 0.17), (2.5, -1.0)],
    "a turn back": [(-1.0, 0.17), (3.5, 0.17), (3.9, 0.9), (1.2, 1.0)],
    "many": [(-1.0, 0.17), (1.5, 0.17), (2.2, 0.6), (2.9, 0.17), (3.6, -0.6), (4.8, -0.3)],
}


@pytest.mark.parametrize("mesh", [rectangle(6.0, 3.2, n_x=15, n_y=8), slanted_strip()], ids="as")
@pytest.mark.parametrize("line", LINES.values(), ids=LINES)
def test_a_notch_lies_on_its_line_from_the_rim_to_the_end(mesh, line):
    sim = cut_strip(mesh=mesh, notched=False)
    rim = sim.mesh.nodes[:, 0].min()
    points = np.array([(rim + x, y, 0.0) for x, y in line])
    sim.notch(*points)
    places = np.array([cut.reference for cut in sim.state.split_log])
    (tip,) = sim.cracks.at_tips(sim.state.node.X)
    starts, legs = points[:-1], np.diff(points, axis=0)
    gaps, _ = off_segments(places[:, None], starts, legs)
    # A segment is straight through its quad, and sides are met off their corners.
    assert np.linalg.norm(gaps, axis=2).min(axis=1).max() < 0.5 * SIZE
    # It ends on the first side behind the end of the line.
    assert np.linalg.norm(tip - points[-1]) < SIZE
    # No part of the line is left out: a segment is no longer than a quad.
    along = (starts + np.linspace(0.0, 1.0, 21)[:, None, None] * legs).reshape(-1, 3)
    along = along[along[:, 0] > rim]
    every = np.concatenate([places, [tip]])
    nearest = np.linalg.norm(along[:, None] - every, axis=2).min(axis=1)
    assert nearest.max() < SIZE


@pytest.mark.parametrize("gap", [0.002, 0.1, 0.5])
@pytest.mark.parametrize("ahead", [-0.3, 0.0, 0.3])
@pytest.mark.parametrize("lean", [0.0, 0.4])
def test_each_sheet_of_a_stack_is_notched_where_the_line_lies_in_it(gap, ahead, lean):
    """However near the other sheet is, whichever sticks out, however both lie in space."""
    sheet = rectangle(3.2, 1.6, n_x=8, n_y=4)
    c, s = np.cos(lean), np.sin(lean)
    turn = np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
    shift = np.array([ahead, 0.0, gap])
    nodes = np.concatenate([sheet.nodes, sheet.nodes + shift]) @ turn.T
    mesh = Mesh.from_arrays(nodes, np.concatenate([sheet.quads, sheet.quads + sheet.n_node]))
    film, law = ShellMaterial.homogeneous(), CohesiveLaw()
    sim = Simulation(mesh, film, law=law, fracture=Fracture(path="free"))
    left = sheet.nodes[:, 0].min()
    for begin in (np.array([left, 0.11, 0.0]), np.array([left, 0.11, 0.0]) + shift):
        before = sim.state.n_quad
        along = np.array([0.1, 0.0, 0.0])
        sim.notch(turn @ (begin - 3.0 * along), turn @ (begin + 13.0 * along))
        cut = sim.state.quad.parent[before : sim.state.n_quad]
        height = (mesh.nodes[mesh.quads[cut]].mean(axis=1) @ turn)[:, 2]
        np.testing.assert_allclose(height, begin[2], rtol=0, atol=1e-9)
        assert len(cut) == 4


@pytest.mark.parametrize("gap", [0.01, 0.1, 0.2])
@pytest.mark.parametrize("start", [(-0.43, 0.31), (0.7, -0.9), (1.13, 0.04)])
@pytest.mark.parametrize("sheet", [0, 1, 2])
def test_a_notch_within_a_stack_cuts_the_sheet_in_which_it_lies(gap, start, sheet):
    """Whatever the quads of the others, whose middles may be nearer."""
    sheets = [rectangle(6.0, 6.0, size=size) for size in (0.8, 1.0, 0.3)]
    first = np.cumsum([0, *(one.n_node for one in sheets)])
    nodes = [one.nodes + np.array([0.0, 0.0, k * gap]) for k, one in enumerate(sheets)]
    quads = [one.quads + at for one, at in zip(sheets, first, strict=False)]
    mesh = Mesh.from_arrays(np.concatenate(nodes), np.concatenate(quads))
    sim = Simulation(
        mesh, ShellMaterial.homogeneous(), law=CohesiveLaw(), fracture=Fracture(path="free")
    )
    begin = np.array([*start, sheet * gap])
    sim.notch(begin, begin + np.array([1.1, 0.2, 0.0]))
    heights = [split.reference[2] for split in sim.state.split_log]
    np.testing.assert_allclose(heights, sheet * gap, rtol=0, atol=1e-9)


@pytest.mark.parametrize("height", [0.0, 0.003, 0.01])
def test_a_line_beside_its_sheet_enters_at_the_border_not_behind_a_hole(height):
    """The film behind the hole has longer sides, and the line comes nearer to it."""
    sheet = rectangle(4.0, 1.6, n_x=10, n_y=4)
    nodes, left = sheet.nodes.copy(), sheet.nodes[:, 0].min()
    nodes[:, 0] = (nodes[:, 0] - left) ** 2
    x = nodes[sheet.quads].mean(axis=1)
    hole = (x[:, 0] > 3.0) & (x[:, 0] < 6.0) & (np.abs(x[:, 1]) < 0.5)
    used, quads = np.unique(sheet.quads[~hole], return_inverse=True)
    mesh = Mesh.from_arrays(nodes[used], quads.reshape(-1, 4))
    film, law = ShellMaterial.homogeneous(), CohesiveLaw()
    sim = Simulation(mesh, film, law=law, fracture=Fracture(path="free"))
    sim.notch((-0.3, 0.11, height), (9.0, 0.11, 0.3 * height))
    assert sim.state.split_log[0].reference[0] == pytest.approx(0.0, abs=1e-9)
