"""The VTKHDF file as VTK's own reader sees it, also after a kill -9 and after a restart."""

import dataclasses
import gc
import signal
import subprocess
import sys
from contextlib import closing
from pathlib import Path
from unittest.mock import Mock

import h5py
import numpy as np
import pytest

import shellcut
from damaged.mutations import mutated
from opening_frame import opening_frame
from shellcut.files.hdf_target import HdfTarget
from shellcut.frame import Frame
from shellcut.results import vtkhdf
from shellcut.results.frame_grid import (
    CABLE,
    CELL_ARRAYS,
    EDGE,
    FLANK,
    KEPT_BITS,
    MEMBRANE,
    TOOL,
    grid_of,
    series_of,
)
from shellcut.results.hdf_columns import Columns
from shellcut.results.run_results import read
from shellcut.results.vtkhdf import VtkHdfWriter
from shellcut.results.vtkhdf_reader import ResultFileError, VtkHdfReader

ROUNDING = 2.0 ** -(KEPT_BITS + 1)  # half of the last bit that is kept


def frames(n=7):
    # Angle 0 twice and three times the same angle: the cells stay, the positions do not.
    angles = [0.0, 0.0, 20.0, 20.0, 20.0, 32.0, 45.0, 60.0, 61.0, 62.0][:n]
    out = [opening_frame(angle, n_side=10, time=1e-4 * k) for k, angle in enumerate(angles, 1)]
    up = np.array([0.0, 0.0, 0.001])
    return [dataclasses.replace(frame, points=frame.points + k * up) for k, frame in enumerate(out)]


def write(path, frames, **options):
    with closing(VtkHdfWriter(path, **options)) as writer:
        for frame in frames:
            writer.append(frame)


class Reading:
    """All frames of a file by VTK."""

    def __init__(self, path):
        reason = "vtk is not installed: pip install 'shellcut-fem[test]'"
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
    n_triangle, n_edge = len(frame.tool_triangles), len(frame.edge_points)
    first_tool = n_node + 2 * n_segment
    first_edge = first_tool + len(frame.tool_points)
    assert got["time"] == frame.time
    for value in got.values():
        assert np.isfinite(value).all()
    cables, edges = frame.cable_segments.reshape(-1, 3), frame.edge_points.reshape(-1, 3)
    points = np.concatenate((frame.points, cables, frame.tool_points, edges))
    np.testing.assert_array_equal(got["points"], points.astype(np.float32))
    n_line = 2 * len(frame.crack_edges) + n_edge
    types = [9] * n_quad + [3] * n_segment + [5] * n_triangle + [3] * n_line
    assert got["types"].tolist() == types
    ids = (
        frame.quads.ravel(),
        np.arange(n_node, first_tool),
        frame.tool_triangles.ravel() + first_tool,
        frame.crack_edges.ravel(),
        np.arange(first_edge, first_edge + 2 * n_edge),
    )
    np.testing.assert_array_equal(got["connectivity"], np.concatenate(ids))
    assert got["offsets"][-1] == len(got["connectivity"])
    part = got["part"]
    counts = [n_quad, n_segment, n_triangle, n_line - n_edge, n_edge]
    assert part.tolist() == np.repeat([MEMBRANE, CABLE, TOOL, FLANK, EDGE], counts).tolist()
    membrane, cable, tool = part == MEMBRANE, part == CABLE, np.isin(part, [TOOL, EDGE])
    of_film = np.arange(len(points)) < n_node
    wanted = {
        "displacement [mm]": (of_film, frame.displacement),
        "velocity [mm per s]": (of_film, frame.velocity),
        "director": (of_film, frame.director),
        "held": (of_film, frame.held),
        "membrane stress [MPa]": (membrane, frame.quad_stress),
        "top stress [MPa]": (membrane, frame.quad_stress_top),
        "bottom stress [MPa]": (membrane, frame.quad_stress_bottom),
        "thickness [mm]": (membrane, frame.quad_thickness),
        "traction [MPa]": (cable, frame.cable_traction),
        "opening [mm]": (cable, frame.cable_opening),
        "cable state": (cable, frame.cable_state),
        "tooth": (tool, np.concatenate((frame.tool_tooth, frame.edge_tooth))),
    }
    for of, where in (("", ""), ("_top", ", top"), ("_bottom", ", bottom")):
        principal = getattr(frame, f"quad_principal{of}")
        for k, size in enumerate(("largest", "smallest")):
            wanted[f"{size} principal stress{where} [MPa]"] = membrane, principal[:, k]
    for name, (there, values) in wanted.items():
        np.testing.assert_allclose(got[name][there], values, rtol=ROUNDING, atol=1e-30)
        assert not got[name][~there].any()
    assert got["angle [deg]"] == [frame.coordinate]
    assert got["torque [N*mm]"] == [frame.scalars["torque"]]


