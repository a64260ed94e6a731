"""Films that yield: forces and energies of quads, axes, tangents, step, statics, runs."""

import itertools

import numpy as np
import pytest

import shellcut as sc
from damaging_film import Damaging
from naive import cases
from shellcut.loads.loads import EdgeTraction
from shellcut.material import (
    Elastic,
    Hencky,
    JohnsonCook,
    Layer,
    Linear,
    Orthotropic,
    Plastic,
    ShellMaterial,
    Voce,
)
from shellcut.mesh.mesh import Mesh
from shellcut.mesh.structured import rectangle
from shellcut.simulation.instability import UnstableStep
from shellcut.simulation.stable_step import Stepping
from shellcut.statics.statics import Statics

E, NU, H = 1678.0, 0.3, 0.074
FILM = Elastic(E, NU, 1e-9)
SOFT_YIELD = 15.0
SOFT = Plastic(FILM, Linear(SOFT_YIELD, 60.0))
FOIL = ShellMaterial([Layer(SOFT, H)], points_per_layer=3)
RUBBER = ShellMaterial([Layer(Hencky(FILM), H)])


def moved(mesh, size, rng):
    """Positions and directors of a strained, bent, turned film."""
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    x = mesh.nodes @ turn.T + size * rng.normal(size=mesh.nodes.shape)
    t = mesh.directors @ turn.T + 0.3 * size * rng.normal(size=mesh.nodes.shape)
    return x, t / np.linalg.norm(t, axis=1, keepdims=True)


def put(state, x, t):
    n = len(x)
    state.node.x[:n], state.node.t[:n] = x, t


def energy(shell, state, history, x, t):
    """Stored and dissipated energy of a step from a history, and the nodal forces."""
    put(state, x, t)
    state.history[:] = history
    state.node.force_rows[:] = 0.0
    work = shell.add_forces(state)
    return work.strain_energy + work.dissipated, state.node.force_rows[: len(x)].copy()


@pytest.mark.parametrize("film", [FOIL, RUBBER], ids=["von Mises", "Hencky"])
@pytest.mark.parametrize("case", ["flat", "curved"])
def test_forces_are_minus_the_gradient_of_the_potential(case, film):
    """Linear hardening: the dissipation of a step is its own potential, ½ (σ_0 + σ) Δp."""
    mesh = cases.ALL[case](2, 1)
    shell, state = cases.set_up(mesh, film)
    rng = np.random.default_rng(3)
    size = 0.03 * np.sqrt(mesh.quad_areas().mean())
    before = moved(mesh, 0.5 * size, rng)
    energy(shell, state, state.history, *before)
    history = state.history.copy()
    x, t = before[0] + size * rng.normal(size=before[0].shape), before[1]
    _, rows = energy(shell, state, history, x, t)
    if film is FOIL:
        assert (state.history > history).any()
    for node, c in [(0, 0), (1, 1), (2, 2), (4, 0), (5, 2)]:
        change = np.zeros_like(x)
        change[node, c] = 1e-5 * size
        ahead, _ = energy(shell, state, history, x + change, t)
        behind, _ = energy(shell, state, history, x - change, t)
        slope = (ahead - behind) / (2e-5 * size)
        # Central differences: their square, and round-off of the energy over the step.
        assert -rows[node, c] == pytest.approx(slope, abs=1e-7 * abs(rows[:, :3]).max())


