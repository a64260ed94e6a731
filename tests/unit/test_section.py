"""Mass and area of quads, the flat shortcut; their strains and stiffness: test_shell.py."""

import numpy as np
import pytest

from naive import cases
from naive import shell as naive
from shellcut.material.shell_material import Elastic, Layer, ShellMaterial
from shellcut.mesh.structured import cylinder
from shellcut.mitc4.section import flat_quads, lumped_mass

SOFT, STIFF = Elastic(1000.0, 0.3, 1e-9), Elastic(70e3, 0.33, 2.7e-9)


def corners(mesh):
    return mesh.nodes[mesh.quads], mesh.directors[mesh.quads]


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
    X, T = corners(mesh)
    mass, area = lumped_mass(X, T, cases.FILM)
    # Round-off: 2 x 2 points integrate a bilinear Jacobian exactly.
    np.testing.assert_allclose(area, mesh.quad_areas(), rtol=1e-13)
    np.testing.assert_allclose(mass.sum(axis=1), 1e-9 * 0.074 * area, rtol=1e-13)
    for x, found in zip(X, mass, strict=True):
        share = np.zeros(4)
        for xi, eta in naive.GAUSS:
            value, *by = naive.shape(xi, eta)
            share += value * np.linalg.norm(np.cross(by[0] @ x, by[1] @ x))
        np.testing.assert_allclose(found, 1e-9 * 0.074 * share, rtol=1e-13)
    assert flat_quads(X, T).all()
    assert not flat_quads(X, T + np.array([1e-9, 0.0, 0.0])).any()  # all alike, yet not normal


def test_bending_ratio_only_where_one_number_says_it():
    def film(*layers):
        return ShellMaterial([Layer(*layer) for layer in layers])

    stiff = Elastic(70e3, SOFT.poisson, 2.7e-9)
    even = film((SOFT, 0.03), (stiff, 0.01), (SOFT, 0.03))
    assert cases.FILM.bending_ratio == pytest.approx(0.074**2 / 12, rel=1e-14)
    bending = (1000.0 * (0.07**3 - 0.01**3) + 70e3 * 0.01**3) / 12
    ratio = bending / (1000.0 * 0.06 + 70e3 * 0.01)
    assert even.bending_ratio == pytest.approx(ratio, rel=1e-13)
    assert film((SOFT, 0.05), (stiff, 0.02)).bending_ratio is None
    # Another Poisson's ratio in the core: even, but bending and stretching are not alike.
    assert film((SOFT, 0.03), (STIFF, 0.01), (SOFT, 0.03)).bending_ratio is None
