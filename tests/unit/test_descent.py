import numpy as np

from shellcut.imprinting.descent import minimise


def test_rosenbrocks_valley():
    def value(x):
        a, b = x[1:] - x[:-1] ** 2, 1.0 - x[:-1]
        gradient = np.zeros_like(x)
        gradient[1:] += 200.0 * a
        gradient[:-1] -= 400.0 * a * x[:-1] + 2.0 * b
        return float((100.0 * a**2 + b**2).sum()), gradient

    start = np.tile([-1.2, 1.0], 10)
    found = minimise(value, start, n_step=2000, tolerance=1e-16, first_move=0.1)
    np.testing.assert_allclose(found, 1.0, atol=1e-6)


def test_a_quadratic_in_few_steps():
    diagonal = np.geomspace(1.0, 100.0, 30)
    calls = []

    def value(x):
        calls.append(1)
        return float(0.5 * (diagonal * x * x).sum()), diagonal * x

    found = minimise(value, np.ones(30), n_step=200, tolerance=1e-14, first_move=0.1)
    assert np.abs(found).max() < 1e-5
    assert len(calls) < 120


def test_infinite_values_are_backed_off_from():
    def value(x):
        if x[0] <= 0.0:
            return np.inf, np.zeros(1)
        return float(x[0] - np.log(x[0])), 1.0 - 1.0 / x

    found = minimise(value, np.array([5.0]), n_step=50, tolerance=1e-14, first_move=20.0)
    assert abs(found[0] - 1.0) < 1e-6


def test_at_the_minimum_nothing_moves():
    start = np.zeros(3)
    found = minimise(lambda x: (0.0, np.zeros(3)), start, n_step=5, tolerance=0.0, first_move=1.0)
    np.testing.assert_array_equal(found, start)
