"""Each prediction in a short form, and the page against its declaration."""

import numpy as np
import pytest

from prediction import BLIND, KNOWN, Figure, Prediction, Run, found
from run import CASES, DOCS, case_of, kept_rows, linked, page, published, row


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_a_short_form_gives_what_the_page_says(name):
    case = case_of(name)
    given = [case.run(**one.keys) for one in case.runs.values() if one.short]
    tested = 0
    for figure in case.figures:
        values = [one[figure.name] for one in given if figure.name in one]
        if values:
            low, high = figure.short or (figure.low, figure.high)
            assert low <= np.mean(values) <= high, figure.name
            tested += 1
    assert tested


@pytest.mark.parametrize("name", CASES)
def test_the_page_shows_what_is_declared(name):
    shown = (DOCS / "predictions.md").read_text(encoding="utf-8")
    case = case_of(name)
    for text in (case.title, case.source, case.sure, case.model, case.said):
        assert linked(text) in shown
    for one in case.figures:
        assert f"| {one.name} | {published(one)} |" in shown


def test_cases_that_do_not_run_keep_their_rows():
    shown = (DOCS / "predictions.md").read_text(encoding="utf-8")
    assert page({name: kept_rows(shown, case_of(name)) for name in CASES}) == shown


def test_derived_values_blind_values_and_answers_in_words():
    given = {"a": (4.0, {"guessed": 3.0, "mesh": 4.0}, 2), "b": "one slit"}
    figures = Figure("a", "withheld", waits=BLIND), Figure("b", "withheld", waits=KNOWN)
    case = Prediction(
        "", "", "", "", figures, {}, dict, lambda results, path: None, derive=lambda _: given
    )
    value, words = (found(case, figure, {}) for figure in figures)
    assert row(value) == "| a | withheld | 4.0 ± 5.0 | *blind, not compared yet* |"
    assert row(words) == "| b | withheld | one slit | *not blind, not compared yet* |"


def test_an_error_bar_has_mesh_speed_and_scatter():
    def run(value):
        return {"f": value}

    runs = {
        "a": Run({}, 1.0),
        "b": Run({}, 1.0),
        "finer": Run({}, 0.5),
        "slower": Run({}, 1.0, 0.5),
    }
    figure = Figure("f", "4", 3.0, 5.0)
    case = Prediction("", "", "", "", (figure,), runs, run, lambda results, path: None)
    results = {"a": run(3.0), "b": run(5.0), "finer": run(6.0), "slower": run(3.7)}
    one = found(case, figure, results)
    # f_q = 6 beside a mean of 4 on twice the edges; slower by 0.3.
    assert one.value == pytest.approx(5.7)
    assert one.parts["mesh"] == pytest.approx(2.0)
    assert one.parts["speed"] == pytest.approx(0.3)
    assert one.scatter == pytest.approx(np.sqrt(2.0))
    # Student's t of one degree of freedom, 95 %.
    assert one.parts["scatter"] == pytest.approx(12.706 * np.sqrt(2.0), rel=1e-3)
    assert not one.hits
    assert "reaches" in one.verdict
