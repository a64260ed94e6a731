"""Damaged files of every format: refused, or read as something; never another error.

A mutation may leave a file that says something else rightly: a coordinate, a name, a line less.
Formats that declare their counts notice what is lost.
"""

import numpy as np
import pytest

from damaged.mutations import mutated
from damaged.samples import FILMS, TOOLS
from shellcut import read_film, read_tool

COUNTED = [name for name in FILMS | TOOLS if name.split()[0] in ("Gmsh", "VTU", "VTK", "PLY")]


def cells_of(path, name):
    if name in FILMS:
        return read_film(path, unit="mm").quads
    return read_tool(path, unit="mm", sharp_angle_deg=90.0).triangles


@pytest.mark.parametrize("name", [*FILMS, *TOOLS])
@pytest.mark.filterwarnings("ignore")  # NumPy's, of numbers out of range
def test_a_damaged_file_is_refused_or_read(tmp_path, capsys, name):
    file, content_of, text = (FILMS | TOOLS)[name]
    content, path = content_of(), tmp_path / file
    path.write_bytes(content)
    n_cell = len(cells_of(path, name))
    n_read, refusals = 0, []
    rng = np.random.default_rng(17)
    for _ in range(40):
        damaged, way = mutated(rng, content, text=text)
        path.write_bytes(damaged)
        try:
            cells = cells_of(path, name)
        except ValueError as refusal:  # FileError, MeshError
            refusals.append(str(refusal).removeprefix(str(path)))
            continue
        n_read += 1
        assert name not in COUNTED or len(cells) == n_cell, way
    assert n_read
    assert refusals
    for said in refusals:
        assert len(said.split()) > 3, "words, not the bare name of an error"
