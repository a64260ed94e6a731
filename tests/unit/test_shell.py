"""The film against its naive twin, and against what its energy must do."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from naive import cases
from naive import shell as naive
from shellcut.material.shell_material import Elastic, Layer, ShellMaterial
from shellcut.mesh.structured import rectangle
from shellcut.mitc4.blocks import build_blocks
from shellcut.mitc4.shell import MITC4Shell

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


@pytest.mark.parametrize("case", cases.ALL)
def test_rigid_motion_gives_no_force(case):
    mesh = cases.ALL[case]()
    shell, state = cases.set_up(mesh)
    R = Rotation.from_rotvec([2.1, -0.7, 1.9]).as_matrix()
    state.node.x[: mesh.n_node] = mesh.nodes @ R.T + [10.0, -20.0, 5.0]
    state.node.t[: mesh.n_node] = mesh.directors @ R.T
    energy, by_x, by_t = cases.forces_of(shell, state)
    # State scale: E h L is the force at a strain of one. The positions, some 20 mm from the origin,
    # are rounded to 4e-15 mm, a strain of 1e-14 in an edge of 1 mm.
    stretch = 1678.0 * 0.074 * 1.0
    assert np.abs(by_x).max() < 1e-13 * stretch
    assert np.abs(by_t).max() < 1e-13 * stretch * 1.0
    assert energy < 1e-26 * stretch * mesh.n_quad


def stiffness(shell, state):
    """K of all 5 dof a node (three of position, two tangent ones) and its lumped mass."""
    n = state.n_node
    x, t = current(state)
    frame = np.array([np.linalg.svd(d[None, :])[2][1:] for d in t])
    delta, K = 1e-5, np.zeros((5 * n, 5 * n))

    def gradient(j, step):
        state.node.x[:n], state.node.t[:n] = x, t
        node, dof = divmod(j, 5)
        if dof < 3:
            state.node.x[node, dof] += step
        else:
            b = frame[node, dof - 3]
            state.node.t[node] = np.cos(step) * t[node] + np.sin(step) * b
        _, by_x, by_t = cases.forces_of(shell, state)
        moved = np.array([np.linalg.svd(d[None, :])[2][1:] for d in t])
        if dof >= 3:  # the tangent turned with the director stays a tangent
            along = frame[node, dof - 3]
            moved[node, dof - 3] = np.cos(step) * along - np.sin(step) * t[node]
        return np.hstack([by_x, np.einsum("nbi,ni->nb", moved, by_t)]).ravel()

    for j in range(5 * n):
        K[:, j] = (gradient(j, delta) - gradient(j, -delta)) / (2 * delta)
    state.node.x[:n], state.node.t[:n] = x, t
    mass = np.column_stack([state.node.mass[:n]] * 3 + [state.node.inertia[:n]] * 2).ravel()
    return 0.5 * (K + K.T), mass


@pytest.mark.parametrize("case", cases.ALL)
def test_a_free_quad_has_six_zero_eigenvalues(case):
    mesh = cases.ALL[case](1, 1)
    shell, state = cases.set_up(mesh)
    K, mass = stiffness(shell, state)
    assert K.shape == (20, 20)
    scaled = K / np.sqrt(np.outer(mass, mass))
    values = np.abs(np.linalg.eigvalsh(scaled))
    values.sort()
    # Differences leave 1e-10 of the largest; the softest strain mode lies 1e3 above that.
    assert (values[:6] < 1e-9 * values[-1]).all()
    assert values[6] > 1e-6 * values[-1]
    # Six rigid motions, seen from the unstrained state: three shifts, three turns with directors.
    n = 4
    frame = np.array([np.linalg.svd(d[None, :])[2][1:] for d in mesh.directors])
    for axis in np.eye(3):
        shift = np.hstack([np.tile(axis, (n, 1)), np.zeros((n, 2))]).ravel()
        spin = np.cross(axis, mesh.directors)
        turn = np.hstack([np.cross(axis, mesh.nodes), np.einsum("nbi,ni->nb", frame, spin)]).ravel()
        for motion in (shift, turn):
            assert np.abs(K @ motion).max() < 1e-8 * np.abs(K).max() * np.abs(motion).max()


def affine_patch(F):
    mesh = cases.skewed_flat(4, 3)
    shell, state = cases.set_up(mesh)
    R = Rotation.from_rotvec([0.4, 1.2, -0.8]).as_matrix()
    state.node.x[: mesh.n_node] = mesh.nodes @ F.T @ R.T
    state.node.t[: mesh.n_node] = mesh.directors @ R.T
    return mesh, shell, state, R


def test_patch_of_constant_stretch_gives_exact_stress():
    F = np.eye(3)
    F[:2, :2] = [[1.2, 0.15], [-0.05, 0.9]]
    mesh, shell, state, R = affine_patch(F)
    E = 0.5 * (F.T @ F - np.eye(3))[:2, :2]
    s = cases.FILM.layers[0].material.plane_stress() @ [E[0, 0], E[1, 1], 2 * E[0, 1]]
    S = np.zeros((3, 3))
    S[:2, :2] = [[s[0], s[2]], [s[2], s[1]]]
    cauchy = R @ F @ S @ F.T @ R.T / np.linalg.det(F)
    quads = np.arange(mesh.n_quad)
    for place in ("mid", "top", "bottom"):  # no curvature: the same at every height
        got = shell.stress(state, quads, place=place)
        np.testing.assert_allclose(got, np.tile(cauchy, (mesh.n_quad, 1, 1)), atol=1e-11)
    # Nominal: the second Piola-Kirchhoff stress turned with the surface has its own invariants.
    nominal = shell.stress(state, quads, place="nominal")
    for sigma in nominal:
        assert np.trace(sigma) == pytest.approx(np.trace(S), rel=1e-12)
    # Inside nodes are in equilibrium: constant stress on any mesh, the patch test.
    _, by_x, _ = cases.forces_of(shell, state)
    inside = np.setdiff1d(np.arange(mesh.n_node), mesh.boundary_nodes())
    assert inside.size == 6
    assert np.abs(by_x[inside]).max() < 1e-12 * np.abs(by_x).max()
    # The sides transmit the first Piola-Kirchhoff traction, F S N h per reference length.
    P, size = R @ F @ S * 0.074, np.abs(by_x).max()
    bottom, right, top, left = (mesh.node_set(k) for k in ("bottom", "right", "top", "left"))
    for chain in (bottom, right, top[::-1], left[::-1]):  # counter-clockwise
        step = np.diff(mesh.nodes[chain], axis=0)
        half = 0.5 * np.column_stack([step[:, 1], -step[:, 0], 0 * step[:, 0]])
        for ends in (chain[:-1], chain[1:]):
            by_x[ends] -= half @ P.T
    assert np.abs(by_x).max() < 1e-12 * size


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


def test_damping_acts_on_the_strain_rate():
    # S + beta C : dE/dt is the elastic force of the strain s + (beta / dt) (s - s_last): on a patch
    # of constant stretch the elastic stress may be used as it stands.
    beta, dt = 3e-6, 1e-5
    F = [np.diag([1.0 + a, 1.0, 1.0]) for a in (0.02, 0.05)]
    mesh, shell, state, R = affine_patch(F[0])
    shell.damping_beta = beta
    cases.forces_of(shell, state)  # the first evaluation leaves the strain, at dt = 0 undamped
    state.dt = dt
    _, _, after, _ = affine_patch(F[1])
    state.node.x[: mesh.n_node] = after.node.x[: mesh.n_node]
    state.node.force[: mesh.n_node] = 0.0
    state.node.director_force[: mesh.n_node] = 0.0
    energy, work, _ = shell.add_forces(state)
    e = [0.5 * (f[0, 0] ** 2 - 1) for f in F]
    modulus = 1678.0 / (1 - 0.09)
    rate = beta * (e[1] - e[0]) / dt
    area = shell.area.sum()
    assert energy == pytest.approx(0.5 * modulus * e[1] ** 2 * area * 0.074, rel=1e-12)
    # ½ (damping stress before + now) : (change of strain), before: of the first evaluation's step,
    # from zero strain, whose rate the law takes at the same dt.
    mean = 0.5 * modulus * rate * ((e[1] - e[0]) + e[0])
    assert work == pytest.approx(mean * area * 0.074, rel=1e-12)
    total = modulus * (e[1] + rate)
    # By virtual work of a uniform stretch along x: sum of f . X = stress * F_xx * area * h.
    along = R @ [1.0, 0.0, 0.0]
    virial = -(state.node.force[: mesh.n_node] @ along) @ mesh.nodes[:, 0]
    assert virial == pytest.approx(total * 1.05 * area * 0.074, rel=1e-12)


def test_mass_and_inertia_of_the_nodes():
    mesh = cases.curved()
    shell, state = cases.set_up(mesh)
    n = mesh.n_node
    assert state.node.mass[:n].sum() == pytest.approx(shell.mass.sum(), rel=1e-14)
    assert (state.node.mass[n:] == 0).all()
    # Scaled rotary inertia: max(h²/12, A/8) of each quad on its share of the mass.
    for node in range(n):
        wanted = [0.0, 0.0]
        for e, quad in enumerate(mesh.quads):
            for a in np.flatnonzero(quad == node):
                share = shell.mass[e, a]
                wanted[0] += share
                wanted[1] += share * max(0.074**2 / 12, shell.area[e] / 8)
        assert state.node.mass[node] == pytest.approx(wanted[0], rel=1e-14)
        assert state.node.inertia[node] == pytest.approx(wanted[1], rel=1e-14)
        mine = (mesh.quads == node).any(axis=1)
        quarter = 0.25 * shell.area[mine].mean()
        assert state.node.contact_area[node] == pytest.approx(quarter, rel=1e-14)
    true = 0.074**2 / 12
    assert shell.added_inertia_factor == pytest.approx(
        shell.quad_inertia(np.arange(mesh.n_quad)).sum() / (true * shell.mass.sum()), rel=1e-14
    )
    assert shell.added_inertia_factor > 50


def test_thick_quads_keep_their_true_inertia():
    thick = ShellMaterial.homogeneous(thickness=3.0)
    shell = MITC4Shell(cases.skewed_flat(2, 1), thick, damping_beta=0.0)
    assert shell.added_inertia_factor == pytest.approx(1.0, rel=1e-12)


def test_strips_of_a_large_film_share_nodes_with_their_neighbours_only():
    """So that every second one may run on another thread; alike in size, at least 5000 quads."""
    mesh = rectangle(240.0, 100.0, n_x=240, n_y=100)
    flat = np.arange(mesh.n_quad) % 7 > 0
    blocks = build_blocks(mesh.nodes, mesh.quads, flat)
    assert blocks.n_strip == 4
    seen, sizes = np.zeros((4, mesh.n_node), bool), np.zeros(4)
    for start in (blocks.flat_start, blocks.full_start):
        for strip in range(4):
            rows = slice(start[strip], start[strip + 1])
            quads = blocks.quad[rows][blocks.filled[rows]]
            sizes[strip] += quads.size
            seen[strip, mesh.quads[quads]] = True
    assert sizes.sum() == mesh.n_quad
    assert sizes.min() == sizes.max() == 6000
    first, last = seen.argmax(axis=0), 3 - seen[::-1].argmax(axis=0)
    assert (last - first <= 1).all()
    assert (last - first == 1).sum() == 3 * 101
    small = build_blocks(mesh.nodes, mesh.quads[:19_999], flat[:19_999])
    assert small.n_strip == 1
