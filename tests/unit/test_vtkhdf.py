"""The VTKHDF file as VTK's own reader sees it, also after a kill -9 and after a restart."""

import dataclasses
import signal
import subprocess
import sys
import textwrap
from pathlib import Path

import h5py
import numpy as np
import pytest

from opening_frame import opening_frame
from shellcut.frame import Frame
from shellcut.vtkhdf import CABLE, MEMBRANE, TOOL, VtkHdfWriter

ROUNDING = 2.0**-13  # half of the last of the 12 bits that are kept


def frames(n=7):
    # Angle 0 twice and three times the same angle: the cells stay, the positions do not.
    angles = [0.0, 0.0, 20.0, 20.0, 20.0, 32.0, 45.0, 60.0, 61.0, 62.0][:n]
    out = []
    for k, angle in enumerate(angles):
        frame = opening_frame(angle, n_side=10, time=1e-4 * (k + 1))
        out.append(
            dataclasses.replace(frame, points=frame.points + np.array([0.0, 0.0, 0.001 * k]))
        )
    return out


def write(path, frames, **options):
    with VtkHdfWriter(path, **options) as writer:
        for frame in frames:
            writer.append(frame)


class Reading:
    """All frames of a file by VTK."""

    def __init__(self, path):
        reason = "vtk is not installed: pip install shellcut[test]"
        hdf = pytest.importorskip("vtkmodules.vtkIOHDF", reason=reason)
        self.to_numpy = pytest.importorskip("vtkmodules.util.numpy_support").vtk_to_numpy
        self.reader = hdf.vtkHDFReader()
        self.reader.SetFileName(str(path))
        self.reader.UpdateInformation()
        self.n_frame = self.reader.GetNumberOfSteps()

    def frame(self, k):
        self.reader.SetStep(k)
        self.reader.Update()
        grid = self.reader.GetOutput()
        arrays = {"time": self.reader.GetTimeValue()}
        arrays["points"] = self.to_numpy(grid.GetPoints().GetData()).copy()
        cells = grid.GetCells()
        arrays["connectivity"] = self.to_numpy(cells.GetConnectivityArray()).copy()
        arrays["offsets"] = self.to_numpy(cells.GetOffsetsArray()).copy()
        arrays["types"] = np.array([grid.GetCellType(i) for i in range(grid.GetNumberOfCells())])
        for data in (grid.GetPointData(), grid.GetCellData(), grid.GetFieldData()):
            for i in range(data.GetNumberOfArrays()):
                arrays[data.GetArrayName(i)] = self.to_numpy(data.GetArray(i)).copy()
        return arrays


def assert_holds(got, frame):
    n_node, n_quad, n_segment = len(frame.points), len(frame.quads), len(frame.cable_segments)
    first_tool = n_node + 2 * n_segment
    assert got["time"] == frame.time
    for value in got.values():
        assert np.isfinite(value).all()
    ends = frame.cable_segments.reshape(-1, 3)
    points = np.concatenate((frame.points, ends, frame.tool_points))
    np.testing.assert_array_equal(got["points"], points.astype(np.float32))
    n_triangle = len(frame.tool_triangles)
    assert got["types"].tolist() == [9] * n_quad + [3] * n_segment + [5] * n_triangle
    np.testing.assert_array_equal(got["connectivity"][: 4 * n_quad], frame.quads.ravel())
    np.testing.assert_array_equal(
        got["connectivity"][4 * n_quad :],
        np.concatenate((np.arange(n_node, first_tool), frame.tool_triangles.ravel() + first_tool)),
    )
    assert got["offsets"][-1] == len(got["connectivity"])
    part = got["part"]
    np.testing.assert_array_equal(np.bincount(part, minlength=3), [n_quad, n_segment, n_triangle])
    for name, wanted in (
        ("displacement [mm]", frame.displacement),
        ("velocity [mm per s]", frame.velocity),
        ("director", frame.director),
    ):
        np.testing.assert_allclose(got[name][:n_node], wanted, rtol=ROUNDING, atol=1e-30)
        assert not got[name][n_node:].any()
    for name, p, wanted in (
        ("membrane stress [MPa]", MEMBRANE, frame.quad_stress),
        ("largest principal stress [MPa]", MEMBRANE, frame.quad_principal[:, 0]),
        ("smallest principal stress [MPa]", MEMBRANE, frame.quad_principal[:, 1]),
        ("traction [MPa]", CABLE, frame.cable_traction),
        ("cable state", CABLE, frame.cable_state),
    ):
        np.testing.assert_allclose(got[name][part == p], wanted, rtol=ROUNDING, atol=1e-30)
        assert not got[name][part != p].any()
    assert np.all(part[-n_triangle:] == TOOL)
    np.testing.assert_array_equal(got["angle [deg]"], [frame.coordinate])
    np.testing.assert_array_equal(got["torque [N*mm]"], [frame.scalars["torque"]])


