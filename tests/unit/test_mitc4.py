"""Strains, resultants and forces of one quad against their definitions."""

import numpy as np
import pytest

from naive import cases
from naive import shell as naive
from shellcut.material import Elastic, Layer, ShellMaterial
from shellcut.mitc4 import N_STRAIN, covariant_metric, nodal_forces, resultants
from shellcut.section import build_sections

EPS = np.finfo(float).eps


def a_quad(seed=0):
    """Corners of a skewed, warped quad and directors that are neither equal nor normal to it."""
    rng = np.random.default_rng(seed)
    x = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.0]]) + rng.uniform(-0.3, 0.3, (4, 3))
    t = np.array([0, 0, 1]) + rng.uniform(-0.4, 0.4, (4, 3))
    return x, t / np.linalg.norm(t, axis=1)[:, None]


@pytest.mark.parametrize("seed", range(3))
def test_metric_is_the_twenty_products(seed):
    x, t = a_quad(seed)
    m = np.full(N_STRAIN, np.nan)
    covariant_metric(x, t, m)
    # Round-off: sums of some ten products of numbers of size one.
    np.testing.assert_allclose(m, naive.metric(x, t), rtol=0, atol=16 * EPS)


@pytest.mark.parametrize("k", range(N_STRAIN))
def test_nodal_forces_are_the_derivative_of_each_product(k):
    x, t = a_quad(7)
    r = np.zeros(N_STRAIN)
    r[k] = 1.0
    fx, ft = np.full((4, 3), np.nan), np.full((4, 3), np.nan)
    nodal_forces(x, t, r, fx, ft)
    tiny = 1e-30  # a complex step has no cancellation: exact to round-off
    for out, which in ((fx, 0), (ft, 1)):
        for a in range(4):
            for c in range(3):
                now = [x.astype(complex), t.astype(complex)]
                now[which][a, c] += 1j * tiny
                slope = naive.metric(*now)[k].imag / tiny
                assert abs(out[a, c] - slope) <= 16 * EPS, (k, which, a, c)


def test_resultants_are_the_gradient_of_the_quadratic_energy():
    # A coupled section: the layers are not symmetric, so all of H is filled.
    layers = [Layer(Elastic(1500.0, 0.3, 1e-9), 0.05), Layer(Elastic(60e3, 0.33, 2.7e-9), 0.01)]
    mesh = cases.warped(1, 1)
    section = build_sections(mesh.nodes, mesh.directors, mesh.quads, ShellMaterial(layers))
    assert not section.flat[0]
    s = np.random.default_rng(2).uniform(-1, 1, N_STRAIN)

    def energy(strain):
        total = 0.0
        for q, (xi, eta) in enumerate(naive.GAUSS):
            i, j = int(eta > 0), int(xi > 0)
            g1 = 0.5 * (1 - eta) * strain[16] + 0.5 * (1 + eta) * strain[17]
            g2 = 0.5 * (1 - xi) * strain[18] + 0.5 * (1 + xi) * strain[19]
            v = np.array(
                [
                    *(strain[i], strain[2 + j], strain[4 + q]),
                    *(strain[8 + i], strain[10 + j], strain[12 + q], g1, g2),
                ]
            )
            total += 0.5 * v @ section.h_full[0, q] @ v
        return total

    r = np.full(N_STRAIN, np.nan)
    resultants(s, False, section.h_flat, section.h_full, 0, r)
    gradient = np.zeros(N_STRAIN)
    for k in range(N_STRAIN):
        z = s.astype(complex)
        z[k] += 1e-30j
        gradient[k] = energy(z).imag / 1e-30
    # Round-off against the largest resultant.
    np.testing.assert_allclose(r, gradient, rtol=0, atol=1e-14 * np.abs(r).max())
    assert 0.5 * s @ r == pytest.approx(energy(s), rel=1e-13)


def test_compact_and_full_stiffness_agree_on_a_flat_quad():
    mesh = cases.skewed_flat(1, 1, seed=4)
    section = build_sections(mesh.nodes, mesh.directors, mesh.quads, cases.FILM)
    assert section.flat[0]
    # An invisible tilt of one director sends the same quad down the full path.
    tilted = mesh.directors.copy()
    tilted[0, 0] += 1e-11
    full = build_sections(mesh.nodes, tilted, mesh.quads, cases.FILM)
    assert not full.flat[0]
    s = np.random.default_rng(2).uniform(-1, 1, N_STRAIN)
    s[8:16] /= cases.FILM.thickness  # so that bending weighs as much as stretching
    r, r_full = np.empty(N_STRAIN), np.empty(N_STRAIN)
    resultants(s, True, section.h_flat, section.h_full, 0, r)
    resultants(s, False, full.h_flat, full.h_full, 0, r_full)
    # The tilt of 1e-11 itself, some ten times that in the products of the stiffness.
    for part in (slice(0, 8), slice(8, 16), slice(16, 20)):
        np.testing.assert_allclose(r_full[part], r[part], rtol=0, atol=1e-9 * np.abs(r[part]).max())
