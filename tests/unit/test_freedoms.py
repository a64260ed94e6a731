"""Freedoms: what supports leave, the assembled stiffness, finite moves."""

import numpy as np
import pytest

from shellcut import Mesh, ShellMaterial, Support
from shellcut.loads.supports import SupportSet
from shellcut.mesh.structured import cylinder, rectangle
from shellcut.mitc4.initial_state import initial_state
from shellcut.mitc4.shell import MITC4Shell
from shellcut.statics.freedoms import Freedoms

EPS = np.finfo(float).eps


def freedoms_of(mesh, *supports):
    state = initial_state(mesh)
    SupportSet(mesh, supports).initialise(state)
    return state, Freedoms(state)


def tilted(direction):
    """One quad with normal ``direction``, a unit vector."""
    t = np.asarray(direction, float)
    b = np.linalg.svd(t[None])[2][1:]
    b[1] *= np.sign(np.cross(b[0], b[1]) @ t)
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1.0]]) @ b
    return Mesh.from_arrays(corners, [[0, 1, 2, 3]], directors=np.tile(t, (4, 1)))


def spins_left(mesh, rotation):
    """Spin vectors that a support of all nodes leaves to node 0."""
    _, freedoms = freedoms_of(mesh, Support(np.arange(4), translation="", rotation=rotation))
    left = [k for k, freedom in enumerate(freedoms.free) if freedom in (3, 4)]
    unit = np.eye(freedoms.free.size)
    return [freedoms.split(freedoms.fill(unit[k]))[1][0] for k in left]


@pytest.mark.parametrize("shape", [(1, 1), (1, 12), (9, 1), (30, 2)])
def test_unsupported_nodes_have_five_freedoms_each(shape):
    mesh = rectangle(2.0, 1.0, n_x=shape[0], n_y=shape[1])
    _, freedoms = freedoms_of(mesh)
    assert sorted(freedoms.free) == list(range(5 * mesh.n_node))
    _, freedoms = freedoms_of(mesh, Support.clamped("left"), Support([1], "xz", ""))
    held = [5 * node + k for node in mesh.node_set("left") for k in range(5)]
    assert set(range(5 * mesh.n_node)) - set(freedoms.free) == {*held, 5, 7}


SLANTED = np.array([2.0, -1.0, 2.0]) / 3.0
# A symmetry plane, out of which directors may lean a little, holds no second turn. Within 30° a
# turn about the one axis that is left would hardly move the director: a film in its own plane of
# symmetry. Along the director itself there is nothing to hold.
LEANING = [
    *(("y", 1, (0.0, 17.0, 69.0, 90.0, 143.0)), ("xz", 1, (0.0, 17.0, 69.0, 90.0, 143.0))),
    *(("yz", 1, (1e-10, 1e-4, 6.0, 27.0)), ("xy", 0, (0.0, 25.0)), ("xy", 1, (35.0,))),
    *(("z", 2, (0.0, 25.0)), ("z", 1, (35.0,))),
]
"""Axes about which spins are held, how many are left, and angles of directors from z to x [°]."""
HELD_SPINS = [
    *(
        (np.array([np.sin(angle), 0.0, np.cos(angle)]), held, n_left)
        for held, n_left, angles in LEANING
        for angle in np.radians(angles)
    ),
    *((SLANTED, held, n_left) for held, n_left in (("x", 1), ("xy", 1), ("xyz", 0))),
    (np.array([0.0, 1.0, 0.0]), "y", 2),
]


@pytest.mark.parametrize(("t", "held", "n_left"), HELD_SPINS, ids=str)
def test_held_spins_leave_the_turn_that_has_none(t, held, n_left):
    spins = spins_left(tilted(t), held)
    assert len(spins) == n_left
    if n_left != 1:
        return
    axes = dict(zip("xyz", np.eye(3), strict=True))
    if len(held) == 1:  # normal to the director and to the axis
        way = np.cross(t, axes[held])
    else:  # about the axis that is left, by as much as the director is not along it
        (free,) = (axis for name, axis in axes.items() if name not in held)
        way = free - (free @ t) * t
    np.testing.assert_allclose(abs(spins[0]), abs(way) / np.linalg.norm(way), atol=4 * EPS)


