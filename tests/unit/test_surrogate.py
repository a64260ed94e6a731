"""Surfaces through runs: closed forms of their error and of their sensitivities."""

import numpy as np
import pytest
import scipy

from shellcut.study.surrogate import surface
from shellcut.study.surrogate.gaussian_process import GaussianProcess, is_there
from shellcut.study.surrogate.inputs import Input, at_shares, columns_of
from shellcut.study.surrogate.polynomial import Polynomial
from shellcut.study.surrogate.sensitivity import sobol_indices
from shellcut.study.surrogate.surface import fit

THREE = [Input(name, (0.0, 2.0)) for name in "abc"]


@pytest.fixture(params=["gaussian", "polynomial"])
def kind(request, monkeypatch):
    """Both kinds of surfaces; the second as if scikit-learn were not installed."""
    if request.param == "gaussian" and not is_there():
        pytest.skip("needs shellcut[study]")
    monkeypatch.setattr(surface, "is_there", lambda: request.param == "gaussian")
    return request.param


def points(inputs, n, seed=1):
    return at_shares(inputs, scipy.stats.qmc.LatinHypercube(len(inputs), seed=seed).random(n))


def within(intervals, known):
    return [low <= value <= high for (low, high), value in zip(intervals, known, strict=True)]


class TestSensitivity:
    # Of a b, each even from 0 to 2: E² V = 1/3 of each alone, V² = 1/9 of both, so 3/7, 3/7, 1/7.
    FIRST, TOTAL = (3 / 7, 3 / 7, 0.0), (4 / 7, 4 / 7, 0.0)

    def test_of_a_product_is_the_closed_form(self, kind):
        values = points(THREE, 32)
        fitted = fit(THREE, values, 5.0 * values[:, 0] * values[:, 1])
        assert fitted.explained > 0.99
        found = sobol_indices(fitted.surface)
        # 512 points of a Sobol' sequence: sampling, a few percent
        assert found.first == pytest.approx(self.FIRST, abs=0.04)
        assert found.total == pytest.approx(self.TOTAL, abs=0.04)
        # zero is the end of an interval, but for the little that a process leaves
        assert all(within(found.first_interval[:2], self.FIRST[:2]))
        assert all(within(found.total_interval[:2], self.TOTAL[:2]))
        assert found.total[2] < 0.01

    def test_intervals_hold_the_closed_form_under_noise_and_are_wider(self, monkeypatch):
        monkeypatch.setattr(surface, "is_there", lambda: False)
        values = points(THREE, 32, seed=4)
        product = values[:, 0] * values[:, 1]
        noise = 0.25 * np.random.default_rng(2).standard_normal(32)
        exact = sobol_indices(fit(THREE, values, product).surface)
        noisy = sobol_indices(fit(THREE, values, product + noise).surface)
        assert all(within(noisy.first_interval[:2], self.FIRST[:2]))
        assert all(within(noisy.total_interval[:2], self.TOTAL[:2]))
        assert (np.ptp(noisy.total_interval, axis=1) > np.ptp(exact.total_interval, axis=1)).all()

    def test_of_names_and_a_number_is_the_closed_form(self, kind):
        inputs = [Input("cap", (0.0, 2.0), ("a", "b", "c")), Input("pitch", (8.0, 12.0))]
        values = points(inputs, 36)
        level = np.array([0.0, 1.0, 5.0])
        found = fit(inputs, values, level[values[:, 0].astype(int)] + values[:, 1])
        assert found.error < 0.1  # of a figure of standard deviation 2.4
        # variance of the three levels 14/3, of a range of 4 even 16/12
        share = (14 / 3) / (14 / 3 + 4 / 3)
        assert sobol_indices(found.surface).first == pytest.approx((share, 1 - share), abs=0.05)

    def test_of_one_input_is_refused(self):
        x = np.linspace(0.0, 2.0, 9)[:, None]
        with pytest.raises(ValueError, match="compare two inputs or more, got 1"):
            sobol_indices(Polynomial(THREE[:1], x, x[:, 0]))


class TestIshigami:
    @pytest.mark.slow  # the product of TestSensitivity is its quick sibling
    def test_a_process_of_128_runs_finds_its_indices(self):
        if not is_there():
            pytest.skip("needs shellcut[study]")
        inputs = [Input(name, (-np.pi, np.pi)) for name in "abc"]
        values = at_shares(inputs, scipy.stats.qmc.Sobol(3, seed=1).random(128))
        a, b, c = values.T
        figure = np.sin(a) + 7.0 * np.sin(b) ** 2 + 0.1 * c**4 * np.sin(a)
        fitted = fit(inputs, values, figure)
        found = sobol_indices(fitted.surface)
        assert fitted.explained > 0.7
        assert all(within(found.first_interval, (0.3139, 0.4424, 0.0)))
        # within the error of the surface, which explains four fifths
        assert found.total == pytest.approx((0.5576, 0.4424, 0.2437), abs=0.12)


