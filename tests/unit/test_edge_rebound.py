"""The contact of an edge of the film returns no more energy than it has got."""

import numpy as np
import pytest

from film_and_bar import bar, flat_bar
from naive.edge_rebound import Rebound, pressing
from shellcut.contact.settings import node_stiffness
from shellcut.tool.pose import Pose
from test_edge_contact import evaluated, one_quad, quad_with, term

FAR = np.array([50.0, 0.0, 0.0])


class Strip:
    """A quad whose edge a-b, 1 mm long, lies across the end of a bar with both ends outside."""

    def __init__(self, tool, gap=0.005, aside=0.02):
        a, b = np.array([gap, aside - 0.5, 0.1]), np.array([gap, aside + 0.5, -0.1])
        self.tool, self.sim = tool, one_quad(quad_with(a, b), tool)
        state = self.sim.state
        self.ends, self.node = self.sim.corners[:2], state.node
        evaluated(self.sim)  # lists what is near, and touches nothing yet
        self.memory.depth[:] = 0.0
        self.law = self.sim.contact.law
        self.k = 0.25 * node_stiffness(self.node.contact_area[0], self.law)
        self.mass = self.node.contact_mass[self.ends[0]]
        self.pose = Pose(np.eye(3), -FAR)

    @property
    def memory(self):
        return term(self.sim).tables.memory

    def move(self, x, known, dt, pose=None):
        """Move the edge's ends to x in a step under known forces; return what its contact adds."""
        state, opposite = self.sim.state, self.sim.corners[[3, 2]]
        velocity = (x - self.node.x[self.ends]) / dt
        state.dt, state.step = dt, state.step + 1
        for nodes in (self.ends, opposite):
            self.node.velocity_half[nodes] = velocity
            self.node.x[nodes] += dt * velocity
        self.node.force[:] = 0.0
        self.node.force[self.ends] = known
        self.pose = pose or self.pose
        self.sim.contact.add_forces(state, self.pose)
        assert not (self.node.force[self.ends] - known).any()  # both ends are outside
        term(self.sim).add_forces(state, self.pose)
        return self.node.force[self.ends] - known


def pressed_and_pulled(strip, step, limited, push=2.0, n=4000):
    """Press an edge on the bar by its ends and pull it off again; works of its contact [N·mm].

    step : over that at which one edge of the tool has k dt² / m = 1.  Returns the work on the film
    after each step of the ends, which turn a little when they come.
    """
    dt, velocity, f = step * np.sqrt(strip.mass / strip.k), np.zeros((2, 3)), np.zeros((2, 3))
    velocity[:, 0] = 1e3, -1e3
    work, works = 0.0, []
    for i in range(n):
        known = np.zeros((2, 3))
        known[:, 0] = -push if i < n // 2 else push
        velocity[:, 0] += dt * (f + known)[:, 0] / strip.mass
        if not limited:
            strip.memory.put_in[:] = 1e9
        before = f
        f = strip.move(strip.node.x[strip.ends] + dt * velocity, known, dt)
        work += 0.5 * dt * ((before + f) * velocity).sum()
        works.append(work)
    assert not f.any()
    return np.array(works)


@pytest.mark.parametrize("step", [0.55, 0.8, 1.0])
def test_an_edge_that_swings_on_a_flat_end_gains_nothing(step):
    """Its end is a face between two edges of the tool, at which the edge presses by turns."""
    strip, push = Strip(flat_bar()), 2.0
    works = pressed_and_pulled(strip, step, limited=True, push=push)
    held = (2.0 * push) ** 2 / (2.0 * strip.k)
    # What swings is taken, measured 1.1 to 1.5 times the energy of the edge pressed at rest.
    assert -3.0 * held < works[-1] < 0.0
    # Within the steps in which it swings. Measured 0 to 0.034.
    assert works.max() < 0.05 * held
    if step == 1.0:
        # Without the limit, measured 12.5 times that.
        assert pressed_and_pulled(Strip(flat_bar()), step, limited=False)[-1] > 5.0 * held


def test_an_edge_at_rest_is_held_and_not_pushed():
    """Nothing has been put in: what presses on it is stopped, whatever the potential says."""
    strip = Strip(bar())
    x = strip.node.x[strip.ends].copy()
    dt, whole = 0.1 * np.sqrt(strip.mass / strip.k), np.zeros((2, 3))
    for depth in np.linspace(-0.005, 0.03, 40):
        whole = strip.move(np.column_stack([[-depth] * 2, x[:, 1:]]), np.zeros((2, 3)), dt)
    assert whole[:, 0].sum() > 1.0
    there = strip.node.x[strip.ends].copy()
    for pressed in (1.0, 0.5, 0.0, -0.5):
        strip.move(there, -whole, dt)
        strip.memory.put_in[:] = 0.0
        strip.memory.force[:] = 0.0
        f = strip.move(there, -pressed * whole, dt)
        np.testing.assert_allclose(f, max(pressed, 0.0) * whole, rtol=1e-12, atol=1e-12)


def test_forces_and_work_are_those_of_a_plain_twin():
    """An edge that is thrown about on the edge of a bar that moves and turns, now and then held."""
    rng, strip, twin = np.random.default_rng(3), Strip(bar()), Rebound()
    x, limited, held = strip.node.x[strip.ends].copy(), 0, 0
    radius, g_m = strip.law.rounding, strip.law.smoothing_depth
    dt = 0.9 * np.sqrt(strip.mass / strip.k)
    for i in range(200):
        before, was = strip.pose, strip.node.x[strip.ends].copy()
        c, d = rng.normal(size=2) * 1e-3
        turn = np.linalg.qr([[1.0, -c, d], [c, 1.0, 0.0], [-d, 0.0, 1.0]])[0]
        turn = turn * np.sign(np.diag(turn))
        pose = Pose.of(turn, rng.normal(size=3) * 3e-4 - turn @ FAR)
        moved = x + rng.uniform(-1.0, 1.0, (2, 3)) * 1e-3
        moved[:, 0] -= 0.028 + 0.012 * np.sin(0.3 * i)
        known = rng.normal(size=(2, 3))
        strip.node.supported[strip.ends] = rng.random(2) < 0.2
        if strip.memory.stored[0] > 0.0:
            twin.got = rng.uniform(-0.2, 0.5) * strip.memory.stored[0]  # of whatever came before
            strip.memory.put_in[0] = twin.got
        if i % 20 == 10:
            strip.sim.contact.near._known.revision = -1  # what is near is listed anew
        found = strip.move(moved, known, dt, pose)
        in_tool = pose.to_body(moved) - FAR
        whole = pressing(in_tool, strip.tool, radius, strip.k, g_m) @ turn.T
        way = (pose.to_body(moved) - before.to_body(was)) @ turn.T
        mass = np.where(strip.node.supported[strip.ends], np.inf, strip.mass)
        wanted = twin.step(whole, way, known, mass, dt)
        # The search for the place ends at 1e-6 of the edge.
        np.testing.assert_allclose(found, wanted, atol=1e-4)
        got = strip.memory.put_in.sum()
        np.testing.assert_allclose(got, twin.got, atol=1e-6)
        # With both ends outside friction takes mu times all that presses.
        pressure = term(strip.sim).carriers.pressure.sum()
        np.testing.assert_allclose(pressure, np.linalg.norm(wanted.sum(axis=0)), atol=1e-4)
        limited += 0.0 < twin.part < 1.0
        held += twin.part == 1.0 and whole.any()
    assert limited > 20
    assert held > 20
