"""Units given and guessed."""

import pytest

from shellcut.formats.length_unit import MILLIMETRES, unit_in_mm


@pytest.mark.parametrize("unit", list(MILLIMETRES))
def test_a_given_unit_is_taken_whatever_the_size(unit):
    assert unit_in_mm(unit, 1e9, "the film") == (MILLIMETRES[unit], "")


@pytest.mark.parametrize(
    ("extent", "factor", "words"),
    [(20.4, 1.0, "taken as mm"), (0.0204, 1000.0, "taken as m, the film is 20.4 mm")],
)
def test_a_safe_guess_is_said(extent, factor, words):
    found, note = unit_in_mm(None, extent, "the film")
    assert found == factor
    assert words in note


@pytest.mark.parametrize("extent", [0.803, 20400.0, 1e-5, 0.0])
def test_what_may_be_several_units_must_be_given(extent):
    with pytest.raises(ValueError, match="the unit must be given, because the film is"):
        unit_in_mm(None, extent, "the film")


def test_an_unknown_unit_is_refused():
    with pytest.raises(ValueError, match="one of um, mm, cm, m, inch, mil, got 'feet'"):
        unit_in_mm("feet", 1.0, "the film")
