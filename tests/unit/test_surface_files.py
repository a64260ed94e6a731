"""STL, OBJ and PLY: the same box in every form, by this package and by meshio; damaged files."""

import struct

import meshio
import numpy as np
import pytest

from damaged import samples
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


class TestStl:
    @pytest.mark.parametrize(
        "content",
        [
            binary_stl(),
            binary_stl(b"solid of text noise: facet normal vertex"),
            binary_stl(bytes(range(128, 208))),
            text_stl().encode(),
            text_stl("facet vertex 1 2 3 endsolid").encode(),
            ("\n" + text_stl().upper().replace("\n", "\r\n")).encode(),
            text_stl(solids=3).encode(),
        ],
    )
    def test_binary_and_text_whatever_the_header(self, tmp_path, content):
        path = tmp_path / "box.stl"
        path.write_bytes(content)
        surface = read_stl(path)
        assert surface.triangles.shape == (12, 3)
        assert volume(surface) == pytest.approx(8.0, rel=1e-12)  # round-off

    def test_files_of_meshio(self, tmp_path):
        for binary in (False, True):
            path = tmp_path / "box.stl"
            meshio.stl.write(path, meshio.Mesh(CORNERS, {"triangle": BOX}), binary=binary)
            assert volume(read_stl(path)) == pytest.approx(8.0, rel=1e-12)

    def test_what_is_written_is_read_by_others(self, tmp_path):
        path = tmp_path / "box.stl"
        write_stl(path, CORNERS, BOX, header="a box")
        other = meshio.stl.read(path)
        assert len(other.cells_dict["triangle"]) == 12
        assert other.points.max(axis=0).tolist() == [4.0, 2.0, 1.0]
        assert volume(read_stl(path)) == pytest.approx(8.0, rel=1e-12)

    @pytest.mark.parametrize(
        ("content", "words"),
        [
            (binary_stl()[:-1], "12 declared and data for 11.98; is it cut short"),
            (binary_stl() + b"x" * 50, "12 declared and data for 13"),
            (b"\0" * 84, "empty, or has only zero bytes"),
            (b"x" * 80 + bytes(4) + b"x", "0 declared"),
            (text_stl()[:-20].encode(), "cut short|must be followed"),
            (
                text_stl().replace("endfacet", "endfact", 1).encode(),
                "line 8: 'endloop' must be followed",
            ),
            (text_stl().replace("e+00", "e+zz", 1).encode(), "line 4: a vertex must have three"),
            (b"solid x\nvertex 1 2\n", "'solid' must be followed by 'facet or endsolid'"),
            (b"hello", "must begin with 'solid'"),
        ],
    )
    def test_refusals(self, tmp_path, content, words):
        path = tmp_path / "box.stl"
        path.write_bytes(content)
        with pytest.raises(FileError, match=words):
            read_stl(path)


OBJ = "# a box\nmtllib box.mtl\no box\n" + "".join(f"v {x} {y} {z}\n" for x, y, z in CORNERS)


class TestObj:
    @pytest.mark.parametrize(
        "faces",
        [
            "".join("f " + " ".join(str(v + 1) for v in t) + "\n" for t in BOX),
            "".join("f " + " ".join(f"{v + 1}/1/2" for v in t) + "\n" for t in BOX),
            "".join("f " + " ".join(f"{v - 8}//3" for v in t) + "\n" for t in BOX),
            "".join("f " + " \\\n ".join(str(v + 1) for v in s) + " # side\n" for s in SIDES),
        ],
    )
    def test_faces_of_all_kinds(self, tmp_path, faces):
        path = tmp_path / "box.obj"
        path.write_text(OBJ + "vn 0 0 1\nvt 0 0\ng side\nusemtl steel\ns off\n" + faces)
        surface = read_obj(path)
        assert surface.triangles.shape == (12, 3)
        assert volume(surface) == 8.0
        assert bool(surface.notes) == ("side" in faces)

    @pytest.mark.parametrize(
        ("add", "words"),
        [
            ("", "there must be faces"),
            ("f 1 2\n", "f must have three corners"),
            ("f 1 2 x\n", "must name a vertex, got 'x'"),
            ("f 1 2 0\n", "must name a vertex, got '0'"),
            ("f 1 2 99\n", "name existing vertices, but faces 0"),
            ("f 1 2 -9\n", "must name a vertex, got '-9'"),
            ("v 0 1 0.5\nf 1 2 9 4 3\n", "faces must be convex, but faces 0"),
            ("f 1 2 3 \\\n", "must not continue"),
            ("v 1 2\n", "v must have three numbers"),
            ("v 1_0 2 3\n", "v must have three numbers"),
            ("v 1 2 3 0.5\n", "the weight of a vertex must be 1, got '0.5'"),
            ("v 1 2 3 1\n", "the same for all v"),
            ("surf 0 1 0 1\n", "'surf' is not read"),
        ],
    )
    def test_refusals(self, tmp_path, add, words):
        path = tmp_path / "box.obj"
        path.write_text(OBJ + add)
        with pytest.raises(FileError, match=words):
            read_obj(path)

    def test_vertices_without_faces_are_said(self, tmp_path):
        path = tmp_path / "box.obj"
        path.write_text(OBJ + "f 1 2 3\n")
        assert read_obj(path).notes == ["5 vertices belong to no face: is the file cut short?"]
        for more in (" 1.0", " 0.5 0.5 1", " 0.5 0.5 1 1"):  # weights and colours
            path.write_text(OBJ.replace("\nv", f"{more}\nv")[:-1] + f"{more}\nf 1 2 3\n")
            np.testing.assert_array_equal(read_obj(path).vertices, CORNERS)


