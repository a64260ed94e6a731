"""What supports leave free, and the pieces of a film that have none: how they come to rest."""

import numpy as np
import pytest

import shellcut as sc
from shellcut.checks.hold import check_held_film, check_hold, pieces_of
from shellcut.checks.sweep import Sweep
from shellcut.mesh.mesh import Mesh
from shellcut.mesh.structured import rectangle
from shellcut.mitc4.initial_state import initial_state
from shellcut.mitc4.shell import MITC4Shell
from shellcut.state.pieces import Pieces

MESH = rectangle(4.0, 2.0, size=1.0)
ALL = np.arange(MESH.n_node)
SIDE = {name: MESH.node_set(name) for name in ("left", "right", "bottom", "top")}
POSITION, CLAMPED = [0, 1, 2], [0, 1, 2, 3, 4, 5]


def held(*parts, n_node=MESH.n_node):
    support = np.zeros((n_node, 6), bool)
    for nodes, components in parts:
        support[np.ix_(np.atleast_1d(nodes), components)] = True
    return support


@pytest.mark.parametrize(
    ("parts", "free"),
    [
        ([], ["along x", "along y", "along z", "about x", "about y", "about z"]),
        ([(SIDE["left"], CLAMPED)], []),
        ([(SIDE["bottom"], POSITION), (SIDE["top"], POSITION)], []),
        ([(ALL, [2])], ["along x", "along y", "about z"]),
        # a hinge along the left side, which is parallel to y
        ([(SIDE["left"], POSITION)], ["about an axis along (0, 1, 0)"]),
        # one clamped node: a director has no drilling
        ([(SIDE["left"][:1], CLAMPED)], ["about an axis along (0, 0, 1)"]),
        # x at the left, y at the bottom and z at the right leave a hinge at the right side
        (
            [(SIDE["left"], [0]), (SIDE["bottom"], [1]), (SIDE["right"], [2])],
            ["about an axis along (0, 1, 0)"],
        ),
        # two nodes on a diagonal, and z where neither of them lies
        ([([0, -1], POSITION)], ["about an axis along (1, 0.5, 0)"]),
    ],
)
def test_what_supports_leave_free(parts, free):
    [(_, found)] = pieces_of(MESH.quads, MESH.nodes, MESH.directors, held(*parts), 1e-10)
    assert found == free


def test_every_piece_must_be_held():
    n, both = MESH.n_node, stacked(MESH, MESH, (0.0, 5.0, 0.0))
    (finding,) = check_hold(both, held((SIDE["left"], CLAMPED), n_node=2 * n))
    assert finding.severity == "doubt"
    assert "the piece of 8 quads about (2, 5, 0) mm, which has no support" in str(finding)
    whole = held((SIDE["left"], CLAMPED), (SIDE["left"] + n, CLAMPED), n_node=2 * n)
    assert list(check_hold(both, whole)) == []
    (finding,) = check_hold(MESH, held((ALL, [2])))
    free = "whose 15 supported nodes leave it free to move along x, along y, about z"
    assert free in str(finding)
    (finding,) = check_hold(MESH, held())
    assert "the film about (2, 0, 0) mm, which has no support" in str(finding)


def test_a_blade_that_cuts_held_film_is_told():
    case = sc.guillotine(1.0, length=6.0, width=4.0, notch=1.0, travel=3.0)
    mesh = case.simulation.mesh
    sweep = Sweep.of(mesh, case.simulation.tool, case.simulation.motion, case.duration)
    assert list(check_held_film(sweep, case.simulation.state.node.support[: mesh.n_node])) == []
    support = held((np.flatnonzero(mesh.nodes[:, 0] > 1.5), POSITION), n_node=mesh.n_node)
    (finding,) = check_held_film(sweep, support)
    assert "quads under their path with all four nodes fixed, the first at (2" in str(finding)


SHEETS = rectangle(3.0, 2.0, n_x=6, n_y=4), rectangle(2.0, 1.4, n_x=5, n_y=4)
FIRST = SHEETS[0].n_node


