"""The table of cut and torn films in docs/verification.md is that of case F05 and its results."""

import sys

import pytest

from page_tables import ROOT, numbers_of, row, shown_as, table

sys.path.insert(0, str(ROOT / "tests" / "verification"))
from cases.f05_cut_and_torn_films import FILMS

PAGE = "docs/verification.md"
CASES = "docs/verification/cutting.md"


@pytest.mark.parametrize("film", FILMS, ids=lambda film: film.name)
def test_a_row_has_the_films_figures(film):
    (told,) = [one for one in table(PAGE, "film | h, mm")[1] if one[0] == film.name]
    _, thickness, torn, of_thickness, ours, measured, _ = told
    assert shown_as(thickness, film.thickness)
    assert shown_as(torn, film.torn, film.scatter)
    # To the digits shown: halves are rounded up.
    product = film.torn * film.thickness, film.scatter * film.thickness
    assert list(map(float, numbers_of(of_thickness))) == pytest.approx(product, abs=5.1e-4)
    result = row(CASES, f"{film.name}: measured force, N")
    assert shown_as(ours, float(result[2]))
    assert numbers_of(measured)[0] == f"{film.force:.3f}"
    assert float(result[1]) == film.force
