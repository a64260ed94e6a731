"""Gmsh's .msh: files that Gmsh wrote, of both versions, as text and binary; refusals."""

import logging
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from known_film import check_film, rows_in
from shellcut.formats.errors import FileError
from shellcut.mesh.film_file import read_film

DATA = Path(__file__).parent / "data"
NAMES = ["gmsh_2.2.msh", "gmsh_2.2_binary.msh", "gmsh_4.1.msh", "gmsh_4.1_binary.msh"]


@pytest.mark.parametrize("name", NAMES)
def test_a_film_written_by_gmsh_comes_back_with_all_its_groups(name):
    mesh = read_film(DATA / name, unit="mm")
    check_film(mesh)
    assert sorted(mesh.node_sets) == ["corner", "curve_4", "left"]  # the unnamed one by its tag
    assert sorted(mesh.quad_sets) == ["film", "right part"]  # which overlap
    assert len(mesh.quad_set("film")) == 10
    np.testing.assert_array_equal(mesh.node_set("corner"), rows_in(mesh, [[0, 0, 0]]))
    assert set(mesh.node_set("curve_4")) == set(rows_in(mesh, [[5, y, 0] for y in (0, 1, 2)]))


def test_the_files_are_what_gmsh_writes_today(tmp_path):
    pytest.importorskip("gmsh")
    shutil.copy(DATA / "make_gmsh_files.py", tmp_path)
    subprocess.run([sys.executable, tmp_path / "make_gmsh_files.py"], check=True)
    for name in NAMES:
        check_film(read_film(tmp_path / name, unit="mm"))


def test_what_is_turned_or_repeated_is_said(caplog):
    with caplog.at_level(logging.WARNING):
        read_film(DATA / "gmsh_2.2.msh")
    told = [record.getMessage().split(": ", 1)[1] for record in caplog.records]
    assert told == [
        "groups without a name, though others have one, are called curve_4",
        "4 cells are listed once per group, kept once",
        'no unit given: taken as mm, the film is 5 mm across; unit="..." says otherwise, '
        'unit="in" would make it 127 mm',
        "4 of 10 quads are turned over to agree with their neighbours",
    ]


TEXT_22 = (DATA / "gmsh_2.2.msh").read_text()
TEXT_41 = (DATA / "gmsh_4.1.msh").read_text()


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("hello\n", "must begin with \\$MeshFormat"),
        ("hello\n$MeshFormat\n", "a section must begin with"),
        (TEXT_22.replace("2.2 0 8", "4.0 0 8"), "version must be 2.2 or 4.1, got 4.0"),
        (TEXT_22.replace("2.2 0 8", "2.2 0 4"), "must read 'version 0|1 8'"),
        (TEXT_22[: TEXT_22.index("$Elements")], r"a section \$Elements: cut short"),
        (TEXT_22.replace("$Nodes\n18", "$Nodes\n17"), "must hold as much as it declares"),
        (TEXT_22.replace("$Nodes\n18", "$Nodes\n19"), "ends before its declared content"),
        (TEXT_22.replace("\n18 4 ", "\n17 4 "), "or twice at one place, got 17"),
        (TEXT_22.replace("14 13 6", "14 13 99").replace("16 13 6", "16 13 99"), "got 99"),
        (TEXT_22.replace("6 3 2 1", "6 77 2 1"), "known ones of Gmsh, got 77"),
        (TEXT_22.replace("3 5 0 0\n", "3 5 0 zero\n"), "there must be numbers, got 'zero'"),
        (TEXT_22.replace("3 5 0 0\n", "3 5 0 nan\n"), r"finite numbers, got node 3 at \(5, 0, nan"),
        (TEXT_22.replace("$EndElements", "$EndElement"), r"end with \$EndElements"),
        (TEXT_22 + "$PartitionedEntities\n", r"got \$PartitionedEntities"),
        (TEXT_41.replace("$Nodes\n", "$Nodex\n"), r"got \$Nodex"),
        # one element more, of which the section's blocks know nothing
        (TEXT_41.replace("\n5 15 1 15\n", "\n5 16 1 15\n"), "elements are declared, got"),
    ],
)
def test_refusals(tmp_path, text, words):
    path = tmp_path / "film.msh"
    path.write_text(text)
    with pytest.raises(FileError, match=words) as caught:
        read_film(path)
    assert str(path) in str(caught.value)


def test_other_cells_are_refused_by_name_or_left_out_by_choice(tmp_path, caplog):
    text = TEXT_22.replace("$Elements\n19", "$Elements\n20")
    text = text.replace("$EndElements", "77 4 2 0 9 1 2 16 15\n$EndElements")
    path = tmp_path / "film.msh"
    path.write_text(text)
    with pytest.raises(FileError, match=r"1 cells of kind 'tetrahedron' \(ids 77\)"):
        read_film(path)
    check_film(read_film(path, unit="mm", leave_out=["Tetrahedron"]))
    assert "1 cells of kind 'tetrahedron' are left out, as chosen" in caplog.text


def test_a_missing_file_or_another_ending_is_refused(tmp_path):
    with pytest.raises(FileError, match="No such file"):
        read_film(tmp_path / "none.msh")
    with pytest.raises(FileError, match=r"must end in one of \.msh, \.inp"):
        read_film(tmp_path / "film.stp")