def assert_same(got, frame):
    """A frame read back is the one written, within the bits that are kept."""
    for field in dataclasses.fields(Frame):
        a, b = getattr(got, field.name), getattr(frame, field.name)
        if field.name in ("points", "cable_segments", "tool_points", "edge_points"):
            np.testing.assert_array_equal(a, b.astype(np.float32), err_msg=field.name)
        elif field.name == "reference":  # points minus displacement
            error = np.spacing(np.float32(20.0)) + ROUNDING * np.abs(frame.displacement)
            assert (np.abs(a - b) <= error).all()
        elif isinstance(b, np.ndarray) and b.dtype == float and "tool" not in field.name:
            np.testing.assert_allclose(a, b, rtol=ROUNDING, atol=1e-30, err_msg=field.name)
        elif isinstance(b, np.ndarray):
            np.testing.assert_array_equal(a, b, err_msg=field.name)
        else:
            assert a == b, field.name


def test_an_array_that_came_later_is_left_out_of_older_files(tmp_path, monkeypatch):
    (frame,), name, path = frames(1), "thickness [mm]", tmp_path / "older.vtkhdf"
    older = {array: kind for array, kind in CELL_ARRAYS.items() if array != name}
    with monkeypatch.context() as context:
        for module in ("frame_grid", "vtkhdf"):
            context.setattr(f"shellcut.results.{module}.CELL_ARRAYS", older)
        context.delitem(vtkhdf._COLUMNS, f"CellData/{name}")
        write(path, [frame])
    without = dataclasses.replace(frame, quad_thickness=np.zeros(len(frame.quads)))
    assert_same(VtkHdfReader(path).frame(0), without)
    with pytest.raises(ValueError, match="by an older version"):  # to go on it needs all of them
        VtkHdfWriter(path, until=np.inf)


def test_frames_are_read_back_as_they_were_written(tmp_path):
    path = tmp_path / "run.vtkhdf"
    written = frames()
    with closing(VtkHdfWriter(path)) as writer:
        for frame in written[:4]:
            writer.append(frame)
        early = VtkHdfReader(path)  # while the run still writes
        writer.append(written[4])
        for k in range(4):
            assert_same(early.frame(k), written[k])
        assert early.n_frame == 4
        reading = VtkHdfReader(path)
    assert reading.n_frame == 5
    assert reading.times.tolist() == [frame.time for frame in written[:5]]
    assert reading.coordinates.tolist() == [frame.coordinate for frame in written[:5]]
    for k in (-1, 0, 3, -5):
        assert_same(reading.frame(k), written[:5][k])
    rotation, translation = reading.pose(-1)
    np.testing.assert_array_equal(rotation, written[4].tool_rotation)
    np.testing.assert_array_equal(translation, written[4].tool_translation)
    for k in (5, -6):
        with pytest.raises(IndexError, match=rf"run.vtkhdf, 0 to 4, got {k}"):
            reading.frame(k)


