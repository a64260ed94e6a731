"""Laws between logarithmic strain and its stress: plain reference, closed forms, refusals."""

import numba as nb
import numpy as np
import pytest

import shellcut as sc
from naive import plastic as naive
from shellcut.material import MaterialPoint
from shellcut.material import logarithmic_strain as log_strain
from shellcut.material.hardening import ACCURACY, FARTHEST
from shellcut.material.rate_factor import RateFactor
from shellcut.material.secants import secants_at
from shellcut.numerics.lane_exponentials import exponential, logarithm
from shellcut.numerics.lane_functions import any_above
from shellcut.numerics.lanes import pick, put

E, NU = 1000.0, 0.35
FILM = sc.Elastic(E, NU, 1e-9)
DRAWN = sc.Orthotropic(1500.0, 2500.0, 0.3, 700.0, 1e-9, angle_deg=20.0)
R_VALUES = (0.8, 1.2, 1.6)
POINTS = (0.0, 0.1, 0.5), (20.0, 30.0, 60.0)
KINDS = {
    "linear": (sc.Plastic(FILM, sc.Linear(20.0, 50.0)), naive.linear(20.0, 50.0)),
    "Voce": (sc.Plastic(FILM, sc.Voce(20.0, 30.0, 0.05, 5.0)), naive.voce(20.0, 30.0, 0.05, 5.0)),
    "table": (sc.Plastic(FILM, sc.Table(*POINTS)), naive.table(*POINTS)),
    "Hill": (sc.Plastic(FILM, sc.Swift(60.0, 0.002, 0.2), R_VALUES), naive.swift(60.0, 0.002, 0.2)),
    "drawn": (sc.Plastic(DRAWN, sc.Linear(20.0), R_VALUES, angle_deg=50.0), naive.linear(20.0)),
}
"""Materials, and the formulae of their yield stress."""


@nb.njit
def _of_one(E):
    e, transform = log_strain.logarithmic_strain((E[0], E[1], E[2]))
    return np.array(e), np.array(log_strain.second_piola_kirchhoff((1.0, 0.5, 0.3), transform))


@nb.njit
def _of_eight(table, found):
    strain = (pick(table, 0, 0, None), pick(table, 0, 1, None), pick(table, 0, 2, None))
    e, transform = log_strain.logarithmic_strain(strain)
    S = log_strain.second_piola_kirchhoff((e[0], e[1], e[2]), transform)
    for k in range(3):
        put(found, 0, k, None, (e[0], e[1], e[2])[k])
        put(found, 0, 3 + k, None, (S[0], S[1], S[2])[k])
    put(found, 0, 6, None, logarithm(1.0 + strain[0]))
    put(found, 0, 7, None, exponential(strain[0]))
    return any_above(strain[0], 1.0), any_above(strain[0], 10.0)


@nb.njit
def _both_forms(E, bulk, shear):
    """Return S, t², |T_d|² and energy by the short and the long form, and whether E is small."""
    e = (E[0], E[1], E[2])
    S, of_mean, of_shear, stored = log_strain.small_isotropic(e, bulk, shear)
    (both, unlike, slip), transform = log_strain.sum_and_difference(e)
    t, Tu, Tv = bulk * both, shear * unlike, shear * slip
    L = log_strain.piola_of_mean(t, Tu, Tv, transform)
    energy = 0.5 * (t * both + Tu * unlike + Tv * slip)
    short = np.array([S[0], S[1], S[2], of_mean, of_shear, stored])
    long = np.array([L[0], L[1], L[2], t * t, Tu * Tu + Tv * Tv, energy])
    return short, long, log_strain.is_small(e)


def _strains(size, rng):
    """Green-Lagrange strains of deformations about the identity."""
    while True:
        F = np.eye(2) + size * rng.uniform(-1, 1, (2, 2))
        if np.linalg.det(F) > 0.1:
            C = F.T @ F
            return 0.5 * np.array([C[0, 0] - 1, C[1, 1] - 1, 2 * C[0, 1]])


