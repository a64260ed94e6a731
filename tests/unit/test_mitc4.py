"""Strains, resultants and forces of a quad against their definitions."""

import numpy as np
import pytest

from from_python import from_python
from naive import cases
from naive import shell as naive
from shellcut.material.shell_material import Elastic, Layer, ShellMaterial
from shellcut.mitc4.element import (
    N_FULL,
    N_STRAIN,
    flat_resultants,
    full_resultants,
    modes,
    nodal_forces,
    products,
)
from shellcut.mitc4.section import flat_moduli, flat_stiffness, full_stiffness, strain_map
from shellcut.mitc4.tangent import quad_products
from shellcut.numerics.jit import kernel

EPS = np.finfo(float).eps

_modes, _products, _nodal_forces = map(from_python, (modes, products, nodal_forces))


def a_quad(seed=0):
    """Corners of a skewed, warped quad and directors that are neither equal nor normal to it."""
    rng = np.random.default_rng(seed)
    x = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.0]]) + rng.uniform(-0.3, 0.3, (4, 3))
    t = np.array([0, 0, 1]) + rng.uniform(-0.4, 0.4, (4, 3))
    return x, t / np.linalg.norm(t, axis=1)[:, None]


def modes_of(v):
    return _modes(*(tuple(corner) for corner in v.tolist()))


@pytest.mark.parametrize("seed", range(3))
def test_products_are_those_of_the_modes(seed):
    x, t = a_quad(seed)
    m = _products(modes_of(x), modes_of(t))
    # Round-off: sums of some ten products of numbers of size four.
    np.testing.assert_allclose(m, naive.products(x, t), rtol=0, atol=256 * EPS)


@pytest.mark.parametrize(("xi", "eta"), [*naive.GAUSS, (0.3, -0.8)])
def test_products_hold_the_strains_at_every_point(xi, eta):
    # Membrane and bending exactly, and the transverse shear as tied at the mid-edge points.
    x, t = a_quad(5)
    wanted = naive.generalised(x, t, xi, eta)
    np.testing.assert_allclose(strain_map(xi, eta) @ naive.products(x, t), wanted, atol=16 * EPS)


@pytest.mark.parametrize("k", range(N_STRAIN))
def test_nodal_forces_are_the_derivative_of_each_product(k):
    x, t = a_quad(7)
    r = tuple(float(k == i) for i in range(N_STRAIN))
    forces = -np.array(_nodal_forces(modes_of(x), modes_of(t), r))
    tiny = 1e-30  # a complex step has no cancellation: exact to round-off
    for first, which in ((0, 0), (3, 1)):
        for a in range(4):
            for c in range(3):
                now = [x.astype(complex), t.astype(complex)]
                now[which][a, c] += 1j * tiny
                slope = naive.products(*now)[k].imag / tiny
                assert abs(forces[a, first + c] - slope) <= 64 * EPS, (k, which, a, c)


@kernel
def _full(h, s, r):
    work = np.empty((2, 16, 8))
    for lane in range(8):
        v = full_resultants(
            h,
            0,
            lane,
            (
                *(s[0], s[1], s[2], s[3], s[4], s[5], s[6], s[7]),
                *(s[8], s[9], s[10], s[11], s[12], s[13], s[14], s[15]),
            ),
            work,
        )
        for k in range(16):
            r[lane, k] = v[k]


def test_resultants_are_the_gradient_of_the_quadratic_energy():
    # A coupled section: the layers are not symmetric, so all of H is filled.
    layers = [Layer(Elastic(1500.0, 0.3, 1e-9), 0.05), Layer(Elastic(60e3, 0.33, 2.7e-9), 0.01)]
    mesh = cases.warped(1, 1)
    X, T = mesh.nodes[mesh.quads], mesh.directors[mesh.quads]
    upper = full_stiffness(X, T, ShellMaterial(layers))[0]
    assert upper.shape == (N_FULL,)
    H = np.zeros((16, 16))
    H[np.triu_indices(16)] = upper
    H += np.triu(H, 1).T
    s = np.random.default_rng(2).uniform(-1, 1, N_STRAIN)
    r = np.full((8, N_STRAIN), np.nan)
    _full(np.repeat(upper[None, :, None], 8, axis=2), s, r)
    # Round-off against the largest resultant.
    np.testing.assert_allclose(r[0], H @ s, rtol=0, atol=1e-14 * np.abs(H @ s).max())
    assert (r == r[0]).all()


def test_flat_and_full_stiffness_agree_on_a_flat_quad():
    mesh = cases.skewed_flat(1, 1, seed=4)
    X, T = mesh.nodes[mesh.quads], mesh.directors[mesh.quads]
    numbers = np.hstack([quad_products(X, T)[:, :6], flat_stiffness(X, T, cases.FILM)])
    table = np.repeat(numbers[:, :, None], 8, axis=2)
    s = np.random.default_rng(2).uniform(-1, 1, N_STRAIN)
    s[6:12] /= cases.FILM.thickness  # so that bending weighs as much as stretching
    r = np.array(
        from_python(flat_resultants)(table, flat_moduli(cases.FILM), 0, 0, tuple(s.tolist()))
    )
    H = np.zeros((16, 16))
    H[np.triu_indices(16)] = full_stiffness(X, T, cases.FILM)[0]
    H += np.triu(H, 1).T
    for part in (slice(0, 6), slice(6, 12), slice(12, 16)):
        wanted = (H @ s)[part]
        np.testing.assert_allclose(r[part], wanted, rtol=0, atol=1e-13 * np.abs(wanted).max())
