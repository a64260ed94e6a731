"""VTK files, written by VTK itself and by meshio; arrays as groups; counts."""

import re
import sys

import meshio
import numpy as np
import pytest

from damaged.mutations import mutated
from known_film import LEFT, NODES, QUADS, RIGHT_PART, check_film
from other_script import run_instead
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
        getattr(writer, f"SetDataModeTo{mode.split()[0].removeprefix('Raw')}")()
        writer.SetEncodeAppendedData(mode != "RawAppended")
        if "BigEndian" in mode:
            writer.SetByteOrderToBigEndian()
        getattr(writer, f"SetCompressorTypeTo{compressor}")()
    writer.SetFileName(str(path))
    writer.SetInputData(grid)
    assert writer.Write() == 1
    if "version 2" in mode:  # it changes nothing for cells like these
        content = path.read_bytes()
        path.write_bytes(re.sub(rb'version="[01].[01]" byte', b'version="2.2" byte', content))


@pytest.mark.parametrize(
    ("name", "mode", "compressor", "by_vtk"),
    [
        ("film.vtu", "Binary", "ZLib", False),
        ("film.vtu", "Ascii", "None", False),
        ("film.vtu", "Appended of BigEndian", "LZMA", False),
        ("film.vtu", "RawAppended", "ZLib", False),
        ("film.vtu", "Binary of version 2", "ZLib", True),
        ("film.vtu", "Appended", "LZ4", True),
        ("film.vtp", "RawAppended", "None", True),
        ("film.vtp", "Binary", "LZ4", True),
        ("film.vtk", "Binary", "", False),
        ("film.vtk", "Ascii", "", False),
        ("film.vtk", "Binary of version 5", "", True),
        ("polygons.vtk", "Binary", "", True),
        ("polygons.vtk", "Ascii of version 5", "", True),
    ],
)
def test_a_grid_written_by_vtk(tmp_path, name, mode, compressor, by_vtk, caplog, monkeypatch):
    path = tmp_path / name
    polygons = name.endswith("p") or name.startswith("p")
    write_by_vtk(path, mode=mode, compressor=compressor, polygons=polygons)
    mesh = read_film(path, unit="mm")
    check_film(mesh, right_part="right part")
    assert list(mesh.node_sets) == ["left"]  # a temperature is no group
    assert "1 array 'temperature'" in caplog.text
    assert len(mesh.quad_set("part_3")) + len(mesh.quad_set("part_4")) == 10
    monkeypatch.setitem(sys.modules, "vtkmodules", None)
    if by_vtk:
        with pytest.raises(FileError, match=r"meshio cannot read it: .*'shellcut\[vtk\]'"):
            read_film(path, unit="mm")
    else:
        assert np.array_equal(read_film(path, unit="mm").quads, mesh.quads)


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
    pytest.importorskip("vtk")
    for suffix in (".vtu", ".vtk"):
        path = tmp_path / f"film{suffix}"
        path.write_text("hello\n")
        with pytest.raises(FileError, match=r"meshio cannot read it: \w.*VTK cannot read it: \w"):
            read_film(path)


def test_pieces_are_one_film(tmp_path, caplog):
    pytest.importorskip("vtk")

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
    assert "sets only: 1 array 'odd', 1 array 't' of the field data" in caplog.text


def test_a_breakdown_of_vtk_is_told(tmp_path, monkeypatch):
    run_instead(monkeypatch, tmp_path, "import os; os.abort()")
    monkeypatch.setitem(sys.modules, "vtkmodules", np)  # whatever is installed
    path = tmp_path / "film.vtp"
    path.write_text('<VTKFile type="PolyData"/>')
    with pytest.raises(FileError, match=r"found PolyData; VTK broke down on it \(code -6\)"):
        read_film(path)


