"""Materials: the plane-stress law, the thickness rule, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest

from naive import shell as naive
from naive.layered_strip import elasticity
from page_tables import shown_as, table
from shellcut import Pressure, Statics, Support
from shellcut.material import Elastic, Linear, Orthotropic, Plastic
from shellcut.material.shear_factors import shear_factors
from shellcut.material.shell_material import POINTS_PER_LAYER, Layer, ShellMaterial
from shellcut.mesh.structured import rectangle
from shellcut.mitc4.section import point_stiffness

FOIL, POLYMER = Elastic(70e3, 0.33, 2.7e-9), Elastic(200.0, 0.4, 0.92e-9)


def test_plane_stress_inverts_hookes_law():
    compliance = np.array([[1, -0.33, 0], [-0.33, 1, 0], [0, 0, 2 * 1.33]]) / 70e3
    np.testing.assert_allclose(FOIL.plane_stress() @ compliance, np.eye(3), atol=1e-15)
    np.testing.assert_allclose(FOIL.transverse_shear(), np.eye(2) * 70e3 / 2.66, rtol=1e-15)
    # An incompressible film: E / (1 - nu) = 2 E both ways alike; in plane strain there is no end.
    rubber = Elastic(3.0, 0.5, 1e-9)
    np.testing.assert_allclose(rubber.plane_stress() @ [1.0, 1.0, 0.0], [6.0, 6.0, 0.0], rtol=1e-15)


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


# --- transverse shear of layers: against elasticity, in closed form, by axes


SQUARE = np.array([[[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0.0]]])
LEVEL = np.tile([0.0, 0.0, 1.0], (1, 4, 1))
ALUMINIUM, LDPE = Elastic(70e3, 0.33, 2.7e-9), Elastic(200.0, 0.42, 0.92e-9)


def film(*layers, **options):
    return ShellMaterial([Layer(*layer) for layer in layers], **options)


def tape(angle):
    """A unidirectional composite, 25 times stiffer along."""
    return Orthotropic(25e3, 1e3, 0.25, 500.0, 1.5e-9, 500.0, angle, 200.0)


def drawn(angle):
    """A film drawn across."""
    return Orthotropic(2e3, 4e3, 0.25, 900.0, 0.9e-9, 600.0, angle, 400.0)


SANDWICH = film((ALUMINIUM, 0.009), (LDPE, 0.056), (ALUMINIUM, 0.009))
UNEVEN = film((ALUMINIUM, 0.006), (LDPE, 0.056), (ALUMINIUM, 0.012))


def deflection(material, span):
    """Middle of a simply supported strip in plane strain under 1 MPa, by statics."""
    mesh = rectangle(0.5 * span, 0.1 * span, n_x=24, n_y=1)
    supports = [
        Support("left", translation="z", rotation=""),
        Support("right", translation="x", rotation="y"),
        *(Support(side, translation="y", rotation="xz") for side in ("bottom", "top")),
    ]
    strip = Statics(mesh, material, supports=supports, loads=[Pressure(1.0)])
    return abs(strip.linear().displacement[mesh.node_set("right"), 2]).mean()


@pytest.mark.parametrize(("span", "close"), [(1.0, 0.02), (2.0, 0.004), (4.0, 0.001), (10.0, 1e-3)])
@pytest.mark.parametrize("layers", [SANDWICH, UNEVEN], ids=["even", "uneven"])
def test_a_soft_core_bends_as_in_elasticity(layers, span, close):
    # Elasticity by the sines of an even load. With 5/6 it is -72, -40, -14, -2.6 %. What is left
    # falls with the third power of h/span; 0.05 % is of the mesh.
    waves = range(1, 10, 2)
    wanted = sum(4 / (m * np.pi) * (-1) ** (m // 2) * elasticity(layers, span / m) for m in waves)
    assert deflection(layers, span) == pytest.approx(wanted, rel=close)


def test_layers_that_yield_have_the_shear_factor_of_their_elastic_section():
    hard = {ALUMINIUM: Plastic(ALUMINIUM, Linear(200.0)), LDPE: Plastic(LDPE, Linear(10.0))}
    yielding = film(*((hard[one.material], one.thickness) for one in UNEVEN.layers))
    assert deflection(yielding, 2.0) == pytest.approx(deflection(UNEVEN, 2.0), rel=1e-6)


def test_the_page_shows_what_a_soft_core_costs():
    (_, *spans), (with_k, even) = table("docs/theory/shell.md", "span | 1 mm")
    for k, span in enumerate((float(words.removesuffix(" mm")) for words in spans), start=1):
        for row, strip in ((with_k, SANDWICH), (even, replace(SANDWICH, shear_factor=5.0 / 6.0))):
            off = 100.0 * (shell(strip, span) / elasticity(SANDWICH, span) - 1.0)
            assert shown_as(row[k], off), (row[0], span, off)


def shell(film, span):
    """Return the deflection of a shell with the section of ``film``, as ``elasticity`` does."""
    h = point_stiffness(SQUARE, LEVEL, film, 0)[0]
    p, rates = np.pi / span, np.zeros((6, 5))  # strains of the waves u_1, u_2, t_1, t_2, w
    rates[:4, :4], rates[4, [2, 4]], rates[5, 3] = p * np.eye(4), (1.0, p), 1.0
    section = h[np.ix_([0, 2, 3, 5, 6, 7], [0, 2, 3, 5, 6, 7])]
    return np.linalg.solve(rates.T @ section @ rates, [0.0, 0.0, 0.0, 0.0, 1.0])[4]


@pytest.mark.parametrize(
    ("layers", "close", "even"),
    [
        (film((tape(0), 0.1), (tape(90), 0.1), (tape(0), 0.1)), 0.002, -0.051),
        (film((tape(0), 0.1), (tape(90), 0.2)), 0.002, None),
        (film((tape(30), 0.1), (tape(-30), 0.1), (tape(30), 0.1)), 0.008, -0.028),
        (film((tape(15), 0.1), (tape(60), 0.1), (tape(-20), 0.1)), 0.001, -0.018),
        (film((drawn(30), 0.02), (LDPE, 0.04), (drawn(-60), 0.02)), 0.0005, -0.041),
        (film((drawn(20), 0.03), (LDPE, 0.04), (drawn(20), 0.02)), 0.0015, -0.034),
    ],
    ids=["cross-ply", "uneven cross-ply", "angle-ply", "three ways", "crossed", "turned"],
)
def test_layers_with_angles_bend_as_in_elasticity(layers, close, even):
    # At 20 thicknesses. ``even`` is what 5/6 gives: the case would tell it.
    span = 20.0 * layers.thickness
    wanted = elasticity(layers, span)
    assert shell(layers, span) == pytest.approx(wanted, rel=close)
    if even is not None:
        one = shell(replace(layers, shear_factor=5.0 / 6.0), span)
        assert one / wanted - 1.0 == pytest.approx(even, abs=0.002)


def test_the_factor_of_isotropic_layers_in_closed_form():
    assert SANDWICH.shear_factors[0, 0] == pytest.approx(0.01125, rel=5e-4)
    for layers in (SANDWICH, UNEVEN, film((ALUMINIUM, 0.009), (LDPE, 0.065))):
        wanted = naive.shear_factor(layers) * np.eye(2)
        np.testing.assert_allclose(layers.shear_factors, wanted, rtol=0, atol=1e-14)


def test_one_material_has_five_sixths_in_any_axes_and_layers():
    one = tape(25.0)
    parts = film((one, 0.1), (one, 0.3), (one, 0.2))
    assert (parts.shear_factors == 5.0 / 6.0 * np.eye(2)).all()
    # By the integrals: moduli that differ by 1e-12.
    nearly = 1.0 + 1e-12 * np.arange(3)[:, None, None]
    found = shear_factors(
        np.array([0.1, 0.3, 0.2]), nearly * one.plane_stress(), nearly * one.transverse_shear()
    )
    np.testing.assert_allclose(found, 5.0 / 6.0 * np.eye(2), rtol=0, atol=1e-11)
    # Moduli along and across its own axes, turned into those of the film.
    assert np.linalg.eigvalsh(one.transverse_shear()) == pytest.approx([200.0, 500.0], rel=1e-14)


def test_the_stiffness_turns_with_the_film():
    layers = [(tape(15), 0.1), (tape(60), 0.1), (LDPE, 0.1)]
    angle = np.radians(35.0)
    c, s = np.cos(angle), np.sin(angle)
    straight, turned = (
        point_stiffness(SQUARE, LEVEL, film(*layers, direction=along), 0)[0, 6:, 6:]
        for along in ((1.0, 0.0, 0.0), (c, s, 0.0))
    )
    turn = np.array([[c, -s], [s, c]])
    close = 1e-12 * straight[0, 0]
    np.testing.assert_allclose(turned, turn @ straight @ turn.T, rtol=0, atol=close)
    assert abs(straight[0, 1]) > 0.01 * straight[0, 0]


@pytest.mark.parametrize("angle_deg", [0.0, 30.0, 90.0])
@pytest.mark.parametrize("axis", [0, 1])
def test_a_film_pulled_along_an_axis_thins_by_the_modulus_there(angle_deg, axis):
    """E_33 is -nu_12 S / E_1 along axis 1; across, -nu_12 S / E_2."""
    film = Orthotropic(3000.0, 1200.0, 0.35, 500.0, 1e-9, angle_deg=angle_deg)
    turn = np.radians(angle_deg + 90.0 * axis)
    n = np.array([np.cos(turn), np.sin(turn)])
    stress = 7.0 * np.array([n[0] ** 2, n[1] ** 2, n[0] * n[1]])
    strain = np.linalg.solve(film.plane_stress(), stress)
    modulus = (film.young_along, film.young_across)[axis]
    assert -film.thickness_slope() @ strain == pytest.approx(-0.35 * 7.0 / modulus, rel=1e-12)


@pytest.mark.parametrize("angle_deg", [0.0, 30.0, 45.0, 101.0])
def test_the_stiffness_for_contact_does_not_depend_on_how_axes_are_given(angle_deg):
    def film(angle_in_layer, angle_of_film):
        law = Orthotropic(10000.0, 1000.0, 0.3, 300.0, 1e-9, angle_deg=angle_in_layer)
        along = np.radians(angle_of_film)
        way = (np.cos(along), np.sin(along), 0.0)
        return ShellMaterial([Layer(law, 0.1)], direction=way)

    turned = [film(angle_deg, 0.0), film(0.0, angle_deg), film(0.5 * angle_deg, 0.5 * angle_deg)]
    assert {one.stretching_stiffness for one in turned} == {1000.0}
