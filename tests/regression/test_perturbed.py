"""The table of figures and chance is that of its runs, and the runs are those of today."""

import json

import pytest

from perturbed import FIGURES_FILE, MODELS, PAGE, entry, figures, page, spread

pytestmark = pytest.mark.skipif(
    not FIGURES_FILE.exists(), reason="python tests/regression/perturbed.py writes the figures"
)


def test_the_table_on_the_page_is_that_of_the_runs():
    text = PAGE.read_text()
    assert page(text, json.loads(FIGURES_FILE.read_text())) == text


@pytest.mark.parametrize(
    "model",
    [
        model if model == "quick" else pytest.param(model, marks=pytest.mark.slow)
        for model in MODELS
    ],
)
def test_the_unmoved_film_gives_one_of_these_runs(model):
    runs, today = json.loads(FIGURES_FILE.read_text())[model], figures(model, 0)
    for name, value in today.items():
        mean, deviation = spread([run[name] for run in runs])
        # Five standard deviations; a figure that chance does not reach differs by what was moved.
        assert value == pytest.approx(mean, abs=5.0 * deviation + 1e-7 * abs(mean)), (
            name,
            entry([run[name] for run in runs]),
        )
