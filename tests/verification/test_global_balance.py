"""Forces and moments on nodes and tool sum to zero while a blade cuts, part by part and in all.

Shells, contact and cables each act between the nodes, or between nodes and tool: they can neither
push nor turn the whole. The moment of the shells has the directors' part t x g; the cables keep a
named couple, because a straight cable's force is along w + delta_0 m, not along w. Supports act
from outside: with them the balance is that of momentum.
"""

import copy

import numpy as np
import pytest

import shellcut as sc
from shellcut.state import BROKEN, JOINTED, STRAIGHT
from shellcut.tool.shapes import straight_blade

# Round-off: some thousand terms are summed; relative to the sum of their sizes. Measured 6e-16.
ROUND_OFF = 1e-13


def _guillotine(*, edge_angle_deg: float = 90.0, equilibrium_start: bool = False) -> sc.Simulation:
    return sc.guillotine(
        0.8,
        length=8.0,
        speed=12000.0,
        tool=straight_blade(edge_angle_deg=edge_angle_deg, length=4.0, height=3.0),
        fracture=sc.Fracture(path="edges", equilibrium_start=equilibrium_start),
        damping_alpha=0.0,
    ).simulation


def _turned(x: np.ndarray, force: np.ndarray) -> np.ndarray:
    return np.cross(x, force).sum(axis=0)


