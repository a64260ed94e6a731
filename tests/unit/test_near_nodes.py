"""What is near the tool is complete as long as it lasts, whatever moves and however large."""

import numpy as np
import pytest

from blunt_tools import ball, needle
from film_and_bar import round_bar
from shellcut import Contact, Mesh, ShellMaterial, Simulation, StraightMotion, TableMotion
from shellcut.contact.near_nodes import NearNodes
from shellcut.mesh.structured import rectangle
from shellcut.mitc4.initial_state import initial_state
from shellcut.recording.unfelt_penetration import UnfeltPenetration
from shellcut.tool.motion import ScrewMotion

LOW = np.array([[0.0, 0.0, -1.0], [3.0, 1.0, -0.5]])
HIGH = np.array([[1.0, 2.0, 1.0], [4.0, 2.0, 0.5]])
MARGIN = 0.4
MOTION = ScrewMotion(20.0, pitch=2.0, axis=(0, 0, 1), axis_point=(1.0, 0.5, 0.0))


def sheet():
    mesh = rectangle(8.0, 4.0, n_x=40, n_y=20)
    state = initial_state(mesh)
    state.node.x[mesh.n_node :] = np.nan
    return mesh, state


def inside(x, pose, margin):
    """By NumPy: nodes within a margin of any box."""
    body = ((x - pose[1]) @ pose[0])[:, None]
    found = ((body > LOW - margin) & (body < HIGH + margin)).all(axis=2)
    return np.flatnonzero(found.any(axis=1))


def test_the_list_holds_every_node_within_half_the_margin_while_it_lasts():
    mesh, state = sheet()
    near = NearNodes(LOW, HIGH, MARGIN)
    rng = np.random.default_rng(4)
    state.dt = 1e-4
    renewals = 0
    for step in range(200):
        state.step, state.time = step, step * state.dt
        v = 40.0 * rng.uniform(-1, 1, (mesh.n_node, 3)) + [0, 0, 20.0]
        state.node.velocity_half[: mesh.n_node] = v
        state.node.x[: mesh.n_node] += state.dt * v
        pose = MOTION.pose(state.time)
        renewals += near.renew(state, pose)
        x = state.node.x[: mesh.n_node]
        # Between two looks tool and nodes have gone a little further.
        assert np.isin(inside(x, pose, 0.5 * MARGIN - 10 * 0.02), near.ids).all()
    assert 3 < renewals < 50


def test_a_split_and_another_state_are_searched_at_once():
    _, state = sheet()
    near = NearNodes(LOW, HIGH, MARGIN)
    pose = MOTION.pose(0.0)
    assert near.renew(state, pose)
    state.step = 1
    assert not near.renew(state, pose)
    new = state.node.append_copy(int(near.ids[0]))
    state.revision += 1
    assert near.renew(state, pose)
    assert new in near.ids
    _, other = sheet()
    other.revision = state.revision
    other.step = 1
    assert near.renew(other, pose)
    assert new not in near.ids


def grid(x, y):
    """A flat film of quads between some coordinates."""
    nodes = [(a, b, 0.0) for a in x for b in y]
    n = len(y)
    first = [n * i + j for i in range(len(x) - 1) for j in range(n - 1)]
    return Mesh.from_arrays(nodes, [(k, k + n, k + n + 1, k + 1) for k in first])


def first_touch(mesh, tool, toward, gap, film_moves=True, past=1.0, **settings):
    """Return how far the film, or else the tool, has come when they first press, and the run.

    toward : the direction in which the film comes to the tool, which touches it as it is given.
    past : up to there beyond the gap.
    """
    toward, moving = np.array(toward, float), {}
    motion = StraightMotion(tuple(-toward), speed=SPEED)
    if film_moves:
        moving["velocity"] = np.tile(SPEED * toward, (mesh.n_node, 1))
        motion = TableMotion([0.0, 1.0], np.zeros((2, 3)))  # at rest
    sim = Simulation(
        mesh,
        ShellMaterial.homogeneous(),
        tool=tool.translated(gap * toward),
        motion=motion,
        contact=Contact(**settings),
        **moving,
    )
    while not sim.terms.wrench[:, :3].any() and SPEED * sim.state.time < gap + past:
        sim.step()
    return SPEED * sim.state.time, sim


