"""VTK files, written by VTK itself and by meshio; arrays as groups; counts."""

import re

import meshio
import numpy as np
import pytest

from known_film import LEFT, NODES, QUADS, RIGHT_PART, check_film, check_geometry
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
    ("name", "mode", "compressor", "readable"),
    [
        ("film.vtu", "Binary", "ZLib", True),
        ("film.vtu", "Ascii", "None", True),
        ("film.vtu", "Appended of BigEndian", "LZMA", True),
        ("film.vtu", "RawAppended", "ZLib", True),
        ("film.vtu", "Binary of version 2", "ZLib", False),
        ("film.vtu", "Appended", "LZ4", False),
        ("film.vtp", "RawAppended", "None", False),
        ("film.vtp", "Binary", "LZ4", False),
        ("film.vtk", "Binary", "", True),
        ("film.vtk", "Ascii", "", True),
        ("film.vtk", "Binary of version 5", "", False),
        ("polygons.vtk", "Binary", "", False),
        ("polygons.vtk", "Ascii of version 5", "", False),
    ],
)
def test_a_grid_written_by_vtk(tmp_path, name, mode, compressor, readable, caplog):
    path = tmp_path / name
    polygons = name.endswith("p") or name.startswith("p")
    write_by_vtk(path, mode=mode, compressor=compressor, polygons=polygons)
    if not readable:
        with pytest.raises(FileError, match=r"meshio (cannot|leaves).*; open it in ParaView"):
            read_film(path, unit="mm")
        path = saved_as_told(path)
    mesh = read_film(path, unit="mm")
    check_film(mesh, right_part="right part")
    assert list(mesh.node_sets) == ["left"]  # a temperature is no group
    assert "1 array 'temperature'" in caplog.text
    assert len(mesh.quad_set("part_3")) + len(mesh.quad_set("part_4")) == 10


def saved_as_told(path):
    """Do what the refusal says, by VTK as ParaView does it."""
    import vtk

    reader = (
        vtk.vtkDataSetReader() if path.suffix == ".vtk" else vtk.vtkXMLGenericDataObjectReader()
    )
    if path.suffix == ".vtk":
        reader.ReadAllScalarsOn()
        reader.ReadAllFieldsOn()
    reader.SetFileName(str(path))
    joined = vtk.vtkAppendFilter()
    joined.SetInputConnection(reader.GetOutputPort())
    writer = vtk.vtkXMLUnstructuredGridWriter()
    writer.SetInputConnection(joined.GetOutputPort())
    writer.SetCompressorTypeToZLib()
    writer.SetFileName(str(path.with_suffix(".saved.vtu")))
    assert writer.Write() == 1
    return path.with_suffix(".saved.vtu")


def in_two_pieces(text):
    (piece,) = re.findall(r"<Piece.*</Piece>", text, re.DOTALL)
    return text.replace(piece, piece * 2)


DECLARED = "# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\nPOINTS 1000000000 float\n"


@pytest.mark.parametrize(
    ("suffix", "change", "words"),
    [
        (".vtk", lambda text: text.replace("POINTS 18", "POINTS 17"), "open it in ParaView"),
        (".vtk", lambda text: text[: len(text) // 3], "open it in ParaView"),
        (".vtk", lambda text: "hello\n", r"meshio cannot read it: \w.*; open it in"),
        (".vtu", lambda text: "hello\n", r"meshio cannot read it: \w.*; open it in"),
        (".vtu", in_two_pieces, "20 cells are declared, got 10.*open it in ParaView"),
        (".vtu", lambda text: re.sub(r"\n17\n", "\n18\n", text), "name existing points"),
        (".vtk", lambda text: DECLARED, "20,000,000 nodes and elements .* got 1,000,000,000"),
        (
            ".vtu",
            lambda text: '<VTKFile><Piece NumberOfPoints="4" NumberOfCells="999999996"/></VTKFile>',
            "20,000,000 nodes and elements .* got 1,000,000,000",
        ),
    ],
)
def test_what_is_not_as_it_declares_is_refused(tmp_path, suffix, change, words):
    path = tmp_path / f"film{suffix}"
    meshio.Mesh(NODES, {"quad": QUADS}).write(path, binary=False)
    text = path.read_text()
    check_geometry(read_film(path, unit="mm"))
    path.write_text(change(text))
    with pytest.raises(FileError, match=words):
        read_film(path, unit="mm")


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


def test_polygons_of_three_or_four_corners_are_cells(tmp_path):
    points = [(0, 0, 0), (3, 0, 0), (3, 3, 0), (0, 3, 0), (6, 0, 0), (6, 3, 0), (4, 5, 0)]
    cells = [[(0, 1, 2, 3), (1, 4, 5, 2)], [(2, 5, 6)], [(0, 1, 4, 6, 3)]]
    path = tmp_path / "film.vtu"

    def written(n_block):
        blocks = [("polygon", np.array(block)) for block in cells[:n_block]]
        marks = [np.arange(len(block)) + (k > 0) for k, block in enumerate(cells[:n_block])]
        meshio.Mesh(np.array(points, float), blocks, cell_data={"later": marks}).write(path)
        return path

    mesh = read_film(written(2), unit="mm", triangles="split")
    assert (mesh.n_quad, len(mesh.quad_set("later"))) == (2 * 4 + 3, 4 + 3)
    with pytest.raises(FileError, match="1 cells of kind 'polygon'"):
        read_film(written(3), unit="mm", triangles="split")
