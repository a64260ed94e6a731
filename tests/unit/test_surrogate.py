"""Surfaces through runs: closed forms of their error and of their sensitivities."""

import numpy as np
import pytest
import scipy

pytest.importorskip("sklearn", reason="needs shellcut[study]")

from shellcut.study import surrogate
from shellcut.study.surrogate import Input, Surface, at_shares, columns_of, sobol_indices

THREE = [Input(name, (0.0, 2.0)) for name in "abc"]


def points(inputs, n, seed=1):
    return at_shares(inputs, scipy.stats.qmc.LatinHypercube(len(inputs), seed=seed).random(n))


def within(intervals, known):
    return [low <= value <= high for (low, high), value in zip(intervals, known, strict=True)]


class TestSensitivity:
    # Of a b, each even from 0 to 2: E² V = 1/3 of each alone, V² = 1/9 of both, so 3/7, 3/7, 1/7.
    FIRST, TOTAL = (3 / 7, 3 / 7, 0.0), (4 / 7, 4 / 7, 0.0)

    def test_of_a_product_is_the_closed_form(self):
        values = points(THREE, 32)
        fitted = Surface(THREE, values, 5.0 * values[:, 0] * values[:, 1])
        assert fitted.explained > 0.99
        found = sobol_indices(fitted)
        # 512 points of a Sobol' sequence: sampling, a few percent
        assert found.first == pytest.approx(self.FIRST, abs=0.04)
        assert found.total == pytest.approx(self.TOTAL, abs=0.04)
        # zero is the end of an interval, but for the little that a process leaves
        assert all(within(found.first_interval[:2], self.FIRST[:2]))
        assert all(within(found.total_interval[:2], self.TOTAL[:2]))
        assert found.total[2] < 0.01
        # Under noise the intervals are wider, and hold it, too.
        noise = 0.25 * np.random.default_rng(2).standard_normal(32)
        noisy = sobol_indices(Surface(THREE, values, values[:, 0] * values[:, 1] + noise))
        assert all(within(noisy.first_interval[:2], self.FIRST[:2]))
        assert all(within(noisy.total_interval[:2], self.TOTAL[:2]))
        assert (np.ptp(noisy.total_interval, axis=1) > np.ptp(found.total_interval, axis=1)).all()

    def test_of_names_and_a_number_is_the_closed_form(self):
        inputs = [Input("cap", (0.0, 2.0), ("a", "b", "c")), Input("pitch", (8.0, 12.0))]
        values = points(inputs, 36)
        level = np.array([0.0, 1.0, 5.0])
        found = Surface(inputs, values, level[values[:, 0].astype(int)] + values[:, 1])
        assert found.error < 0.1  # of a figure of standard deviation 2.4
        # variance of the three levels 14/3, of a range of 4 even 16/12
        share = (14 / 3) / (14 / 3 + 4 / 3)
        assert sobol_indices(found).first == pytest.approx((share, 1 - share), abs=0.05)

    @pytest.mark.slow  # the product is its quick sibling
    def test_128_runs_of_ishigami_give_its_indices(self):
        inputs = [Input(name, (-np.pi, np.pi)) for name in "abc"]
        values = at_shares(inputs, scipy.stats.qmc.Sobol(3, seed=1).random(128))
        a, b, c = values.T
        figure = np.sin(a) + 7.0 * np.sin(b) ** 2 + 0.1 * c**4 * np.sin(a)
        fitted = Surface(inputs, values, figure)
        found = sobol_indices(fitted)
        assert fitted.explained > 0.7
        assert all(within(found.first_interval, (0.3139, 0.4424, 0.0)))
        # within the error of the surface, which explains four fifths
        assert found.total == pytest.approx((0.5576, 0.4424, 0.2437), abs=0.12)


class TestError:
    def test_of_a_noisy_plane_is_the_noise(self):
        values = points(THREE, 64)
        noise = 0.5 * np.random.default_rng(3).standard_normal(64)
        plane = 30.0 * values[:, 0] - 10.0 * values[:, 1] + noise
        found = Surface(THREE, values, plane)
        # the spread of 64 values 9 %, what the surface itself misses 5 %
        assert found.error == pytest.approx(noise.std(), rel=0.15)
        assert found.mean_error == pytest.approx(plane.std(), rel=0.05)
        assert (found.n_run, found.n_fold) == (64, 10)

    def test_of_noise_is_no_better_than_the_mean(self):
        values = points(THREE, 32)
        found = Surface(THREE, values, np.random.default_rng(5).standard_normal(32))
        assert found.explained < 0.1

    def test_few_runs_are_left_out_one_by_one(self):
        values = points(THREE, 8)
        found = Surface(THREE, values, values @ [1.0, 2.0, 3.0])
        assert found.n_fold == 8
        assert found.error < 0.05 * found.mean_error

    def test_a_part_of_the_runs_may_have_one_value(self):
        values = np.arange(6.0)[:, None]
        found = Surface(THREE[:1], values / 3.0, np.array([0.0, 0, 0, 0, 0, 1]))
        assert found.left_out[5] == pytest.approx(0.0, abs=1e-12)

    def test_of_many_runs_a_part_is_taken(self, monkeypatch):
        monkeypatch.setattr(surrogate, "_MOST", 10)
        values = points(THREE, 64)
        found = Surface(THREE, values, values.sum(axis=1))
        assert (found.n_run, len(set(found.rows.tolist()))) == (10, 10)


def test_draws_go_through_runs_without_noise():
    values = points(THREE[:2], 16)
    process = Surface(THREE[:2], values, values[:, 0] ** 2)
    drawn = process.draws(values, 20, np.random.default_rng(0))
    assert np.abs(drawn - values[:, 0] ** 2).max() < 0.05


def test_two_names_share_a_column_and_three_have_their_own():
    two, three = Input("a", (0, 1), ("x", "y")), Input("b", (0, 2), ("x", "y", "z"))
    values = np.array([[0.0, 2.0], [1.0, 0.0]])
    assert columns_of([two, three], values).tolist() == [[-1, 0, 0, 1], [1, 1, 0, 0]]
