"""The stable step: a bound, close to exact, with damping, contact and cables counted."""

import numpy as np
import pytest

import shellcut as sc
from naive import cases
from shellcut.cables.directional_cable import CableSet
from shellcut.contact.penalty_contact import PenaltyContact
from shellcut.contact.settings import STEEPEST
from shellcut.mesh.structured import rectangle
from shellcut.mitc4.shell import DAMPING_SHARE, MITC4Shell
from shellcut.simulation.stable_step import StableStep
from shellcut.statics.freedoms import Freedoms
from shellcut.tool.pose import Pose
from shellcut.tool.shapes import straight_blade

LAW = sc.CohesiveLaw()


def stepper(shell, contact=None, tool=None, **stepping):
    terms = [CableSet(LAW, tool)] if contact is None else [contact, CableSet(LAW, tool)]
    return StableStep(sc.Stepping(**stepping), shell, terms)


@pytest.mark.parametrize("deformed", [False, True], ids=["rest", "far"])
@pytest.mark.parametrize("case", cases.ALL)
def test_bound_is_below_the_exact_limit_and_close_to_it(case, deformed):
    mesh = cases.ALL[case]()
    shell, state = cases.set_up(mesh)
    if deformed:
        cases.deform(state, stretch=0.03, tilt=0.05)
    freedoms, n = Freedoms(state), mesh.n_node
    K = freedoms.stiffness(shell).toarray()
    mass = freedoms.diagonal(state.node.mass[:n], state.node.inertia[:n])
    exact = 2.0 / np.sqrt(np.linalg.eigvalsh(K / np.sqrt(np.outer(mass, mass)))[-1])
    got = stepper(shell, safety=1.0).next(state)
    # A bound by theory, for which those of the quads are taken, within 0.1 % (test_quad_frequency).
    # 25 % is what irregular quads may cost, 12 % is measured on squares.
    assert 0.75 * exact < got <= exact * (1 + 1e-9)
    assert stepper(shell, safety=0.9).next(state) == pytest.approx(0.9 * got, rel=1e-12)


@pytest.mark.parametrize("thickness", [0.01, 1.0])
@pytest.mark.parametrize("size", [0.05, 2.0])
def test_a_share_of_critical_damping_costs_any_film_the_same_part_of_the_step(size, thickness):
    mesh = rectangle(8.0 * size, 4.0 * size, size=size)
    film = sc.ShellMaterial.homogeneous(thickness=thickness)
    free, damped = (
        sc.Simulation(mesh, film, damping_share=share, stepping=sc.Stepping(safety=1.0)).dt
        for share in (0.0, 0.3)
    )
    # sqrt(1 + xi²) - xi, of the bounds from which the damping comes
    assert damped == pytest.approx((np.sqrt(1.09) - 0.3) * free, rel=1e-9)


def test_films_are_damped_by_a_share_and_the_papers_meshes_by_its_time():
    mesh, film = rectangle(4.0, 4.0, size=1.0), sc.ShellMaterial.homogeneous()
    shared = sc.guillotine(1.0, damping_share=0.2).simulation
    for sim, share in ((sc.Simulation(mesh, film), DAMPING_SHARE), (shared, 0.2)):
        at_rest = MITC4Shell(sim.mesh, sim.material).frequencies.squared
        wanted = 2 * share / np.sqrt(at_rest.max())
        assert sim.shell.damping_beta == pytest.approx(wanted, rel=1e-12)
    assert sc.opening_test("quick").simulation.shell.damping_beta == 5e-8
    assert sc.guillotine(1.0).simulation.shell.damping_beta == 5e-8
    with pytest.raises(ValueError, match="not both: got 1e-08 s and 0"):
        sc.Simulation(mesh, film, damping_beta=1e-8, damping_share=0.2)


