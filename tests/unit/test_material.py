"""Materials: the plane-stress law, the thickness rule, and what is refused."""

import numpy as np
import pytest

from shellcut.material.shell_material import POINTS_PER_LAYER, Elastic, Layer, ShellMaterial

FOIL, POLYMER = Elastic(70e3, 0.33, 2.7e-9), Elastic(200.0, 0.4, 0.92e-9)


def test_plane_stress_inverts_hookes_law():
    compliance = np.array([[1, -0.33, 0], [-0.33, 1, 0], [0, 0, 2 * 1.33]]) / 70e3
    np.testing.assert_allclose(FOIL.plane_stress() @ compliance, np.eye(3), atol=1e-15)
    np.testing.assert_allclose(FOIL.transverse_shear(), np.eye(2) * 70e3 / 2.66, rtol=1e-15)


def test_an_incompressible_film_is_stiff_as_any_in_plane_stress():
    # Pulled both ways alike it answers with E / (1 - nu) = 2 E; in plane strain there is no end.
    rubber = Elastic(3.0, 0.5, 1e-9)
    np.testing.assert_allclose(rubber.plane_stress() @ [1.0, 1.0, 0.0], [6.0, 6.0, 0.0], rtol=1e-15)
    np.testing.assert_allclose(rubber.transverse_shear(), np.eye(2), rtol=1e-15)


def test_defaults_are_the_film_of_the_paper():
    film = ShellMaterial.homogeneous()
    assert film.thickness == 0.074
    assert (film.shear_factors == 5 / 6 * np.eye(2)).all()
    assert film.layers == (Layer(Elastic(1678.0, 0.3, 1.0e-9), 0.074),)


def test_thickness_points_run_from_the_bottom_and_integrate_polynomials():
    section = ShellMaterial([Layer(POLYMER, 0.04), Layer(FOIL, 0.009)])
    z, w, materials = section.thickness_points()
    assert materials == [POLYMER] * POINTS_PER_LAYER + [FOIL] * POINTS_PER_LAYER
    assert (np.diff(z) > 0).all()
    assert section.thickness == pytest.approx(0.049, rel=1e-15)
    # Gauss points are exact to the degree 2 n - 1 = 7: round-off.
    for degree in range(2 * POINTS_PER_LAYER):
        low, high = np.array([-0.0245, 0.0155]), np.array([0.0155, 0.0245])
        exact = ((high ** (degree + 1) - low ** (degree + 1)) / (degree + 1)).sum()
        size = 0.0245 ** (degree + 1)
        assert np.sum(w * z**degree) == pytest.approx(exact, abs=1e-14 * size)


def test_symmetry_looks_at_material_and_thickness():
    a, b = Layer(POLYMER, 0.03), Layer(FOIL, 0.01)
    assert ShellMaterial([a]).is_symmetric
    assert ShellMaterial([a, b, a]).is_symmetric
    assert not ShellMaterial([a, b]).is_symmetric
    assert not ShellMaterial([a, b, Layer(POLYMER, 0.02)]).is_symmetric