@pytest.mark.parametrize("size", [1e-9, 1e-3, 0.03, 0.1, 0.3, 1.0, 2.0])
def test_strain_and_transformed_stress_are_those_of_eigenvectors(size):
    rng = np.random.default_rng(5)
    for _ in range(20):
        E = _strains(size, rng)
        e, S = _of_one(E)
        # Round-off of the reference: of ln(1 + x), and of differences of the fourth order.
        np.testing.assert_allclose(e, naive.logarithm(E), rtol=1e-13, atol=1e-15)
        wanted = naive.second_piola_kirchhoff([1.0, 0.5, 0.3], E)
        np.testing.assert_allclose(S, wanted, rtol=0, atol=1e-8 * abs(wanted).max())


@pytest.mark.parametrize("size", [1e-9, 1e-4, 4e-3, 0.0068, 0.0069, 0.02, 0.0355, 0.036, 0.08, 0.2])
@pytest.mark.parametrize(
    "shape", [(1.0, -0.3, 0.0), (1.0, 0.3, 0.2), (0.0, 0.0, 1.3), (-1.0, 0.3, 0.0)]
)
def test_series_of_every_range_of_strains_are_exact_to_the_last_places(size, shape):
    E = size * np.array(shape)
    # In the 64 bits of x86's long double; the axes turn by sine and cosine, without eigenvectors.
    mean, u, v = (np.longdouble(one) for one in ((E[0] + E[1]) / 2, (E[0] - E[1]) / 2, E[2] / 2))
    r = np.sqrt(u * u + v * v)
    first, second = (np.log1p(2 * (mean + sign * r)) / 2 for sign in (1, -1))
    middle, half = (first + second) / 2, (first - second) / 2
    wanted = np.array([middle + half * u / r, middle - half * u / r, 2 * half * v / r], float)
    e, _ = _of_one(E)
    # A few roundings of doubles, of the largest component.
    np.testing.assert_allclose(e, wanted, rtol=0, atol=6e-16 * abs(wanted).max())


@pytest.mark.parametrize("size", [1e-9, 1e-4, 2e-3, 4.4e-3])
@pytest.mark.parametrize("shape", [(1.0, -0.3, 0.0), (1.0, 0.3, 0.2), (0.0, 0.0, 1.3), (1.0, 1, 0)])
def test_the_short_form_of_an_elastic_film_is_the_long_one(size, shape):
    short, long, small = _both_forms(size * np.array(shape), 1200.0, 650.0)
    assert small
    assert not _both_forms(0.01 * np.array(shape), 1.0, 1.0)[2]
    largest = np.sqrt(long[3:5].max())
    # A few roundings of doubles, of the largest component.
    np.testing.assert_allclose(short[:3], long[:3], rtol=0, atol=1.5e-15 * largest)
    np.testing.assert_allclose(short[3:5], long[3:5], rtol=0, atol=3e-15 * largest**2)
    assert short[5] == pytest.approx(long[5], rel=2e-15)


def test_lanes_are_the_numbers_one_by_one():
    rng = np.random.default_rng(6)
    for sizes in ([0.01] * 8, [0.1] * 8, [1e-4, 0.01, 0.1, 0.3, 0.5, 1.0, 2.0, 3.0]):
        table, found = np.zeros((1, 3, 8)), np.zeros((1, 8, 8))
        for lane, size in enumerate(sizes):
            table[0, :, lane] = _strains(size, rng)
        above = _of_eight(table, found)
        assert above == ((table[0, 0] > 1.0).any(), (table[0, 0] > 10.0).any())
        for lane in range(8):
            e, _ = _of_one(np.ascontiguousarray(table[0, :, lane]))
            # Two units of the last place of the logarithm, and another order of operations.
            np.testing.assert_allclose(found[0, :3, lane], e, rtol=1e-14, atol=1e-15)
        np.testing.assert_allclose(found[0, 6], np.log(1 + table[0, 0]), rtol=1e-15, atol=3e-16)
        np.testing.assert_allclose(found[0, 7], np.exp(table[0, 0]), rtol=5e-16)


def test_a_film_folded_flat_gives_numbers():
    for E in ([-0.5, 0.0, 0.0], [-0.5, -0.5, 0.0], [-3.0, -2.0, 9.0], [0.0, 0.0, 5.0]):
        e, S = _of_one(np.array(E))
        assert np.isfinite(e).all()
        assert np.isfinite(S).all()
    assert np.isfinite(MaterialPoint(KINDS["Voce"][0]).pull(np.log(4.0)).stress).all()  # 300 %


