"""Damaged files of every format: refused, or read whole; never another error or a smaller film.

A mutation may leave a file that says something else rightly (a coordinate, a name, an id). What
must not happen: an error that is none of the package's, or other quads without a word. Files that
declare no counts betray a loss by what is left, or by what no mesher makes, and it is said.
``python -m damaged 400`` in tests counts what becomes of 400 damages to a film of 64 quads in each
format, and shows what is not said.
"""

import logging
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import test_abaqus
from damaged.mutations import mutated as damaged_content
from damaged.outcomes import film_of, read_quietly, tool_of
from damaged.outcomes import outcome as outcome_of
from damaged.samples import FILMS, TOOLS
from shellcut.formats import vtk as vtk_file
from shellcut.mesh.film_file import read_film
from test_lsdyna import deck
from test_vtk import write_by_vtk

DATA = Path(__file__).parent / "data"
N_MUTATION = 60
N_TRUNCATION = 25

ASSEMBLY = test_abaqus.TestPartsAndInstances.PART + (
    "*ASSEMBLY, NAME=a\n*INSTANCE, NAME=s-1, PART=Sheet\n1., 2., 3.\n*END INSTANCE\n*END ASSEMBLY\n"
)


@pytest.fixture(autouse=True)
def _without_vtk(monkeypatch):
    """What meshio refuses is final; VTK's second opinion is in test_vtk, a process for each."""
    monkeypatch.setattr(vtk_file, "_VTK", replace(vtk_file._VTK, module="no_such_module"))


def contents(tmp_path):
    """(name, bytes, whether counts are declared) of a sound file of every format."""
    for path in sorted(DATA.glob("gmsh_*.msh")):
        yield path.name, path.read_bytes(), True
    yield "flat.inp", test_abaqus.FLAT.encode(), False
    yield "assembly.inp", ASSEMBLY.encode(), False
    yield "fixed.k", deck().encode(), False
    yield "commas.k", deck(free=True).encode(), False
    for name, mode in (
        ("binary.vtu", "Binary"),
        ("ascii.vtu", "Ascii"),
        ("binary.vtk", "Binary"),
        ("ascii.vtk", "Ascii"),
    ):
        write_by_vtk(tmp_path / name, mode=mode)
        yield name, (tmp_path / name).read_bytes(), True


def mutated(rng, content):
    """One damage: a byte changed, lost, doubled or swapped, or a stretch lost or repeated."""
    at = int(rng.integers(len(content)))
    kind = rng.integers(6)
    length = int(rng.integers(1, 40))
    if kind == 0:
        byte = bytes([rng.choice(list(b"0123456789 -.,eE\n*$aZ\"'=\xff"))])
        return content[:at] + byte + content[at + 1 :]
    if kind == 1:
        return content[:at] + content[at + 1 :]
    if kind == 2:
        return content[:at] + content[at : at + 1] + content[at:]
    if kind == 3:
        return content[:at] + content[at + length :]
    if kind == 4:
        return content[:at] + content[at : at + length] + content[at:]
    return content[:at] + bytes([content[at] ^ (1 << int(rng.integers(8)))]) + content[at + 1 :]


def outcome(path, content, caplog):
    """None if refused, otherwise (n_quad, n_node, what was said)."""
    path.write_bytes(content)
    caplog.clear()
    try:
        mesh = read_film(path, unit="mm")
    except ValueError:  # FileError, MeshError
        return None
    return mesh.n_quad, mesh.n_node, caplog.text


def check(found, declared, what):
    if found is None:
        return
    n_quad, n_node, said = found
    if declared:
        assert (n_quad, n_node) == (10, 18) or "belong to no quad" in said, what
    elif (n_quad, n_node) != (10, 18):
        # without counts: a lost quad inside leaves no node behind; one at the rim does
        assert "left out" in said or "pairs of nodes" in said or n_node == 18, what


@pytest.mark.filterwarnings("ignore")  # NumPy's, of numbers out of range
def test_mutations(tmp_path, caplog, capsys):
    pytest.importorskip("vtk")
    rng = np.random.default_rng(20261121)
    n_read = n_refused = 0
    with caplog.at_level(logging.WARNING):
        for name, content, declared in contents(tmp_path):
            for k in range(N_MUTATION):
                damaged = mutated(rng, content)
                found = outcome(tmp_path / name, damaged, caplog)
                check(found, declared, (name, k))
                n_refused += found is None
                n_read += found is not None
    # most damages are seen; the rest hit names, digits and blanks
    assert n_refused > 200
    assert n_read > 100


@pytest.mark.filterwarnings("ignore")
def test_truncations(tmp_path, caplog, capsys):
    pytest.importorskip("vtk")
    rng = np.random.default_rng(5)
    with caplog.at_level(logging.WARNING):
        for name, content, declared in contents(tmp_path):
            for length in rng.integers(0, len(content) - 1, N_TRUNCATION).tolist():
                found = outcome(tmp_path / name, content[:length], caplog)
                if found is None:
                    continue
                n_quad, n_node, said = found
                whole = (n_quad, n_node) == (10, 18)
                assert whole or (not declared and said), (name, length)
                if name.endswith(".k"):
                    assert "the file may be cut short" in said or b"*END" in content[:length]


@pytest.mark.parametrize("name", [*FILMS, *TOOLS])
@pytest.mark.filterwarnings("ignore")  # NumPy's, of numbers out of range
def test_no_element_is_lost_or_changed_without_a_word(tmp_path, capsys, name):
    kind = "film" if name in FILMS else "tool"
    file, content_of, text = (FILMS | TOOLS)[name]
    content, path = content_of(), tmp_path / file
    path.write_bytes(content)
    sound = read_quietly(film_of if kind == "film" else tool_of, path)
    rng = np.random.default_rng(17)
    for _ in range(40):
        damaged, way = damaged_content(rng, content, text=text)
        path.write_bytes(damaged)
        assert outcome_of(kind, path, sound) != "elements", way


@pytest.mark.parametrize(
    "name", ["Abaqus deck", "Abaqus parts", "LS-DYNA columns", "LS-DYNA commas"]
)
def test_every_line_that_is_lost_is_missed(tmp_path, name):
    # all but those of sets: of a full line of ids, or of the keyword between two sets, none is left
    file, content_of, _ = FILMS[name]
    lines, path = content_of().splitlines(keepends=True), tmp_path / file
    path.write_bytes(b"".join(lines))
    sound = read_quietly(film_of, path)
    silent = []
    for k in range(0, len(lines), 3):
        path.write_bytes(b"".join(lines[:k] + lines[k + 1 :]))
        if outcome_of("film", path, sound) not in ("refused", "same", "said"):
            silent.append(lines[k])
    assert len(silent) < 8
    of_sets = (b"*NSET", b"*ELSET")
    for line in silent:
        assert line.upper().startswith(of_sets) or len(line.replace(b",", b" ").split()) >= 8, line


@pytest.mark.parametrize("mode", ["text", "binary"])
@pytest.mark.filterwarnings("ignore")
def test_meshio_says_why_it_cannot_read(tmp_path, capsys, mode):
    for kind in ("VTK", "VTU"):
        file, content_of, text = FILMS[f"{kind} {mode}"]
        content, path, rng = content_of(), tmp_path / file, np.random.default_rng(4)
        for _ in range(20):
            path.write_bytes(damaged_content(rng, content, text=text)[0])
            try:
                read_film(path, unit="mm")
            except ValueError as refusal:
                said = str(refusal).rpartition("meshio cannot read it: ")[2].partition("; VTK")[0]
                assert len(said.split()) > 2, "words, not the bare name of an error"
