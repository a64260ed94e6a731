"""Stress at the centres: the kernel against its definition in NumPy."""

from types import SimpleNamespace

import numpy as np
import pytest

from naive import cases
from naive import recovery as naive
from shellcut import Elastic, Layer, Mesh, ShellMaterial
from shellcut.mesh.structured import rectangle
from shellcut.mitc4.initial_state import initial_state
from shellcut.mitc4.nodal_stress import recover

LAMINATE = ShellMaterial(
    [Layer(Elastic(5000.0, 0.35, 2e-9), 0.01), Layer(Elastic(800.0, 0.4, 1e-9), 0.06)]
)


def base_vectors(x, t, z):
    """g_1, g_2 at the centre and the height z, and the director there."""
    d1 = 0.25 * np.array([-1, 1, 1, -1])
    d2 = 0.25 * np.array([-1, -1, 1, 1])
    return d1 @ x + z * (d1 @ t), d2 @ x + z * (d2 @ t), t.mean(axis=0)


def deformed(X, T, x, t, z):
    """Strains (E_11, E_22, 2 E_12), the carried frame and the change of area at a height."""
    G1, G2, T0 = base_vectors(X, T, z)
    g1, g2, _ = base_vectors(x, t, z)
    # The deformation gradient of the surface, taken from and to the plane of the frame.
    e3 = T0 / np.linalg.norm(T0)
    e1 = np.cross(G2, e3) / np.linalg.norm(np.cross(G2, e3))
    e2 = np.cross(e3, e1)
    up = np.linalg.inv(np.stack([G1, G2, T0], axis=1))[:2]
    F = np.outer(g1, up[0]) + np.outer(g2, up[1])
    frame = np.stack([e1, e2])
    reference = np.outer(G1, up[0]) + np.outer(G2, up[1])
    E = 0.5 * frame @ (F.T @ F - reference.T @ reference) @ frame.T
    J = np.linalg.norm(np.cross(g1, g2)) / np.linalg.norm(np.cross(G1, G2))
    return np.array([E[0, 0], E[1, 1], 2 * E[0, 1]]), F @ frame.T, J