FORMULAE = [
    *((sc.Linear(*n), naive.linear(*n)) for n in ((20.0,), (20.0, 50.0), (1e-3, 1e5))),
    *(
        (sc.Swift(*n), naive.swift(*n))
        for n in (
            (164.51, 2.951e-4, 0.257),
            (522.09, 6.794e-4, 0.18),
            (150.0, 0.002, 0.0),  # an ideal film
            (150.0, 0.002, 1.0),  # straight
            (300.0, 1e-9, 0.5),  # no film is so
            (20.0, 3.0, 0.9),
        )
    ),
    *(
        (sc.Voce(*n), naive.voce(*n))
        for n in (
            (20.0, 30.0, 0.05, 5.0),
            (50.0, 20.0, 0.1),
            (10.0, 0.0, 0.1, 3.0),
            (0.01, 1e3, 1e-4, 0.0),
            (10.0, 1.0, 500.0, 1.0),
        )
    ),
]


@pytest.mark.parametrize(("hardening", "formula"), FORMULAE)
def test_tables_of_formulae_are_within_their_accuracy(hardening, formula):
    corners = np.array(hardening.plastic_strain)
    within = [corners[:-1] + w * np.diff(corners) for w in np.linspace(0, 1, 21)]
    p = np.concatenate([np.geomspace(1e-12, FARTHEST, 20_000), corners, *within])
    assert corners[-1] == pytest.approx(FARTHEST)
    assert hardening.stress(p) == pytest.approx(formula(p), rel=ACCURACY)
    assert hardening.first_yield == pytest.approx(formula(0.0), rel=1e-15)
    # Beyond the end it is constant.
    assert hardening.stress(2.0 * FARTHEST) == hardening.stress_at[-1]


@pytest.mark.parametrize(("material", "formula"), KINDS.values(), ids=KINDS)
def test_steps_of_any_size_are_those_of_the_plain_twin(material, formula):
    rng = np.random.default_rng(7)
    P = naive.flow(material.r_values or (1.0, 1.0, 1.0), material.angle_deg)
    C = naive.elastic(material.elastic)
    yields_at = naive.table(material.hardening.plastic_strain, material.hardening.stress_at)
    for size in (0.02, 0.3):
        point, history = MaterialPoint(material), (0.0, np.zeros(3))
        smooth = history
        strain, work = np.zeros(3), 0.0
        for _ in range(12):
            strain = strain + size * rng.uniform(-1, 1, 3)
            state = point.strain_to(strain)
            T, *history = naive.step(C, P, yields_at, strain, history)
            S, *smooth = naive.step(C, P, formula, strain, smooth)
            # The formula's own film: stresses and strains differ as the yield stresses do.
            np.testing.assert_allclose(state.stress, S, rtol=0, atol=3e-4 * abs(S).max())
            # The last correction is of the first order: 1e-11 of the stress.
            np.testing.assert_allclose(state.stress, T, rtol=0, atol=1e-9 * abs(T).max())
            p, above, *plastic = state.history.values()
            assert p == pytest.approx(history[0], rel=1e-9)
            # What the next step begins with: the last correction counts here, too.
            assert above == pytest.approx(yields_at(p) - yields_at(0.0), rel=1e-9, abs=1e-10)
            np.testing.assert_allclose(plastic, history[1], atol=1e-9 * max(history[0], 1e-3))
            elastic = strain - history[1]
            assert state.stored == pytest.approx(0.5 * (elastic @ C @ elastic), rel=1e-8)
            assert state.dissipated >= work
            work = state.dissipated
        assert history[0] > size


@pytest.mark.parametrize(("material", "_"), KINDS.values(), ids=KINDS)
def test_work_is_what_is_stored_and_dissipated(material, _):
    point, turn = MaterialPoint(material), np.linspace(0.0, 6.0, 600)
    parts = np.sin(turn), 0.3 * np.sin(2 * turn), 0.8 * (1 - np.cos(turn))
    strains = 0.05 * np.stack(parts, axis=1)
    states = [point.strain_to(strain) for strain in strains]
    stresses = np.array([state.stress for state in states])
    work = (0.5 * (stresses[1:] + stresses[:-1]) * np.diff(strains, axis=0)).sum()
    # The trapezoidal rule over steps that begin elastic and end plastic.
    assert work == pytest.approx(states[-1].stored + states[-1].dissipated, rel=2e-3)
    assert states[-1].dissipated > 0.5 * work


