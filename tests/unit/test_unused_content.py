"""Text files without counts: what no film takes is said, what is misspelt is refused."""

import logging

import numpy as np
import pytest

from damaged import samples
from shellcut.formats.errors import FileError
from shellcut.formats.obj import read_obj
from shellcut.formats.ply import read_ply
from shellcut.mesh.film_file import read_film


@pytest.fixture
def said(tmp_path, caplog):
    """Write a text, read it as a film, return what was said beside the path."""

    def read(name, text):
        path = tmp_path / name
        path.write_text(text)
        caplog.clear()
        with caplog.at_level(logging.WARNING):
            read_film(path, unit="mm")
        return [message.removeprefix(f"{path}: ") for message in caplog.messages]

    return read


ABAQUS = samples.abaqus()
COLUMNS, COMMAS = samples.lsdyna(), samples.lsdyna(commas=True)


@pytest.mark.parametrize(
    ("name", "text"),
    [("a.inp", ABAQUS), ("a.k", COLUMNS), ("a.k", COMMAS)],
    ids=["Abaqus", "columns", "commas"],
)
def test_of_a_sound_deck_only_what_is_not_used_is_said(said, name, text):
    (note,) = said(name, text)
    assert note.startswith("not used, a film takes nodes, quads and sets only: ")
    assert ("1 *MATERIAL" if name == "a.inp" else "1 *MAT_ELASTIC") in note


@pytest.mark.parametrize(
    ("name", "text", "old", "new", "told"),
    [
        ("a.inp", ABAQUS, "*Elastic", "*Boundary", "1 *BOUNDARY, 1 *MATERIAL, 1 *SHELL SECT"),
        ("a.inp", ABAQUS, "0.00000\n2,", "0.00000, 0, 0, 1\n2,", "1 normals of nodes"),
        ("a.inp", ABAQUS, "type=S4R", "type=M3D4", "elements of type M3D4, which do not bend"),
        ("a.inp", ABAQUS, "type=S4R", "FILE=x, type=S4R", "parameter 'FILE' of *ELEMENT is not"),
        ("a.inp", ABAQUS, "*Material", "*PARAMETER\nx = 3\n*Material", "1 *PARAMETER"),
        ("a.inp", ABAQUS, "generate\n1, 9, 2\n", "generate\n", "node set 'first' in line"),
        ("a.inp", ABAQUS, "generate\n1, 9, 2\n", "generate\n60, 90\n", "17 of the 31 nodes from"),
        ("a.k", COMMAS, "0.0\n2,", "0.0, 7, 0\n2,", "1 constraints TC, RC on cards of"),
        ("a.k", COMMAS, "*MAT_EL", "*PARAMETER\nrx, 3\n*MAT_EL", "1 *MAT_ELASTIC, 1 *PARAMETER"),
        ("a.k", COMMAS, "*MAT_EL", "*SET_BEAM\n1\n*MAT_EL", "1 *SET_BEAM"),
        ("a.k", COMMAS, "\n60, 1, 40", "\n60, 7, 40", "shells are of parts 7, which no *PART"),
        ("a.k", COMMAS, "*SET_SHELL_LIST_T", "*SET_BLOB_T", "1 *SET_BLOB_TITLE"),
    ],
    ids=range(12),
)
def test_what_is_not_used_is_said(said, name, text, old, new, told):
    assert text.count(old) == 1, "the sample has changed"
    assert told in " ".join(said(name, text.replace(old, new)))


@pytest.mark.parametrize(
    ("name", "text", "old", "new", "told"),
    [
        ("a.inp", ABAQUS, "*Elset, elset=u", "*Elset, elsset=u", "'ELSSET'; did you mean ELSET"),
        ("a.inp", ABAQUS, "*Nset, nset=ring", "*Nset nset=ring", "a comma must stand between"),
        ("a.inp", ABAQUS, "\n44, 2, ", "\n4_4, 2, ", "must be a whole number, got '4_4'"),
        ("a.k", COLUMNS, "*SET_NODE_LIST_TITLE\nrim", "*SET_NOD_LIST_TITLE\nrim", "mean *SET_NODE"),
        ("a.k", COLUMNS, "*SET_SHELL_LIST", "*ET_SHELL_LIST", "did you mean *SET_SHELL_LIST"),
    ],
)
def test_what_is_misspelt_is_refused(tmp_path, name, text, old, new, told):
    assert text.count(old) == 1, "the sample has changed"
    (tmp_path / name).write_text(text.replace(old, new))
    with pytest.raises(FileError) as refusal:
        read_film(tmp_path / name, unit="mm")
    assert told in str(refusal.value)


OBJ = samples.TOOLS["OBJ text"][1]().decode()
OBJ = OBJ[OBJ.index("v ") :]  # without the comment, which has points of its own
PLY = samples.TOOLS["PLY text"][1]().decode()


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (lambda text: text.replace(".", ". ", 1), "the weight of a vertex must be 1, got '0.02'"),
        (lambda text: text.replace(".", ". ", 2), "v must have three numbers"),
        (lambda text: "v 1 2 3 0.5\n" + text, "the weight of a vertex must be 1, got '0.5'"),
        (lambda text: "v 1 2 3 1\n" + text, "the same for all v"),
        (lambda text: "v 1_0 2 3\n" + text, "v must have three numbers"),
    ],
)
def test_obj_vertices_are_all_alike(tmp_path, change, told):
    path = tmp_path / "a.obj"
    path.write_text(change(OBJ))
    with pytest.raises(FileError) as refusal:
        read_obj(path)
    assert told in str(refusal.value)


def test_obj_with_weights_or_colours_is_read(tmp_path):
    path = tmp_path / "a.obj"
    path.write_text(OBJ)
    plain = read_obj(path)
    for more in (" 1.0", " 0.5 0.5 1", " 0.5 0.5 1 1"):
        lines = [f"{t}{more}" if t.startswith("v ") else t for t in OBJ.splitlines()]
        path.write_text("\n".join(lines) + "\n")
        np.testing.assert_array_equal(read_obj(path).vertices, plain.vertices)


def test_ply_lines_are_told_by_their_numbers(tmp_path):
    path = tmp_path / "a.ply"
    path.write_text(PLY)
    n_triangle = len(read_ply(path).triangles)
    lines = PLY.splitlines()
    first = lines.index("end_header") + 1
    x, y, z = lines[first + 2].split()
    lines[first + 2] = f"{x} {y}"
    lines[first + 3] = f"{z} {lines[first + 3]}"
    path.write_text("\n".join(lines) + "\n")
    with pytest.raises(FileError, match=rf"vertex in line {first + 3} of the file has fewer value"):
        read_ply(path)
    path.write_text(PLY[: PLY.index("end_header") + 11] + " ".join(lines[first:]))
    assert len(read_ply(path).triangles) == n_triangle
