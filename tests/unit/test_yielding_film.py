"""Films that yield: forces and energies of quads, axes, tangents, step, statics, runs."""

import itertools

import numpy as np
import pytest

import shellcut as sc
from damaging_film import Damaging
from naive import cases
from shellcut.mesh.structured import rectangle
from shellcut.simulation.instability import UnstableStep

E, NU, H = 1678.0, 0.3, 0.074
FILM = sc.Elastic(E, NU, 1e-9)
DRAWN = sc.Orthotropic(1500.0, 4000.0, 0.25, 700.0, 1e-9)
SOFT_YIELD = 15.0
SOFT = sc.Plastic(FILM, sc.Linear(SOFT_YIELD, 60.0))
FOIL = sc.ShellMaterial([sc.Layer(SOFT, H)], points_per_layer=3)
RUBBER = sc.ShellMaterial([sc.Layer(sc.Hencky(FILM), H)])


def a_turn(rng):
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    return turn * np.sign(np.linalg.det(turn))


def size_of(mesh):
    """Return by how much nodes are moved for strains of some 3 %."""
    return 0.03 * np.sqrt(mesh.quad_areas().mean())


def moved(mesh, size, rng):
    """Positions and directors of a strained, bent, turned film."""
    turn = a_turn(rng)
    x = mesh.nodes @ turn.T + size * rng.normal(size=mesh.nodes.shape)
    t = mesh.directors @ turn.T + 0.3 * size * rng.normal(size=mesh.nodes.shape)
    return x, t / np.linalg.norm(t, axis=1, keepdims=True)


def energy(shell, state, history, x, t):
    """Stored and dissipated energy of a step from a history, and the nodal forces."""
    state.node.x[: len(x)], state.node.t[: len(x)] = x, t
    state.history[:] = history
    state.node.force_rows[:] = 0.0
    work = shell.add_forces(state)
    return work.strain_energy + work.dissipated, state.node.force_rows[: len(x)].copy()


@pytest.mark.parametrize("film", [FOIL, RUBBER], ids=["von Mises", "Hencky"])
@pytest.mark.parametrize("case", ["flat", "curved"])
def test_forces_and_tangents_are_derivatives_of_the_potential(case, film):
    """Linear hardening: the dissipation of a step is its own potential, ½ (σ_0 + σ) Δp."""
    mesh = cases.ALL[case](2, 1)
    shell, state = cases.set_up(mesh, film)
    rng, size = np.random.default_rng(3), size_of(mesh)
    before = moved(mesh, 0.5 * size, rng)
    energy(shell, state, state.history, *before)
    history = state.history.copy()
    x, t = before[0] + size * rng.normal(size=before[0].shape), before[1]
    _, rows = energy(shell, state, history, x, t)
    flows = (state.history > history).any()
    state.history[:] = history
    if film is FOIL:
        assert flows
        # By single quads. A block goes on until all its lanes are returned: 1e-10 of what is left.
        corner, total = mesh.quads.ravel(), np.zeros_like(x)
        quads = np.repeat(np.arange(mesh.n_quad), 4)
        np.add.at(total, corner, shell.corner_forces(state, quads, corner))
        np.testing.assert_allclose(total, rows[:, :3], rtol=0, atol=1e-10 * abs(rows).max())
        np.testing.assert_array_equal(state.history, history)
    tangents = shell.tangents(state, np.arange(mesh.n_quad))
    for node, c in [(0, 0), (1, 1), (2, 2), (4, 0), (5, 2)]:
        change = np.zeros_like(x)
        change[node, c] = 1e-5 * size
        (ahead, rows_ahead), (behind, rows_behind) = (
            energy(shell, state, history, x + sign * change, t) for sign in (1.0, -1.0)
        )
        # Central differences: their square, and round-off of the energy over the step.
        slope = (ahead - behind) / (2e-5 * size)
        assert -rows[node, c] == pytest.approx(slope, abs=1e-7 * abs(rows[:, :3]).max())
        wanted = np.zeros_like(x)
        for quad, tangent in zip(mesh.quads, tangents, strict=True):
            for a in np.flatnonzero(quad == node):
                wanted[quad] += tangent[:12, 3 * a + c].reshape(4, 3)
        slope = -(rows_ahead - rows_behind)[:, :3] / (2e-5 * size)
        # Differences of both kinds: 1e-7 of the largest stiffness.
        largest = abs(tangents[:, :12, :12]).max()
        np.testing.assert_allclose(slope, wanted, atol=3e-7 * largest)