def test_vtk_reads_every_frame_in_order_and_jumping_back(tmp_path):
    path = tmp_path / "run.vtkhdf"
    written = frames()
    write(path, written)
    reading = Reading(path)
    assert reading.n_frame == len(written)
    for k in (0, 1, 2, 3, 4, 5, 6, 1, 4, 0, 6):
        assert_holds(reading.frame(k), written[k])


def test_frames_with_the_same_cells_share_them(tmp_path):
    path = tmp_path / "run.vtkhdf"
    write(path, frames())
    with h5py.File(path) as file:
        assert file["VTKHDF/Steps/PartOffsets"][:].tolist() == [0, 0, 1, 1, 1, 2, 3]
        assert len(file["VTKHDF/NumberOfCells"]) == 4


def test_a_membrane_without_tool_and_with_an_awkward_unit(tmp_path):
    bare = {
        f.name: getattr(opening_frame(0.0, n_side=6), f.name)
        for f in dataclasses.fields(Frame)
        if not f.name.startswith(("tool", "edge", "cable", "crack", "scalar"))
    }
    frame = Frame(**bare, scalars={"speed": 6e3}, scalar_units={"speed": "mm/s"})
    write(tmp_path / "run.vtkhdf", [frame])
    got = Reading(tmp_path / "run.vtkhdf").frame(0)
    np.testing.assert_array_equal(got["speed [mm per s]"], [6e3])
    np.testing.assert_array_equal(got["connectivity"], frame.quads.ravel())


def test_a_continued_run_appends_and_drops_what_came_after_the_checkpoint(tmp_path):
    path = tmp_path / "run.vtkhdf"
    written = frames(10)
    write(path, written[:6])
    with VtkHdfWriter(path, mode="a", until=written[3].time) as writer:
        assert writer.n_frame == 4
        for frame in written[4:]:
            writer.append(frame)
    reading = Reading(path)
    assert reading.n_frame == len(written)
    for k in (9, *range(10)):
        assert_holds(reading.frame(k), written[k])


def test_dropping_everything_begins_anew(tmp_path):
    path = tmp_path / "run.vtkhdf"
    written = frames(3)
    write(path, written)
    write(path, written, mode="a", until=0.0)
    assert_holds(Reading(path).frame(2), written[2])


def test_a_foreign_file_is_not_appended_to(tmp_path):
    path = tmp_path / "other.h5"
    h5py.File(path, "w").close()
    with pytest.raises(ValueError, match="was not written by shellcut"):
        VtkHdfWriter(path, mode="a")


def test_frames_out_of_order_or_with_other_scalars_are_refused(tmp_path):
    first, second, *_ = frames(2)
    with VtkHdfWriter(tmp_path / "run.vtkhdf") as writer:
        writer.append(second)
        with pytest.raises(ValueError, match=r"in order of time, got 0.0001 s after 0.0002 s"):
            writer.append(first)
        later = dataclasses.replace(second, time=1.0, scalars={}, scalar_units={})
        with pytest.raises(ValueError, match="every frame must have the scalars"):
            writer.append(later)


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="needs kill -9")
@pytest.mark.parametrize("moment", ["_count", "write", "between frames"])
def test_a_killed_run_leaves_a_readable_file(tmp_path, moment):
    # Killed after 40 frames: when the next one is about to count, at its first data, or in peace.
    path = tmp_path / "run.vtkhdf"
    script = textwrap.dedent(f"""
        import dataclasses, os, signal, sys
        sys.path.insert(0, {str(Path(__file__).parent)!r})
        from opening_frame import opening_frame
        from shellcut.vtkhdf import VtkHdfWriter

        def kill(*_):
            os.kill(os.getpid(), signal.SIGKILL)

        frames = [opening_frame(a, n_side=10) for a in (20.0, 40.0)]
        writer = VtkHdfWriter({str(path)!r})
        for k in range(41):
            if k == 40:
                setattr(writer._columns if {moment!r} == "write" else writer, {moment!r}, kill)
            writer.append(dataclasses.replace(frames[k % 2], time=1.0 + k))
        kill()
    """)
    done = subprocess.run([sys.executable, "-c", script], check=False)
    assert done.returncode == -signal.SIGKILL
    n_frame = 41 if moment == "between frames" else 40
    frames = [opening_frame(angle, n_side=10) for angle in (20.0, 40.0)]
    reading = Reading(path)
    assert reading.n_frame == n_frame
    for k in range(n_frame):
        assert_holds(reading.frame(k), dataclasses.replace(frames[k % 2], time=1.0 + k))
    last = dataclasses.replace(frames[0], time=1e9)
    write(path, [last], mode="a")
    assert_holds(Reading(path).frame(n_frame), last)
