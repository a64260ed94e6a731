"""PVD + VTU as VTK's own reader sees them, also after a kill -9 and after a restart."""

import dataclasses
import os
import signal
import subprocess
import sys
import textwrap
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from opening_frame import opening_frame
from shellcut.results.frame_grid import grid_of
from shellcut.results.pvd import PvdWriter


def frames(n=4):
    return [opening_frame(25.0 * k, n_side=8, time=1e-4 * (k + 1)) for k in range(n)]


def listed(path):
    """Times and files of a list; the files are there."""
    rows = ElementTree.parse(path).getroot().findall("Collection/DataSet")
    files = [path.parent / row.get("file") for row in rows]
    assert all(file.exists() for file in files)
    return [float(row.get("timestep")) for row in rows], files


def assert_holds(file, frame):
    reason = "vtk is not installed: pip install shellcut[test]"
    xml = pytest.importorskip("vtkmodules.vtkIOXML", reason=reason)
    to_numpy = pytest.importorskip("vtkmodules.util.numpy_support").vtk_to_numpy
    reader = xml.vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(file))
    reader.Update()
    got, wanted = reader.GetOutput(), grid_of(frame)
    np.testing.assert_array_equal(to_numpy(got.GetPoints().GetData()), wanted.points)
    ids = to_numpy(got.GetCells().GetConnectivityArray())
    np.testing.assert_array_equal(ids, wanted.connectivity)
    types = [got.GetCellType(i) for i in range(got.GetNumberOfCells())]
    assert types == wanted.types.tolist()
    for data, arrays in (
        (got.GetPointData(), wanted.point_arrays),
        (got.GetCellData(), wanted.cell_arrays),
    ):
        assert data.GetNumberOfArrays() == len(arrays)
        for name, rows in arrays.items():
            np.testing.assert_array_equal(to_numpy(data.GetArray(name)), rows, err_msg=name)


def test_vtk_reads_every_frame(tmp_path):
    path, written = tmp_path / "run.pvd", frames()
    with PvdWriter(path) as writer:
        for k, frame in enumerate(written):
            writer.append(frame)
            assert len(listed(path)[0]) == k + 1  # whole after each frame
        assert writer.n_frame == 4
    times, files = listed(path)
    assert times == [frame.time for frame in written]
    for file, frame in zip(files, written, strict=True):
        assert_holds(file, frame)


def test_a_continued_run_appends_and_drops_what_came_after_the_checkpoint(tmp_path):
    path, written = tmp_path / "run.pvd", frames()
    with PvdWriter(path) as writer:
        for frame in written[:3]:
            writer.append(frame)
    with PvdWriter(path, mode="a", until=written[1].time) as writer:
        assert writer.n_frame == 2
        assert sorted(os.listdir(tmp_path / "run_frames")) == ["frame_0000.vtu", "frame_0001.vtu"]
        with pytest.raises(ValueError, match=r"in order of time, got 0.0001 s after 0.0002 s"):
            writer.append(written[0])
        writer.append(written[3])
    times, files = listed(path)
    assert times == [written[k].time for k in (0, 1, 3)]
    assert_holds(files[2], written[3])
    PvdWriter(path).close()
    assert listed(path) == ([], [])
    assert os.listdir(tmp_path / "run_frames") == []


@pytest.mark.parametrize(
    "text",
    [
        "no XML",
        '<VTKFile><Collection><DataSet timestep="0" file="other.vtu"/></Collection></VTKFile>',
    ],
)
def test_a_foreign_list_is_not_appended_to(tmp_path, text):
    (tmp_path / "run.pvd").write_text(text)
    with pytest.raises(ValueError, match="was not written by shellcut"):
        PvdWriter(tmp_path / "run.pvd", mode="a")


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="needs kill -9")
@pytest.mark.parametrize("killer", ["meshio.Mesh.write", "os.replace"])
def test_a_killed_run_leaves_a_list_of_whole_frames(tmp_path, killer):
    # Killed at the third frame, while it is written and before it gets its name.
    path = tmp_path / "run.pvd"
    script = textwrap.dedent(f"""
        import os, signal, sys, meshio, pathlib
        sys.path.insert(0, {str(Path(__file__).parent)!r})
        from test_pvd import PvdWriter, frames

        def kill(*_, **__):
            os.kill(os.getpid(), signal.SIGKILL)

        first, second, third, _ = frames()
        writer = PvdWriter({str(path)!r})
        writer.append(first)
        writer.append(second)
        {killer} = kill
        writer.append(third)
    """)
    done = subprocess.run([sys.executable, "-c", script], check=False)
    assert done.returncode == -signal.SIGKILL
    times, files = listed(path)
    written = frames()
    assert times == [frame.time for frame in written[:2]]
    assert_holds(files[1], written[1])
    with PvdWriter(path, mode="a") as writer:
        writer.append(dataclasses.replace(written[2], time=1.0))
    assert [file.name for file in (tmp_path / "run_frames").iterdir() if "part" in file.name] == []