def test_the_nominal_stress_of_layers_is_the_force_over_width_and_thickness():
    """Of a film stretched in one direction: the sum of nodal forces there, over the stretch."""
    length, width, stretch = 2.0, 1.0, 1.05
    stiff = sc.Layer(sc.Hencky(sc.Elastic(4.0 * E, NU, 1e-9)), 0.3 * H)
    film = sc.ShellMaterial([sc.Layer(SOFT, 0.7 * H), stiff], points_per_layer=3)
    mesh = rectangle(length, width, n_x=2, n_y=1)
    shell, state = cases.set_up(mesh, film)
    x = mesh.nodes * [stretch, 1.0, 1.0]
    _, forces = energy(shell, state, state.history.copy(), x, mesh.directors)
    pull = abs(forces[mesh.node_set("right"), 0].sum())
    nominal, middle = (
        shell.stress(state, np.array([0]), place=place)[0, 0, 0] for place in ("nominal", "mid")
    )
    assert nominal == pytest.approx(pull / (width * H * stretch), rel=1e-9)
    assert middle < 0.8 * nominal


def test_a_turn_in_mid_run_changes_nothing():
    mesh = cases.ALL["curved"](2, 2)
    rng, size = np.random.default_rng(4), size_of(mesh)
    x, t = moved(mesh, size, rng)
    further = x + size * rng.normal(size=x.shape)
    found = []
    for R in (np.eye(3), a_turn(rng)):
        shell, state = cases.set_up(mesh, FOIL)
        energy(shell, state, state.history, x, t)
        _, rows = energy(shell, state, state.history.copy(), further @ R.T, t @ R.T)
        found.append((state.history.copy(), rows[:, :3] @ R, rows[:, 3:6] @ R))
    assert found[0][0].max() > 1e-3
    # Turned as it is: nothing flows, though the points lie on the yield surface.
    energy(shell, state, found[1][0].copy(), further, t)
    # The return leaves up to 1e-10 of a stress; what it left flows in the next step.
    np.testing.assert_allclose(state.history, found[1][0], rtol=0, atol=1e-10 * SOFT_YIELD)
    for one, other in zip(*found, strict=True):
        # Round-off of a metric of order one, in strains.
        np.testing.assert_allclose(other, one, rtol=0, atol=1e-11 * abs(one).max())


def test_axes_follow_the_film_whatever_the_mesh():
    """A drawn film: the same forces by any order of a quad's corners, turned with the film.

    The layer without axes never comes to its onset of damage: the kernels of these two laws are
    compiled for the laminate of test_new_law.py, too.
    """
    layers = [sc.Layer(DRAWN, 0.05), sc.Layer(Damaging(E, NU, 1e-9, onset=1e3), 0.02)]
    films = {"five": (layers, None), "two": (layers, 2), "linear": ([sc.Layer(DRAWN, 0.07)], None)}
    corners = np.array([[0.0, 0.0], [2.0, 0.1], [2.2, 1.3], [-0.2, 1.0]])
    rng = np.random.default_rng(9)
    shift, lean = 0.02 * rng.normal(size=(4, 3)), 0.1 * rng.normal(size=(4, 3))
    t = np.array([0.0, 0.0, 1.0]) + lean
    t /= np.linalg.norm(t, axis=1, keepdims=True)

    def found(name, first=0, angle=0.0, direction=(1.0, 0.2, 0.4)):
        """Return energy, forces and stress, turned back."""
        c, s = np.cos(angle), np.sin(angle)
        turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        these, points = films[name]
        film = sc.ShellMaterial(these, points_per_layer=points, direction=turn @ direction)
        mesh = sc.Mesh.from_arrays(corners @ turn[:2, :2].T, [np.roll([0, 1, 2, 3], first)])
        shell, state = cases.set_up(mesh, film)
        w, rows = energy(shell, state, state.history, mesh.nodes + shift @ turn.T, t @ turn.T)
        parts = [w, rows[:, :3] @ turn, rows[:, 3:6] @ turn]
        if name != "linear":  # its kernel of stresses would be compiled for this alone
            parts.append(turn.T @ shell.stress(state, np.array([0]))[0] @ turn)
        return parts

    def check_equal(one, other):
        for got, wanted in zip(one, other, strict=True):
            np.testing.assert_allclose(got, wanted, rtol=0, atol=1e-11 * np.abs(wanted).max())

    reference = {name: found(name) for name in films}
    for name, first, angle in itertools.product(films, range(4), (0.0, 0.7)):
        check_equal(found(name, first, angle), reference[name])
    # Two points a layer are enough for these laws; at the middle surface they have another stress.
    check_equal(reference["two"][:3], reference["five"][:3])
    assert found("five", direction=(0.0, 1.0, 0.0))[0] < 0.9 * reference["five"][0]


def test_a_direction_that_is_none_is_refused():
    mesh = rectangle(1.0, 1.0, n_x=1, n_y=1)
    for direction in ((0.0, 0.0, 1.0), lambda places: 0.0 * places):
        film = sc.ShellMaterial([sc.Layer(DRAWN, 0.05)], direction=direction)
        with pytest.raises(ValueError, match="direction must have a part in the sheet"):
            cases.set_up(mesh, film)
    with pytest.raises(ValueError, match="direction must be a vector of three numbers"):
        sc.ShellMaterial([sc.Layer(DRAWN, 0.05)], direction=(0.0, 0.0, 0.0))


