"""The stretch of the film since the last look at all quads, and the look that it brings forward."""

import numpy as np
import pytest

import shellcut as sc
from naive import cases
from shellcut.mesh.structured import rectangle
from shellcut.mitc4.stretch_since import StretchSince


@pytest.mark.parametrize("name", cases.ALL)
def test_it_is_the_largest_stretch_of_a_centre(name):
    mesh = cases.ALL[name]()
    _, state = cases.set_up(mesh)
    rng = np.random.default_rng(3)
    squared = rng.uniform(1.0, 2.0, mesh.n_quad)
    since = StretchSince(1.5)
    assert since.growth(state) == 1.0  # nothing has been taken yet
    since.take(state, squared)
    assert since.growth(state) == pytest.approx(1.0, abs=1e-12)
    before = state.node.x[state.quads]
    cases.deform(state, stretch=0.05, tilt=0.0)
    now = state.node.x[state.quads]
    stretches = []
    for old, new in zip(before, now, strict=True):
        F = []
        for corners in (old, new):
            p, q = (np.array(signs) @ corners for signs in ((-1, 1, 1, -1), (-1, -1, 1, 1)))
            F.append(np.linalg.qr(np.column_stack([p, q]))[1])
        stretches.append(np.linalg.svd(F[1] @ np.linalg.inv(F[0]), compute_uv=False)[0])
    grown = squared * (1.0 + 3.0 * np.maximum(np.array(stretches) - 1.0, 0.0))
    assert since.growth(state) == pytest.approx(grown.max() / squared.max(), rel=1e-12)
    # A split changes masses, not what has been stretched since.
    since.follow(state, 2.0 * squared)
    assert since.growth(state) == pytest.approx(grown.max() / squared.max(), rel=1e-12)
    again = StretchSince(1.5)
    again.restore(since.saved())
    assert again.growth(state) == since.growth(state)


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
