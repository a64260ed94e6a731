"""Bounds of the quads' frequencies, never below the exact ones, and what calls for new ones."""

from functools import cache

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import shellcut as sc
from naive import cases
from shellcut import Elastic, Layer, Mesh, ShellMaterial
from shellcut.mesh.structured import opening_disc, rectangle
from shellcut.mitc4.frequency import bound_largest_eigenvalues
from shellcut.mitc4.initial_state import initial_state
from shellcut.mitc4.shell import MITC4Shell


def state_of(mesh, x, t):
    """A state of a mesh at positions and with directors."""
    state = initial_state(mesh)
    state.node.x[: mesh.n_node], state.node.t[: mesh.n_node] = x, t
    return state


def exact(shell, state):
    """The largest eigenvalue of every quad of an elastic film by LAPACK."""
    K = shell.tangents(state, np.arange(state.n_quad))
    mass = np.repeat(shell.mass, 3, axis=1)
    inertia = np.repeat(shell.quad_inertia(np.arange(shell.area.size)), 2, axis=1)
    scale = np.concatenate([mass, inertia], axis=1) ** -0.5
    return np.linalg.eigvalsh(K * scale[:, :, None] * scale[:, None])[:, -1]


@pytest.mark.parametrize("deformed", [False, True], ids=["rest", "far"])
@pytest.mark.parametrize("case", cases.ALL)
def test_an_evaluated_quad_is_bounded_within_a_five_hundredth(case, deformed):
    mesh = cases.ALL[case]()
    shell, state = cases.set_up(mesh)
    if deformed:
        cases.deform(state)
    wanted = exact(shell, state)
    frequencies = shell.frequencies
    frequencies.evaluate(state.node.x, state.node.t, state.quads, np.arange(mesh.n_quad))
    # Never below, round-off apart; not more than the 0.2 % that the bound is tried above.
    assert (frequencies.squared >= wanted * (1 - 1e-12)).all()
    assert (frequencies.squared <= wanted * 1.002 * (1 + 1e-12)).all()


def test_all_quads_of_a_disc_at_rest():
    mesh = opening_disc("quick")
    shell = MITC4Shell(mesh, cases.FILM, damping_beta=0.0)
    ratio = shell.frequencies.squared / exact(shell, initial_state(mesh))
    # Congruent quads agree to the 1e-9 of their scalar products.
    assert ratio.min() > 1.0 - 1e-8
    assert ratio.max() < 1.002 + 1e-8


@cache
def few_quads(case, size, seed):
    """A mesh and its shell, which the motions of the next test share."""
    mesh = rectangle(3.0, 2.0, n_x=3, n_y=2) if case == "squares" else cases.ALL[case](seed=seed)
    mesh = Mesh.from_arrays(size * mesh.nodes, mesh.quads, directors=mesh.directors)
    return mesh, MITC4Shell(mesh, cases.FILM, damping_beta=0.0)


@pytest.mark.parametrize("amount", [1e-3, 1e-2, 0.05, 0.2])
@pytest.mark.parametrize("kind", ["random", "stretched", "bent", "tilted"])
@pytest.mark.parametrize("case", ["squares", *cases.ALL])
def test_bounds_hold_in_between(case, kind, amount):
    rng = np.random.default_rng(5)
    for seed, size in enumerate((0.1, 0.4, 1.0)):  # of the quads [mm]
        mesh, shell = few_quads(case, size, seed)
        n = mesh.n_node
        # Evaluated in a state that is deformed already, and nothing is left of the last one.
        x = mesh.nodes + 0.05 * size * rng.uniform(-1, 1, (n, 3))
        t = Rotation.from_rotvec(rng.uniform(-0.1, 0.1, (n, 3))).apply(mesh.directors.copy())
        node = state_of(mesh, x, t).node
        shell.frequencies.evaluate(node.x, node.t, mesh.quads, np.arange(mesh.n_quad))
        if kind == "random":
            x = x + amount * size * rng.uniform(-1, 1, (n, 3))
        if kind == "stretched":
            x = x @ (np.eye(3) + amount * rng.uniform(-1, 1, (3, 3))).T
        if kind in ("random", "tilted"):
            t = Rotation.from_rotvec(amount * rng.uniform(-1, 1, (n, 3))).apply(t)
        if kind == "bent":
            t = Rotation.from_rotvec(np.outer(x[:, 0], [0, -amount / size, 0])).apply(t)
            x = x + np.outer(0.5 * amount / size * x[:, 0] ** 2, [0, 0, 1])
        turn = Rotation.from_rotvec(rng.uniform(-2, 2, 3))  # of the whole: it changes nothing
        state = state_of(mesh, turn.apply(x), turn.apply(t))
        shell.frequencies.follow(state.node.x, state.node.t, mesh.quads)
        growth = shell.frequencies.squared / exact(shell, state)
        assert growth.min() >= 1.0 - 1e-12
        if amount <= 1e-3:  # and it is no idle bound
            assert growth.max() < 1.04


def test_bounds_hold_for_an_unsymmetric_laminate():
    foil = Layer(Elastic(70e3, 0.35, 2.7e-9), 0.009)
    film = ShellMaterial([foil, Layer(Elastic(300.0, 0.45, 0.92e-9), 0.065)])
    rng, mesh = np.random.default_rng(6), cases.curved()
    for amount in (1e-3, 0.02, 0.1):
        shell = MITC4Shell(mesh, film, damping_beta=0.0)
        moves, spins = amount * rng.uniform(-1, 1, (2, mesh.n_node, 3))
        t = Rotation.from_rotvec(spins).apply(mesh.directors.copy())
        state = state_of(mesh, mesh.nodes + moves, t)
        shell.frequencies.follow(state.node.x, state.node.t, mesh.quads)
        assert (shell.frequencies.squared >= exact(shell, state)).all()


@pytest.mark.parametrize("least", [0.0, -0.5, -30.0])
def test_bound_of_a_matrix_with_negative_eigenvalues(least):
    # Where the least outweighs the largest the power iteration ends there: the bound is then by
    # rows, loose and true.
    rng = np.random.default_rng(3)
    Q, _ = np.linalg.qr(rng.normal(size=(20, 20)))
    values = np.linspace(least, 1.0, 20)
    K = (Q * values) @ Q.T
    squared = np.zeros(1)
    one = np.ones((1, 4))
    bound_largest_eigenvalues(tangent=K[None].copy(), mass=one, inertia=one, squared=squared)
    assert squared[0] >= 1.0
    assert squared[0] <= (1.0021 if least > -1.0 else np.abs(K).sum(axis=1).max() * (1 + 1e-12))


def test_a_film_that_is_drawn_out_after_a_long_rest_stays_stable():
    # At rest nothing is to be looked at; then the film is drawn out by half within one interval.
    mesh = rectangle(4.0, 1.0, n_x=8, n_y=2)
    drawn = sc.Support("right", velocity={"x": lambda t: 2e4 if t > 1e-3 else 0.0})
    sim = sc.Simulation(
        mesh,
        sc.ShellMaterial.homogeneous(),
        supports=[sc.Support.clamped("left"), drawn],
        damping_beta=0.0,
    )
    sim.run(1e-3)
    resting = sim.dt
    first = sim.state.step
    sim.run(1.1e-3)
    assert np.ptp(sim.state.node.x[:, 0]) > 5.9
    assert sim.state.step - first < sim.time_step.stepping.evaluate_every
    assert sim.dt < 0.8 * resting
    book = sim.close_ledger()
    assert abs(book.imbalance) < 1e-2 * book.support_work
