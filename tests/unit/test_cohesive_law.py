"""The law, of Fig. 4 and by tables: envelope, energies on any path, unloading, refusals."""

import itertools
from dataclasses import replace

import numpy as np
import pytest

from naive import cable as naive
from shellcut.cables.cohesive_law import CohesiveLaw, CohesiveTable, area_below, envelope

LAWS = {
    "the paper's": CohesiveLaw(),
    "no onset": CohesiveLaw(onset=0.0),
    "no drop": CohesiveLaw(strength=12.0),
    "no plateau": CohesiveLaw(opening_p=0.5),
    "linear": CohesiveTable.linear(strength=18.0, opening_u=4.0),
    "bilinear": CohesiveTable.bilinear(
        strength=18.0, knee_opening=0.6, knee_traction=4.0, opening_u=4.0
    ),
    "exponential": CohesiveTable.exponential(strength=18.0, fracture_energy=8.0),
    "two steps": CohesiveTable(
        openings=[0.0, 1.0, 1.1, 2.0, 2.1, 4.0], tractions=[18.0, 17.0, 8.0, 7.5, 1.0, 0.0]
    ),
}
TABLES = {name: law for name, law in LAWS.items() if not isinstance(law, CohesiveLaw)}


def energies(law, opening, largest):
    stored, dissipated = law.energies(np.array([opening]), np.array([largest]))
    return float(stored[0]), float(dissipated[0])


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_area_of_the_envelope_is_the_fracture_energy(law):
    corners = np.array(naive.corners(law)[0])
    by_corners = np.trapezoid(naive.envelope(corners, law), corners)
    # Round-off: the envelope is linear between its corners.
    assert law.fracture_energy == pytest.approx(by_corners, rel=1e-12)
    parameters = law.parameters()
    for ell in (0.1, 0.5, 0.7, 2.9, 3.0, 3.6, 4.0, 9.0):
        grid = np.unique(np.clip(np.concatenate([corners, [0.0, ell]]), 0.0, ell))
        area = np.trapezoid(naive.envelope(grid, law), grid)
        assert area_below(ell, parameters) == pytest.approx(area, rel=1e-12)
    assert area_below(-1.0, parameters) == 0.0
    over = 1.05 * law.opening_u
    assert energies(law, over, over) == (0.0, pytest.approx(law.fracture_energy, rel=1e-12))


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_traction_matches_the_naive_twin(law):
    rng = np.random.default_rng(1)
    for _ in range(300):
        largest = rng.choice([rng.uniform(0, 4.2), rng.uniform(0, 0.02)])
        opening = largest * rng.uniform(-0.2, 1.0)
        wanted = naive.stress(opening, largest, law)
        got = law.traction(opening, largest)
        assert got == pytest.approx(wanted, rel=1e-12, abs=1e-12 * law.strength)
    for ell in np.linspace(-0.1, 4.5, 60):
        wanted = naive.envelope(ell, law)
        assert law.traction(ell) == pytest.approx(wanted, rel=1e-12, abs=1e-13)
        assert envelope(ell, law.parameters()) == law.traction(ell)


PATHS = {
    "over the end": [0.0, 4.6],
    "cyclic": [0.0, 0.3, 0.0, 0.3, 2.0, 1.1, 2.5, 0.0, 3.5, 3.2, 3.5],
    "small cycle": [0.0, 0.004, 0.001, 0.009, 0.002],
    "unloaded": [0.0, 1.0, 0.97],
}
PAPER_AND_TABLES = pytest.mark.parametrize(
    "law", [CohesiveLaw(), *TABLES.values()], ids=["the paper's", *TABLES]
)


@PAPER_AND_TABLES
@pytest.mark.parametrize("path", PATHS.values(), ids=PATHS)
def test_stored_and_dissipated_are_the_work(path, law):
    work, largest = 0.0, 0.0
    for start, end in itertools.pairwise(path):
        ell = np.linspace(start, end, 1_001)
        most = np.maximum(np.maximum.accumulate(ell), largest)
        stress = [law.traction(*pair) for pair in zip(ell, most, strict=True)]
        work, largest = work + np.trapezoid(stress, ell), most[-1]
    stored, dissipated = energies(law, path[-1], largest)
    # Trapezoids of 1000 a leg: a few steps of 5e-3 mm at kinks.
    assert stored + dissipated == pytest.approx(work, abs=1e-4 * law.fracture_energy)


@PAPER_AND_TABLES
def test_dissipation_never_falls_and_what_is_stored_comes_back(law):
    booked = [energies(law, ell, ell)[1] for ell in np.linspace(0.01, 4.0, 200)]
    assert (np.diff(booked) >= -1e-12).all()
    for largest in (0.2, 1.0, 3.4):
        stored, before = energies(law, largest, largest)
        assert stored > 0.0
        assert energies(law, 0.0, largest) == (pytest.approx(0.0, abs=1e-12), pytest.approx(before))


