"""What a run leaves is read back: history, frames, figures, also before it has ended."""

import dataclasses
import re
import subprocess
import sys
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest

import shellcut
import shellcut.view
from opening_frame import opening_frame
from shellcut import Recorder, guillotine
from shellcut.frame import JOINTED
from shellcut.recording.frame_capture import frame_of
from shellcut.results.vtkhdf import VtkHdfWriter
from test_vtkhdf import assert_same


def leave(folder, n=3, name="made"):
    """A made-up run that has not ended."""
    folder.mkdir(exist_ok=True)
    frames = [opening_frame(30.0 * k, n_side=8, time=1e-3 * (k + 1)) for k in range(n)]
    with closing(VtkHdfWriter(folder / f"{name}.vtkhdf")) as writer:
        for frame in frames:
            writer.append(frame)
    rows = "".join(f"{1e-3 * k},{30.0 * k},{144.0 + k}\n" for k in range(5))
    header = "time [s],angle [deg],torque [N*mm]\n"
    (folder / "history.csv").write_text(header + rows + "0.006,33")  # killed within a row
    return frames


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """A short cut by a guillotine, with the frames as they were when they were written."""
    folder = tmp_path_factory.mktemp("run")
    case = guillotine(0.8, length=8.0, width=4.8, notch=1.6, travel=4.0)
    written = []

    def append(output, frame, write=VtkHdfWriter.append):
        written.append(frame)
        write(output, frame)

    numbers = {"n_row": 40, "n_frame": 8, "n_snapshot": 0, "progress": False}
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(VtkHdfWriter, "append", append)
        recorder = Recorder(case.simulation, folder, until=case.duration, name="strip", **numbers)
        case.simulation.run(case.duration, [recorder])
    return folder, written, case.simulation


def test_a_cut_is_read_back_frame_by_frame_as_it_was_simulated(run):
    folder, written, sim = run
    results = shellcut.read(folder)
    assert len({len(frame.points) for frame in written}) > 2  # the topology changes
    assert any((frame.cable_state == JOINTED).any() for frame in written)
    assert results.n_frame == len(written)
    for got, wanted in zip(results.frames(), written, strict=True):
        assert_same(got, wanted)
    assert_same(results.frame(-1), written[-1])
    # The last frame stays true to the state, though the run went on for less than a frame.
    last, s = written[-1], sim.state
    assert last.crack_edges.shape[0] > 2
    np.testing.assert_array_equal(last.reference, s.node.X[: len(last.points)])
    assert last.held.sum() == 2 * 11
    np.testing.assert_array_equal(np.unique(last.tool_tooth), [1])


def test_history_figures_and_splits(run):
    folder, written, sim = run
    results = shellcut.read(folder)
    assert results.name == "strip"
    assert (results.coordinate_name, results.coordinate_unit) == ("path", "mm")
    assert (results.resistance_name, results.resistance_unit) == ("force", "N")
    assert results.units["tool_work"] == "N*mm"
    assert len(results.history["force"]) == len(results.history["time"]) >= 40
    assert results.summary["n_quad"] == sim.mesh.n_quad
    np.testing.assert_array_equal(results.coordinates, [frame.coordinate for frame in written])
    assert len(results.splits["time"]) == len(sim.state.split_log)
    for k in (0, -1):
        rotation, translation = results.tool_pose(k)
        np.testing.assert_array_equal(rotation, np.eye(3))
        np.testing.assert_array_equal(translation, sim.motion.pose(results.times[k])[1])
    shown = repr(results)
    assert "time, path, force, " in shown.partition("history: ")[2]
    assert re.search(r"frames: \d+, path 0 to [34]\.?\d* mm, time 0 to", shown)


def test_the_cut_s_quality_over_the_frames(run):
    folder, written, _ = run
    figures = shellcut.read(folder).cut_quality()
    assert (figures.units["crack_length"], figures.units["path"]) == ("mm", "mm")
    assert set(figures) == set(figures.units)
    crack = figures["crack_length"]
    assert crack[0] == pytest.approx(1.6, rel=1e-3)  # the notch
    assert (np.diff(crack) >= -1e-3).all()
    assert crack[-1] > 3.0
    # Half-edges of the run's own figure, whole edges here; a file keeps 12 bits.
    assert crack[-1] - crack[0] == pytest.approx(written[-1].scalars["crack length"], abs=0.8)
    assert (figures["n_piece"] == 1).all()
    assert (figures["n_loose"] == 0).all()
    assert figures["slit_width_largest"][-1] > 0.05 > figures["slit_width_largest"][0]