SPEED, LATE = 2e4, 0.02
"""Of film and tool [mm/s], and distance within which a touch is felt [mm]."""
UP, LEFT = (0.0, 0.0, 1.0), (-1.0, 0.0, 0.0)
SQUARES = grid(np.arange(5.0), np.arange(5.0))
TOUCHING = {
    "nodes": (ball(1.0, 2).translated((2.0, 2.0, 1.0)), UP, {}),
    "points": (needle().translated((2.37, 1.21, 0.0)), UP, {}),
    "border": (round_bar().translated((0.0, 1.5, 0.0)), LEFT, {"film_edges": True}),
}


@pytest.mark.parametrize("gap", [0.2, 2.4, 4.1])
@pytest.mark.parametrize("by", TOUCHING)
def test_film_that_comes_to_a_tool_at_rest_is_felt_at_first_touch(by, gap):
    tool, toward, settings = TOUCHING[by]
    came, sim = first_touch(SQUARES, tool, toward, gap, **settings)
    assert came == pytest.approx(gap, abs=LATE)
    assert next(t for t in sim.terms if t.name == TERMS[by]).forces.n_touching > 0


TERMS = {"nodes": "contact", "points": "points", "border": "edges"}


@pytest.mark.parametrize("gap", [0.3, 2.7])
def test_film_that_comes_while_other_film_rests_at_the_tool_is_felt(gap):
    # The tool rests below the first sheet, and the second comes from below.
    tool = ball(1.0, 2).translated((2.0, 2.0, 1.0))
    above = SQUARES.nodes + np.array([0.0, 0.0, 2.0 + gap + 0.1])
    nodes = np.concatenate([SQUARES.nodes, above])
    mesh = Mesh.from_arrays(nodes, np.concatenate([SQUARES.quads, SQUARES.quads + len(above)]))
    velocity = np.repeat([[0.0, 0.0, SPEED], [0.0, 0.0, 0.0]], len(above), axis=0)
    sim = Simulation(
        mesh,
        ShellMaterial.homogeneous(),
        tool=tool.translated((0.0, 0.0, gap)),
        motion=TableMotion([0.0, 1.0], np.zeros((2, 3))),
        velocity=velocity,
    )
    while not sim.contact.forces.n_touching and SPEED * sim.state.time < gap + 1.0:
        sim.step()
    assert SPEED * sim.state.time == pytest.approx(gap, abs=LATE)
    assert (sim.contact.near.ids >= len(above)).any()


@pytest.mark.parametrize("film_moves", [False, True])
@pytest.mark.parametrize("ratio", [1.0, 5.0, 12.0])
@pytest.mark.parametrize("by", ["points", "border"])
def test_a_quad_much_larger_than_the_median_is_felt_between_its_nodes(by, ratio, film_moves):
    fine = np.arange(0.0, 2.1, 0.25)
    mesh = grid(fine, np.append(fine, 2.0 + 0.25 * ratio * np.arange(1, 3)))
    if by == "points":
        mesh = grid(*[np.append(fine, 2.0 + 0.25 * ratio * np.arange(1, 3))] * 2)
    middle = 2.0 + 0.25 * ratio * 0.46
    tool, toward, settings = {
        "points": (needle().translated((middle, middle, 0.0)), UP, {}),
        "border": (round_bar(0.1).translated((0.0, middle, 0.0)), LEFT, {"film_edges": True}),
    }[by]
    came, sim = first_touch(mesh, tool, toward, 0.1, film_moves, **settings)
    assert came == pytest.approx(0.1, abs=LATE)
    assert next(t for t in sim.terms if t.name == TERMS[by]).forces.n_touching > 0


@pytest.mark.parametrize("ratio", [1.0, 5.0, 12.0])
def test_depth_that_is_not_felt_is_measured_in_quads_of_all_sizes(ratio):
    fine = np.arange(0.0, 2.1, 0.25)
    x = np.append(fine, 2.0 + 0.25 * ratio * np.arange(1, 3))
    middle = 2.0 + 0.25 * ratio * 0.46
    needle_there = needle().translated((middle, middle, 0.0))
    _, sim = first_touch(grid(x, x), needle_there, UP, 0.1, past=0.1, tool_points=False)
    assert UnfeltPenetration(sim).now().quads == pytest.approx(0.1, abs=LATE)
    bar = round_bar(0.075 * ratio).translated((0.0, middle, 0.0))
    _, sim = first_touch(grid(fine, x), bar, LEFT, 0.1, past=0.05, tool_points=False)
    assert UnfeltPenetration(sim).now().film_edges == pytest.approx(0.05, abs=LATE)