def test_a_turn_in_mid_run_changes_nothing():
    mesh = cases.ALL["curved"](2, 2)
    rng = np.random.default_rng(4)
    size = 0.03 * np.sqrt(mesh.quad_areas().mean())
    x, t = moved(mesh, size, rng)
    further = x + size * rng.normal(size=x.shape)
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    turn *= np.sign(np.linalg.det(turn))
    found = []
    for R in (np.eye(3), turn):
        shell, state = cases.set_up(mesh, FOIL)
        energy(shell, state, state.history, x, t)
        _, rows = energy(shell, state, state.history.copy(), further @ R.T, t @ R.T)
        found.append((state.history.copy(), rows[:, :3] @ R, rows[:, 3:6] @ R))
    assert found[0][0].max() > 1e-3
    # Turned as it is: nothing flows, though the points lie on the yield surface.
    energy(shell, state, found[1][0].copy(), further, t)
    # The return leaves up to 1e-10 of a stress; what it left flows now.
    np.testing.assert_allclose(state.history, found[1][0], rtol=0, atol=1e-10 * SOFT_YIELD)
    for one, other in zip(*found, strict=True):
        # Round-off of a metric of order one, in strains.
        np.testing.assert_allclose(other, one, rtol=0, atol=1e-11 * abs(one).max())


def test_single_quads_and_lanes_agree():
    mesh = cases.ALL["flat"](3, 3)
    rng = np.random.default_rng(8)
    x, t = moved(mesh, 0.03 * np.sqrt(mesh.quad_areas().mean()), rng)
    lanes, state = cases.set_up(mesh, FOIL)
    _, rows = energy(lanes, state, state.history, x, t)
    history = state.history.copy()
    state.history[:] = 0.0
    quads = np.repeat(np.arange(mesh.n_quad), 4)
    one = lanes.corner_forces(state, quads, mesh.quads.ravel())
    total = np.zeros((mesh.n_node, 3))
    np.add.at(total, mesh.quads.ravel(), one)
    # A block goes on until all its lanes are returned; the return of one leaves up to 1e-10.
    np.testing.assert_allclose(total, rows[:, :3], rtol=0, atol=1e-10 * abs(rows).max())
    assert history.max() > 1e-3
    assert not state.history.any()


# ---------------------------------------------------------------- axes


def test_axes_follow_the_film_whatever_the_mesh():
    """A drawn film: the same forces by any order of a quad's corners, turned with the film.

    The layer without axes never comes to its onset of damage: the kernels of these two laws are
    compiled for the laminate of test_new_law.py, too.
    """
    drawn = Orthotropic(1500.0, 4000.0, 0.25, 700.0, 1e-9)
    layers = [Layer(drawn, 0.05), Layer(Damaging(E, NU, 1e-9, onset=1e3), 0.02)]
    films = {"five": (layers, None), "two": (layers, 2), "linear": ([Layer(drawn, 0.07)], None)}
    corners = np.array([[0.0, 0.0], [2.0, 0.1], [2.2, 1.3], [-0.2, 1.0]])
    rng = np.random.default_rng(9)
    shift, lean = 0.02 * rng.normal(size=(4, 3)), 0.1 * rng.normal(size=(4, 3))
    found = {}
    for name, first, angle in itertools.product(films, range(4), (0.0, 0.7)):
        c, s = np.cos(angle), np.sin(angle)
        turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        these, points = films[name]
        film = ShellMaterial(these, points_per_layer=points, direction=turn @ [1.0, 0.2, 0.4])
        mesh = Mesh.from_arrays(corners @ turn[:2, :2].T, [np.roll([0, 1, 2, 3], first)])
        shell, state = cases.set_up(mesh, film)
        t = np.array([0.0, 0.0, 1.0]) + lean
        t /= np.linalg.norm(t, axis=1, keepdims=True)
        x = mesh.nodes + shift @ turn.T
        w, rows = energy(shell, state, state.history, x, t @ turn.T)
        found[name, first, angle] = [w, rows[:, :3] @ turn, rows[:, 3:6] @ turn]
        if name != "linear":  # its kernel of stresses would be compiled for this alone
            tensor = turn.T @ shell.stress(state, np.array([0]))[0] @ turn
            found[name, first, angle].append(tensor)
    for (name, *_), one in found.items():
        for got, wanted in zip(one, found[name, 0, 0.0], strict=True):
            np.testing.assert_allclose(got, wanted, rtol=0, atol=1e-11 * np.abs(wanted).max())
    # Two points a layer are enough for these laws; at the middle surface they have another stress.
    reference = found["five", 0, 0.0]
    for got, wanted in zip(found["two", 0, 0.0][:3], reference[:3], strict=True):
        np.testing.assert_allclose(got, wanted, rtol=0, atol=1e-11 * np.abs(wanted).max())
    other = ShellMaterial(layers, direction=(0.0, 1.0, 0.0))
    shell, state = cases.set_up(Mesh.from_arrays(corners, [[0, 1, 2, 3]]), other)
    t = np.array([0.0, 0.0, 1.0]) + lean
    t /= np.linalg.norm(t, axis=1, keepdims=True)
    x = np.column_stack([corners, np.zeros(4)]) + shift
    assert energy(shell, state, state.history, x, t)[0] < 0.9 * reference[0]