def test_frames_with_the_same_cells_share_them_and_vtk_reads_them_in_any_order(tmp_path):
    path, written = tmp_path / "run.vtkhdf", frames()
    write(path, written)
    with h5py.File(path) as file:
        assert file["shellcut"].attrs["version"] == shellcut.__version__
        assert file["VTKHDF/Steps/PartOffsets"][:].tolist() == [0, 0, 1, 1, 1, 2, 3]
        assert len(file["VTKHDF/NumberOfCells"]) == 4
    reading = Reading(path)
    assert reading.n_frame == len(written)
    for k in (0, 1, 2, 3, 4, 5, 6, 1, 4, 0, 6):
        assert_holds(reading.frame(k), written[k])


def test_a_foreign_or_damaged_file_is_neither_read_nor_appended_to(tmp_path):
    (tmp_path / "text.vtkhdf").write_text("no HDF5 at all")
    with pytest.raises(ValueError, match=r"text.vtkhdf must be a complete result file of shellcut"):
        VtkHdfReader(tmp_path / "text.vtkhdf")
    path = tmp_path / "other.vtkhdf"
    h5py.File(path, "w").close()
    with pytest.raises(ValueError, match="was not written by shellcut"):
        VtkHdfReader(path)
    with pytest.raises(ValueError, match="was not written by shellcut"):
        VtkHdfWriter(path, until=np.inf)


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
    assert series_of(frame) == {"time [s]": 0.0, "angle [deg]": 0.0, "speed [mm per s]": 6e3}
    assert_same(VtkHdfReader(tmp_path / "run.vtkhdf").frame(0), frame)
    assert VtkHdfReader(tmp_path / "run.vtkhdf").pose(0) is None
    np.testing.assert_array_equal(got["connectivity"], frame.quads.ravel())


def test_a_continued_run_appends_and_drops_what_came_after_the_checkpoint(tmp_path):
    path = tmp_path / "run.vtkhdf"
    written = frames(10)
    write(path, written[:6])
    with closing(VtkHdfWriter(path, until=written[3].time)) as writer:
        assert writer.n_frame == 4
        for frame in written[4:]:
            writer.append(frame)
    reading = Reading(path)
    assert reading.n_frame == len(written)
    for k in (9, *range(10)):
        assert_holds(reading.frame(k), written[k])
        assert_same(VtkHdfReader(path).frame(k), written[k])
    # Frames 2 to 4 share their cells, so the file goes on within them.
    write(tmp_path / "whole.vtkhdf", written)
    with h5py.File(path) as one, h5py.File(tmp_path / "whole.vtkhdf") as whole:

        def compare(name, item):
            if isinstance(item, h5py.Dataset):
                np.testing.assert_array_equal(one[name], item, err_msg=name)

        whole.visititems(compare)
    write(path, written[:3], until=-np.inf)  # anew
    assert_holds(Reading(path).frame(2), written[2])
    assert VtkHdfReader(path).n_frame == 3
    with pytest.raises(ValueError, match="must reach to the checkpoint"):
        VtkHdfWriter(path, until=written[4].time)


def test_after_a_frame_that_failed_the_next_one_is_whole(tmp_path, monkeypatch):
    # Both have the same new cells; those of the failed one must not be taken for written.
    before, failed, after = frames(4)[1:]
    path = tmp_path / "run.vtkhdf"
    with closing(VtkHdfWriter(path)) as writer:
        writer.append(before)
        with monkeypatch.context() as patch:
            patch.setattr(Columns, "write", Mock(side_effect=OSError("disk full")))
            with pytest.raises(OSError, match="disk full"):
                writer.append(failed)
        writer.append(after)
    assert_same(VtkHdfReader(path).frame(-1), after)


