"""The film against its naive twin; mass and inertia of its nodes.

Rigid motions and patches: verification cases A01 and A02; damping: Y02.
"""

import numpy as np
import pytest

from naive import cases
from naive import shell as naive
from shellcut.material.shell_material import Elastic, Layer, ShellMaterial

LAYERED = ShellMaterial(
    [Layer(Elastic(800.0, 0.35, 1e-9), 0.05), Layer(Elastic(30e3, 0.33, 2.7e-9), 0.02)]
)
MATERIALS = {"film": cases.FILM, "layered": LAYERED}


@pytest.fixture(params=[(c, m) for c in cases.ALL for m in MATERIALS], ids="-".join)
def far(request):
    """Mesh, material, shell and a state that is turned, stretched and tilted."""
    case, name = request.param
    mesh = cases.ALL[case]()
    shell, state = cases.set_up(mesh, MATERIALS[name])
    return mesh, MATERIALS[name], shell, cases.deform(state)


def current(state):
    return state.node.x[: state.n_node].copy(), state.node.t[: state.n_node].copy()


def test_energy_and_forces_match_the_naive_twin(far):
    mesh, material, shell, state = far
    x, t = current(state)
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