@pytest.mark.parametrize(
    ("suffix", "content"),
    [
        (
            ".vtk",
            "# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\nPOINTS 1000000000 float\n",
        ),
        (".vtu", '<VTKFile><Piece NumberOfPoints="4" NumberOfCells="999999996"/></VTKFile>'),
        (".vtp", '<VTKFile><Piece NumberOfPoints="4" NumberOfPolys="999999996"/></VTKFile>'),
    ],
)
def test_what_is_declared_is_counted_first(tmp_path, suffix, content):
    path = tmp_path / f"film{suffix}"
    path.write_text(content)
    with pytest.raises(FileError, match=r"20,000,000 nodes and elements .* got 1,000,000,000"):
        read_film(path)


def test_a_structured_grid(tmp_path):
    path = tmp_path / "film.vtk"
    marks = " ".join(str(int(n % 4 == 0)) for n in range(12))
    path.write_text(
        "# vtk DataFile Version 3.0\nx\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 4 3 1\n"
        "ORIGIN 0 0 0\nSPACING 2 2 1\nPOINT_DATA 12\nSCALARS left%20rim int 1\n"
        f"LOOKUP_TABLE default\n{marks}\n"
    )
    mesh = read_film(path, unit="mm")
    assert (mesh.n_node, mesh.n_quad) == (12, 6)
    assert mesh.nodes[mesh.node_set("left rim")].tolist() == [[0, 0, 0], [0, 2, 0], [0, 4, 0]]


@pytest.mark.parametrize("suffix", [".vtk", ".vtu"])
def test_polygons_of_three_or_four_corners_are_cells(tmp_path, suffix):
    """And keep their arrays, which meshio leaves out in legacy files."""
    vtk = pytest.importorskip("vtk")
    grid = vtk.vtkUnstructuredGrid()
    points = vtk.vtkPoints()
    for x, y in ((0, 0), (3, 0), (3, 3), (0, 3), (6, 0), (6, 3), (4, 5)):
        points.InsertNextPoint(x, y, 0)
    grid.SetPoints(points)
    marks = vtk.vtkIntArray()
    marks.SetName("first")
    for mark, cell in ((1, (0, 1, 2, 3)), (0, (1, 4, 5, 2)), (0, (2, 5, 6))):
        grid.InsertNextCell(7, len(cell), cell)
        marks.InsertNextValue(mark)
    grid.GetCellData().AddArray(marks)

    def read():
        kind = "XML" if suffix == ".vtu" else ""
        writer = getattr(vtk, f"vtk{kind}UnstructuredGridWriter")()
        writer.SetFileName(str(tmp_path / f"film{suffix}"))
        writer.SetInputData(grid)
        writer.Write()
        return read_film(tmp_path / f"film{suffix}", unit="mm", triangles="split")

    mesh = read()
    assert (mesh.n_quad, len(mesh.quad_set("first"))) == (2 * 4 + 3, 4)
    grid.InsertNextCell(7, 5, (0, 1, 4, 6, 3))
    marks.InsertNextValue(0)
    with pytest.raises(FileError, match="1 cells of kind 'polygon'"):
        read()


@pytest.mark.parametrize(
    ("name", "mode", "compressor"),
    [
        ("film.vtu", "Binary", "ZLib"),
        ("film.vtu", "RawAppended", "LZ4"),
        ("film.vtp", "Ascii", "None"),
        ("polygons.vtk", "Binary", ""),
    ],
)
@pytest.mark.filterwarnings("ignore")  # NumPy's, of numbers out of range
def test_what_vtk_reads_of_damaged_files(tmp_path, capsys, name, mode, compressor):
    path = tmp_path / name
    write_by_vtk(path, mode=mode, compressor=compressor, polygons=name != "film.vtu")
    content, rng = path.read_bytes(), np.random.default_rng(7)
    n_refused = 0
    for _ in range(10):
        damaged, way = mutated(rng, content, text=mode == "Ascii")
        path.write_bytes(damaged)
        try:
            mesh = read_film(path, unit="mm")
        except ValueError:  # FileError, MeshError
            n_refused += 1
        else:
            assert (mesh.n_quad, mesh.n_node) == (10, 18), way
    assert n_refused > 0