KILLED = """
import dataclasses, os, signal, sys
from opening_frame import opening_frame
from shellcut.results.hdf_columns import Columns
from shellcut.results.vtkhdf import VtkHdfWriter

def kill(*_, **__):
    os.kill(os.getpid(), signal.SIGKILL)

frame, writer = opening_frame(20.0, n_side=10), VtkHdfWriter(sys.argv[1])
for k in range(40):
    writer.append(dataclasses.replace(frame, time=1.0 + k))
if sys.argv[2] == "at its first data":
    Columns.write = kill
    writer.append(dataclasses.replace(frame, time=41.0))
kill()
"""


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="needs kill -9")
@pytest.mark.parametrize("moment", ["at its first data", "between frames"])
def test_a_run_killed_after_frames_leaves_them_readable(tmp_path, moment):
    path = tmp_path / "run.vtkhdf"
    command = [sys.executable, "-c", KILLED, path, moment]
    assert subprocess.run(command, cwd=Path(__file__).parent).returncode == -signal.SIGKILL
    frame = opening_frame(20.0, n_side=10)
    reading = Reading(path)
    assert VtkHdfReader(path).n_frame == reading.n_frame == 40
    for k in (0, 39):
        assert_holds(reading.frame(k), dataclasses.replace(frame, time=1.0 + k))
    del reading  # VTK 9.4 shows what it had open
    write(path, [dataclasses.replace(frame, time=1e9)], until=np.inf)
    assert_holds(Reading(path).frame(40), dataclasses.replace(frame, time=1e9))


def test_twelve_bits_are_kept_to_nearest():
    frame = opening_frame(0.0, n_side=2)
    stress = np.random.default_rng(1).normal(size=frame.quad_stress.shape) * 10.0
    *_, on_cells = grid_of(dataclasses.replace(frame, quad_stress=stress))
    kept = on_cells["membrane stress [MPa]"][: len(stress)]
    error = np.abs(kept / stress - 1.0).max()
    # Half of the last bit, and next to all of it where there are so many.
    assert 0.8 * 2.0 ** -(KEPT_BITS + 1) < error <= 2.0 ** -(KEPT_BITS + 1)
    assert not (kept.view(np.int32) & ((1 << (23 - KEPT_BITS)) - 1)).any()


# --- a result file that is not what was written is refused; damage is never read as other numbers


@pytest.fixture(autouse=True)
def _no_waiting(monkeypatch):
    """No run writes these files."""
    monkeypatch.setattr("shellcut.results.vtkhdf_reader._TICK_S", 0.0)
    monkeypatch.setattr("shellcut.results.vtkhdf_reader._HELD_UP_S", 0.0)


@pytest.fixture(scope="module")
def sound(tmp_path_factory):
    path = tmp_path_factory.mktemp("sound") / "run.vtkhdf"
    write(path, frames(5))
    return path


def numbers(reader):
    """Return every number and text that a reader gives, as bytes by name."""
    held = {
        "times": reader.times,
        "coordinates": reader.coordinates,
        "coordinate": f"{reader.coordinate_name} {reader.coordinate_unit}",
    }
    for k in range(reader.n_frame):
        frame, pose = reader.frame(k), reader.pose(k)
        held |= {f"{k} {f.name}": getattr(frame, f.name) for f in dataclasses.fields(Frame)}
        held |= {f"{k} pose {i}": part for i, part in enumerate(pose or ())}
    return {n: v.tobytes() if isinstance(v, np.ndarray) else repr(v) for n, v in held.items()}


def test_no_damage_is_read_as_other_numbers(tmp_path):
    # so many points that they are left unpacked: nothing but the checksums guards them
    path, rng = tmp_path / "run.vtkhdf", np.random.default_rng(250)
    write(path, [opening_frame(angle, n_side=46, time=1e-3 * angle) for angle in (20.0, 40.0)])
    content, right = path.read_bytes(), numbers(VtkHdfReader(path))
    refused = 0
    for _ in range(40):
        damaged, way = mutated(rng, content, text=False)
        path.write_bytes(damaged)
        try:
            found = numbers(VtkHdfReader(path))
        except ResultFileError:
            refused += 1
            continue
        other = [name for name, value in found.items() if value != right.get(name)]
        assert (other, len(found)) == ([], len(right)), way
    assert refused > 15  # the rest hits what is not read: filling, names and links for VTK


