"""Frames and files of a run with cracks through quads."""

import numpy as np
import pytest

import shellcut as sc
from free_strip import NOTCH, cut_strip, slanted_strip
from shellcut.frame import is_corner, sides_of
from shellcut.material import Elastic, Layer, Linear, Plastic, ShellMaterial
from shellcut.models.case import Case
from shellcut.recording.cut_front import CrackEnds, CutFront
from shellcut.recording.frame_capture import frame_of
from shellcut.results.cut_quality import cut_quality
from shellcut.results.frame_grid import POLYGON, grid_of
from shellcut.state import JOINTED

# A law with history whose kernels case P07 compiles anyway.
YIELDING = ShellMaterial(
    [Layer(Plastic(Elastic(1678.0, 0.3, 1e-9), Linear(15.0, 60.0)), 0.074)], points_per_layer=3
)
WHERE = {"coordinate": 0.0, "coordinate_name": "path", "coordinate_unit": "mm"}


@pytest.fixture(scope="module")
def cut():
    """A strip that has been cut almost halfway."""
    sim = cut_strip()
    while sim.cables.n_broken < 8:
        sim.step()
    return sim


def test_polygons_cover_the_film_and_each_has_its_share(cut):
    frame, s = frame_of(cut, **WHERE), cut.state
    x, y = frame.reference[frame.quads][..., :2].transpose(2, 0, 1)
    areas = 0.5 * (x * np.roll(y, -1, axis=1) - np.roll(x, -1, axis=1) * y).sum(axis=1)
    shares = s.quad.share[: s.n_quad] * cut.mesh.quad_areas()[s.quad.parent[: s.n_quad]]
    # A straight side of the drawing is a curve in xi and eta of a quad that is no parallelogram.
    np.testing.assert_allclose(areas, shares, rtol=5e-3)
    assert areas.sum() == pytest.approx(6.0 * 3.2, rel=1e-12)
    assert len(frame.quads) == s.n_quad > cut.mesh.n_quad


def test_no_virtual_node_and_no_flank_point_is_drawn(cut):
    frame, s = frame_of(cut, **WHERE), cut.state
    assert np.unique(frame.quads).tolist() == list(range(len(frame.points)))
    flank, real = s.flank.node[: s.flank.count], s.node.real[: s.n_node].copy()
    assert flank.size > 4
    assert (~real).sum() > 4
    real[flank] = False
    np.testing.assert_array_equal(frame.points[: real.sum()], s.node.x[: s.n_node][real])


def test_outlines_meet_point_by_point(cut):
    frame = frame_of(cut, **WHERE)
    sides = np.sort(sides_of(frame.quads), axis=1)
    sides, count = np.unique(sides, axis=0, return_counts=True)
    assert count.max() == 2
    x, y, _ = frame.reference[sides].transpose(2, 0, 1)
    rim = [np.ptp(c, axis=1) < 1e-9 for c in (x, y)]
    on_rim = rim[0] & np.isin(np.round(x[:, 0], 9), (0.0, 6.0))
    on_rim |= rim[1] & np.isin(np.round(np.abs(y[:, 0]), 9), 1.6)
    assert (count[on_rim] == 1).all()
    # Else only flanks have one polygon, and every crack edge has two of them.
    flanks = frame.crack_edges.reshape(-1, 2)
    assert sorted(map(tuple, np.sort(flanks, axis=1))) == sorted(
        map(tuple, sides[(count == 1) & ~on_rim])
    )


def test_crack_is_as_long_as_the_cuts(cut):
    frame = frame_of(cut, **WHERE)
    quality = cut_quality(frame)
    before = cut_quality(frame_of(cut_strip(), **WHERE)).crack_length
    assert before == pytest.approx(1.2)  # to the first side at or beyond the notch's end
    assert before > NOTCH
    assert quality.crack_length == pytest.approx(before + cut.state.crack_length, rel=1e-9)
    assert len(quality.cracks) == 1
    assert len(quality.pieces) == 1
    line = quality.cracks[0]
    ends = cut.cracks.at_tips(cut.mesh.nodes)
    assert min(np.linalg.norm(line[i] - ends[0]) for i in (0, -1)) < 1e-12


def test_frames_and_records_of_a_run_come_back_from_the_files(tmp_path):
    sim = cut_strip()
    Case("strip", sim, 2.2e-4).run(tmp_path, n_snapshot=2, n_frame=4, curves=False, progress=False)
    results = sc.read(tmp_path)
    frame, now = results.frame(-1), frame_of(sim, **WHERE)
    np.testing.assert_array_equal(frame.quads, now.quads)
    np.testing.assert_array_equal(frame.crack_edges, now.crack_edges)
    np.testing.assert_allclose(frame.points, now.points, atol=1e-5)
    assert (is_corner(frame.quads).sum(axis=1) != 4).any()
    _, _, cells, *_ = grid_of(frame)
    assert (cells["Types"] == POLYGON).any()
    assert len(results.splits["time"]) == len(sim.state.splits) > 4
    assert set(results.splits["node"]) == {-1}
    assert set(results.splits["kind"]) <= {"criterion", "blade"}
    np.testing.assert_allclose(results.splits["Y"], 0.0, atol=0.08)
    assert results.history["crack_length"][-1] == pytest.approx(sim.state.crack_length)
    assert results.summary["n_copy"] == sim.state.n_quad - sim.mesh.n_quad
    texts = " ".join(line["text"] for line in results.summary["verdict"])
    assert "row of mesh edges" not in texts


def test_ends_of_cracks(cut):
    ends = CrackEnds.of(cut, cut.mesh.boundary_nodes())
    np.testing.assert_allclose(ends.director, [[0.0, 0.0, 1.0]], atol=1e-12)
    assert ends.heading(0)[0] > 0.9
    ((length, zone, ahead, spare),) = CutFront(cut, 1e-3).rows(cut)
    assert 0.0 < zone < length < cut.state.crack_length
    c = cut.state.cable
    jointed = np.flatnonzero(c.status[: cut.state.n_cable] == JOINTED)
    edge = c.at_ends(cut.state.node.X)[jointed, 0, 0].max()
    assert ahead == pytest.approx(6.0 - edge, abs=1e-3)
    assert spare > 0.5


@pytest.mark.parametrize("slope", [0.0, 0.15], ids=["along sides", "through quads"])
def test_cuts_that_cross_leave_four_pieces_that_meet_point_by_point(slope):
    sim = cut_strip(mesh=slanted_strip(slope), notched=False)
    for start, end in (((-1.0, 0.0, 0.0), (6.0, 0.0, 0.0)), ((3.1, -2.0, 0.0), (3.1, 1.6, 0.0))):
        sim.notch(start, end)
    frame = frame_of(sim, **WHERE)
    quality = cut_quality(frame)
    areas = sorted(piece.area for piece in quality.pieces)
    np.testing.assert_allclose(areas, [2.9 * 1.6, 2.9 * 1.6, 3.1 * 1.6, 3.1 * 1.6], rtol=2e-3)
    assert sum(areas) == pytest.approx(6.0 * 3.2, rel=1e-12)
    assert quality.crack_length == pytest.approx(6.0 + 3.2, rel=2e-3)
