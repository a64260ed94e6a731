"""The film against its plain reference; mass, inertia and area.

Rigid motions and patches: verification cases A01 and A02; damping: Y02.
"""

import numpy as np
import pytest

from naive import cases
from naive import shell as naive
from shellcut import Elastic, Layer, ShellMaterial
from shellcut.mesh.structured import cylinder
from shellcut.mitc4.section import flat_quads, lumped_mass

LAYERED = ShellMaterial(
    [Layer(Elastic(800.0, 0.35, 1e-9), 0.05), Layer(Elastic(30e3, 0.33, 2.7e-9), 0.02)]
)
MATERIALS = {"film": cases.FILM, "layered": LAYERED}


SOFT, STIFF = Elastic(1000.0, 0.3, 1e-9), Elastic(70e3, 0.33, 2.7e-9)


def current(state):
    return state.node.x[: state.n_node].copy(), state.node.t[: state.n_node].copy()


@pytest.mark.parametrize("material", MATERIALS.values(), ids=MATERIALS)
@pytest.mark.parametrize("case", cases.ALL)
def test_energy_and_forces_match_the_plain_reference(case, material):
    mesh = cases.ALL[case]()
    shell, state = cases.set_up(mesh, material)
    x, t = current(cases.deform(state))
    energy, by_x, by_t = cases.forces_of(shell, state)
    reference = mesh.nodes, mesh.directors
    assert energy == pytest.approx(naive.energy(*reference, x, t, mesh.quads, material), rel=1e-12)
    naive_x, naive_t = naive.forces(*reference, x, t, mesh.quads, material)
    # Round-off against the largest force: both sides are exact derivatives.
    np.testing.assert_allclose(by_x, naive_x, rtol=0, atol=1e-12 * np.abs(naive_x).max())
    np.testing.assert_allclose(by_t, naive_t, rtol=0, atol=1e-12 * np.abs(naive_t).max())
    for rows in (state.node.force, state.node.director_force):
        assert np.isnan(rows[state.n_node :]).all()


def test_corner_forces_add_up_to_the_nodal_force():
    mesh = cases.warped()
    shell, state = cases.set_up(mesh, damping_beta=2e-6)
    cases.forces_of(shell, state)
    cases.deform(state)
    state.dt = 1e-5
    node = 5
    around = state.node.quads[node, : state.node.n_quad_at[node]]
    assert around.size == 4
    parts = shell.corner_forces(state, around, np.full(4, node))
    whole = parts.sum(axis=0)
    _, by_x, _ = cases.forces_of(shell, state)
    scale = np.abs(parts).max()
    # The damping counts in both, 20 % of the force here.
    np.testing.assert_allclose(whole, -by_x[node], rtol=0, atol=1e-13 * scale)
    undamped = -naive.forces(mesh.nodes, mesh.directors, *current(state), mesh.quads, cases.FILM)[0]
    assert np.abs(whole - undamped[node]).max() > 0.05 * scale


@pytest.mark.parametrize("thickness", [0.074, 3.0])
def test_mass_and_inertia_of_the_nodes(thickness):
    mesh = cases.curved()
    shell, state = cases.set_up(mesh, ShellMaterial.homogeneous(thickness=thickness))
    node, n, true = state.node, mesh.n_node, thickness**2 / 12
    # Scaled rotary inertia: max(h²/12, A/8) of each quad on its share of the mass.
    scaled = np.maximum(true, shell.area / 8)
    mass, inertia, area = np.zeros((3, n))
    for quad, share, radius, whole in zip(mesh.quads, shell.mass, scaled, shell.area, strict=True):
        mass[quad] += share
        inertia[quad] += share * radius
        area[quad] += 0.25 * whole
    np.testing.assert_allclose(node.mass[:n], mass, rtol=1e-14)
    np.testing.assert_allclose(node.inertia[:n], inertia, rtol=1e-14)
    around = np.bincount(mesh.quads.ravel())
    np.testing.assert_allclose(node.contact_area[:n], area / around, rtol=1e-14)
    assert (node.mass[n:] == 0).all()
    added = inertia.sum() / (true * mass.sum())
    assert shell.added_inertia_factor == pytest.approx(added, rel=1e-13)
    assert added > 50 if thickness < 1.0 else added == pytest.approx(1.0, rel=1e-12)


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
