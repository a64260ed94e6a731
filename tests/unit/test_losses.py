"""Text files without counts: what may have been lost is said, what is sound is read in silence."""

import logging

import numpy as np
import pytest

from damaged import samples
from shellcut.formats.errors import FileError
from shellcut.formats.losses import gap_note, is_numbers, ragged_note, repeat_note
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


ABAQUS, PARTS = samples.abaqus(), samples.abaqus_parts()
COLUMNS, COMMAS = samples.lsdyna(), samples.lsdyna(commas=True)


@pytest.mark.parametrize(
    ("name", "text"),
    [("a.inp", ABAQUS), ("a.inp", PARTS), ("a.k", COLUMNS), ("a.k", COMMAS)],
    ids=["deck", "parts", "columns", "commas"],
)
def test_of_a_sound_deck_only_what_is_not_used_is_said(said, name, text):
    (note,) = said(name, text)
    assert note.startswith("not used, a film takes nodes, quads and sets only: ")
    assert ("1 *MATERIAL" if name == "a.inp" else "1 *MAT_ELASTIC") in note


@pytest.mark.parametrize(
    ("name", "text", "old", "new", "told"),
    [
        (
            "a.inp",
            PARTS,
            "*Elastic",
            "*Boundary",
            "1 *BOUNDARY, 1 *MATERIAL, 1 *SHELL SECTION, 1 i",
        ),
        ("a.inp", ABAQUS, "0.00000\n2,", "0.00000, 0, 0, 1\n2,", "1 normals of nodes"),
        ("a.inp", ABAQUS, "TYPE=S4R", "TYPE=M3D4", "elements of type M3D4, which do not bend"),
        ("a.inp", ABAQUS, "TYPE=S4R", "FILE=x, TYPE=S4R", "parameter 'FILE' of *ELEMENT is not"),
        ("a.inp", ABAQUS, "*MATERIAL", "*PARAMETER\nx = 3\n*MATERIAL", "1 *PARAMETER"),
        ("a.k", COMMAS, "0.00000\n2,", "0.00000, 7, 0\n2,", "1 constraints TC, RC on cards of"),
        ("a.k", COMMAS, "*MAT_EL", "*PARAMETER\nrx, 3\n*MAT_EL", "1 *MAT_ELASTIC, 1 *PARAMETER"),
        ("a.k", COMMAS, "*MAT_EL", "*SET_BEAM\n1\n*MAT_EL", "1 *SET_BEAM"),
        ("a.inp", ABAQUS, "\n60, 40,", "\n**60, 40,", "comments in 1 lines look like data"),
        ("a.inp", ABAQUS, "*NSET, NSET=ring", "**NSET, NSET=ring", "look like data or keywords"),
        ("a.inp", ABAQUS, "GENERATE\n1, 9, 2\n", "GENERATE\n", "node set 'first' in line"),
        ("a.inp", ABAQUS, "GENERATE\n1, 9, 2\n", "GENERATE\n60, 90\n", "17 of the 31 nodes from"),
        ("a.inp", ABAQUS, "17, 18, 19, 20, ", "17, 18, 20, ", "its lines have 8 ids each, but"),
        ("a.inp", ABAQUS, "17, 18, 19, 20, ", "17, 18, 18, 20, ", "names 18 more than once"),
        ("a.inp", ABAQUS, "*END STEP\n", "*END STEP", "the last line does not end: is the file"),
        ("a.inp", ABAQUS, "ELSET=film", "COLOR=red", "the parameter 'COLOR' of *ELEMENT is not"),
        (
            "a.inp",
            ABAQUS,
            "\n60, 40,",
            "\n69, 40,",
            "by 1, but after 59 comes 61, after 64 comes 69",
        ),
        ("a.k", COLUMNS, "\n      60       1", "\n$     60       1", "comments in 1 lines look"),
        ("a.k", COMMAS, "*PART\nthe film\n", "$*PART\n$ a film\n$ ", "look like data or keywords"),
        ("a.k", COMMAS, "\n60, 1, 40", "\n60, 7, 40", "shells are of parts 7, which no *PART"),
        ("a.k", COMMAS, "*SET_SHELL_LIST_T", "*SET_BLOB_T", "1 *SET_BLOB_TITLE"),
        ("a.k", COMMAS, "ring\n2\n42", "ring\n42", "looks like one of members: is a line lost?"),
    ],
    ids=range(22),
)
def test_what_is_not_used_or_may_be_lost_is_said(said, name, text, old, new, told):
    assert text.count(old) == 1, "the sample has changed"
    assert told in " ".join(said(name, text.replace(old, new)))


@pytest.mark.parametrize(
    ("name", "text", "old", "new", "told"),
    [
        ("a.inp", ABAQUS, "ELSET=film", "ELSSET=film", "'ELSSET'; did you mean ELSET"),
        ("a.inp", ABAQUS, "*NSET, NSET=ring", "*NSET NSET=ring", "a comma must stand between"),
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


def test_gaps_ragged_lines_repeats_and_numbers_are_told():
    assert gap_note("node", range(1, 50)) == []
    assert gap_note("node", [*range(1, 50), *range(1001, 1050)]) == []  # another part
    assert gap_note("node", np.arange(50) ** 2) == []
    (note,) = gap_note("node", [k for k in range(10, 400, 7) if k not in (87, 94)])
    assert note == "node ids go from 10 to 395 by 7, but after 80 comes 101: is a line lost there?"
    assert ragged_note("set", [(1, 8), (2, 8), (3, 2)]) == []
    assert ragged_note("set", [(1, 3), (2, 7), (3, 1), (4, 5), (5, 2)]) == []  # by hand
    (note,) = ragged_note("set", [(1, 8), (2, 8), (3, 5), (4, 8), (5, 8), (6, 2)])
    assert note == "set: its lines have 8 ids each, but line 3 has 5: is something lost?"
    assert repeat_note("set", [3, 1, 2]) == []
    assert repeat_note("set", [3, 1, 3]) == ["set names 3 more than once"]
    for text in (" 1, 2, 3", "   17   0.5   -1e-3   0", "1,2,3,"):
        assert is_numbers(text)
    for text in ("", " 12", "#   nid   x   y", " 3 nodes, 2 quads", "1.5 mm, 2, 3"):
        assert not is_numbers(text)


OBJ, PLY = samples.obj(), samples.ply().decode()


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (lambda text: text.replace(".", ". ", 1), "the weight of a vertex must be 1, got '0.0200"),
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
    path.write_text(OBJ.rstrip())
    assert read_obj(path).notes == ["the last line does not end: is the file cut short?"]


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
