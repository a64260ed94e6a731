"""Symmetry planes and leaning directors: half is whole, and statics and the driver hold alike."""

import numpy as np
import pytest

from courses import UNDAMPED
from shellcut import Gravity, Mesh, Pressure, ShellMaterial, Simulation, Statics, Support
from shellcut.loads.symmetry_plane import put_directors_into_planes
from shellcut.mesh.structured import rectangle

FILM = ShellMaterial.homogeneous(young=100.0, thickness=0.3)
N = 4


def patch(x, y):
    """A dome, symmetric in x = 0 and y = 0, directors left to the mesh, sides as node sets."""
    x, y = np.meshgrid(x, y, indexing="ij")
    nodes = np.stack([x, y, 8.0 - 0.06 * x**2 - 0.04 * y**2 - 0.002 * (x * y) ** 2], axis=-1)
    ids = np.arange(x.size).reshape(x.shape)
    quads = np.stack([ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]], axis=-1)
    sides = {"x0": ids[0], "x1": ids[-1], "y0": ids[:, 0], "y1": ids[:, -1]}
    return Mesh.from_arrays(nodes.reshape(-1, 3), quads.reshape(-1, 4), node_sets=sides)


def graded(n):
    """Steps that grow from 0 to 6: nothing is even."""
    return 6.0 * np.linspace(0.0, 1.0, n + 1) ** 1.3


def mirrored(steps):
    return np.concatenate([-steps[:0:-1], steps])


QUARTER = patch(graded(N), graded(N + 1))
WHOLE = patch(mirrored(graded(N)), mirrored(graded(N + 1)))
IN_QUARTER = WHOLE.nodes_where(lambda x, y, _: (x >= 0.0) & (y >= 0.0))
PLANES = [Support.symmetry("x0", "x"), Support.symmetry("y0", "y")]
LOADS = [Gravity((0.0, 0.0, -2e8)), Pressure(-0.1)]


def test_a_quarter_is_the_whole_to_round_off():
    rim = [Support.clamped("x1"), Support.clamped("y1")]
    around = [Support.clamped(side) for side in ("x0", "x1", "y0", "y1")]
    quarter = Statics(QUARTER, FILM, supports=PLANES + rim, loads=LOADS)
    whole = Statics(WHOLE, FILM, supports=around, loads=LOADS)
    assert (quarter.mesh.nodes == whole.mesh.nodes[IN_QUARTER]).all()
    # As the means of the quads' normals on both sides, without their mirror images.
    rim = (QUARTER.nodes[:, :2] == 6.0).any(axis=1)
    np.testing.assert_allclose(
        quarter.mesh.directors[~rim], whole.mesh.directors[IN_QUARTER][~rim], atol=1e-15
    )
    part, all_ = quarter.linear()[0], whole.linear()[0][IN_QUARTER]
    # Round-off over the film's condition, some 1e5.
    np.testing.assert_allclose(part, all_, atol=1e-10 * abs(all_).max())
    (part,), (all_,) = quarter.load_steps([1.0]), whole.load_steps([1.0])
    far = all_.displacement[IN_QUARTER]
    assert abs(far).max() > FILM.thickness  # not linear
    # Both are at equilibrium to 1e-8 of the largest force.
    np.testing.assert_allclose(part.displacement, far, atol=1e-6 * abs(far).max())


# --- which directors are put into a plane --------------------------------------------------------


def moved(mesh, *supports):
    """Nodes whose directors are put elsewhere."""
    other = put_directors_into_planes(mesh, supports)
    return set(np.flatnonzero((other.directors != mesh.directors).any(axis=1)).tolist())


def test_directors_of_a_symmetry_plane_lie_in_it():
    side = QUARTER.node_set("x0")
    there = put_directors_into_planes(QUARTER, PLANES)
    assert (there.directors[side, 0] == 0.0).all()
    corner = QUARTER.node_set("x0")[0]
    np.testing.assert_array_equal(there.directors[corner], [0.0, 0.0, 1.0])  # on both planes
    np.testing.assert_allclose(np.linalg.norm(there.directors, axis=1), 1.0, atol=1e-15)
    # Written out, the support is the same; a velocity, or anything held besides, makes it another.
    assert moved(QUARTER, Support("x0", "x", "yz")) == set(side.tolist())
    assert not moved(QUARTER, Support("x0", "x", "yz", velocity={"x": np.cos}))
    for other in (Support.clamped("x0"), Support.pinned("x0"), Support("x0", "xyz", "yz")):
        assert not moved(QUARTER, other)
    # Directors that lie in it are left alone, to the last bit, and so is the mesh.
    assert put_directors_into_planes(there, PLANES) is there