MODES = {  # strain, its stress; equivalent stress and strain over these; modulus
    "uniaxial": (None, 0, 1.0, 1.0, E),
    "equibiaxial": ([1.0, 1.0, 0.0], 0, 1.0, 2.0, E / (1.0 - NU)),
    "shear": ([0.0, 0.0, 2.0], 2, np.sqrt(3.0), 2.0 / np.sqrt(3.0), E / (1.0 + NU)),
}


@pytest.mark.parametrize(
    "law",
    [
        lambda least: sc.Voce(least, 10.0, 0.05),
        lambda least: sc.Voce(20.0, 10.0, least),
        lambda least: sc.Swift(150.0, least, 0.2),
    ],
)
def test_a_formula_that_no_table_follows_is_refused(law):
    with pytest.raises(ValueError, match="at most 20,000 parts, needs inf: take a larger"):
        law(5e-324)


@pytest.mark.parametrize("kind", ["Voce", "table"])
@pytest.mark.parametrize("mode", MODES)
def test_monotonic_curves_are_the_hardening_itself(kind, mode):
    """To 100 % of logarithmic strain; the stress is σ_y at p = ε - σ/E exactly."""
    material, formula = KINDS[kind]
    way, k, of_stress, of_strain, modulus = MODES[mode]
    point = MaterialPoint(material)
    for strain in (0.05, 0.3, 1.0):
        state = point.strain_to(strain * np.array(way)) if way else point.pull(strain)
        stress, p = of_stress * state.stress[k], state.history["equivalent plastic strain [-]"]
        assert stress == pytest.approx(float(material.hardening.stress(p)), rel=1e-8)
        assert stress == pytest.approx(formula(p), rel=ACCURACY)
        assert p == pytest.approx(of_strain * (strain - state.stress[k] / modulus), rel=1e-8)
        # What flows keeps its volume.
        elastic = (1.0 - 2.0 * NU) / E * state.stress[:2].sum()
        thinner = np.exp(elastic - state.strain[:2].sum())
        assert state.thickness_stretch == pytest.approx(thinner, rel=1e-8)


def test_hencky_is_the_closed_form_and_orthotropic_turns():
    state = MaterialPoint(sc.Hencky(FILM)).pull(0.7)
    assert state.stress[0] == pytest.approx(0.7 * E, rel=1e-9)
    assert state.strain[1] == pytest.approx(-0.7 * NU, rel=1e-8)
    assert state.thickness_stretch == pytest.approx(np.exp(-0.7 * NU), rel=1e-8)
    for angle in (0.0, 30.0, 90.0):
        turned = sc.Hencky(sc.Orthotropic(1500.0, 2500.0, 0.3, 700.0, 1e-9, angle_deg=-angle))
        c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
        flexible = c**4 / 1500 + s**4 / 2500 + c * c * s * s * (1 / 700 - 2 * 0.3 / 1500)
        stress = MaterialPoint(turned).pull(1e-3).stress[0]
        assert stress == pytest.approx(1e-3 / flexible, rel=1e-8)


