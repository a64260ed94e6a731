"""Damaged files of every format: refused, or read whole; never another error or a smaller film.

A mutation may leave a file that says something else rightly (a coordinate, a name, an id). What
must not happen: an error that is none of the package's, or other quads without a word. Files that
declare no counts betray a loss by what is left, or by what no mesher makes, and it is said.
``python -m damaged 400`` in tests counts what becomes of 400 damages to a film in each format, and
shows what is not said.
"""

import sys

import numpy as np
import pytest

from damaged.mutations import mutated
from damaged.outcomes import film_of, read_quietly, tool_of
from damaged.outcomes import outcome as outcome_of
from damaged.samples import FILMS, TOOLS
from shellcut.mesh.film_file import read_film


@pytest.fixture(autouse=True)
def _without_vtk(monkeypatch):
    """What meshio refuses is final; VTK's second opinion is in test_vtk, a process for each."""
    monkeypatch.setitem(sys.modules, "vtkmodules", None)


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
        damaged, way = mutated(rng, content, text=text)
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
            path.write_bytes(mutated(rng, content, text=text)[0])
            try:
                read_film(path, unit="mm")
            except ValueError as refusal:
                said = str(refusal).rpartition("meshio cannot read it: ")[2].partition("; VTK")[0]
                assert len(said.split()) > 2, "words, not the bare name of an error"