class TestPly:
    @pytest.mark.parametrize("binary", [False, True])
    def test_files_of_meshio(self, tmp_path, binary):
        path = tmp_path / "box.ply"
        meshio.ply.write(path, meshio.Mesh(CORNERS, {"triangle": BOX}), binary=binary)
        assert volume(read_ply(path)) == 8.0

    def test_big_endian_with_further_properties(self, tmp_path):
        head = "ply\nformat binary_big_endian 1.0\ncomment x\nelement vertex 8\n"
        head += "property float x\nproperty float y\nproperty float z\nproperty uchar red\n"
        head += "element face 6\nproperty list uchar int vertex_indices\nproperty float quality\n"
        body = b"".join(struct.pack(">3fB", *corner, 7) for corner in CORNERS.tolist())
        body += b"".join(struct.pack(">B4if", 4, *side, 0.5) for side in SIDES.tolist())
        path = tmp_path / "box.ply"
        path.write_bytes(head.encode() + b"end_header\n" + body)
        surface = read_ply(path)
        assert volume(surface) == 8.0
        assert surface.notes == ["6 faces with more than three corners are triangulated"]
        for damaged, words in (
            (body[:-1], "cut short"),
            (body + bytes(21), "must end after the content"),
        ):
            path.write_bytes(head.encode() + b"end_header\n" + damaged)
            with pytest.raises(FileError, match=words):
                read_ply(path)

    @pytest.mark.parametrize(
        ("old", "new", "words"),
        [
            ("ply\n", "plx\n", "from 'ply' to 'end_header'"),
            ("ascii", "asciii", "format must be one of"),
            ("double x", "double a", "vertex with x, y and z"),
            ("double x", "quad x", "this line of the header is invalid: 'property quad x'"),
            ("element face 12", "element face 13", "cut short"),
            ("element v", "element odd 1000000000\nelement v", "got 1,000,000,000 of odd without"),
            ("element face", "element face 0\nelement face", "each element must occur once"),
            ("double x", "list uchar double x", "vertex with x, y and z"),
            ("element face 12", "element face 11", "must end after the content"),
            ("element vertex 8", "element vertex 7", "there must be .*numbers|faces must name"),
            ("4.0 2.0 1.0", "4.0 2.0 one", "there must be .*numbers"),
        ],
    )
    def test_refusals(self, tmp_path, old, new, words):
        path = tmp_path / "box.ply"
        text = "ply\nformat ascii 1.0\nelement vertex 8\n"
        text += "".join(f"property double {axis}\n" for axis in "xyz")
        text += "element face 12\nproperty list uchar int vertex_indices\nend_header\n"
        text += "".join(f"{x} {y} {z}\n" for x, y, z in CORNERS)
        text += "".join("3 " + " ".join(map(str, t)) + "\n" for t in BOX)
        path.write_text(text)
        assert volume(read_ply(path)) == 8.0
        path.write_text(text.replace(old, new, 1))
        with pytest.raises(FileError, match=words):
            read_ply(path)


TOOTH_PLY = samples.TOOLS["PLY text"][1]().decode()


def test_ply_lines_are_told_by_their_numbers(tmp_path):
    path = tmp_path / "a.ply"
    path.write_text(TOOTH_PLY)
    n_triangle = len(read_ply(path).triangles)
    lines = TOOTH_PLY.splitlines()
    first = lines.index("end_header") + 1
    x, y, z = lines[first + 2].split()
    lines[first + 2] = f"{x} {y}"
    lines[first + 3] = f"{z} {lines[first + 3]}"
    path.write_text("\n".join(lines) + "\n")
    with pytest.raises(FileError, match=rf"vertex in line {first + 3} of the file has fewer value"):
        read_ply(path)
    path.write_text(TOOTH_PLY[: TOOTH_PLY.index("end_header") + 11] + " ".join(lines[first:]))
    assert len(read_ply(path).triangles) == n_triangle
