"""A tool without cutting edges: it pushes, and the film tears ahead of it as it likes."""

import numpy as np

import shellcut as sc
from blunt_tools import BOX_FACES, blunt, box_corners
from films import cut_by
from shellcut.meshing import rectangle
from shellcut.models import Case
from shellcut.tool_shapes import straight_blade

# A box of 2 mm that leans forward with its top: its front pushes the film down.
LEANING = box_corners((-2.0, -1.0, -4.0), (0.0, 1.0, 4.0))
LEANING[:, 0] += 0.2 * LEANING[:, 2]
LAW = sc.CohesiveLaw(
    strength=7.0, plateau=5.6, opening_a=0.4, opening_p=1.6, opening_u=2.4, onset=0.02
)


def bar():
    return blunt(LEANING, BOX_FACES)


def test_the_film_tears_ahead_of_it_and_checks_report_and_preview_do_without_edges(tmp_path):
    tool = bar().translated((-0.1, 0.0, 0.0))
    sim = cut_by(tool, rectangle(12.0, 8.0, size=1.0), 8000.0, ramp=1e-4, law=LAW)
    sim.notch((-1.0, 0.0, 0.0), (3.0, 0.0, 0.0))
    case = Case("pushed", sim, 0.4e-3)
    said = sc.preview(sim, tmp_path / "bar.png", time=1e-4)
    assert "0 cutting edges" in said
    folder = tmp_path / "pushed"
    case.run(folder, n_row=50, n_frame=2, n_snapshot=2)
    cuts = sim.state.split_log
    assert sim.state.crack_length >= 3.0
    assert {cut.kind for cut in cuts} == {"notch", "tear"}
    # All is the same on both sides of the bar.
    assert max(abs(cut.end[1]) for cut in cuts) < 1e-6
    assert max(cut.reference[0] for cut in cuts) > sim.pose.translation[0]
    book = sim.ledger
    assert abs(book.relative(book.imbalance)) < 1e-3
    assert case.check.findings == ()
    assert case.check.sweep is None
    assert sc.report_run(folder).exists()


def test_a_blunt_body_before_a_cutting_one_stops_no_free_cut():
    blade = straight_blade(length=4.0, height=3.0)
    body = box_corners((-2, -1, 6), (0, 1, 8))
    both = sc.Tool.from_triangles(
        np.concatenate([body, blade.vertices]),
        np.concatenate([BOX_FACES, blade.triangles + 8]),
        edges=blade.edges + 8,
    )
    assert (both.n_tooth, both.edge_tooth.tolist()) == (2, [1])
    tool = both.translated((-0.05, 0.0, 0.0))
    sim = cut_by(tool, rectangle(6.0, 4.0, size=0.5), 6000.0, ramp=1e-4)
    sim.notch((-1.0, 0.0, 0.0), (1.0, 0.0, 0.0))
    sim.run(until=5e-4)
    assert sim.state.crack_length > 1.0
    assert not sim.tooth_wrenches[0].any()
    assert sim.tooth_wrenches[1, 0] < 0.0