def test_only_where_the_film_ends_at_the_plane():
    inside = WHOLE.nodes_where(lambda x, y, _: (x == 0.0) & (abs(y) < 6.0))
    assert not moved(WHOLE, Support.symmetry(inside, "x"))
    # At the far side the film is too steep to be one.
    everywhere, side = np.arange(QUARTER.n_node), set(QUARTER.node_set("x0").tolist())
    assert moved(QUARTER, Support.symmetry(everywhere, "x")) == side


def test_not_where_the_whole_would_have_a_fold():
    # A gable: mirrored at its ridge it has a fold, of 50° it passes as a curved film, of 70° not.
    for half_fold, put in ((25.0, True), (35.0, False)):
        flat = rectangle(2.0, 1.0, n_x=2, n_y=1)
        turn = np.radians(half_fold)
        nodes = flat.nodes @ np.array(
            [[np.cos(turn), 0, -np.sin(turn)], [0, 1, 0], [np.sin(turn), 0, np.cos(turn)]]
        )
        gable = Mesh.from_arrays(nodes, flat.quads, node_sets=dict(flat.node_sets))
        assert bool(moved(gable, Support.symmetry("left", "x"))) == put


# --- equilibrium in one is equilibrium in the other ----------------------------------------------

LEANING = patch(graded(N) + 0.5, graded(N) + 1.0)


@pytest.mark.parametrize(
    "supports",
    [
        [Support.symmetry("x0", "x"), Support.clamped("x1")],
        [Support("x0", "xz", "yz"), Support.clamped("y1")],
        [Support("x0", "xyz", "yz"), Support("x1", "z", "xz"), Support("y0", "yz", "xz")],
        [Support("x0", "xz", "y"), Support("x1", "xz", "y"), Support("y0", "y", "x")],
        [Support("x0", "x", ""), Support("x0", "yz", "y"), Support("x1", "z", "y")],
    ],
    ids=["plane", "guide", "hinges", "diaphragms", "one"],
)
def test_equilibrium_of_statics_is_rest_in_the_explicit_driver(supports):
    # Every director at the held sides leans out of the axes, by 2 to 30°.
    loads = [Pressure(-2e-3)]
    still = Statics(LEANING, FILM, supports=supports, loads=loads)
    (rest,) = still.load_steps([1.0])
    assert abs(rest.displacement).max() > 0.01
    sim = Simulation(LEANING, FILM, supports=supports, loads=loads, damping_alpha=0.0)
    n, node = LEANING.n_node, sim.state.node
    node.x[:n], node.t[:n] = still.state.node.x[:n], still.state.node.t[:n]
    assert sim.relax(tolerance=1e-6) == 0  # statics leaves 1e-8 of the largest force
    for _ in range(1000):
        sim.step()
    np.testing.assert_allclose(node.x[:n] - node.X[:n], rest.displacement, atol=1e-6)
    np.testing.assert_allclose(node.t[:n], rest.director, atol=1e-6)
    assert sim.ledger.kinetic < 1e-10 * sim.ledger.strain


def test_a_leaning_director_swings_on_its_cone_for_long():
    # Free swings of large amplitude: directors stay of unit length and where their support lets
    # them, and the support does no work.
    supports = [Support("x0", "xyz", "yz"), Support("x1", "xyz", "y")]
    velocity = np.zeros((LEANING.n_node, 3))
    inner = LEANING.nodes_where(lambda x, _y, _z: (x > 0.5) & (x < 6.5))
    velocity[inner, 2] = 1e4
    sim = Simulation(LEANING, FILM, supports=supports, velocity=velocity, **UNDAMPED)
    t, T = sim.state.node.t, sim.mesh.directors
    on_cone, in_plane = (sim.mesh.node_set(side) for side in ("x0", "x1"))
    first, largest = sim.ledger.initial, 0.0
    for _ in range(2500):
        sim.step()
        largest = max(largest, abs(t[on_cone] - T[on_cone]).max())
    assert largest > 0.1
    np.testing.assert_allclose(np.linalg.norm(t[: LEANING.n_node], axis=1), 1.0, atol=1e-11)
    np.testing.assert_allclose(t[on_cone, 0], T[on_cone, 0], atol=1e-11)
    plane = np.cross([0.0, 1.0, 0.0], T[in_plane])
    # In the plane of y and T: no part along y x T.
    np.testing.assert_allclose(np.einsum("ni,ni->n", plane, t[in_plane]), 0.0, atol=1e-11)
    assert abs(sim.ledger.support_work) < 1e-10 * first
    # Discretisation in time of a violent swing: as much as with clamped sides.
    assert abs(sim.ledger.imbalance) < 2e-2 * first