def stacked(one, two, shift):
    """Return two meshes as one, the second moved."""
    nodes = np.concatenate([one.nodes, two.nodes + np.array(shift)])
    return Mesh.from_arrays(nodes, np.concatenate([one.quads, two.quads + one.n_node]))


def test_pieces_of_a_film_by_construction_are_loose_only_if_nothing_holds_them():
    mesh = stacked(*SHEETS, (0.3, 0.1, 1.0))
    state = initial_state(mesh)
    MITC4Shell(mesh, sc.ShellMaterial.homogeneous(), damping_beta=0.0).initialise(state)
    pieces = Pieces.of(state)
    np.testing.assert_array_equal(pieces.of_row, np.repeat([0, 1], [24, 20]))
    # Nothing is held: the heavier piece is the film.
    assert pieces.loose.tolist() == [False, True]
    assert pieces.mass == pytest.approx([6.0e-9 * 0.074, 2.8e-9 * 0.074], rel=1e-12)
    second = np.arange(mesh.n_node) >= FIRST
    np.testing.assert_array_equal(pieces.nodes_that_meet_others(state), second)
    state.node.supported[FIRST] = True
    pieces = Pieces.of(state)
    assert pieces.loose.tolist() == [True, False]
    assert pieces.nodes_that_meet_others(state).all()
    state.node.supported[0] = True
    pieces = Pieces.of(state)
    assert pieces.n_loose == 0
    np.testing.assert_array_equal(pieces.nodes_that_meet_others(state), second)


STRIP = rectangle(3.4, 0.8, n_x=10, n_y=3)


@pytest.mark.parametrize(
    ("still", "moves", "shift"),
    [(SHEETS[0], SHEETS[1], (0.3, 0.1)), (STRIP, rectangle(2.0, 1.6, n_x=5, n_y=4), (0.7, 0.0))],
    ids=["the lighter one moves", "the heavier one moves"],
)
def test_supported_pieces_do_not_pass_through_each_other(still, moves, shift):
    """A sheet without a crack that its supports move 0.6 mm down, from 0.3 mm above another."""
    mesh, first = stacked(still, moves, (*shift, 0.3)), still.n_node
    supports = [
        sc.Support.clamped(np.concatenate([still.node_set(name) for name in ("left", "right")])),
        sc.Support(np.arange(first, mesh.n_node), "xyz", "xyz", velocity={"z": lambda _: -600.0}),
    ]
    film, contact = sc.ShellMaterial.homogeneous(), sc.Contact(self_contact=True)
    sim = sc.Simulation(mesh, film, supports=supports, contact=contact, damping_beta=5e-8)
    sim.run(1e-3)
    z = sim.state.node.x[: mesh.n_node, 2]
    assert z[first:] == pytest.approx(-0.3, abs=1e-3)
    assert z[:first].min() < -0.3


def test_a_loose_piece_comes_to_rest_on_the_film():
    mesh = stacked(*SHEETS, (0.3, 0.1, 0.1))
    v = np.zeros((mesh.n_node, 3))
    v[FIRST:, 2] = -1000.0
    sim = sc.Simulation(
        mesh,
        sc.ShellMaterial.homogeneous(),
        supports=[sc.Support.clamped(np.arange(FIRST))],
        loads=[sc.Gravity((0.0, 0.0, -2e7))],
        contact=sc.Contact(self_contact=True),
        velocity=v,
        damping_alpha=3e4,
    )
    for _ in range(4000):
        sim.step()
    z = sim.state.node.x[FIRST : mesh.n_node, 2]
    h = sim.material.thickness
    assert np.abs(sim.state.node.velocity_half[FIRST : mesh.n_node]).max() < 1.0
    assert sim.self_contact.forces.n_touching == 30
    # Its weight on 30 springs, all as deep: k f(D) = m g.
    assert z.min() > 0.9 * h
    assert z.max() < h
    assert abs(sim.ledger.imbalance) < 5e-3 * sim.ledger.put_in
