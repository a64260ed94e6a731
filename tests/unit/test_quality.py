"""The quality report: shapes against values by hand, steps against the run's own bound."""

import numpy as np
import pytest

import shellcut as sc
from shellcut.mesh.structured import opening_disc, rectangle


def test_the_step_is_that_of_the_run():
    mesh = opening_disc("quick")
    run = sc.Simulation(mesh, sc.ShellMaterial.homogeneous(), stepping=sc.Stepping(safety=1.0))
    # the same arithmetic: round-off
    assert sc.mesh_quality(mesh).stable_step == pytest.approx(run.dt, rel=1e-12)


def test_a_short_quad_is_the_worst_and_its_cost_is_told():
    mesh = rectangle(10.0, 4.0, n_x=10, n_y=4)
    nodes = mesh.nodes.copy()
    nodes[nodes[:, 0] == 5.0, 0] = 4.25  # column 4 is 0.25 wide, column 5 1.75
    quality = sc.mesh_quality(sc.Mesh.from_arrays(nodes, mesh.quads))
    assert set(quality.worst[:4]) == {4, 14, 24, 34}
    assert quality.shortest_edge[4] == 0.25
    assert quality.aspect[4] == 4.0
    assert quality.aspect[5] == 1.75
    assert quality.scaled_jacobian.min() == pytest.approx(1.0, rel=1e-14)
    # the step falls about as the shortest edge; thin quads gain a little by their width
    assert 0.2 < quality.step_cost < 0.5
    told = str(quality)
    assert "40 quads" in told
    assert f"the worst quad shortens the step to {quality.step_cost:.2f} of" in told
    assert "(4.125, -1.5, 0)" in told


def test_damping_shortens_the_step():
    mesh = rectangle(4.0, 4.0, size=1.0)
    free = sc.mesh_quality(mesh, damping_beta=0.0)
    damped = sc.mesh_quality(mesh, damping_beta=2e-7)
    assert (damped.step < free.step).all()


def test_few_quads_are_all_listed():
    quality = sc.mesh_quality(rectangle(2.0, 1.0, n_x=2, n_y=1))
    assert sorted(quality.worst) == [0, 1]
    assert np.isclose(quality.step_cost, 1.0)
