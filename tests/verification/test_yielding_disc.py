"""A yielding disc, in statics: the tables of docs/theory/yielding-disc.md.

CalculiX's values are on the page alone; ``python -m benchmarks.yielding_disc`` has both.
"""

import sys
from pathlib import Path

import pytest

from page_tables import numbers_of, table

sys.path.insert(0, str(Path(__file__).parent.parent))
from benchmarks import yielding_disc

PAGE = "docs/theory/yielding-disc.md"
ROWS = {"ours, 140 quads": 10, "560 quads": 20, "1,260 quads": 30, "ours, 1,260 quads": 30}
"""Rows of our deflections, and the quads of a side of the square within the disc."""


@pytest.mark.parametrize(
    ("young", "name"),
    [
        (1678.0, "ours, 140 quads"),
        pytest.param(1678.0, "560 quads", marks=pytest.mark.slow),
        pytest.param(1678.0, "1,260 quads", marks=pytest.mark.slow),
        pytest.param(16780.0, "ours, 1,260 quads", marks=pytest.mark.slow),
    ],
)
def test_deflections_are_those_of_the_page(young, name, monkeypatch):
    (_, *pressures), rows = table(PAGE, f"E = {young:,.0f} MPa".replace("1,678", "1678"))
    assert tuple(map(float, pressures)) == yielding_disc.PRESSURES
    (told,) = [row[1:] for row in rows if row[0] == name]
    monkeypatch.setattr(yielding_disc, "YOUNG", young)
    found, _ = yielding_disc.ours(ROWS[name])
    assert found == pytest.approx([float(text) for text in told], abs=1.5e-4)


@pytest.mark.parametrize("young", ["1678", "16,780"])
def test_what_is_said_of_the_solids_follows_from_the_figures(young):
    _, rows = table(PAGE, f"E = {young} MPa")
    by_name = {row[0]: row[1:] for row in rows}
    ours = next(row for name, row in by_name.items() if name.endswith("1,260 quads"))
    solids = next(row for name, row in by_name.items() if "solids" in name)
    over = next(row for name, row in by_name.items() if "over it" in name)
    for cell, w, w_solids in zip(over, ours, solids, strict=True):
        assert abs(float(numbers_of(cell)[0]) - 100.0 * (float(w) / float(w_solids) - 1.0)) < 0.06
    assert max(abs(float(numbers_of(cell)[0])) for cell in over) < 2.0