@pytest.mark.parametrize("squeeze", [0.6, 1.0, 2.0])
def test_the_step_is_bounded_by_the_film_as_it_is(squeeze):
    """A squeezed film is stiffer than its moduli on the reference say, a stretched one softer."""
    mesh, which = rectangle(1.0, 1.0, n_x=1, n_y=1), np.array([0])
    shell, state = cases.set_up(mesh, RUBBER)
    state.node.x[:4] = mesh.nodes * [squeeze, 1.0, 1.0]
    shell.evaluate_frequencies(state, which)
    bound = np.sqrt(shell.frequencies.squared[0])
    mass, inertia = shell.corner_shares(which)
    m = np.concatenate([np.repeat(mass[0], 3), np.repeat(inertia[0], 2)])
    exact = shell.tangents(state, which)[0] / np.sqrt(np.outer(m, m))
    root = np.sqrt(np.linalg.eigvalsh(exact).max())
    assert root <= bound * (1 + 1e-9)
    assert bound <= 1.02 * root


def test_a_drawn_film_with_damping_stays_at_rest():
    """Damping keeps the elastic moduli on a film that has softened: the step must allow for it."""
    mesh = rectangle(3.0, 3.0, n_x=3, n_y=3)
    rim = mesh.boundary_nodes()
    sim = sc.Simulation(
        mesh,
        RUBBER,
        supports=[sc.Support.clamped(rim)],
        damping_beta=5e-6,
        stepping=sc.Stepping(safety=1.0),
    )
    n = sim.state.node
    n.x[: n.count] = mesh.nodes * [2.2, 1.0, 1.0]
    n.velocity_half[: n.count] = 1e-3 * np.random.default_rng(2).normal(size=(n.count, 3))
    n.velocity_half[rim] = 0.0
    sim.time_step.forget()
    largest = []
    for _ in range(400):
        sim.step()
        largest.append(np.abs(n.velocity_half[: n.count]).max())
    # Motions die away; with the step that the softened moduli alone allow they grow by 1e9.
    assert max(largest[200:]) < 0.1 * largest[0]


def test_statics_of_a_strip_is_the_hardening_and_converges_quadratically():
    mesh, stress = rectangle(4.0, 2.0, n_x=4, n_y=2), 20.0  # nominal
    supports = [
        sc.Support("left", translation="xz"),
        sc.Support("bottom", translation="y", rotation=""),
    ]
    pull = sc.EdgeTraction("right", (1.0, 0.0, 0.0))
    strip = sc.Statics(mesh, FOIL, supports=supports, loads=[pull])
    path = strip.load_steps([10.0 * H, stress * H])
    assert path[-1].n_iteration <= 8
    strain = np.log1p(path[-1].displacement[:, 0].max() / 4.0)
    true = stress * np.exp(strain)
    plastic = (true - 15.0) / 60.0
    J = np.exp((1 - 2 * NU) * true / E)
    np.testing.assert_allclose(strip.stress()[:, 0, 0] * J, true, rtol=1e-7)
    assert strain == pytest.approx(plastic + true / E, rel=1e-6)
    means = strip.shell.history_means(strip.state)["equivalent plastic strain [-]"]
    np.testing.assert_allclose(means, plastic, rtol=1e-6)
    # Unloaded: what stays is the plastic strain.
    left = strip.load_steps([0.0])[-1].displacement[:, 0].max()
    assert np.log1p(left / 4.0) == pytest.approx(plastic, rel=1e-6)


def test_statics_refuses_a_rate():
    rate = sc.JohnsonCook(0.02, 1.0)
    film = sc.ShellMaterial([sc.Layer(sc.Plastic(FILM, sc.Linear(15.0), rate=rate), H)])
    with pytest.raises(ValueError, match="statics must have layers whose stress does not depend"):
        sc.Statics(rectangle(1.0, 1.0, n_x=1, n_y=1), film)


def test_a_quad_folded_flat_stops_the_run_by_name():
    mesh = rectangle(2.0, 1.0, n_x=2, n_y=1)
    shut = sc.Support("right", velocity={"x": lambda t: -4e4})
    flat = sc.Support(np.arange(mesh.n_node), translation="z", rotation="xyz")
    supports = [sc.Support.clamped("left"), shut, flat]
    sim = sc.Simulation(mesh, RUBBER, supports=supports, stepping=sc.Stepping(evaluate_every=20))
    with pytest.raises(UnstableStep, match=r"quad \d+ at .* has been folded flat at step"):
        sim.run(6e-5)
    assert np.isfinite(sim.state.node.force).all()
