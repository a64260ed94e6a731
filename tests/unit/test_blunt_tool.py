"""A tool without cutting edges: it pushes, and the film tears ahead of it as it likes."""

import numpy as np
import pytest

import shellcut as sc
from shellcut.meshing import rectangle
from shellcut.models import Case
from shellcut.tool_shapes import straight_blade

# A box of 2 mm that leans forward with its top: its front pushes the film down.
CORNERS = [
    [x + (0.8 if z > 0.0 else -0.8), y, z]
    for x in (-2.0, 0.0)
    for y in (-1.0, 1.0)
    for z in (-4.0, 4.0)
]
SIDES = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
FACES = [half for a, b, c, d in SIDES for half in ([a, b, c], [a, c, d])]
LAW = sc.CohesiveLaw(
    strength=7.0, plateau=5.6, opening_a=0.4, opening_p=1.6, opening_u=2.4, onset=0.02
)


def bar():
    none = np.zeros((0, 2), int)
    return sc.Tool.from_triangles(CORNERS, FACES, edges=none, name="bar")


def test_it_has_no_edges_and_no_flanks():
    tool = bar()
    assert (tool.n_edge, tool.n_chain, tool.chains()) == (0, 0, [])
    assert not tool.flank.any()
    assert tool.volume()[0] == pytest.approx(2.0 * 2.0 * 8.0)  # round-off


@pytest.fixture(scope="module")
def pushed(tmp_path_factory):
    """A notched strip that the bar tears."""
    folder = tmp_path_factory.mktemp("pushed")
    sim = sc.Simulation(
        rectangle(12.0, 8.0, size=1.0),
        sc.ShellMaterial.homogeneous(),
        supports=[sc.Support.clamped("bottom"), sc.Support.clamped("top")],
        tool=bar().translated((-0.1, 0.0, 0.0)),
        motion=sc.StraightMotion((1.0, 0.0, 0.0), speed=8000.0, ramp=1e-4),
        law=LAW,
        fracture=sc.Fracture(path="free"),
    )
    sim.notch((-1.0, 0.0, 0.0), (3.0, 0.0, 0.0))
    case = Case("pushed", sim, 0.4e-3)
    case.run(folder, n_row=50, n_frame=2, n_snapshot=2)
    return case, folder


def test_the_film_tears_ahead_of_it(pushed):
    case, _ = pushed
    s = case.simulation.state
    assert s.crack_length >= 3.0
    assert {cut.kind for cut in s.split_log} == {"notch", "tear"}
    # All is the same on both sides of the bar.
    assert max(abs(cut.end[1]) for cut in s.split_log) < 1e-6
    ahead = max(cut.reference[0] for cut in s.split_log)
    assert ahead > case.simulation.pose.translation[0]
    book = case.simulation.ledger
    assert abs(book.relative(book.imbalance)) < 1e-3


def test_checks_report_and_preview_do_without_edges(pushed, tmp_path):
    case, folder = pushed
    assert case.check.findings == ()
    assert case.check.sweep is None
    assert sc.report_run(folder).exists()
    fresh = sc.Simulation(
        rectangle(4.0, 4.0, size=1.0),
        sc.ShellMaterial.homogeneous(),
        supports=[sc.Support.clamped("left")],
        tool=bar().translated((-1.5, 0.0, 0.0)),
        motion=sc.StraightMotion((1.0, 0.0, 0.0), speed=8000.0),
    )
    said = sc.preview(fresh, tmp_path / "bar.png", time=1e-4)
    assert "0 cutting edges" in said


def test_a_blunt_body_before_a_cutting_one_stops_no_free_cut():
    blade = straight_blade(length=4.0, height=3.0)
    box = np.array([[x, y, z] for x in (-2, 0) for y in (-1, 1) for z in (6, 8)], float)
    both = sc.Tool.from_triangles(
        np.concatenate([box, blade.vertices]),
        np.concatenate([FACES, blade.triangles + len(box)]),
        edges=blade.edges + len(box),
    )
    assert (both.n_tooth, both.edge_tooth.tolist()) == (2, [1])
    sim = sc.Simulation(
        rectangle(6.0, 4.0, size=0.5),
        sc.ShellMaterial.homogeneous(),
        supports=[sc.Support.clamped("bottom"), sc.Support.clamped("top")],
        tool=both.translated((-0.05, 0.0, 0.0)),
        motion=sc.StraightMotion((1.0, 0.0, 0.0), speed=6000.0, ramp=1e-4),
        law=sc.CohesiveLaw(),
        fracture=sc.Fracture(path="free"),
    )
    sim.notch((-1.0, 0.0, 0.0), (1.0, 0.0, 0.0))
    sim.run(until=5e-4)
    assert sim.state.crack_length > 1.0
    assert not sim.tooth_wrenches[0].any()
    assert sim.tooth_wrenches[1, 0] < 0.0
