"""Strains and stiffness of a quad against their definitions, its mass, the flat shortcut."""

import numpy as np
import pytest

from from_python import from_python
from naive import cases
from naive import shell as naive
from shellcut.material.shell_material import Elastic, Layer, ShellMaterial
from shellcut.mesh.structured import cylinder
from shellcut.mitc4.element import modes, products
from shellcut.mitc4.section import (
    flat_quads,
    full_stiffness,
    lumped_mass,
    point_stiffness,
    strain_map,
)

SOFT, STIFF = Elastic(1000.0, 0.3, 1e-9), Elastic(70e3, 0.33, 2.7e-9)


def naive_stiffness(X, T, q, material, n_point):
    """H of one Gauss point from the stresses of unit strains, n_point points a layer."""
    value, *by = naive.shape(*naive.GAUSS[q])
    A, dT, T0 = [d @ X for d in by], [d @ T for d in by], value @ T
    normal = T0 / np.linalg.norm(T0)
    H, factor = np.zeros((8, 8)), naive.shear_factor(material)

    def tensor(v, contra, z):
        E = np.zeros((3, 3))
        for k, (i, j) in enumerate(((0, 0), (1, 1), (0, 1))):  # v[2] is 2 E_12
            both = np.outer(contra[i], contra[j]) + np.outer(contra[j], contra[i])
            E += 0.5 * (v[k] + z * v[3 + k]) * both
        for k in range(2):
            both = np.outer(contra[k], contra[2]) + np.outer(contra[2], contra[k])
            E += 0.5 * v[6 + k] * both
        return E

    for z, weight, elastic in naive.thickness_rule(material, n_point):
        G = np.array([A[0] + z * dT[0], A[1] + z * dT[1], T0])
        contra, volume = np.linalg.inv(G.T), np.linalg.det(G)

        strains = [tensor(unit, contra, z) for unit in np.eye(8)]
        for i, E in enumerate(strains):
            stress = naive.stress_of(E, normal, elastic, factor)
            for j, other in enumerate(strains):
                H[i, j] += weight * volume * np.sum(stress * other)
    return H


_modes, _products = map(from_python, (modes, products))


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
    np.testing.assert_allclose(m, naive.products(x, t), rtol=0, atol=256 * np.finfo(float).eps)


@pytest.mark.parametrize(("xi", "eta"), [*naive.GAUSS, (0.3, -0.8)])
def test_products_hold_the_strains_at_every_point(xi, eta):
    # Membrane and bending exactly, and the transverse shear as tied at the mid-edge points.
    x, t = a_quad(5)
    wanted = naive.generalised(x, t, xi, eta)
    np.testing.assert_allclose(
        strain_map(xi, eta) @ naive.products(x, t), wanted, atol=16 * np.finfo(float).eps
    )


def corners(mesh):
    return mesh.nodes[mesh.quads], mesh.directors[mesh.quads]


@pytest.mark.parametrize("layers", [[(SOFT, 0.3)], [(SOFT, 0.2), (STIFF, 0.05), (SOFT, 0.05)]])
def test_curved_reference_against_a_converged_quadrature(layers):
    # Thickness / radius = 0.15, twice what a shell is for. Quadrature: four points a layer leave
    # 9e-8 of the bending stiffness there (measured), and less of the rest.
    mesh = cases.curved(2, 1)
    material = ShellMaterial([Layer(*pair) for pair in layers])
    X, T = corners(mesh)
    assert not flat_quads(X, T).any()
    whole = np.zeros((mesh.n_quad, 16, 16))
    for q, point in enumerate(naive.GAUSS):
        h = point_stiffness(X, T, material, q)
        for e in range(mesh.n_quad):
            wanted = naive_stiffness(X[e], T[e], q, material, 12)
            scale = np.sqrt(np.outer(np.diag(wanted), np.diag(wanted)))
            assert (np.abs(h[e] - wanted) / scale).max() < 2e-7
            whole[e] += strain_map(*point).T @ wanted @ strain_map(*point)
    # In the strains of the modes, where it is a sum over the four points.
    upper = full_stiffness(X, T, material)
    i, j = np.triu_indices(16)
    scale = np.sqrt(np.einsum("ek,ek->ek", whole[:, i, i], whole[:, j, j]))
    assert (np.abs(upper - whole[:, i, j]) / scale).max() < 2e-7


