"""What cracks through quads know of a film that is curved, and of slivers beside a blade."""

import numpy as np
import pytest

import shellcut as sc
from curved_films import Roll, moved
from films import free_film
from free_strip import path_in
from naive.crack_path import place_of
from shellcut.fracture.free_direction import FreeDirection
from shellcut.fracture.quad_polygon import WHOLE, divide, film_beside
from shellcut.fracture.tip import Tip
from shellcut.mesh.structured import rectangle

SIZE = 0.5


def film_and_path(mesh):
    """Return a simulation without tool, and what finds the paths of its cracks."""
    sim = free_film(mesh)
    return sim, path_in(sim)


def rolled(angle, radius):
    """Return the same for a strip of 6 by 4 mm on a cylinder, with the cylinder and the strip."""
    strip = moved(rectangle(6.0, 4.0, size=SIZE), "random", 0.2, SIZE)
    roll = Roll(angle, radius)
    return *film_and_path(roll.mesh(strip)), roll, strip


def inner_tips(sim, roll):
    """Return tips at inner nodes that came along the strip, where they lie and their headings."""
    X = sim.mesh.nodes
    inside = np.setdiff1d(np.arange(sim.mesh.n_node), sim.mesh.boundary_nodes())
    found = []
    for node in inside[:: max(1, len(inside) // 12)].tolist():
        u, v = roll.unrolled(X[node][None])
        (before, here), _ = roll.onto(np.array([u[0] - 0.4, u[0]]), v)
        way = (here - before) / np.linalg.norm(here - before)
        found.append(Tip((node, node), 0.0, -1, way))
    return found


@pytest.mark.parametrize("radius", [1e9, 4.0])
def test_a_heading_goes_on_into_the_next_quad_and_turns_with_the_film(radius):
    sim, path, roll, _ = rolled(30.0, radius)
    turn = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    for tip in inner_tips(sim, roll):
        at, heading = place_of(path, sim.state, tip)
        # In the tangent plane ahead it is the heading but for its part across that plane, which is
        # no more than the angle that two quads make.
        assert np.linalg.norm(heading - tip.heading) < 0.5 * SIZE / radius + 1e-7
        x = sim.state.node.x.copy()
        sim.state.node.x[:] = x @ turn.T
        turned, turned_heading = place_of(path, sim.state, tip)
        sim.state.node.x[:] = x
        np.testing.assert_allclose(turned_heading, turn @ heading, atol=1e-12)
        np.testing.assert_array_equal(turned.T, at.T)


@pytest.mark.parametrize(("fold_deg", "aside"), [(60.0, 0.05), (120.0, 0.0), (170.0, -0.05)])
def test_on_film_folded_at_a_tip_the_way_ahead_is_that_of_the_film_ahead(fold_deg, aside):
    mesh = rectangle(6.0, 4.0, size=SIZE)
    sim, path = film_and_path(mesh)
    (node,) = mesh.nodes_where(lambda x, y, z: np.hypot(x - 2.5, y) < 1e-9)
    heading = np.array([1.0, aside, 0.0]) / np.hypot(1.0, aside)
    tip = Tip((int(node), int(node)), 0.0, -1, heading)
    c, s = np.cos(np.radians(fold_deg)), np.sin(np.radians(fold_deg))
    fold = np.array([[c, 0.0, -s], [0.0, 1.0, 0.0], [s, 0.0, c]])
    ahead = mesh.nodes[:, 0] > 2.5
    x = sim.state.node.x
    x[: mesh.n_node][ahead] = mesh.nodes[node] + (mesh.nodes[ahead] - mesh.nodes[node]) @ fold.T
    _, forward = place_of(path, sim.state, tip)
    np.testing.assert_allclose(forward, fold @ heading, atol=1e-12)
    # A way along the film ahead is found in a row ahead.
    segment = path.segment_from(sim.state, tip, forward)
    assert mesh.nodes[mesh.quads[segment.row], 0].mean() > 2.5


@pytest.mark.parametrize("angle", [0.0, 30.0])
def test_directions_do_not_know_that_the_sheet_is_rolled(angle):
    # A strain that is uniform in the sheet, its principal axes at 45 degrees to the cylinder's: the
    # mean of stresses in planes that lean against each other would turn the direction by degrees.
    sim, path, roll, strip = rolled(angle, 2.5)
    stretch = np.array([[1.010, 0.004], [0.004, 1.008]])
    u, v = (strip.nodes[:, :2] @ stretch).T
    x, t = roll.onto(u, v)
    node = sim.state.node
    node.x[: len(x)], node.t[: len(t)] = x, t
    _, vectors = np.linalg.eigh(stretch)
    across = vectors[:, 0] * np.sign(vectors[0, 0])
    # Above the strength the stress decides alone.
    free = FreeDirection(sim.shell, path.film, sc.CohesiveLaw(strength=12.0))
    for tip in inner_tips(sim, roll):
        at, _ = place_of(path, sim.state, tip)
        way = next(free.directions(sim.state, tip))
        a, b = (np.array(roll.unrolled((at.x + d * way)[None]))[:, 0] for d in (-0.05, 0.05))
        found = (b - a) / np.linalg.norm(b - a)
        # Discretisation: two degrees.
        assert abs(found @ across) > np.cos(np.radians(2.0))


def test_the_film_of_a_sliver_shows_clear_of_its_flank():
    right, left = divide(WHOLE, (-1.0, 0.9), (0.8, 1.0))
    for part in (right, left):
        xi, eta = film_beside(part)
        off = (1.8 * (eta - 0.9) - 0.1 * (xi + 1.0)) / np.hypot(1.8, 0.1)
        assert abs(off) > 0.499
        assert (off > 0.0) == (part is left)
    assert film_beside(WHOLE) == (0.0, 0.0)
