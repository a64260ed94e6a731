"""What a run shows of its cut, of records put together by hand."""

from dataclasses import replace

import numpy as np
import pytest

from shellcut import Fracture, StraightMotion, Support
from shellcut.checks import Sweep
from shellcut.mesh.structured import rectangle
from shellcut.models import free_cut, guillotine
from shellcut.recording.run_summary import cut_evidence
from shellcut.results.verdict import verdict
from shellcut.state import SplitRecord
from shellcut.tool.shapes import straight_blade


@pytest.fixture
def cut():
    """A guillotine of 1 mm quads at its start, and the way of its blade."""
    case = guillotine(1.0, length=8.0, width=4.0, notch=1.0, travel=4.0)
    sim = case.simulation
    return sim, Sweep.of(sim.mesh, sim.tool, sim.motion, case.duration)


def record(sim, place, kind="blade", end=(9.0, 9.0, 9.0)):
    node = int(np.argmin(np.linalg.norm(sim.mesh.nodes - place, axis=1)))
    return SplitRecord(0.0, node, node, place, place, end, kind, 1.0, 0.0)


def test_splits_on_another_row_are_counted(cut):
    sim, sweep = cut
    on, near, off = (2.0, 0.0, 0.0), (3.0, 0.14, 0.0), (3.0, 1.0, 0.0)
    # The blade is at 4 mm at last: a crack leads it straight on, as far as it will.
    ahead, aside = (8.0, 0.0, 0.0), (7.0, -0.5, 0.0)
    sim.state.split_log += [record(sim, place) for place in (on, near, off, ahead, aside)]
    found = cut_evidence(sim, sweep)
    assert (found["n_split"], found["n_split_off_path"], found["edge_length_mm"]) == (5, 2, 1.0)
    assert found["off_path_mm"] == pytest.approx(1.0, abs=0.03)
    assert found["crack_lead_mm"] == pytest.approx(4.0, abs=0.06)


def test_cuts_that_go_on_from_a_tear_have_not_left_the_path(cut):
    sim, sweep = cut
    tear = record(sim, (4.0, 0.5, 0.0), "tear", end=(3.0, 1.5, 0.0))
    goes_on, beside = record(sim, (3.05, 1.55, 0.0)), record(sim, (4.0, 1.0, 0.0))
    sim.state.split_log += [tear, goes_on]
    found = cut_evidence(sim, sweep)
    assert (found["n_split"], found["n_tear"], found["n_split_off_path"]) == (1, 1, 0)
    assert found["tear_off_path_mm"] == pytest.approx(1.5, abs=0.03)
    assert found["off_path_mm"] == pytest.approx(np.hypot(0.05, 0.05))
    sim.state.split_log.append(beside)
    found = cut_evidence(sim, sweep)
    assert (found["n_split"], found["n_split_off_path"]) == (2, 1)
    assert found["off_path_mm"] == pytest.approx(np.hypot(0.25, 0.25))


def test_where_no_edge_comes_by_or_no_film_tears_nothing_is_compared(cut):
    sim, sweep = cut
    sim.state.split_log.append(record(sim, (2.0, 0.0, 0.0)))
    names = ("chain", "time", "place", "quad", "velocity", "back", "normal", "along_edge")
    empty = replace(sweep, **{name: getattr(sweep, name)[:0] for name in names})
    for none in (empty, None):
        assert "n_split" not in cut_evidence(sim, none)
    sim.law = None
    assert list(cut_evidence(sim, None)) == ["edge_length_mm"]


def test_what_joints_missed(cut):
    sim, sweep = cut
    assert "overshoot_rel" not in cut_evidence(sim, sweep)
    for _ in range(3):
        sim.state.cable.append_blank()
    sim.state.cable.overshoot[:3] = 0.1, 0.3, 0.0
    sim.cables.n_joint_made, sim.cables.n_broken = 2, 1
    assert cut_evidence(sim, sweep)["overshoot_rel"] == pytest.approx(0.2 / 2.0)  # of half of 4 mm


def after_a_run(place, direction, duration, length=8.0, **options):
    """The case of a blade on a strip, run, and its evidence."""
    case = free_cut(
        rectangle(8.0, 4.8, size=0.8),
        tool=straight_blade(length=length, height=3.0).translated(place),
        motion=StraightMotion(direction, 12000.0, ramp=1e-4),
        duration=duration,
        supports=[Support.clamped("bottom"), Support.clamped("top")],
        **options,
    )
    case.simulation.run(case.duration)
    return case, cut_evidence(case.simulation, case.check.sweep)


def test_a_cut_on_rows_beside_the_blade_is_told_by_the_run_itself():
    # The blade goes midway between two rows of a strip: both are cut.
    edges = Fracture(path="edges")
    _, found = after_a_run((-0.05, 0.4, 0.0), (1.0, 0.0, 0.0), 4e-4, fracture=edges)
    assert found["n_split_off_path"] == found["n_split"] > 2
    assert found["off_path_mm"] == pytest.approx(0.4, abs=0.01)
    (line,) = [line for line in verdict(found) if "splits" in line.text]
    assert line.kind == "doubt"


def test_a_blade_driven_backwards_is_told_by_the_run_itself():
    # Its back, 0.6 mm wide, comes in over the end of the strip; the edge follows 2 mm behind.
    case, found = after_a_run((10.05, 0.0, 0.0), (-1.0, 0.0, 0.0), 4.9e-4, length=2.0)
    lines = verdict(found, map(str, case.check.doubts))
    doubts = [line.text for line in lines if line.kind == "doubt"]
    # Three of its cables have broken by then: what the share of the cables says comes too late.
    assert case.simulation.cables.n_broken <= 3
    for said in ("reverse the motion", "the cutting edge meets its cables late"):
        assert any(said in text for text in doubts), (said, found)