def test_each_maker_has_the_energy_of_its_closed_form():
    # Round-off.
    assert LAWS["linear"].fracture_energy == pytest.approx(0.5 * 18.0 * 4.0, rel=1e-14)
    by_hand = 0.5 * (18.0 + 4.0) * 0.6 + 0.5 * 4.0 * 3.4
    assert LAWS["bilinear"].fracture_energy == pytest.approx(by_hand, rel=1e-14)
    assert LAWS["exponential"].fracture_energy == pytest.approx(8.0, rel=1e-14)
    knee = CohesiveLaw(plateau=4.0, opening_a=0.6, opening_p=0.6)
    for ell in np.linspace(0.0, 4.1, 83):
        assert LAWS["bilinear"].traction(ell) == knee.traction(ell)
    law = CohesiveTable(openings=[0, 0.5, 3, 4], tractions=(18, 12, 12, 0), joint="free")
    np.testing.assert_array_equal(law.parameters(), CohesiveLaw(joint="free").parameters())
    assert (law.joint, law.short_branch) == ("free", CohesiveLaw().short_branch)


def test_the_exponential_law_is_one_to_a_ten_thousandth_of_the_strength():
    for strength, energy in ((18.0, 8.0), (3.0, 43.5)):
        law = CohesiveTable.exponential(strength=strength, fracture_energy=energy)
        ell = np.linspace(0.0, 1.1 * law.opening_u, 20_001)
        exact = strength * np.exp(-ell * strength / energy)
        off = np.interp(ell, law.openings, law.tractions) - exact
        assert np.abs(off).max() < 1e-4 * strength
        assert law.opening_u == pytest.approx(9.38 * energy / strength, rel=1e-3)
        assert len(law.openings) == 100


# A law with a low plateau, and one of little more than a drop, end in other ways than the paper's.
CUT_OFF = {
    "paper": CohesiveLaw(),
    "low plateau": CohesiveLaw(plateau=3.0, opening_p=1.0),
    "no drop": CohesiveLaw(strength=12.0),
    "triangle": CohesiveLaw(
        strength=24.0, plateau=12.0, opening_a=1.0, opening_p=1.0, opening_u=2.0
    ),
}


@pytest.mark.parametrize("whole", CUT_OFF.values(), ids=CUT_OFF)
def test_the_law_at_an_edge_ends_at_the_area_that_the_edge_severs_at(whole):
    least = 0.05 * whole.fracture_energy
    law = replace(whole, cutting_energy=least, severing_pressure=300.0)
    radii = np.linspace(0.0, 1.3 * law.blunt_radius, 150)
    cut = [law.at_edge(r) for r in radii]
    expected = np.minimum(whole.fracture_energy, least + 600.0 * radii)
    # Round-off: the corners come of a quadratic equation.
    np.testing.assert_allclose([one.fracture_energy for one in cut], expected, rtol=1e-12)
    openings = np.array([one.opening_u for one in cut])
    assert openings[-1] == whole.opening_u
    steps = np.diff(openings)
    assert (steps >= 0.0).all()
    # Continuous: no step is longer than the steepest of the ends, 2/sigma_C and 4/sigma_F, takes.
    assert steps.max() < 2.0 / whole.plateau * 600.0 * radii[1] * (1.0 + 1e-9)
    share = [one.openings[-2] / one.opening_u for one in cut if len(one.openings) == 4]
    np.testing.assert_allclose(share, whole.opening_p / whole.opening_u, rtol=1e-12)
    for one, area in zip(cut[::15], expected[::15], strict=True):
        plain = naive.severed(whole, area)
        for ell in np.linspace(0.0, whole.opening_u, 50):
            below = one.traction(ell)
            assert below == pytest.approx(naive.envelope(ell, plain), abs=1e-9 * whole.strength)
            assert below <= whole.traction(ell) + 1e-12 * whole.strength
            if ell <= one.openings[1]:
                assert below == pytest.approx(whole.traction(ell), rel=1e-12)


@pytest.mark.parametrize("name", TABLES)
def test_an_edge_cuts_off_any_law(name):
    whole = TABLES[name]
    energy, ells = whole.fracture_energy, np.linspace(0.0, whole.opening_u, 2_000)
    envelope, before = np.interp(ells, *naive.corners(whole)), np.zeros_like(ells)
    for k, area in enumerate(np.linspace(0.05, 0.999, 160) * energy):
        one = replace(whole, cutting_energy=area, onset=1e-4).at_edge(0.0)
        assert one.fracture_energy == pytest.approx(area, rel=1e-12)
        stress = np.interp(ells, one.openings, one.tractions)
        # Round-off. It is nowhere above the whole law, and grows everywhere, by steps as short as
        # those of the area: over the bulges of the two steps too.
        assert (stress - envelope).max() < 1e-12 * whole.strength
        assert (before - stress).max() < 1e-12 * whole.strength
        grown = np.trapezoid(stress - before, ells)
        assert grown < (0.06 if not before.any() else 0.007) * energy
        before = stress
        if name == "two steps":
            continue
        leaves = max(len(one.openings) - 2, 0)
        assert one.openings[: leaves - 1] == whole.openings[: leaves - 1]
        if k % 40 == 10:
            plain = naive.severed(whole, area)
            wanted = [naive.envelope(ell, plain) for ell in ells[::40]]
            # The plain reference searches among places.
            np.testing.assert_allclose(stress[::40], wanted, atol=1e-4 * whole.strength)


