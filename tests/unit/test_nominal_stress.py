"""What a film carries at most, against closed forms, and what the check says about it."""

import math

import numpy as np
import pytest

import shellcut as sc
from shellcut.checks.strength import check_strength
from shellcut.material.hardening import ACCURACY
from shellcut.material.nominal_stress import largest_nominal_stress, nominal_curve

# So stiff that its elastic strain, 1e-5, is below the tolerances of the rigid closed forms.
RIGID = sc.Elastic(3e7, 0.3, 1e-9)
FINE = 1e-4  # round-off of the search: strains are sampled, the maximum is flat


def power(strength, exponent):
    """σ_y = K p^n, of so many points that the place of a flat maximum is seen."""
    p = np.append(0.0, np.geomspace(1e-9, 3.0, 6000))
    return sc.Table(p, strength * (1e-9 + p) ** exponent)


def film(*materials, thickness=0.05):
    return sc.ShellMaterial([sc.Layer(one, thickness) for one in materials])


@pytest.mark.parametrize("n", [0.1, 0.3, 0.8])
@pytest.mark.parametrize(
    ("pull", "factor"),
    [
        ("uniaxial", lambda n: 1.0),
        ("plane strain", lambda n: (2.0 / math.sqrt(3.0)) ** (n + 1.0)),
        ("equibiaxial", lambda n: 2.0**n),
    ],
)
def test_considere_for_a_power_law(n, pull, factor):
    # σ_y = K ε^n: largest at ε = n, K n^n exp(-n) times the factor of the state
    most = largest_nominal_stress(film(sc.Plastic(RIGID, power(300.0, n))), pull)
    assert most.stress == pytest.approx(300.0 * n**n * math.exp(-n) * factor(n), rel=FINE)
    # the maximum is flat: its place is known to the root of its height
    assert math.log1p(most.strain) == pytest.approx(n, abs=0.01)
    swift = largest_nominal_stress(film(sc.Plastic(RIGID, sc.Swift(300.0, 1e-9, n))), pull)
    assert swift.stress == pytest.approx(most.stress, rel=ACCURACY)


@pytest.mark.parametrize(
    ("material", "stress"),
    [
        # σ = σ_0 + H p: at p = 1 - σ_0/H, H exp(-p)
        (sc.Plastic(RIGID, sc.Linear(20.0, 50.0)), 50.0 * math.exp(-0.6)),
        (sc.Plastic(RIGID, sc.Linear(20.0)), 20.0),
        (sc.Hencky(sc.Elastic(100.0, 0.3, 1e-9)), 100.0 / math.e),
    ],
    ids=["linear", "ideal", "Hencky"],
)
def test_the_maximum_lies_where_the_slope_is_the_stress(material, stress):
    most = largest_nominal_stress(film(material), "uniaxial")
    assert most.stress == pytest.approx(stress, rel=FINE)


@pytest.mark.parametrize(
    ("material", "pull", "modulus"),
    [
        (sc.Elastic(1000.0, 0.3, 1e-9), "uniaxial", 1000.0),
        (sc.Elastic(1000.0, 0.3, 1e-9), "plane strain", 1000.0 / 0.91),
        (sc.Orthotropic(1000.0, 500.0, 0.3, 300.0, 1e-9), "uniaxial", 1000.0),
    ],
)
def test_elastic_films_keep_their_modulus(material, pull, modulus):
    strain, stress = nominal_curve(film(material), pull)
    assert np.interp(1e-4, strain, stress) == pytest.approx(1e-4 * modulus, rel=1e-3)


def test_hill_across_and_along():
    # Hill's criterion: σ_90/σ_0 for r = 0.8, 1.2, 1.6; nominal stress goes with its power n + 1
    moduli = sc.Orthotropic(3e7, 3e7, 0.3, 1e7, 1e-9)
    sheet = film(sc.Plastic(moduli, sc.Swift(300.0, 1e-9, 0.2), (0.8, 1.2, 1.6)))
    along = largest_nominal_stress(sheet, "uniaxial")
    across = largest_nominal_stress(sheet, "uniaxial", across=True)
    assert across.stress / along.stress == pytest.approx(1.17670**1.2, rel=FINE)
    # turned by 90° the two change places
    turned = film(sc.Plastic(moduli, sc.Swift(300.0, 1e-9, 0.2), (0.8, 1.2, 1.6), angle_deg=90.0))
    assert largest_nominal_stress(turned, "uniaxial").stress == pytest.approx(
        across.stress, rel=1e-12
    )


def test_a_laminate_is_the_sum_of_its_layers():
    soft = sc.Plastic(RIGID, sc.Linear(10.0, 40.0))
    hard = sc.Plastic(RIGID, sc.Swift(160.0, 1e-9, 0.25))
    laminate = sc.ShellMaterial([sc.Layer(soft, 0.06), sc.Layer(hard, 0.02)])
    strain = np.linspace(1e-3, 2.0, 200_001)
    p = np.log1p(strain)
    wanted = (0.75 * (10.0 + 40.0 * p) + 0.25 * 160.0 * p**0.25) / (1.0 + strain)
    most = largest_nominal_stress(laminate, "uniaxial")
    assert most.stress == pytest.approx(wanted.max(), rel=FINE)


LAW = sc.CohesiveLaw()  # 18 MPa


def test_a_film_that_cannot_reach_its_strength_is_doubted():
    weak = film(sc.Plastic(sc.Elastic(200.0, 0.4, 1e-9), sc.Linear(8.0, 20.0)))
    (finding,) = check_strength(weak, LAW)
    assert finding.severity == "doubt"
    most = largest_nominal_stress(weak, "plane strain")
    assert f"carries {most.stress:.3g} MPa at most (plane strain, at" in finding.came
    assert "a crack needs 18 MPa" in str(finding)
    assert "it necks and parts only where a blade has passed" in str(finding)


def test_a_film_that_yields_first_or_cracks_when_stretched_both_ways_only_is_noted():
    drawn = film(sc.Plastic(sc.Elastic(200.0, 0.4, 1e-9), sc.Table((0.0, 1.2), (10.0, 90.0))))
    strain, stress = nominal_curve(drawn, "plane strain")
    reached = strain[np.argmax(stress >= 18.0)]
    # equibiaxially 2^n of uniaxial, plane strain (2/√3)^(n+1): for n = 0.8 the first is 1.34 times
    n = 0.8
    between = 18.0 / (math.exp(-n) * n**n * 1.5)
    sheet = film(sc.Plastic(RIGID, sc.Swift(between, 1e-9, n)))
    told = f"at {100 * reached:.0f} % strain", "stretched in both directions"
    for one, said in zip((drawn, sheet), told, strict=True):
        (finding,) = check_strength(one, LAW)
        assert finding.severity == "note"
        assert said in str(finding)


def test_films_that_do_not_yield_below_the_strength_are_left_in_peace():
    stiff = film(sc.Plastic(sc.Elastic(1678.0, 0.3, 1e-9), sc.Linear(60.0, 100.0)))
    weak = film(sc.Plastic(sc.Elastic(200.0, 0.4, 1e-9), sc.Linear(8.0, 20.0)))
    for one, law in ((sc.ShellMaterial.homogeneous(), LAW), (stiff, LAW), (weak, None)):
        assert list(check_strength(one, law)) == []