def test_a_direction_that_is_none_is_refused():
    drawn = Orthotropic(1500.0, 4000.0, 0.25, 700.0, 1e-9)
    mesh = rectangle(1.0, 1.0, n_x=1, n_y=1)
    for direction in ((0.0, 0.0, 1.0), lambda places: 0.0 * places):
        film = ShellMaterial([Layer(drawn, 0.05)], direction=direction)
        with pytest.raises(ValueError, match="direction must have a part in the sheet"):
            cases.set_up(mesh, film)
    with pytest.raises(ValueError, match="direction must be a vector of three numbers"):
        ShellMaterial([Layer(drawn, 0.05)], direction=(0.0, 0.0, 0.0))


# ---------------------------------------------------------------- tangents and the step


@pytest.mark.parametrize("film", [FOIL, RUBBER], ids=["von Mises", "Hencky"])
def test_the_tangent_is_the_difference_of_forces(film):
    mesh = cases.ALL["curved"](1, 1)
    shell, state = cases.set_up(mesh, film)
    rng = np.random.default_rng(5)
    size = 0.03 * np.sqrt(mesh.quad_areas().mean())
    x, t = moved(mesh, size, rng)
    history = state.history.copy()
    energy(shell, state, history, x, t)
    state.history[:] = history
    tangent = shell.tangents(state, np.array([0]))[0]
    for a, c in ((0, 0), (1, 2), (3, 1)):
        change = np.zeros_like(x)
        change[mesh.quads[0, a], c] = 1e-5 * size
        _, ahead = energy(shell, state, history, x + change, t)
        _, behind = energy(shell, state, history, x - change, t)
        slope = -(ahead - behind)[mesh.quads[0], :3].ravel() / (2e-5 * size)
        # Differences of both kinds: 1e-7 of the largest stiffness.
        wanted = tangent[:12, 3 * a + c]
        np.testing.assert_allclose(slope, wanted, atol=3e-7 * abs(tangent[:12, :12]).max())


@pytest.mark.parametrize("squeeze", [0.6, 1.0, 2.0])
def test_the_step_is_bounded_by_the_film_as_it_is(squeeze):
    """A squeezed film is stiffer than its moduli on the reference say, a stretched one softer."""
    mesh = rectangle(1.0, 1.0, n_x=1, n_y=1)
    shell, state = cases.set_up(mesh, RUBBER)
    x = mesh.nodes * [squeeze, 1.0, 1.0]
    put(state, x, mesh.directors)
    which = np.array([0])
    shell.evaluate_frequencies(state, which)
    bound = np.sqrt(shell.frequencies.squared[0])
    exact = shell.tangents(state, which)[0]
    mass, inertia = shell.corner_shares(which)
    m = np.concatenate([np.repeat(mass[0], 3), np.repeat(inertia[0], 2)])
    root = np.sqrt(np.linalg.eigvalsh(exact / np.sqrt(np.outer(m, m))).max())
    assert root <= bound * (1 + 1e-9)
    assert bound <= 1.02 * root