def test_a_law_that_no_edge_cuts_off_stays_itself():
    law = CohesiveLaw()
    assert law.at_edge(0.1) is law
    assert law.blunt_radius == np.inf
    razor = CohesiveLaw(cutting_energy=10.0)
    assert razor.blunt_radius == np.inf
    assert razor.at_edge(0.0).fracture_energy == pytest.approx(10.0, rel=1e-12)
    blunt = CohesiveLaw(cutting_energy=10.0, severing_pressure=335.0)
    assert blunt.blunt_radius == pytest.approx(0.05, rel=1e-12)
    assert blunt.at_edge(0.051) == law


def table_of(openings, tractions):
    return lambda: CohesiveTable(openings=openings, tractions=tractions)


def bilinear(**changes):
    numbers = {"strength": 18.0, "knee_opening": 1.0, "knee_traction": 2.0, "opening_u": 4.0}
    return lambda: CohesiveTable.bilinear(**numbers | changes)


REFUSED = [
    (lambda: CohesiveLaw(plateau=20.0), "must decrease.*plateau 20.0 MPa.*strength 18.0"),
    (lambda: CohesiveLaw(opening_a=3.5), "decrease.*opening_a <= opening_p.*3.5, 3.0, 4.0"),
    (lambda: CohesiveLaw(opening_p=4.0), "opening_p < opening_u"),
    (lambda: CohesiveLaw(onset=0.5), "small beside opening_u = 4 mm, a tenth at most, got 0.5"),
    (lambda: CohesiveLaw(plateau=20.0, opening_p=5.0), "plateau 20.0.*0.5, 5.0, 4.0"),
    (lambda: CohesiveLaw(severing_pressure=300.0), "severing_pressure needs cutting_energy"),
    (lambda: CohesiveLaw(cutting_energy=1000.0), "must not exceed.*43.5 N/mm, got 1000.0"),
    (lambda: CohesiveLaw(cutting_energy=0.5), "cutting_energy = 0.5.*onset must be small"),
    (lambda: CohesiveLaw(joint="slip"), "needs a joint_friction that is positive, got 0.0"),
    (lambda: CohesiveLaw(joint="free", joint_friction=0.1), "friction belongs to joint = 'slip'"),
    (lambda: CohesiveLaw(joint_friction=0.1), "got 0.1 with joint = 'adhesion'"),
    (table_of([0, 1, 1, 2], [18, 12, 8, 0]), "must start at 0 and rise, got 1 mm in row 3"),
    (table_of([0.1, 1], [18, 0]), "openings must start at 0 and rise, got 0.1 mm in row 1"),
    (table_of([0, np.nan, 2], [18, 2, 0]), "openings must be finite, got nan mm in row 2"),
    (table_of([0, 1], [18, 2]), "tractions must end with 0, got 2 MPa in row 2"),
    (table_of([0, 1, 2], [18, -3, 0]), "tractions must be positive, got -3 MPa in row 2"),
    (table_of([0, 1], [0, 0]), "tractions must be positive, got 0 MPa in row 1"),
    (table_of([0, 1, 2], [18, np.nan, 0]), "tractions must be positive, got nan MPa in row 2"),
    (table_of([0, 1, 2], [18, 20, 0]), "must not rise.*part first.*20 MPa in row 2"),
    (table_of([0.5, 1], [18, 2]), "got 0.5 mm in row 1.*got 2 MPa in row 2"),
    (table_of([0, 1, 2], [18, 0]), "the same number of points, at least 2, got 3 and 2"),
    (table_of([0], [0]), "the same number of points, at least 2, got 1 and 1"),
    (table_of([0, "1"], [18, 0]), "openings must be numbers, got"),
    (table_of([0, 0.04], [18, 0]), "onset must be small beside opening_u = 0.04 mm"),
    (bilinear(knee_opening=5.0), "knee_opening < opening_u, .* got 5.0 and 4.0 mm"),
    (bilinear(knee_traction=20.0), "knee_traction <= strength, .* 20.0 and 18.0 MPa"),
    (bilinear(onsett=0.1), "no argument onsett; did you mean onset"),
]


@pytest.mark.parametrize(("make", "said"), REFUSED)
def test_what_is_no_law_is_refused(make, said):
    with pytest.raises(ValueError, match=f"(?s){said}"):
        make()