def test_a_run_that_was_killed_or_has_no_frame_yet(tmp_path):
    frames = leave(tmp_path / "out")
    results = shellcut.read(tmp_path / "out")
    assert results.history["torque"].tolist() == [144.0, 145.0, 146.0, 147.0, 148.0]
    assert (results.summary, results.splits) == ({}, {})
    assert "the run has not ended" in repr(results)
    assert_same(results.frame(1), frames[1])
    summary = tmp_path / "out" / "summary.json"
    summary.write_text('{"n_quad": 3')  # no run leaves it half written
    with pytest.raises(ValueError, match=r"summary\.json, line 1, column 13: must be JSON"):
        shellcut.read(tmp_path / "out")
    summary.write_text('{"n_quad": 3}')
    assert shellcut.read(tmp_path / "out" / "made.vtkhdf").summary == {"n_quad": 3}
    leave(tmp_path / "out", n=0)
    results = shellcut.read(tmp_path / "out")
    assert (results.n_frame, results.coordinate_name) == (0, "angle")
    assert len(results.cut_quality()["n_piece"]) == 0
    with pytest.raises(IndexError, match="none yet, got 0"):
        results.frame(0)


WRITER = """
import dataclasses, sys, time
sys.path.insert(0, {folder!r})
from opening_frame import opening_frame
from shellcut.results.vtkhdf import VtkHdfWriter

frames = [opening_frame(a, n_side=8) for a in (0.0, 30.0, 60.0)]
writer = VtkHdfWriter({path!r})
print("begun", flush=True)
for k in range(25):
    writer.append(dataclasses.replace(frames[k % 3], time=1.0 + k))
    time.sleep(0.03)
sys.stdin.read()
"""


def test_a_run_that_another_process_is_writing(tmp_path):
    # Frames come as fast as they can; whatever is read meanwhile must be whole.
    script = WRITER.format(folder=str(Path(__file__).parent), path=str(tmp_path / "made.vtkhdf"))
    command = [sys.executable, "-c", script]
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
    with subprocess.Popen(command, **pipes) as writing:
        assert writing.stdout.readline() == b"begun\n"
        wanted = [opening_frame(a, n_side=8) for a in (0.0, 30.0, 60.0)]
        seen = set()
        while (n := shellcut.read(tmp_path).n_frame) < 25:
            if n:
                k = n - 1
                got = shellcut.read(tmp_path).frame(k)
                assert_same(got, dataclasses.replace(wanted[k % 3], time=1.0 + k))
                seen.add(k)
        assert len(seen) > 3
        writing.stdin.close()


def test_what_is_not_there_is_said(tmp_path):
    with pytest.raises(FileNotFoundError, match="nowhere must be the folder of a run"):
        shellcut.read(tmp_path / "nowhere")
    (tmp_path / "empty").mkdir()
    with pytest.raises(FileNotFoundError, match=r"empty must hold the result of a run, NAME.vtkh"):
        shellcut.read(tmp_path / "empty")
    leave(tmp_path / "out")
    leave(tmp_path / "out", name="other")
    with pytest.raises(ValueError, match=r"one .vtkhdf file, got made.vtkhdf, other.vtkhdf; give"):
        shellcut.read(tmp_path / "out")
    assert shellcut.read(tmp_path / "out" / "other.vtkhdf").name == "other"
    (tmp_path / "out" / "history.csv").unlink()
    results = shellcut.read(tmp_path / "out" / "other.vtkhdf")
    assert results.coordinate_name == "angle"
    with pytest.raises(ValueError, match=r"must contain the run's history.csv"):
        _ = results.resistance_name


def test_capture_shows_the_cables_that_hold_and_the_tool_where_it_is(run):
    *_, sim = run
    frame = frame_of(sim, coordinate=0.0, coordinate_name="path", coordinate_unit="mm")
    c = sim.state.cable
    ends, status = c.at_ends(sim.state.node.x), c.status[: c.count]
    straight, bent = np.flatnonzero(status == 0), np.flatnonzero(status == JOINTED)
    assert (status == 2).any()  # some are broken, and not shown
    ids = np.concatenate((straight, bent, bent))
    segments = [ends[straight], np.stack((ends[bent, 0], c.joint[bent]), axis=1)]
    segments.append(np.stack((c.joint[bent], ends[bent, 1]), axis=1))
    np.testing.assert_array_equal(frame.cable_segments, np.concatenate(segments))
    np.testing.assert_array_equal(frame.cable_opening, c.opening[ids])
    np.testing.assert_array_equal(frame.cable_traction, c.traction[ids])
    np.testing.assert_array_equal(frame.cable_state, status[ids])
    points = sim.tool.vertices @ frame.tool_rotation.T + frame.tool_translation
    np.testing.assert_array_equal(frame.tool_points, points)
    np.testing.assert_array_equal(frame.edge_points, points[sim.tool.edges])


def test_capture_of_a_film_without_a_tool():
    sim = shellcut.Simulation(
        shellcut.Mesh.from_arrays([[0, 0], [1, 0], [1, 1], [0, 1]], [[0, 1, 2, 3]]),
        shellcut.ShellMaterial.homogeneous(),
    )
    frame = frame_of(sim, coordinate=0.0, coordinate_name="path", coordinate_unit="mm")
    assert frame.tool_points.shape == (0, 3)
    assert not frame.held.any()
    assert frame.quad_thickness.tolist() == [0.074]