@pytest.mark.parametrize(
    "factor",
    [sc.CowperSymonds(40.0, 5.0), sc.CowperSymonds(100.0, 10.0), sc.JohnsonCook(0.05, 1.0)],
)
@pytest.mark.parametrize("beyond", [1e-12, 1e-8, 1e-6, 3e-6, 1e-5, 1e-3, 0.1, 5.0])
def test_a_trial_however_little_beyond_the_yield_stress_flows_at_its_rate(factor, beyond):
    # Just above it the rate law asks for flows of 1e-30 and less, from a slope without end.
    dt, shear = 1e-7, 0.5 * E / (1.0 + NU)
    parameters, f = np.array(factor.row()), type(factor).function
    strain = 20.0 * (1.0 + beyond) / np.sqrt(3) / shear
    point = MaterialPoint(sc.Plastic(FILM, sc.Linear(20.0, 50.0), rate=factor))
    state = point.strain_to(np.array([0.0, 0.0, strain]), dt=dt)
    low, high = np.log(1e-40), np.log(20.0 * beyond / (3.0 * shear))
    for _ in range(100):  # halves the logarithm of the flow
        middle = 0.5 * (low + high)
        p = np.exp(middle)
        trial = np.sqrt(3) * shear * (strain - np.sqrt(3) * p)
        above = trial > (20.0 + 50.0 * p) * f(parameters, 0, p / dt)[0]
        low, high = (middle, high) if above else (low, middle)
    # What the last correction leaves.
    wanted = shear * (strain - np.sqrt(3) * np.exp(low))
    assert state.stress[2] == pytest.approx(wanted, rel=1e-10)
    assert state.dissipated >= 0.0
    # Output asks again in no time: the same stress, and nothing is lost.
    again = point.strain_to(state.strain, dt=0.0)
    np.testing.assert_allclose(again.stress, state.stress, rtol=1e-12, atol=1e-9)
    assert (again.dissipated, again.history) == (state.dissipated, state.history)


HARD = sc.Linear(20.0)


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: sc.Linear(20.0, -1.0), "modulus must be 0 or more .a film that softens"),
        (lambda: sc.Table((0.0, 0.1), (20.0, 19.0)), "stress must not decrease"),
        (lambda: sc.Table((0.1, 0.2), (20.0, 21.0)), "plastic_strain must start at 0"),
        (lambda: sc.Table((0.0,), (20.0,)), "at least 2 points"),
        (lambda: sc.Plastic(FILM, HARD, (1.0, -0.5, 1.0)), "not closed and convex"),
        (
            lambda: sc.Plastic(FILM, 2.0, angle_deg="x"),
            "hardening must be a Table.*; angle_deg must",
        ),
        (lambda: sc.Plastic(FILM, HARD, kinematic=5.0), "there is no argument kinematic"),
        (lambda: sc.Plastic(FILM, HARD, rate=RateFactor()), "rate must be a CowperSymonds"),
        (lambda: sc.Plastic(3, HARD), "elastic must be an Elastic or an Orthotropic"),
        (lambda: sc.Hencky(3), "elastic must be an Elastic or an Orthotropic"),
        (lambda: sc.Orthotropic(100.0, 400.0, 0.6, 50.0, 1e-9), "poisson must lie between"),
    ],
)
def test_what_cannot_be_is_refused_with_a_sentence(make, said):
    with pytest.raises(ValueError, match=said):
        make()


def test_the_work_of_a_film_that_yields_at_a_rate_is_stored_or_lost():
    point = MaterialPoint(sc.Plastic(FILM, sc.Linear(20.0, 50.0), rate=sc.CowperSymonds(40.0, 5.0)))
    work, strain, stress = 0.0, np.zeros(3), np.zeros(3)
    for along in np.linspace(0.0, 0.1, 101)[1:]:
        state = point.pull(along, dt=1e-5)
        work += 0.5 * (stress + state.stress) @ (state.strain - strain)
        strain, stress = state.strain, state.stress
    assert 0.0 < state.stored < 0.5 * work
    # Of a hundred steps each flows with the stress at its end.
    assert state.stored + state.dissipated == pytest.approx(work, rel=2e-3)


@pytest.mark.parametrize("r_values", [None, (3.0, 3.0, 3.0), (0.3, 0.5, 0.4)])
def test_the_secant_where_a_film_is_pulled_in_all_directions(r_values):
    """A film that resists thinning yields later so, one that thins easily sooner."""
    foil = sc.Plastic(FILM, sc.Linear(20.0, 50.0), r_values=r_values)
    film, tension = sc.ShellMaterial([sc.Layer(foil, 0.05)]), 40.0
    point = MaterialPoint(foil)
    for part in np.linspace(0.02, 1.0, 50):
        state = point.stress_to(np.array([part * tension, part * tension, 0.0]))
    (secant,), strain = secants_at(film, tension * 0.05)
    assert strain == pytest.approx(0.5 * (state.strain[0] + state.strain[1]), rel=2e-3)
    elastic = tension * (1.0 - NU) / E
    assert secant == pytest.approx(elastic / strain, rel=1e-9)