def test_contact_of_nodes_that_the_tool_comes_to_counts_at_once():
    mesh = cases.skewed_flat()
    shell, state = cases.set_up(mesh)
    tool = straight_blade()
    contact = PenaltyContact(tool, sc.Contact(penalty=1e6), sc.ShellMaterial.homogeneous(), 0.4)
    free = stepper(shell, safety=1.0).next(state)
    step = stepper(shell, contact, tool, safety=1.0, evaluate_every=500)
    node = 5
    contact.add_forces(state, Pose(np.eye(3), mesh.nodes[node] - [100.0, 0.0, 0.0]))
    assert step.next(state) == free  # nothing is near yet
    state.step += 10  # it asks every ten steps whether the tool has moved on
    contact.add_forces(state, Pose(np.eye(3), mesh.nodes[node].copy()))
    near = contact.near_nodes(state)
    assert node in near
    added = np.zeros(mesh.n_node)
    added[near] = STEEPEST * 1e6 * state.node.contact_area[near] / state.node.mass[near]
    total = shell.frequencies.squared + added[state.quads].max(axis=1)
    assert step.bound(state) == pytest.approx(2.0 / np.sqrt(total.max()), rel=1e-12)
    assert step.next(state) == step.bound(state) < 0.8 * free


def test_a_split_is_seen_at_once_by_its_cables_on_the_mass_that_is_left():
    shell, state = cases.set_up(cases.skewed_flat())
    step = stepper(shell, safety=1.0, evaluate_every=100)
    free = step.next(state)
    for ends in ((5, 6), (5, 7)):
        k = state.cable.append_blank()
        state.cable.ends[k], state.cable.area[k], state.cable.m[k] = ends, 0.2, (0, 1, 0)
    state.node.mass[5] *= 0.01  # as of a small half
    state.step += 1
    assert step.next(state) == free  # nobody has told
    state.revision += 1
    K = 2 * 18.0 * 0.2 / LAW.onset
    total = shell.frequencies.squared.copy()
    for node, held in ((5, 2.0 * K), (6, K), (7, K)):
        extra = np.where((state.quads == node).any(axis=1), held / state.node.mass[node], 0.0)
        total = np.maximum(total, shell.frequencies.squared + extra)
    assert step.bound(state) == pytest.approx(2.0 / np.sqrt(total.max()), rel=1e-12)
    assert step.next(state) == pytest.approx(step.bound(state), rel=1e-12)
    assert step.next(state) < 0.5 * free


def test_a_small_gain_is_taken_when_it_has_lasted():
    shell, state = cases.set_up(cases.skewed_flat())
    step = stepper(shell, safety=1.0, evaluate_every=100)
    first = step.next(state)
    omega2 = shell.frequencies.squared.copy()
    shell.frequencies.follow = shell.frequencies.evaluate = lambda *_: None  # as it is set below

    def after(factor):
        """Return the step, over the first, to which it grows by 0.2 % at most each time."""
        shell.frequencies.squared[:] = omega2 / factor**2
        state.step += 100
        state.dt = dt = step.next(state)
        while (longer := step.next(state)) != dt:
            assert dt < longer <= 1.0021 * dt
            state.dt = dt = longer
        return dt / first

    # A longer step at once only when 8 % are to be won, else after an interval, for 1 %.
    factors = (1.05, 1.03, 1.05, 1.034, 1.15, 1.05)  # a shorter one at once
    steps = [after(factor) for factor in factors]
    assert steps == pytest.approx([1.0, 1.03, 1.03, 1.03, 1.15, 1.05], rel=1e-12)
    state.step += 1
    shell.frequencies.squared[:] = omega2 * 100
    assert step.next(state) == pytest.approx(1.05 * first, rel=1e-12)  # no split: not due yet
    state.step += 100
    assert step.next(state) == pytest.approx(0.1 * first, rel=1e-12)


def test_a_bound_that_is_no_number_is_not_passed_over():
    shell, state = cases.set_up(cases.skewed_flat())
    step = stepper(shell, evaluate_every=100)
    first = step.next(state)
    state.node.x[5] = np.nan
    state.step += 100
    assert np.isnan(step.next(state))
    state.node.x[5] = cases.skewed_flat().nodes[5]
    state.step += 100
    assert np.isfinite(step.next(state))  # and no longer than before: nothing else has moved
    assert step.next(state) <= first
