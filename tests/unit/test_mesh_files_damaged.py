"""Damaged files of every format: refused, or read as something; never another error.

A mutation may leave a file that says something else rightly: a coordinate, a name, a line less.
Formats that declare their counts notice what is lost. `tests/reliability/run.py` tries many more.
"""

import numpy as np
import pytest

from damaged.samples import FILMS, TOOLS
from reliability.fuzz import mesh_file


@pytest.mark.parametrize("name", [*FILMS, *TOOLS])
@pytest.mark.filterwarnings("ignore")  # NumPy's, of numbers out of range
def test_a_damaged_file_is_refused_or_read(tmp_path, name):
    rng = np.random.default_rng(17)
    refusals = [mesh_file(name, rng, tmp_path) for _ in range(25)]
    assert any(refusals)
    assert not all(refusals)
