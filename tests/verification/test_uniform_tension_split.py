"""A row of nodes split under uniform tension: with the equilibrium start nothing moves.

A strip is stretched homogeneously, uniaxial stress along x, fixed at its ends, and so in
equilibrium to round-off. Then all nodes of its middle line are split across the pull, chosen by the
criterion itself. The strength of the law is the stress divided by ``mismatch``.
"""

import numpy as np
import pytest

import shellcut as sc
from courses import UNDAMPED, recorded
from films import shaken
from shellcut.fracture.tip import Tip
from shellcut.mesh.structured import rectangle

E, NU, THICKNESS = 1678.0, 0.3, 0.074
LENGTH, WIDTH, SIZE = 4.0, 2.0, 0.25  # short: the fall of the start force is softer than the strip
STRAIN = 0.02  # Green-Lagrange, along x
STRETCH = np.array([np.sqrt(1.0 + 2.0 * STRAIN), np.sqrt(1.0 - 2.0 * NU * STRAIN), 1.0])
NOMINAL = STRETCH[0] * E * STRAIN  # force per reference area [MPa]


def _middle_row(mesh):
    return mesh.nodes_where(lambda x, y, z: np.abs(x - 0.5 * LENGTH) < 1e-9)


def _stretched(mesh, mismatch):
    sim = sc.Simulation(
        mesh,
        sc.ShellMaterial.homogeneous(young=E, poisson=NU, thickness=THICKNESS),
        supports=[sc.Support.clamped("left"), sc.Support.clamped("right")],
        law=sc.CohesiveLaw(strength=NOMINAL / mismatch),
        fracture=sc.Fracture(path="edges", equilibrium_start=True),
        **UNDAMPED,
    )
    sim.state.node.x[: mesh.n_node] = mesh.nodes * STRETCH
    _evaluate(sim)
    return sim


def _evaluate(sim):
    sim.loads.begin_forces(sim.state)
    sim.ledger.strain = sim.shell.add_forces(sim.state).strain_energy
    sim.terms.add_forces(sim.state, sim.pose, sim.ledger)


def _largest_residual(sim):
    """Return the largest force on a free node over that of one edge length of the section."""
    n = sim.state.node
    free = ~n.supported[: n.count]
    return float(np.abs(n.force[: n.count][free]).max() / (NOMINAL * THICKNESS * SIZE))


def _split_middle_row(sim, mesh):
    """Let a crack run from the border across half the length; return its measures."""
    row = _middle_row(mesh)
    start, *_, end = row[np.argsort(mesh.nodes[row, 1])].tolist()
    sim.cracks.growth.tips = [Tip((start, start), 0.0, -1, np.array([0.0, 1.0, 0.0]))]
    while sim.cracks.tips:
        sim.cracks.cut_due(sim.state, sim.pose)
    log = sim.state.split_log
    assert sorted({record.node for record in log} | {end}) == sorted(row.tolist())
    return [record.measure for record in log]


@pytest.mark.parametrize(("jitter", "mismatch"), [(0.0, 1.4), (0.06, 1.0)])
def test_equilibrium_start_leaves_everything_at_rest(jitter, mismatch):
    mesh = rectangle(LENGTH, WIDTH, size=SIZE)
    mesh = shaken(mesh, jitter, seed=3, held=_middle_row(mesh))
    # One part in 1e9 above the strength, lest round-off decide whether the row splits at all.
    sim = _stretched(mesh, mismatch * (1.0 + 1e-9))
    # Round-off, of forces relative to the force of an edge: measured 1e-13.
    assert _largest_residual(sim) < 1e-11
    strain, momentum_mass = sim.ledger.strain, float(sim.state.node.mass.sum())

    measures = _split_middle_row(sim, mesh)
    # The row carries sigma A, every node of it, on both meshes: round-off, measured 2e-14.
    assert np.allclose(measures, mismatch, rtol=1e-8)
    cables = sim.state.cable
    assert sim.state.crack_length == pytest.approx(WIDTH, rel=1e-14)
    assert cables.area[: cables.count].sum() == pytest.approx(WIDTH * THICKNESS, rel=1e-14)
    assert np.allclose(cables.m[: cables.count] * np.sign(cables.m[: cables.count, :1]), [1, 0, 0])
    assert float(sim.state.node.mass[: sim.state.n_node].sum()) == pytest.approx(momentum_mass)

    _evaluate(sim)
    assert sim.ledger.strain == strain  # bitwise: the quads have not noticed
    assert _largest_residual(sim) < 1e-11
    # A bound far above round-off, far below any unrest: measured 1e-25.
    until = sim.state.step + 300
    kinetic = recorded(sim, lambda one: one.state.step == until, lambda one: one.ledger.kinetic)
    assert kinetic.max() < 1e-10 * strain
    assert cables.opening_max[: cables.count].max() < 1e-10
