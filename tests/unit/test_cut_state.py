"""Cutting quads of a film in motion changes nothing that is conserved."""

import numpy as np
import pytest

import shellcut as sc
from shellcut.fracture.cuts import Cuts
from shellcut.mesh.structured import rectangle
from test_cut_loads import random_cut
from test_topology import totals


def film(kind, **material):
    mesh = rectangle(4.0, 3.0, size=0.5)
    X = mesh.nodes.copy()
    rng = np.random.default_rng(3)
    X[:, :2] += rng.uniform(-0.1, 0.1, (mesh.n_node, 2))
    if kind == "curved":
        X[:, 2] = 0.1 * X[:, 0] ** 2 + 0.05 * X[:, 0] * X[:, 1]
    mesh = sc.Mesh.from_arrays(X, mesh.quads)
    layers = sc.ShellMaterial.homogeneous(**material)
    velocity = rng.normal(size=(mesh.n_node, 3)) * 3000.0
    sim = sc.Simulation(mesh, layers, velocity=velocity, threads=1)
    for _ in range(30):
        sim.step()
    return sim


def cut_often(sim, rng):
    """Cut sixty rows, some of them copies, each from one place of its boundary to another."""
    cuts = Cuts(sim.state, sim.shell, sc.CohesiveLaw(), fibres=6)
    for _ in range(60):
        random_cut(sim, cuts, int(rng.integers(cuts.topology.n_row)), rng)


def conserved(sim):
    """Mass, momentum, energies, and the power of the film's forces."""
    s = sim.state
    n, c = s.node, s.node.count
    n.force_rows[:c] = 0.0
    saved = s.strain.copy(), s.strain_before.copy(), s.strain_forms, s.history.copy()
    strain = sim.shell.add_forces(s).strain_energy
    s.strain[:], s.strain_before[:], s.strain_forms, s.history[:] = saved
    turning = np.cross(n.spin_half[:c], n.t[:c])
    power = (n.force[:c] * n.velocity_half[:c]).sum() + (n.director_force[:c] * turning).sum()
    return totals(s) | {"strain": strain, "power": power}


@pytest.mark.parametrize(("kind", "material"), [("flat", {}), ("curved", {"points_per_layer": 3})])
def test_random_cuts_conserve_everything(kind, material):
    sim = film(kind, **material)
    s, rng = sim.state, np.random.default_rng(11)
    before = conserved(sim)
    cut_often(sim, rng)
    after = conserved(sim)
    assert s.n_quad == sim.mesh.n_quad + 60
    assert s.n_node > sim.mesh.n_node
    scale = {name: np.abs(value).max() for name, value in before.items()}
    for name, value in after.items():
        np.testing.assert_allclose(value, before[name], atol=1e-12 * scale[name], err_msg=name)


@pytest.mark.parametrize("kind", ["flat", "curved"])
def test_frequencies_of_all_parts_stay_below_their_bounds(kind):
    # A sliver has more mass than film, the other part less: its frequency rises at every cut.
    sim = film(kind)
    s = sim.state
    cut_often(sim, np.random.default_rng(5))
    frequencies = sim.shell.frequencies
    frequencies.follow(s.node.x, s.node.t, s.quads)
    bound = frequencies.squared.copy()
    sim.shell.evaluate_frequencies(s, np.arange(s.n_quad))
    exact = frequencies.squared
    ratio = s.quad.share[: s.n_quad] / s.quad.mass_share[: s.n_quad]
    assert ratio.max() > 1.02
    assert ratio.min() < 0.8
    assert (bound >= exact * (1.0 - 1e-9)).all()
    # They grow with the strains since the last evaluation.
    assert (bound <= exact * 1.2).all()
