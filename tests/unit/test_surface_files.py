"""STL, OBJ and PLY: the same box in every form, by this package and by meshio; damaged files."""

import struct

import meshio
import numpy as np
import pytest

from shellcut.formats.errors import FileError
from shellcut.formats.obj import read_obj
from shellcut.formats.ply import read_ply
from shellcut.formats.stl import read_stl, write_stl

CORNERS = np.array([[x, y, z] for x in (0.0, 4.0) for y in (0.0, 2.0) for z in (0.0, 1.0)])
SIDES = np.array(
    [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
)
BOX = np.concatenate([SIDES[:, [0, 1, 2]], SIDES[:, [0, 2, 3]]])


def volume(surface):
    a, b, c = (surface.vertices[surface.triangles[:, k]] for k in range(3))
    return np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0


def text_stl(name="box", solids=1):
    lines = []
    for part in np.array_split(BOX, solids):
        lines.append(f"solid {name}")
        for triangle in part:
            lines += ["facet normal 0 0 0", "  outer loop"]
            lines += [f"    vertex {x:.9e} {y:.9e} {z:.9e}" for x, y, z in CORNERS[triangle]]
            lines += ["  endloop", "endfacet"]
        lines.append(f"endsolid {name}")
    return "\n".join(lines) + "\n"


def binary_stl(header=b"a box"):
    records = b"".join(struct.pack("<12fH", 0, 0, 0, *CORNERS[t].ravel().tolist(), 0) for t in BOX)
    return header.ljust(80) + struct.pack("<I", len(BOX)) + records


def box_by_meshio(path, binary):
    meshio.Mesh(CORNERS, {"triangle": BOX}).write(path, binary=binary)
    return path.read_bytes()


OBJ = "# a box\nmtllib box.mtl\no box\n" + "".join(f"v {x} {y} {z}\n" for x, y, z in CORNERS)
OTHERS = "vn 0 0 1\nvt 0 0\ng side\nusemtl steel\ns off\n"
PLY_HEAD = "ply\nformat ascii 1.0\nelement vertex 8\n"
PLY_HEAD += "".join(f"property double {axis}\n" for axis in "xyz")
PLY_HEAD += "element face 12\nproperty list uchar int vertex_indices\nend_header\n"
PLY_BODY = "".join(f"{x} {y} {z}\n" for x, y, z in CORNERS)
PLY_BODY += "".join("3 " + " ".join(map(str, t)) + "\n" for t in BOX)
PLY = PLY_HEAD + PLY_BODY
BIG_ENDIAN = b"ply\nformat binary_big_endian 1.0\ncomment x\nelement vertex 8\nproperty float x\n"
BIG_ENDIAN += b"property float y\nproperty float z\nproperty uchar red\nelement face 6\n"
BIG_ENDIAN += b"property list uchar int vertex_indices\nproperty float quality\nend_header\n"
BIG_ENDIAN += b"".join(struct.pack(">3fB", *corner, 7) for corner in CORNERS.tolist())
BIG_ENDIAN += b"".join(struct.pack(">B4if", 4, *side, 0.5) for side in SIDES.tolist())


def faces(corner, polygons=BOX, after=""):
    """Return faces of an OBJ file, each corner written by a function."""
    return "".join(f"f {' '.join(map(corner, one))}{after}\n" for one in polygons)


READERS = {"stl": read_stl, "obj": read_obj, "ply": read_ply}


def read(tmp_path, ending, content):
    path = tmp_path / f"box.{ending}"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return READERS[ending](path)


@pytest.mark.parametrize(
    ("ending", "content"),
    [
        ("stl", binary_stl()),
        ("stl", binary_stl(b"solid of text noise: facet normal vertex")),
        ("stl", binary_stl(bytes(range(128, 208)))),
        ("stl", text_stl()),
        ("stl", text_stl("facet vertex 1 2 3 endsolid")),
        ("stl", "\n" + text_stl().upper().replace("\n", "\r\n")),
        ("stl", text_stl(solids=3)),
        ("obj", OBJ + OTHERS + faces(lambda v: f"{v + 1}")),
        ("obj", OBJ + OTHERS + faces(lambda v: f"{v + 1}/1/2")),
        ("obj", OBJ + OTHERS + faces(lambda v: f"{v - 8}//3")),
        ("obj", OBJ + OTHERS + faces(lambda v: f"\\\n {v + 1}", SIDES, " # side")),
        ("ply", PLY),
        ("ply", PLY_HEAD + " ".join(PLY_BODY.split())),
        ("ply", BIG_ENDIAN),
    ],
)
def test_a_box_in_every_form(tmp_path, ending, content):
    surface = read(tmp_path, ending, content)
    assert surface.triangles.shape == (12, 3)
    assert volume(surface) == pytest.approx(8.0, rel=1e-12)  # round-off
    sides = content == BIG_ENDIAN or "# side" in str(content)
    told = ["6 faces with more than three corners are triangulated"]
    assert surface.notes == (told if sides else [])


def test_other_programs(tmp_path):
    for ending in ("stl", "ply"):
        for binary in (False, True):
            content = box_by_meshio(tmp_path / f"other.{ending}", binary)
            assert volume(read(tmp_path, ending, content)) == pytest.approx(8.0, rel=1e-12)
    write_stl(tmp_path / "ours.stl", CORNERS, BOX, header="a box")
    other = meshio.stl.read(tmp_path / "ours.stl")
    assert len(other.cells_dict["triangle"]) == 12
    assert other.points.max(axis=0).tolist() == [4.0, 2.0, 1.0]


def changed(old, new):
    assert old in PLY
    return PLY.replace(old, new, 1)


@pytest.mark.parametrize(
    ("ending", "content", "words"),
    [
        ("stl", binary_stl()[:-1], "12 declared and data for 11.98; is it cut short"),
        ("stl", binary_stl() + b"x" * 50, "12 declared and data for 13"),
        ("stl", b"\0" * 84, "empty, or has only zero bytes"),
        ("stl", b"x" * 80 + bytes(4) + b"x", "0 declared"),
        ("stl", text_stl()[:-20], "cut short|must be followed"),
        ("stl", text_stl().replace("endfacet", "endfact", 1), "line 8: 'endloop' must be followed"),
        ("stl", text_stl().replace("e+00", "e+zz", 1), "line 4: a vertex must have three"),
        ("stl", b"solid x\nvertex 1 2\n", "'solid' must be followed by 'facet or endsolid'"),
        ("stl", b"hello", "must begin with 'solid'"),
        ("obj", OBJ, "there must be faces"),
        ("obj", OBJ + "f 1 2\n", "f must have three corners"),
        ("obj", OBJ + "f 1 2 x\n", "must name a vertex, got 'x'"),
        ("obj", OBJ + "f 1 2 0\n", "must name a vertex, got '0'"),
        ("obj", OBJ + "f 1 2 99\n", "name existing vertices, but faces 0"),
        ("obj", OBJ + "f 1 2 -9\n", "must name a vertex, got '-9'"),
        ("obj", OBJ + "v 0 1 0.5\nf 1 2 9 4 3\n", "faces must be convex, but faces 0"),
        ("obj", OBJ + "f 1 2 3 \\\n", "must not continue"),
        ("obj", OBJ + "v 1 2\n", "v must have three numbers"),
        ("obj", OBJ + "v 1_0 2 3\n", "v must have three numbers"),
        ("obj", "v 1 2 3 0.5\n", "the weight of a vertex must be 1, got '0.5'"),
        ("obj", OBJ + "v 1 2 3 1\n", "the same for all v"),
        ("obj", OBJ + "surf 0 1 0 1\n", "'surf' is not read"),
        ("ply", changed("ply\n", "plx\n"), "from 'ply' to 'end_header'"),
        ("ply", changed("ascii", "asciii"), "format must be one of"),
        ("ply", changed("double x", "double a"), "vertex with x, y and z"),
        ("ply", changed("double x", "quad x"), "line of the header is invalid: 'property quad x'"),
        ("ply", changed("face 12", "face 13"), "cut short"),
        ("ply", changed("element v", "element odd 10\nelement v"), "got 10 of odd without"),
        ("ply", changed("element f", "element face 0\nelement f"), "each element must occur once"),
        ("ply", changed("double x", "list uchar double x"), "vertex with x, y and z"),
        ("ply", changed("face 12", "face 11"), "must end after the content"),
        ("ply", changed("vertex 8", "vertex 7"), "there must be .*numbers|faces must name"),
        ("ply", changed("4.0 2.0 1.0", "4.0 2.0 one"), "there must be .*numbers"),
        ("ply", BIG_ENDIAN[:-1], "cut short"),
        ("ply", BIG_ENDIAN + bytes(21), "must end after the content"),
    ],
)
def test_refusals(tmp_path, ending, content, words):
    with pytest.raises(FileError, match=words):
        read(tmp_path, ending, content)


def test_obj_vertices_without_faces_are_said_and_weights_and_colours_passed_over(tmp_path):
    for more in ("", " 1.0", " 0.5 0.5 1", " 0.5 0.5 1 1"):
        text = OBJ.replace("\nv", f"{more}\nv")[:-1]
        surface = read(tmp_path, "obj", f"{text}{more}\nf 1 2 3\n")
        assert surface.notes == ["5 vertices belong to no face: is the file cut short?"]
        np.testing.assert_array_equal(surface.vertices, CORNERS)