def test_volume_factor_gives_the_mass_of_a_layered_sector():
    # Dense outside, light inside: without mu the mass would be that of the flat sheet, 9 % less.
    inner, outer = Elastic(1000.0, 0.3, 1e-9), Elastic(1000.0, 0.3, 9e-9)
    material = ShellMaterial([Layer(inner, 0.3), Layer(outer, 0.3)])
    radius, length, arc = 1.0, 2.0, np.radians(90.0)
    sector = 0.5 * arc * length
    r = radius + np.array([-0.3, 0.0, 0.3])
    exact = sector * (1e-9 * (r[1] ** 2 - r[0] ** 2) + 9e-9 * (r[2] ** 2 - r[1] ** 2))
    error = []
    for n in (4, 8, 16):
        mesh = cylinder(radius, length, n_around=n, n_along=2, arc_deg=90.0)
        mass, _ = lumped_mass(*corners(mesh), material)
        error.append(abs(mass.sum() / exact - 1.0))
    order = np.log2(np.array(error[:-1]) / np.array(error[1:]))
    # Discretisation: chords for arcs, second order, within the usual 0.15.
    np.testing.assert_allclose(order, 2.0, atol=0.15)
    assert error[-1] < 2e-3


def test_mass_and_area_of_a_skewed_flat_sheet_are_exact():
    mesh = cases.skewed_flat()
    mass, area = lumped_mass(*corners(mesh), cases.FILM)
    # Round-off: 2 x 2 points integrate a bilinear Jacobian exactly.
    np.testing.assert_allclose(area, mesh.quad_areas(), rtol=1e-13)
    np.testing.assert_allclose(mass.sum(axis=1), 1e-9 * 0.074 * area, rtol=1e-13)
    x = mesh.nodes[mesh.quads]
    for e in range(mesh.n_quad):
        share = np.zeros(4)
        for xi, eta in naive.GAUSS:
            value, *by = naive.shape(xi, eta)
            share += value * np.linalg.norm(np.cross(by[0] @ x[e], by[1] @ x[e]))
        np.testing.assert_allclose(mass[e], 1e-9 * 0.074 * share, rtol=1e-13)


def test_flat_quads_are_told_from_warped_curved_and_tilted_ones():
    for case, flat in (("flat", True), ("warped", False), ("curved", False)):
        assert flat_quads(*corners(cases.ALL[case]())).tolist() == [flat] * 6
    mesh = cases.skewed_flat(2, 1)
    X, T = corners(mesh)
    tilted = T + np.array([1e-9, 0.0, 0.0])  # all alike, yet not normal
    assert not flat_quads(X, tilted).any()


def test_bending_ratio_only_where_one_number_says_it():
    stiff = Elastic(70e3, SOFT.poisson, 2.7e-9)
    even = ShellMaterial([Layer(SOFT, 0.03), Layer(stiff, 0.01), Layer(SOFT, 0.03)])
    assert cases.FILM.bending_ratio == pytest.approx(0.074**2 / 12, rel=1e-14)
    bending = (1000.0 * (0.07**3 - 0.01**3) + 70e3 * 0.01**3) / 12
    ratio = bending / (1000.0 * 0.06 + 70e3 * 0.01)
    assert even.bending_ratio == pytest.approx(ratio, rel=1e-13)
    assert ShellMaterial([Layer(SOFT, 0.05), Layer(stiff, 0.02)]).bending_ratio is None
    # Other Poisson's ratio in the core: even, but bending and stretching are not alike.
    other = ShellMaterial([Layer(SOFT, 0.03), Layer(STIFF, 0.01), Layer(SOFT, 0.03)])
    assert other.bending_ratio is None
