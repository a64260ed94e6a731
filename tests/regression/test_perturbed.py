"""The table of figures and chance is that of its runs, and the runs are those of today."""

import json

import pytest

from perturbed import FIGURES_FILE, PAGE, check_among_runs, figures, page


def test_the_table_on_the_page_is_that_of_the_runs():
    text = PAGE.read_text()
    assert page(text, json.loads(FIGURES_FILE.read_text())) == text


@pytest.mark.slow
@pytest.mark.parametrize("model", ["guillotine", "free"])  # quick: test_opening.py
def test_the_unmoved_film_gives_one_of_these_runs(model):
    check_among_runs(model, figures(model, 0))