def _about_origin(sim: sc.Simulation, wrench: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return force and moment about the origin of space from wrenches of the teeth."""
    force, moment = wrench.sum(axis=0)[:3], wrench.sum(axis=0)[3:]
    return force, moment + np.cross(sim.pose.translation, force)


def _check_shell(sim: sc.Simulation) -> None:
    s = copy.deepcopy(sim.state)  # the evaluation writes the strains of the last one
    s.node.force[:] = s.node.director_force[:] = 0.0
    sim.shell.add_forces(s)
    n = s.n_node
    x, f = s.node.x[:n], s.node.force[:n]
    directors = np.cross(s.node.t[:n], s.node.director_force[:n])
    assert np.abs(f.sum(axis=0)).max() <= ROUND_OFF * np.abs(f).sum()
    moments = np.abs(np.cross(x, f)).sum()
    assert np.abs(_turned(x, f) + directors.sum(axis=0)).max() <= ROUND_OFF * moments


def _check_contact(sim: sc.Simulation) -> None:
    n = sim.state.n_node
    x, f = sim.state.node.x[:n], sim.state.node.contact_force[:n]
    force, moment = _about_origin(sim, sim.contact.forces.wrench)
    assert np.abs(f.sum(axis=0) + force).max() <= ROUND_OFF * np.abs(f).sum()
    scale = np.abs(np.cross(x, f)).sum()
    assert np.abs(_turned(x, f) + moment).max() <= ROUND_OFF * scale


def _check_cables(sim: sc.Simulation) -> None:
    c = sim.state.cable
    live = c.status[: c.count] != BROKEN
    x = c.at_ends(sim.state.node.x)[live].reshape(-1, 3)
    f = c.force[: c.count][live].reshape(-1, 3)
    force, moment = _about_origin(sim, sim.cables.forces.wrench)
    assert np.abs(f.sum(axis=0) + force).max() <= ROUND_OFF * np.abs(f).sum()
    rest = _turned(x, f) + moment - sim.cables.forces.couple
    assert np.abs(rest).max() <= ROUND_OFF * (np.abs(np.cross(x, f)).sum() + 1e-3)
    # The couple is what the module says it is at most: sigma_F A delta_0 of each straight cable.
    assert sim.law is not None
    straight = c.area[: c.count][c.status[: c.count] == STRAIGHT].sum()
    most = sim.law.strength * straight * sim.law.onset
    assert np.linalg.norm(sim.cables.forces.couple) <= most + 1e-12


def _check_all(sim: sc.Simulation) -> None:
    s, n = sim.state, sim.state.n_node
    x, f = s.node.x[:n], s.node.force[:n]
    directors = np.cross(s.node.t[:n], s.node.director_force[:n]).sum(axis=0)
    force, moment = _about_origin(sim, sim.tooth_wrenches)
    assert np.abs(f.sum(axis=0) + force).max() <= ROUND_OFF * np.abs(f).sum()
    rest = _turned(x, f) + directors + moment - sim.cables.forces.couple
    assert np.abs(rest).max() <= ROUND_OFF * np.abs(np.cross(x, f)).sum()


def test_forces_and_moments_of_a_guillotine_sum_to_zero() -> None:
    sim = _guillotine()
    checked = 0
    while sim.motion.coordinate(sim.state.time) < 5.0:
        sim.step()
        if sim.state.step % 50 == 0:
            checked += 1
            _check_shell(sim)
            _check_contact(sim)
            _check_all(sim)
            if sim.state.n_cable:
                _check_cables(sim)
    # The run has come by all that acts: contact, straight, bent and broken cables.
    status = sim.state.cable.status[: sim.state.n_cable]
    assert checked > 50
    assert sim.cables.n_joint_made > 2
    assert {STRAIGHT, JOINTED, BROKEN} == set(status.tolist())
    assert sim.contact.forces.n_touching > 0
    assert sim.ledger.strain > 0.1


def test_they_do_with_a_slanting_blade_and_the_equilibrium_start() -> None:
    # Forces out of the plane, and the start forces of the cables with their couple.
    sim = _guillotine(edge_angle_deg=50.0, equilibrium_start=True)
    while sim.motion.coordinate(sim.state.time) < 4.0:
        sim.step()
        if sim.state.step % 50 == 0:
            _check_shell(sim)
            _check_contact(sim)
            _check_all(sim)
    assert sim.cables.n_joint_made > 0
    assert np.abs(sim.state.node.force[: sim.state.n_node, 2]).max() > 1e-2
    cable, n = sim.state.cable, sim.state.n_cable
    assert np.abs(cable.start_force[:n]).max() > 1e-2
    # The work of these is in the ledger, by itself.
    assert sim.ledger.cohesive_start_work == pytest.approx(cable.start_work[:n].sum(), rel=1e-9)
    assert sim.ledger.cohesive_work == pytest.approx(cable.work[:n].sum(), rel=1e-9)
    assert np.abs(cable.start_work[:n]).max() > 1e-6


def test_momentum_is_what_tool_and_supports_gave() -> None:
    sim = _guillotine()
    node = sim.state.node

    def momentum() -> np.ndarray:
        n = sim.state.n_node
        return (node.mass[:n, None] * node.velocity_half[:n]).sum(axis=0)

    # The first kick, from rest, came from no force: the notch is free and unloaded.
    impulse, largest = momentum(), 0.0
    for _ in range(2500):
        before = momentum()
        sim.step()
        force, _ = _about_origin(sim, sim.tooth_wrenches)
        held = node.reaction[: sim.state.n_node, :3].sum(axis=0)
        dt = 0.5 * (sim.state.dt + sim.dt)
        step = dt * (held - force)
        # Round-off, relative to the impulse of all nodal forces, splits included.
        scale = dt * np.abs(node.force[: sim.state.n_node]).sum() + np.abs(before).max()
        assert np.abs(momentum() - before - step).max() <= ROUND_OFF * scale
        impulse = impulse + step
        largest = max(largest, float(np.abs(impulse).max()))
    assert sim.state.n_cable > 1
    assert np.abs(momentum() - impulse).max() < ROUND_OFF * 2500 * largest


def test_the_torque_on_a_resisted_screw_is_against_its_turn() -> None:
    through = sc.Fracture(path="free")
    sim = sc.opening_test("quick", duration=1.5e-3, fracture=through).simulation
    motion = sim.motion
    axis = np.array([0.0, 0.0, 1.0])
    torque, power, aside = [], [], []
    while sim.motion.coordinate(sim.state.time) < np.radians(12.0):
        sim.step()
        force, moment = _about_origin(sim, sim.tooth_wrenches)
        spin, velocity = motion.twist(sim.state.time)
        torque.append(-float(moment @ axis))  # what the drive must give, positive if resisted
        power.append(-float(force @ velocity + moment @ spin) * sim.state.dt)
        aside.append(np.abs(force[:2]).max() / max(np.abs(sim.tooth_wrenches[:, :3]).sum(), 1.0))
    # The sign, of the mean while the cuts begin: 54 to 126 N·mm.
    assert np.mean(torque[len(torque) // 2 :]) > 10.0
    # The ledger's tool work is the integral of that power, trapezoidal against midpoint twist:
    # discretisation, measured 1e-3.
    assert sim.ledger.tool_work > 0.0
    assert sim.ledger.tool_work == pytest.approx(np.sum(power), rel=5e-3)
    # Four teeth a quarter turn apart: no side force. Symmetry, up to round-off grown while the tips
    # rattle at first touch, and to a fibre that the edge of one tooth bends a step before the
    # others, which rings: 1e-5 of the force in most steps.
    assert sim.tooth_wrenches.shape == (4, 6)
    assert np.median(aside[len(aside) // 2 :]) < 1e-4
