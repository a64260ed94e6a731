import numpy as np
import pytest

from shellcut import PathCurve
from shellcut.imprinting.smoothing import Sliders, Smoother, corner_determinants, quad_cost
from shellcut.mesh.structured import rectangle


def naive_cost(x, quads, size, weight, eps, power, step_weight):
    total = 0.0
    for e, quad in enumerate(quads):
        for a in range(4):
            p = (x[quad[(a + 1) % 4]] - x[quad[a]]) / size[e]
            q = (x[quad[a - 1]] - x[quad[a]]) / size[e]
            D = p[0] * q[1] - p[1] * q[0]
            chi = 0.5 * (D + np.hypot(D, eps))
            S = (p @ p + q @ q) / (2.0 * chi)
            total += weight[e, a] * (S**power + step_weight * (S / chi) ** power)
    return total


def random_quads():
    mesh = rectangle(3.0, 2.0, size=1.0)
    rng = np.random.default_rng(4)
    x = mesh.nodes[:, :2] + rng.uniform(-0.4, 0.4, (mesh.n_node, 2))
    size = rng.uniform(0.7, 1.3, mesh.n_quad)
    weight = rng.uniform(0.5, 2.0, (mesh.n_quad, 4))
    weight[0, 0] = 0.0
    return x, mesh.quads, size, weight


@pytest.mark.parametrize(("eps", "power"), [(0.3, 1.0), (0.1, 2.0), (1e-3, 4.0)])
def test_cost_and_gradient_against_the_naive_twin(eps, power):
    x, quads, size, weight = random_quads()
    if eps < 0.01:
        x = rectangle(3.0, 2.0, size=1.0).nodes[:, :2] + 0.1 * x  # no inverted quads
    gradient = np.zeros_like(x)
    value = quad_cost(x, quads, size, weight, eps, power, 0.03, gradient)
    assert value == pytest.approx(naive_cost(x, quads, size, weight, eps, power, 0.03), rel=1e-10)
    way = np.random.default_rng(1).normal(size=x.shape)
    d = 1e-6
    ends = [naive_cost(x + s * d * way, quads, size, weight, eps, power, 0.03) for s in (1, -1)]
    # round-off of the difference: 1e-16 / 1e-6 of a value of the same order
    assert (gradient * way).sum() == pytest.approx((ends[0] - ends[1]) / (2.0 * d), rel=1e-6)


def test_a_tangled_sheet_becomes_squares():
    mesh = rectangle(6.0, 6.0, size=1.0)
    x = mesh.nodes[:, :2].copy()
    free = np.ones(mesh.n_node, np.bool_)
    free[mesh.boundary_nodes()] = False
    x[free] = np.random.default_rng(0).uniform((1.0, -2.0), (5.0, 2.0), (free.sum(), 2))
    size, weight = np.ones(mesh.n_quad), np.ones((mesh.n_quad, 4))
    assert corner_determinants(x, mesh.quads, size).min() < -0.5
    y = Smoother(x, mesh.quads, size, free, [], weight).run()
    np.testing.assert_array_equal(y[~free], x[~free])
    # the minimum is the regular sheet; the last minimisation ends at a fall of 3e-3
    np.testing.assert_allclose(y, mesh.nodes[:, :2], atol=0.02)


def test_sliders_stay_on_their_curve():
    mesh = rectangle(6.0, 4.0, size=0.5)
    x = mesh.nodes[:, :2].copy()
    row = mesh.nodes_where(lambda x, y, z: abs(y) < 1e-9)
    curve = PathCurve.of_function(lambda t: (t, 0.3 * np.sin(t)), 0.0, 6.0)
    free = np.ones(mesh.n_node, np.bool_)
    free[mesh.boundary_nodes()] = False
    free[row] = False
    u = curve.nearest(x[row])
    sliders = [Sliders(row[1:-1], curve, u[1:-1])]
    size, weight = np.full(mesh.n_quad, 0.5), np.ones((mesh.n_quad, 4))
    y = Smoother(x, mesh.quads, size, free, sliders, weight).run()
    off = np.linalg.norm(curve.point(curve.nearest(y[row[1:-1]])) - y[row[1:-1]], axis=1)
    assert off.max() < 1e-12
    assert corner_determinants(y, mesh.quads, size).min() > 0.7
    # exactly the same again
    z = Smoother(x, mesh.quads, size, free, sliders, weight).run()
    np.testing.assert_array_equal(y, z)


def test_without_unknowns_nothing_happens():
    mesh = rectangle(2.0, 2.0, size=1.0)
    x = mesh.nodes[:, :2]
    none = np.zeros(mesh.n_node, np.bool_)
    y = Smoother(x, mesh.quads, np.ones(4), none, [], np.ones((4, 4))).run()
    np.testing.assert_array_equal(x, y)
