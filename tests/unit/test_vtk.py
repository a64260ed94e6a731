"""VTK files, written by VTK itself and by meshio; arrays as groups; counts."""

import base64
import struct
import zlib

import meshio
import numpy as np
import pytest

from known_film import LEFT, NODES, QUADS, RIGHT_PART, check_film
from shellcut.formats.errors import FileError
from shellcut.mesh.film_file import read_film

LEFT_MASK = np.isin(np.arange(18), LEFT).astype(np.int32)
RIGHT_MASK = np.isin(np.arange(10), RIGHT_PART).astype(np.int32)


def write_by_vtk(path, *, mode="Binary", compressor="ZLib", polygons=False):
    vtk = pytest.importorskip("vtk")
    from vtk.util.numpy_support import numpy_to_vtk

    grid = vtk.vtkPolyData() if polygons else vtk.vtkUnstructuredGrid()
    points = vtk.vtkPoints()
    points.SetDataTypeToDouble()
    for xyz in NODES:
        points.InsertNextPoint(xyz)
    grid.SetPoints(points)
    cells = vtk.vtkCellArray()
    for quad in QUADS.tolist():
        cells.InsertNextCell(4, quad)
    if polygons:
        grid.SetPolys(cells)
    else:
        grid.SetCells(vtk.VTK_QUAD, cells)
    for data, name, values in (
        (grid.GetPointData(), "left", LEFT_MASK),
        (grid.GetPointData(), "temperature", NODES[:, 0]),
        (grid.GetCellData(), "right part", RIGHT_MASK),
        (grid.GetCellData(), "part", 3 + RIGHT_MASK),
    ):
        array = numpy_to_vtk(values, deep=True)
        array.SetName(name)
        data.AddArray(array)
    kind = "PolyData" if polygons else "UnstructuredGrid"
    if path.suffix == ".vtk":
        writer = getattr(vtk, f"vtk{kind}Writer")()
        writer.SetFileVersion(42 if mode in ("Binary", "Ascii") else 51)
        getattr(writer, "SetFileTypeToASCII" if "Ascii" in mode else "SetFileTypeToBinary")()
    else:
        writer = getattr(vtk, f"vtkXML{kind}Writer")()
        getattr(writer, f"SetDataModeTo{mode.removeprefix('Raw')}")()
        writer.SetEncodeAppendedData(mode != "RawAppended")
        getattr(writer, f"SetCompressorTypeTo{compressor}")()
    writer.SetFileName(str(path))
    writer.SetInputData(grid)
    assert writer.Write() == 1


@pytest.mark.parametrize(
    ("name", "mode", "compressor"),
    [
        ("film.vtu", "Binary", "ZLib"),
        ("film.vtu", "Ascii", "None"),
        ("film.vtu", "Appended", "LZ4"),
        ("film.vtu", "RawAppended", "LZMA"),
        ("film.vtp", "RawAppended", "None"),
        ("film.vtp", "Binary", "LZ4"),
        ("film.vtk", "Binary", ""),
        ("film.vtk", "Ascii", ""),
        ("film.vtk", "Binary of version 5", ""),
        ("polygons.vtk", "Binary", ""),
        ("polygons.vtk", "Ascii of version 5", ""),
    ],
)
def test_a_grid_written_by_vtk(tmp_path, name, mode, compressor, caplog):
    path = tmp_path / name
    polygons = name.endswith("p") or name.startswith("p")
    write_by_vtk(path, mode=mode, compressor=compressor, polygons=polygons)
    if not name.endswith("k"):  # the version changes nothing for cells like these
        path.write_bytes(path.read_bytes().replace(b'version="1.0"', b'version="2.2"', 1))
    # the legacy format writes %20 for a blank
    blank = "%20" if name.endswith("k") else " "
    mesh = read_film(path, unit="mm")
    check_film(mesh, right_part=f"right{blank}part")
    assert list(mesh.node_sets) == ["left"]  # a temperature is no group
    assert "1 array 'temperature'" in caplog.text
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
        with pytest.raises(FileError, match=r"it is no XML|it must begin with # vtk"):
            read_film(path)


def test_pieces_are_one_film(tmp_path, caplog):
    def array(name, values, kind="Int64", n=1):
        text = " ".join(map(str, np.ravel(values)))
        head = f'Name="{name}" type="{kind}" NumberOfComponents="{n}" format="ascii"'
        return f"<DataArray {head}>{text}</DataArray>"

    def piece(x, marks):
        points = array("Points", [[x, 0, 0], [x + 3, 0, 0], [x + 3, 3, 0], [x, 3, 0]], "Float32", 3)
        cells = array("connectivity", range(4)) + array("offsets", [4]) + array("types", [9])
        return (
            f'<Piece NumberOfPoints="4" NumberOfCells="1"><Points>{points}</Points><Cells>{cells}'
            f"</Cells><PointData>{array('left', [1, 0, 0, 1])}{marks}</PointData></Piece>"
        )

    pieces = piece(0, array("odd", [1, 0, 0, 0])) + piece(3, "")
    path = tmp_path / "film.vtu"
    path.write_text(
        '<VTKFile type="UnstructuredGrid" version="2.2"><UnstructuredGrid><FieldData>'
        f"{array('t', [1])}</FieldData>{pieces}</UnstructuredGrid></VTKFile>"
    )
    mesh = read_film(path, unit="mm", merge=1e-6)
    assert (mesh.n_quad, mesh.n_node, len(mesh.node_set("left"))) == (2, 6, 4)
    assert "sets only: 1 array 'odd', 1 arrays of the field data" in caplog.text


def test_what_data_unpack_to_is_counted_first(tmp_path):
    """A block of 3 GB in 3 MB would fill the memory; here it says so in its head only."""
    head = base64.b64encode(struct.pack("<4I", 1, 3_000_000_000, 0, 8))
    data = base64.b64encode(zlib.compress(b""))
    array = f'<DataArray type="Float64" NumberOfComponents="3" format="binary">{head.decode()}'
    path = tmp_path / "film.vtu"
    path.write_text(
        '<VTKFile type="UnstructuredGrid" compressor="vtkZLibDataCompressor"><UnstructuredGrid>'
        f'<Piece NumberOfPoints="4" NumberOfCells="1"><Points>{array}{data.decode()}</DataArray>'
        "</Points></Piece></UnstructuredGrid></VTKFile>"
    )
    with pytest.raises(FileError, match="2,000,000,000 bytes unpacked at most, got 3,000,000,000"):
        read_film(path)


@pytest.mark.parametrize("how", ["ASCII", "BINARY"])
def test_more_declared_than_the_file_has_room_for(tmp_path, how):
    path = tmp_path / "film.vtk"
    head = f"# vtk DataFile Version 3.0\nx\n{how}\nDATASET POLYDATA\n"
    path.write_text(f"{head}POINTS 1000000000000 double\n1 2 3\n")
    with pytest.raises(FileError, match="POINTS: 3,000,000,000,000 numbers are declared, and ther"):
        read_film(path)
