"""A process zone shorter than two sides of the quads costs work: the table of docs/limits.md."""

import numpy as np
import pytest

from page_tables import table
from runs import run
from shellcut import CohesiveLaw, guillotine, opening_test

SIDE = 2.0 * np.pi * 9.4 / 72
"""Of the quads of quick under the path [mm]."""


def law(opening_u):
    """Return the default law with all its openings shortened alike."""
    part = opening_u / 4.0
    return CohesiveLaw(opening_a=0.5 * part, opening_p=3.0 * part, opening_u=opening_u)


STRIP = {"length": 20.0, "notch": 1.6, "travel": 14.4}
CASES = {
    "guillotine": lambda rungs: guillotine(0.8, **STRIP, law=law(rungs * 0.8)),
    "opening test": lambda rungs: opening_test("quick", law=law(rungs * SIDE)),
}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "way", "first", "last"),
    [("guillotine", "path", 8.0, 15.0), ("opening test", "angle", 30.0, 68.0)],
)
def test_it_costs_what_the_page_says(name, way, first, last, tmp_path):
    (_, *rungs), rows = table("docs/limits.md", "ℓ_U/s")
    (told,) = [row[1:] for row in rows if row[0] == name]
    found = []
    for one in map(float, rungs):
        case = CASES[name](one)
        assert (len(case.check.findings) > 0) == (one < 2.0)
        _, history = run(case, tmp_path / str(one))
        late = (history[way] > first) & (history[way] < last)
        work, cables = (np.ptp(history[entry][late]) for entry in ("tool_work", "cohesive_work"))
        found.append(work / cables)
    # The digits shown, and chance in the runs.
    assert [float(text) for text in told] == pytest.approx(found, abs=1e-3)
    assert found == sorted(found)