def other_unit(file):
    names = list(file["shellcut"].attrs["scalar_units"])
    file["shellcut"].attrs["scalar_units"] = ["N" if n == "N*mm" else n for n in names]


def of_frame_3(name):
    def change(file):
        file[f"VTKHDF/Steps/{name}"][3] += 1

    return change


@pytest.mark.parametrize(
    ("change", "frame"),
    [
        (of_frame_3("Values"), 3),
        (of_frame_3("CellOffsets"), 3),
        (of_frame_3("PointOffsets"), 3),
        (other_unit, 0),
    ],
)
def test_every_place_of_the_rows_their_names_and_units_are_covered(sound, tmp_path, change, frame):
    path = tmp_path / "run.vtkhdf"
    path.write_bytes(sound.read_bytes())
    with h5py.File(path, "r+") as file:
        change(file)
    with pytest.raises(ResultFileError, match=f"or pose of frame {frame} are not what was written"):
        VtkHdfReader(path)
    with pytest.raises(ValueError, match="is damaged; start anew"):
        VtkHdfWriter(path, until=np.inf)


def test_frames_lost_or_damaged_are_named(sound, tmp_path):
    path = tmp_path / "run.vtkhdf"
    path.write_bytes(sound.read_bytes())
    with h5py.File(path, "r+") as file:
        begin = file["VTKHDF/Steps/PointOffsets"][2]
        file["VTKHDF/PointData/director"][begin + 5, 1] += 1e-3
    results = read(path)
    assert results.frame(1).time < results.frame(3).time
    with pytest.raises(ResultFileError, match="the arrays of frame 2 are not what was written"):
        results.frame(2)
    with h5py.File(path, "r+") as file:
        file["VTKHDF/Steps"].attrs["NSteps"] = 4
    with pytest.raises(ResultFileError, match="it counts 4 frames and has 5"):
        VtkHdfReader(path)
    with h5py.File(path, "r+") as file:  # as a killed run leaves it
        file["shellcut"].attrs["n_frame"] = -1
    assert VtkHdfReader(path).n_frame == 4


def test_a_flipped_bit_is_refused_by_other_readers_too(sound, tmp_path, capfd):
    path = tmp_path / "run.vtkhdf"
    with h5py.File(sound) as file:
        places = {
            name: file[f"VTKHDF/{name}"].id.get_chunk_info(0).byte_offset
            for name in ("Points", "Connectivity", "CellData/membrane stress [MPa]")
        }
    for name, place in places.items():
        content = bytearray(sound.read_bytes())
        content[place + 60] ^= 4
        path.write_bytes(content)
        with h5py.File(path) as file, pytest.raises(OSError, match=r"[Cc]an't .*read"):
            file[f"VTKHDF/{name}"][:]
    content = bytearray(sound.read_bytes())
    content[places["Points"] + 60] ^= 64
    path.write_bytes(content)
    reader = Reading(path).reader
    reader.SetStep(0)
    reader.Update()
    points = reader.GetOutput().GetPoints()
    assert points is None or points.GetNumberOfPoints() == 0
    assert "ERR" in capfd.readouterr().err


def test_ctrl_c_while_hdf5_writes_is_answered_when_it_has_written(tmp_path, monkeypatch):
    write = HdfTarget.write

    def interrupted(target, data):
        signal.raise_signal(signal.SIGINT)
        return write(target, data)

    monkeypatch.setattr(HdfTarget, "write", interrupted)
    former = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(KeyboardInterrupt):
            VtkHdfWriter(tmp_path / "run.vtkhdf")
    finally:
        signal.signal(signal.SIGINT, former)
    monkeypatch.undo()
    gc.collect()
    with h5py.File(tmp_path / "run.vtkhdf") as file:
        assert file["VTKHDF"].attrs["Type"] == b"UnstructuredGrid"