def test_a_drawn_film_with_damping_stays_at_rest():
    """Damping keeps the elastic moduli on a film that has softened: the step must allow for it."""
    mesh = rectangle(3.0, 3.0, n_x=3, n_y=3)
    x, y, _ = mesh.nodes.T
    rim = np.flatnonzero((x == x.min()) | (x == x.max()) | (y == y.min()) | (y == y.max()))
    sim = sc.Simulation(
        mesh,
        RUBBER,
        supports=[sc.Support.clamped(rim)],
        damping_beta=5e-6,
        stepping=Stepping(safety=1.0),
    )
    n = sim.state.node
    n.x[: n.count] = mesh.nodes * [2.2, 1.0, 1.0]
    rng = np.random.default_rng(2)
    n.velocity_half[: n.count] = 1e-3 * rng.normal(size=(n.count, 3))
    n.velocity_half[rim] = 0.0
    sim.time_step.forget()
    largest = []
    for _ in range(400):
        sim.step()
        largest.append(np.abs(n.velocity_half[: n.count]).max())
    # Motions die away; with the step that the softened moduli alone allow they grow by 1e9.
    assert max(largest[200:]) < 0.1 * largest[0]


# ---------------------------------------------------------------- statics


def test_statics_of_a_strip_is_the_hardening_and_converges_quadratically():
    mesh = rectangle(4.0, 2.0, n_x=4, n_y=2)
    corner = mesh.nodes[:, 1] == mesh.nodes[:, 1].min()
    strip = Statics(
        mesh,
        FOIL,
        supports=[
            sc.Support("left", translation="xz"),
            sc.Support(np.flatnonzero(corner), translation="y", rotation=""),
        ],
        loads=[EdgeTraction("right", (1.0, 0.0, 0.0))],
    )
    stress = 20.0  # nominal
    path = strip.load_steps([10.0 * H, stress * H])
    assert path[-1].n_iteration <= 8
    sigma = strip.stress()[:, 0, 0]
    x = path[-1].displacement[:, 0]
    strain = np.log1p(x.max() / 4.0)
    plastic = (stress * np.exp(strain) - 15.0) / 60.0
    J = np.exp((1 - 2 * NU) * stress * np.exp(strain) / E)
    np.testing.assert_allclose(sigma * J, stress * np.exp(strain), rtol=1e-7)
    assert strain == pytest.approx(plastic + stress * np.exp(strain) / E, rel=1e-6)
    means = strip.shell.history_means(strip.state)["equivalent plastic strain [-]"]
    np.testing.assert_allclose(means, plastic, rtol=1e-6)
    # Unloaded: what stays is the plastic strain.
    left = strip.load_steps([0.0])[-1].displacement[:, 0].max()
    assert np.log1p(left / 4.0) == pytest.approx(plastic, rel=1e-6)


def test_statics_refuses_a_rate():
    timed = Plastic(FILM, Voce(15.0, 5.0, 0.1), rate=JohnsonCook(0.02, 1.0))
    with pytest.raises(ValueError, match="statics must have layers whose stress does not depend"):
        Statics(rectangle(1.0, 1.0, n_x=1, n_y=1), ShellMaterial([Layer(timed, H)]))


# ---------------------------------------------------------------- runs


def test_a_quad_folded_flat_stops_the_run_by_name():
    mesh = rectangle(2.0, 1.0, n_x=2, n_y=1)
    shut = sc.Support("right", velocity={"x": lambda t: -4e4})
    flat = sc.Support(np.arange(mesh.n_node), translation="z", rotation="xyz")
    sim = sc.Simulation(
        mesh,
        RUBBER,
        supports=[sc.Support.clamped("left"), shut, flat],
        stepping=Stepping(evaluate_every=20),
    )
    with pytest.raises(UnstableStep, match=r"quad \d+ at .* has been folded flat at step"):
        sim.run(6e-5)
    assert np.isfinite(sim.state.node.force).all()