def test_a_director_with_one_axis_left_turns_about_it_on_a_cone():
    t = SLANTED
    state, freedoms = freedoms_of(tilted(t), Support(np.arange(4), rotation="xy"))
    assert sorted(freedoms.free) == [3, 8, 13, 18]
    freedoms.move(freedoms.fill(np.full(4, 0.9)))
    turned = state.node.t[:4]
    np.testing.assert_allclose(turned[:, 2], t[2], atol=4 * EPS)
    assert (turned[:, :2] @ t[:2] < 0.5 * (t[:2] @ t[:2])).all()


def deformed_roof():
    mesh = cylinder(3.0, 4.0, n_around=5, n_along=3, arc_deg=100.0)
    # Left directors turn about y, to which they are normal; those on the right about x, on cones.
    state, freedoms = freedoms_of(
        mesh, Support("left", "xyz", "xz"), Support("top", "y", "xz"), Support("right", "z", "yz")
    )
    material = ShellMaterial.homogeneous(young=100.0, thickness=0.2)
    shell = MITC4Shell(mesh, material, damping_beta=0.0)
    shell.initialise(state)
    rng = np.random.default_rng(2)
    u = freedoms.fill(rng.uniform(-0.1, 0.1, freedoms.free.size))
    freedoms.move(u)
    return mesh, state, freedoms, shell


@pytest.mark.parametrize("leave_out", [False, True])
def test_stiffness_is_symmetric_and_its_product_with_a_motion_needs_no_matrix(leave_out):
    mesh, _, freedoms, shell = deformed_roof()  # away from equilibrium
    rng = np.random.default_rng(6)
    bent = rng.uniform(-0.1, 0.1, (mesh.n_quad, 16)) if leave_out else None
    K, free = freedoms.stiffness(shell, bent), freedoms.free
    # Round-off of sums of a few terms as large as the largest entry.
    assert abs(K - K.T).max() < 64 * EPS * abs(K).max()
    np.testing.assert_array_equal(freedoms.restrict(K).toarray(), K.toarray()[np.ix_(free, free)])
    u = rng.uniform(-1.0, 1.0, 5 * mesh.n_node)
    found = freedoms.product(shell, u, bent)
    np.testing.assert_allclose(found, K @ u, atol=256 * EPS * abs(K).max())


def test_stiffness_is_the_derivative_of_the_forces():
    mesh, state, freedoms, shell = deformed_roof()
    u = freedoms.fill(np.random.default_rng(3).uniform(-1.0, 1.0, freedoms.free.size))
    start = state.node.x.copy(), state.node.t.copy()
    expected = freedoms.stiffness(shell) @ u
    basis, step, forces = freedoms.basis.copy(), 1e-5, []
    for sign in (1.0, -1.0):
        freedoms.move(sign * step * u)
        # Forces on the turned directors, along the tangents as they were carried along.
        t = state.node.t[: mesh.n_node]
        freedoms.basis[:] = carried(basis, start[1][: mesh.n_node], t)
        # On a cone about x the tangent b_1 is along x x t, also where the great circle's is not.
        for node in mesh.node_set("right"):
            way = np.cross([1.0, 0.0, 0.0], t[node])
            freedoms.basis[node, 0] = way * np.sign(way @ basis[node, 0]) / np.linalg.norm(way)
        node = state.node
        node.force_rows[: mesh.n_node] = 0.0
        shell.add_forces(state)
        inner = node.force[: mesh.n_node], node.director_force[: mesh.n_node]
        forces.append(-freedoms.gather(*inner))
        node.x[:], node.t[:] = start
        freedoms.update()
    difference = (forces[0] - forces[1]) / (2.0 * step)
    # Central difference: error of order step² beside the stiffness, and round-off / step.
    free, atol = freedoms.free, 1e-8 * abs(expected).max()
    np.testing.assert_allclose(difference[free], expected[free], atol=atol)


def carried(basis, before, after):
    """Turn the tangents by the smallest rotation from one director to the other."""
    axis = np.cross(before, after)[:, None]
    cos = np.einsum("ni,ni->n", before, after)[:, None, None]
    along = np.einsum("nki,nbi->nbk", axis, basis)
    return cos * basis + np.cross(axis, basis) + along * axis / (1.0 + cos)