class TestError:
    def test_of_a_noisy_plane_is_the_noise(self, kind):
        values = points(THREE, 64)
        noise = 0.5 * np.random.default_rng(3).standard_normal(64)
        plane = 30.0 * values[:, 0] - 10.0 * values[:, 1] + noise
        found = fit(THREE, values, plane)
        # the spread of 64 values 9 %, what the surface itself misses 5 %
        assert found.error == pytest.approx(noise.std(), rel=0.15)
        assert found.mean_error == pytest.approx(plane.std(), rel=0.05)
        assert (found.n_run, found.n_fold) == (64, 10)

    def test_of_noise_is_no_better_than_the_mean(self, kind):
        values = points(THREE, 32)
        found = fit(THREE, values, np.random.default_rng(5).standard_normal(32))
        assert found.explained < 0.1

    def test_few_runs_are_left_out_one_by_one(self, kind):
        values = points(THREE, 8)
        found = fit(THREE, values, values @ [1.0, 2.0, 3.0])
        assert found.n_fold == 8
        assert found.error < 0.05 * found.mean_error

    def test_a_process_of_many_runs_takes_a_part_of_them(self, monkeypatch):
        if not is_there():
            pytest.skip("needs shellcut[study]")
        monkeypatch.setattr(surface, "_MOST", 10)
        values = points(THREE, 64)
        found = fit(THREE, values, values.sum(axis=1))
        assert (found.n_run, len(set(found.rows.tolist()))) == (10, 10)


class TestPolynomial:
    def test_takes_the_degree_that_predicts_best(self):
        values = points(THREE, 64)
        a, b, _ = values.T
        degrees = [Polynomial(THREE, values, f).degree for f in (a + b, a * b, a**2 * b)]
        # all degrees describe the first two exactly; round-off must not choose wildly
        assert degrees[2] == 3
        assert degrees[1] >= 2

    def test_draws_have_the_error_of_the_coefficients(self):
        x = np.linspace(0.0, 2.0, 50)[:, None]
        noise = np.random.default_rng(1).standard_normal(50)
        plane = Polynomial(THREE[:1], x, 3.0 * x[:, 0] + noise)
        assert plane.degree == 1
        middle = np.array([[1.0]])
        drawn = plane.draws(middle, 4000, np.random.default_rng(2))[:, 0]
        missed = 3.0 * x[:, 0] + noise - plane.predict(x)
        error = np.sqrt(missed @ missed / 48 / 50)  # of a mean of 50
        assert drawn.mean() == pytest.approx(plane.predict(middle)[0], abs=0.1 * error)
        assert drawn.std() == pytest.approx(error, rel=0.06)  # Student's t of 48: 2 %


def test_draws_of_a_process_go_through_runs_without_noise():
    if not is_there():
        pytest.skip("needs shellcut[study]")
    values = points(THREE[:2], 16)
    process = GaussianProcess(THREE[:2], values, values[:, 0] ** 2)
    drawn = process.draws(values, 20, np.random.default_rng(0))
    assert np.abs(drawn - values[:, 0] ** 2).max() < 0.05


class TestRefused:
    def test_too_few_runs(self, kind):
        values = points(THREE, 4)
        with pytest.raises(ValueError, match="must rest on 6 runs or more, got 4"):
            fit(THREE, values, values[:, 0])

    def test_a_constant_figure(self, kind):
        with pytest.raises(ValueError, match="must differ from run to run, got 59 in all"):
            fit(THREE, points(THREE, 8), np.full(8, 59.0))

    def test_an_input_of_one_value(self):
        with pytest.raises(ValueError, match="pitch must take two values or more, got only 12"):
            Input("pitch", (12.0, 12.0))


def test_two_names_share_a_column_and_three_have_their_own():
    two, three = Input("a", (0, 1), ("x", "y")), Input("b", (0, 2), ("x", "y", "z"))
    values = np.array([[0.0, 2.0], [1.0, 0.0]])
    assert columns_of([two, three], values).tolist() == [[-1, 0, 0, 1], [1, 1, 0, 0]]
