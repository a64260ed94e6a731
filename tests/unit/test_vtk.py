"""VTK files, written by VTK itself and by meshio; arrays as groups; counts."""

import meshio
import numpy as np
import pytest

from known_film import LEFT, NODES, QUADS, RIGHT_PART, check_film
from shellcut.formats.errors import FileError
from shellcut.mesh.film_file import read_film

LEFT_MASK = np.isin(np.arange(18), LEFT).astype(np.int32)
RIGHT_MASK = np.isin(np.arange(10), RIGHT_PART).astype(np.int32)


def write_by_vtk(path, *, mode="Binary"):
    vtk = pytest.importorskip("vtk")
    from vtk.util.numpy_support import numpy_to_vtk

    grid = vtk.vtkUnstructuredGrid()
    points = vtk.vtkPoints()
    points.SetDataTypeToDouble()
    for xyz in NODES:
        points.InsertNextPoint(xyz)
    grid.SetPoints(points)
    for quad in QUADS.tolist():
        grid.InsertNextCell(vtk.VTK_QUAD, 4, quad)
    for data, name, values in (
        (grid.GetPointData(), "left", LEFT_MASK),
        (grid.GetPointData(), "temperature", NODES[:, 0]),
        (grid.GetCellData(), "right part", RIGHT_MASK),
        (grid.GetCellData(), "part", 3 + RIGHT_MASK),
    ):
        array = numpy_to_vtk(values, deep=True)
        array.SetName(name)
        data.AddArray(array)
    if path.suffix == ".vtu":
        writer = vtk.vtkXMLUnstructuredGridWriter()
        getattr(writer, f"SetDataModeTo{mode}")()
    else:
        writer = vtk.vtkUnstructuredGridWriter()
        writer.SetFileVersion(42)
        getattr(writer, "SetFileTypeToBinary" if mode == "Binary" else "SetFileTypeToASCII")()
    writer.SetFileName(str(path))
    writer.SetInputData(grid)
    assert writer.Write() == 1


@pytest.mark.parametrize(
    ("name", "mode"),
    [
        ("film.vtu", "Binary"),
        ("film.vtu", "Ascii"),
        ("film.vtu", "Appended"),
        ("film.vtk", "Binary"),
        ("film.vtk", "Ascii"),
    ],
)
def test_a_grid_written_by_vtk(tmp_path, name, mode):
    write_by_vtk(tmp_path / name, mode=mode)
    # the legacy format writes %20 for a blank
    blank = " " if name.endswith("u") else "%20"
    mesh = read_film(tmp_path / name, unit="mm")
    check_film(mesh, right_part=f"right{blank}part")
    assert list(mesh.node_sets) == ["left"]  # a temperature is no group
    assert len(mesh.quad_set("part_3")) + len(mesh.quad_set("part_4")) == 10


@pytest.mark.parametrize("suffix", [".vtu", ".vtk"])
def test_a_grid_written_by_meshio(tmp_path, suffix):
    path = tmp_path / f"film{suffix}"
    mesh = meshio.Mesh(
        NODES,
        {"quad": QUADS},
        point_data={"left": LEFT_MASK},
        cell_data={"right_part": [RIGHT_MASK]},
    )
    mesh.write(path)
    check_film(read_film(path, unit="mm"), right_part="right_part")


def test_other_counts_than_declared_are_refused(tmp_path):
    path = tmp_path / "film.vtk"
    write_by_vtk(path, mode="Ascii")
    text = path.read_text()
    path.write_text(text.replace("POINTS 18", "POINTS 17"))
    with pytest.raises(FileError):
        read_film(path)
    path.write_text(text[: len(text) // 3])
    with pytest.raises(FileError):
        read_film(path)


def test_cells_beyond_the_points_are_refused(tmp_path):
    path = tmp_path / "film.vtu"
    meshio.Mesh(NODES[:-1], {"quad": QUADS}).write(path)
    with pytest.raises(FileError, match="name existing points"):
        read_film(path)


def test_no_vtk_file_is_refused(tmp_path):
    for suffix in (".vtu", ".vtk"):
        path = tmp_path / f"film{suffix}"
        path.write_text("hello\n")
        with pytest.raises(FileError, match="cannot read it"):
            read_film(path)
