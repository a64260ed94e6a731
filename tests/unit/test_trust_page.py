"""Limits of the checks and of the verdict are those of docs/howto/trust.md."""

import pytest

from page_tables import numbers_of, row
from shellcut.checks import path, plausible
from shellcut.results import verdict
from shellcut.tool.shapes import tooth_ring

PAGE = "docs/howto/trust.md"
HALF_THICKNESS = tooth_ring().half_thickness()
MODULUS = [plausible.SOFTEST, plausible.STIFFEST, plausible.LIGHTEST, plausible.HEAVIEST]
MODULUS += [1e-3 * plausible.SLOWEST_WAVE, 1e-3 * plausible.FASTEST_WAVE]
STRENGTH = [plausible.SMALLEST_STRAIN, plausible.LARGEST_STRAIN, plausible.RUPTURED]
FIRST_YIELD = [plausible.LARGEST_YIELD_STRAIN, plausible.RUPTURED]
FIRST_YIELD += [plausible.SMALLEST_R, plausible.LARGEST_R]


@pytest.mark.parametrize(
    ("begins", "limits"),
    [
        ("The thickness is", [plausible.SLENDER, plausible.THINNEST]),
        ("The modulus is", MODULUS),
        ("The strength is", STRENGTH),
        ("The first yield stress is", FIRST_YIELD),
        ("The cutting edge is slower", [plausible.OF_WAVE]),
        ('With `path = "edges"`', [path.OFF_ROW]),
        ("With cracks through quads", [path.ONE_LINE]),
        ("Quads under the path have", [path.BENDS]),
    ],
)
def test_conditions_before_the_run_are_those_of_the_page(begins, limits):
    assert list(map(float, numbers_of(row(PAGE, begins)[0]))) == pytest.approx(limits)


@pytest.mark.parametrize(
    ("begins", "limits"),
    [
        ("`imbalance_rel`", [verdict.IMBALANCE_LIMIT]),
        ("`kinetic_rel`", [verdict.KINETIC_LIMIT, verdict.QUASI_STATIC_LIMIT]),
        ("`piercing_delay_rel`", [verdict.DELAY_LIMIT]),
        ("`overstress_rel`", [0.01 * verdict.STRESS_LIMIT]),
        ("`idle_edge_load_rel`", [0.01 * verdict.IDLE_LIMIT]),
        ("`damping_Nmm`", [verdict.DAMPING_LIMIT]),
        ("`contact_Nmm`", [verdict.CONTACT_LIMIT, verdict.GIVEN_LIMIT]),
        ("`overshoot_rel`", [verdict.OVERSHOOT_LIMIT]),
        ("`stored_growth_rel`", [verdict.STORED_LIMIT]),
        ("share of cables, film and friction", [verdict.ASKED_LIMIT]),
        ("work of the [steady window]", [verdict.OTHER_LIMIT]),
    ],
)
def test_limits_after_the_run_are_those_of_the_page(begins, limits):
    shown = numbers_of(row(PAGE, begins)[1])
    assert [0.01 * float(text) for text in shown] == pytest.approx(limits)


def test_the_depth_that_is_allowed_is_a_quarter_of_the_mean_half_thickness():
    cell = row(PAGE, "`deepest_penetration_mm`")[1]
    assert f"{HALF_THICKNESS:.3f} mm in the opening test" in cell
    assert f"the limit is {verdict.PENETRATION_LIMIT * HALF_THICKNESS:.4f} mm" in cell