def stress(X, T, x, t, material, place):
    h, C = material.thickness, [one.material.plane_stress() for one in material.layers]
    z = {"top": 0.5 * h, "bottom": -0.5 * h}.get(place, 0.0)
    layer = {"top": -1, "bottom": 0}.get(place, len(C) // 2)
    strain, carried, J = deformed(X, T, x, t, z)
    s = C[layer] @ strain
    if place == "nominal":  # the mean of the layers, by the strains in their middles
        slope = (deformed(X, T, x, t, 0.5 * h)[0] - deformed(X, T, x, t, -0.5 * h)[0]) / h
        part = [one.thickness for one in material.layers]
        middle = np.cumsum(part) - 0.5 * np.array(part) - 0.5 * h
        s = sum(w / h * c @ (strain + m * slope) for w, c, m in zip(part, C, middle, strict=True))
        f1 = carried[:, 0] / np.linalg.norm(carried[:, 0])
        normal = np.cross(carried[:, 0], carried[:, 1])
        f2 = np.cross(normal / np.linalg.norm(normal), f1)
        carried, J = np.stack([f1, f2], axis=1), 1.0
    S = np.array([[s[0], s[2]], [s[2], s[1]]])
    return carried @ S @ carried.T / J


PLACES = ["mid", "top", "bottom", "nominal"]


def in_lamina(tensor, x):
    """Return s11, s22 and s12 in the axes in which a frame's stresses are given."""
    e1 = x[1] + x[2] - x[0] - x[3]
    normal = np.cross(e1, x[2] + x[3] - x[0] - x[1])
    e2 = np.cross(normal, e1)
    axes = np.stack([e1 / np.linalg.norm(e1), e2 / np.linalg.norm(e2)])
    return (axes @ tensor @ axes.T)[[0, 1, 0], [0, 1, 1]]


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("material", [cases.FILM, LAMINATE], ids=["film", "laminate"])
@pytest.mark.parametrize("case", cases.ALL)
def test_stress_is_its_definition(case, material, place):
    mesh = cases.ALL[case]()
    shell, state = cases.set_up(mesh, material)
    cases.deform(state)
    which = np.array([4, 0, 3])
    got, faces = shell.stress(state, which, place=place), shell.face_stresses(state).stress
    for tensor, e in zip(got, which, strict=True):
        q = mesh.quads[e]
        x, t = state.node.x[q], state.node.t[q]
        wanted = stress(mesh.nodes[q], mesh.directors[q], x, t, material, place)
        # Round-off of a metric of order one.
        close = 1e-11 * np.abs(wanted).max()
        np.testing.assert_allclose(tensor, wanted, atol=close)
        if place in PLACES[: 3 if material is cases.FILM else 0]:
            found = faces[e, PLACES.index(place)]
            np.testing.assert_allclose(found, in_lamina(wanted, x), atol=close)


def one_quad(curvature, strain, material):
    """A unit square stretched along x and bent to a curvature about y, by the law of the module."""
    mesh = Mesh.from_arrays([[0, 0], [1, 0], [1, 1], [0, 1]], [[0, 1, 2, 3]])
    shell, state = cases.set_up(mesh, material)
    angle = 0.5 * curvature
    state.node.x[:4, 0] *= 1.0 + strain
    lean = np.array([-1, 1, 1, -1]) * np.sin(angle)
    state.node.t[:4] = np.stack([lean, 0 * lean, np.full(4, np.cos(angle))], axis=1)
    return shell.face_stresses(state)


def test_the_membrane_of_a_laminate_carries_the_resultant_over_the_thickness():
    strain, curvature = 1e-4, 5e-3
    got = one_quad(curvature, strain, LAMINATE)
    z, w, materials = LAMINATE.thickness_points()
    moduli = np.array([material.plane_stress()[0, 0] for material in materials])
    stretched, bent = w @ (moduli * strain), w @ (moduli * z * curvature)
    # The strain's own square.
    membrane = got.stress[0, 0, 0] * LAMINATE.thickness
    np.testing.assert_allclose(membrane, stretched + bent, rtol=1e-3)
    assert abs(bent) > 0.3 * stretched  # the coupling is no small part of it


@pytest.mark.parametrize("film", [cases.FILM, LAMINATE], ids=["film", "laminate"])
@pytest.mark.parametrize("stretch", [1.001, 1.01, 1.3])
def test_each_layer_of_a_stretched_film_gets_thinner_by_its_own_ratio(stretch, film):
    got = one_quad(0.0, stretch - 1.0, film)
    along = 0.5 * (stretch**2 - 1.0)  # E_11; E_22 is held at 0
    ratios = [layer.material.poisson for layer in film.layers]
    factors = [np.sqrt(1.0 - 2.0 * along * nu / (1.0 - nu)) for nu in ratios]
    wanted = sum(x.thickness * f for x, f in zip(film.layers, factors, strict=True))
    np.testing.assert_allclose(got.thickness, wanted, rtol=1e-13)  # round-off


@pytest.mark.parametrize("place", PLACES[:3])
@pytest.mark.parametrize("material", [cases.FILM, LAMINATE], ids=["film", "laminate"])
@pytest.mark.parametrize("case", cases.ALL)
def test_the_linear_change_of_the_stress_is_its_slope(case, material, place):
    """Of film that is deformed already, for any small motion of nodes and directors."""
    mesh = cases.ALL[case]()
    shell, state = cases.set_up(mesh, material)
    cases.deform(state)
    n, rng, which = mesh.n_node, np.random.default_rng(9), np.array([4, 0, 3])
    x, t = state.node.x[:n].copy(), state.node.t[:n].copy()
    dx, spin = rng.normal(size=(2, n, 3))
    dt, still = np.cross(spin, t), np.zeros((n, 3))
    moved, before = (
        shell.linear_stress(x, t, mesh.quads, *motion, which, place)
        for motion in ((dx, spin), (still, still))
    )
    ends = []
    for step in (1e-5, -1e-5):
        state.node.x[:n], state.node.t[:n] = x + step * dx, t + step * dt
        ends.append(shell.stress(state, which, place=place))
    # Central differences: truncation 1e-10 of the change, round-off 1e-16 / 1e-5 of the stress.
    slope = (ends[0] - ends[1]) / 2e-5
    np.testing.assert_allclose(moved - before, slope, atol=1e-7 * np.abs(slope).max())


# --- patch recovery: exact for linear fields, never across a crack, against least squares


def field(tensor):
    """Stands for the shell: a stress given as a function of the quads' centres."""

    def stress(state, quads):
        return np.array([tensor(*c) for c in state.node.x[state.quads[quads]].mean(axis=1)])

    return SimpleNamespace(stress=stress)


def linear(x, y, z=0.0):
    s = np.zeros((3, 3))
    s[:2, :2] = [[10 + 2 * x - y, 3 - x + 0.5 * y], [3 - x + 0.5 * y, 6 + 0.3 * x + 4 * y]]
    return s


def check_exact(state, nodes, tensor=linear):
    """Recover a field at nodes; return at how many with the polynomial of a neighbour."""
    stress = recover(state, field(tensor), nodes)
    for k, n in enumerate(nodes):
        values, vectors = np.linalg.eigh(tensor(*state.node.x[n])[:2, :2])
        assert stress.principal[k] == pytest.approx(values[-1], rel=1e-11), n
        cos = abs(stress.direction[k, :2] @ vectors[:, -1])
        assert cos == pytest.approx(1.0, abs=1e-11)
        assert stress.direction[k, 2] == 0.0
    return stress.n_borrowed


def test_linear_field_is_recovered_exactly_on_distorted_patches():
    mesh = cases.skewed_flat(5, 4, seed=3, amount=0.25)
    state, nodes = initial_state(mesh), np.arange(mesh.n_node)
    # The 18 nodes of the boundary have one or two quads: they take an inner neighbour's polynomial.
    assert check_exact(state, nodes) == mesh.boundary_nodes().size == 18
    assert check_exact(state, np.setdiff1d(nodes, mesh.boundary_nodes())) == 0


@pytest.mark.parametrize("case", ["warped", "curved"])
def test_patch_against_least_squares(case):
    mesh = cases.ALL[case](5, 4)
    state = cases.deform(initial_state(mesh), stretch=0.05)
    samples = np.random.default_rng(2).uniform(-5, 20, (mesh.n_quad, 3, 3))
    samples += samples.transpose(0, 2, 1)
    shell = SimpleNamespace(stress=lambda state, quads: samples[quads])
    inner = np.setdiff1d(np.arange(mesh.n_node), mesh.boundary_nodes())
    stress = recover(state, shell, inner)
    for n, principal, direction in zip(inner, stress.principal, stress.direction, strict=True):
        around = np.flatnonzero((mesh.quads == n).any(axis=1))
        centres = state.node.x[mesh.quads[around]].mean(axis=1)
        at = state.node.x[n], state.node.t[n]
        value, wanted = naive.principal(centres, samples[around], *at)
        # Round-off of two solutions of a system of condition below 100.
        assert principal == pytest.approx(value, rel=1e-11)
        assert abs(direction @ wanted) == pytest.approx(1.0, abs=1e-11)
        assert direction @ state.node.t[n] == pytest.approx(0.0, abs=1e-14)


def test_no_sample_from_across_a_crack():
    # A crack right through: another linear field on either side, recovered exactly on each flank.
    mesh = rectangle(6.0, 4.0, n_x=6, n_y=4).cut(list(range(14, 21)))
    state = initial_state(mesh)
    flanks = np.flatnonzero(mesh.nodes[:, 1] == 0)
    highest = [mesh.nodes[mesh.quads[(mesh.quads == n).any(axis=1)]][..., 1].max() for n in flanks]
    lower, upper = (flanks[np.equal(highest, top)] for top in (0.0, 1.0))
    assert len(lower) == len(upper) == 7

    def of(side):
        def field(x, y, z=0.0):
            below = y < 0 or (y == 0 and side == "below")
            return linear(x, y) if below else -3.0 * linear(y, x) + 50 * np.diag([1.0, 0, 0])

        return field

    check_exact(state, lower, of("below"))
    assert check_exact(state, upper, of("above")) == 7


def test_a_single_row_has_nothing_to_borrow_and_takes_the_mean():
    state = initial_state(rectangle(3.0, 1.0, n_x=3, n_y=1))
    stress = recover(state, field(linear), np.array([1]))
    mean = 0.5 * (linear(0.5, 0.0) + linear(1.5, 0.0))
    assert stress.n_borrowed == 0
    assert stress.principal[0] == pytest.approx(np.linalg.eigvalsh(mean[:2, :2])[-1], rel=1e-13)
    assert recover(state, field(linear), np.zeros(0, np.int64)).principal.shape == (0,)
