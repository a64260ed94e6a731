"""Broken sides of every kind: what must not change, what goes with which half."""

import numpy as np
import pytest

from naive import cases
from shellcut.cables.cohesive_law import CohesiveLaw
from shellcut.fracture.cuts import Cuts
from shellcut.fracture.open_edges import crack_edges, crack_tips
from shellcut.mesh.structured import rectangle
from shellcut.mitc4.initial_state import initial_state

LAW = CohesiveLaw()
H = 0.074
FIBRES = 6

# Six by four quads; node j * 7 + i is the i-th of row j. Each side: its nodes, and which of them
# part when it is broken after those before it.
SEQUENCE = [
    ("inner side", (16, 17), []),
    ("at a tip", (17, 18), [17]),
    ("at a tip", (18, 19), [18]),
    ("to the rim", (19, 20), [19, 20]),
    ("from a flank", (17, 10), [17]),
    ("to the rim", (10, 3), [10, 3]),
    ("at a tip, round a corner", (16, 23), [16]),
    ("at a tip", (23, 24), [23]),
]
KINDS = [f"{k}-{kind}" for k, (kind, *_) in enumerate(SEQUENCE)]


def prepared():
    mesh = cases.skewed_flat(6, 4, seed=5, amount=0.12)
    nodes = mesh.nodes.copy()
    nodes[:, 2] = 0.1 * np.sin(nodes[:, 0]) * np.cos(0.7 * nodes[:, 1])
    mesh = cases.moved_mesh(mesh, nodes)
    shell, state = cases.set_up(mesh)
    cases.deform(state, stretch=0.03)
    rng = np.random.default_rng(7)
    n = mesh.n_node
    state.node.velocity_half[:n] = rng.uniform(-1e3, 1e3, (n, 3))
    spin = rng.uniform(-1e3, 1e3, (n, 3))
    t = state.node.t[:n]
    state.node.spin_half[:n] = spin - np.einsum("ni,ni->n", spin, t)[:, None] * t
    state.node.contact_force[:n] = rng.uniform(-1, 1, (n, 3))
    state.node.load_force[:n] = rng.uniform(-1, 1, (n, 3))
    return mesh, shell, state


def broken(mesh, shell, state, n_side):
    """Break the first sides of the sequence; return what cuts."""
    cuts = Cuts(state, shell, LAW, fibres=FIBRES)
    for _, side, _ in SEQUENCE[:n_side]:
        cases.break_side(cuts, shell, state, *side)
    return cuts


def totals(state):
    n = state.node
    rows = slice(n.count)
    m, j = n.mass[rows, None], n.inertia[rows, None]
    v, w = n.velocity_half[rows], n.spin_half[rows]
    return {
        "mass": m.sum(),
        "inertia": j.sum(),
        "momentum": (m * v).sum(axis=0),
        "angular momentum": (m * np.cross(n.x[rows], v) + j * w).sum(axis=0),
        "kinetic": 0.5 * (m * v * v).sum() + 0.5 * (j * w * w).sum(),
        "contact force": n.contact_force[rows].sum(axis=0),
        "load": n.load_force[rows].sum(axis=0),
    }


def check_cables(mesh, state, sides):
    """Area and ends of all cables against the sides that are broken, one after the other."""
    c, live = state.cable, state.n_cable
    assert live == FIBRES * len(sides)
    for k in range(live):
        here, there = sides[k // FIBRES]
        beside = [q for q, quad in enumerate(mesh.quads.tolist()) if here in quad and there in quad]
        assert sorted(c.row[k].tolist()) == beside  # a flank each
        for side, row in enumerate(c.row[k].tolist()):
            quad = mesh.quads[row].tolist()
            assert c.ends[k, side] == state.quads[row, quad.index(here)]
            assert c.far[k, side] == state.quads[row, quad.index(there)]
        assert c.share[k] == pytest.approx((k % FIBRES + 0.5) / FIBRES, rel=1e-14)
        length = np.linalg.norm(mesh.nodes[here] - mesh.nodes[there]) / FIBRES
        assert c.length[k] == pytest.approx(length, rel=1e-14)
        assert c.area[k] == pytest.approx(H * length, rel=1e-14)


@pytest.mark.parametrize("k", range(len(SEQUENCE)), ids=KINDS)
def test_a_broken_side_keeps_mass_momentum_energy_and_cohesive_area(k):
    mesh, shell, state = prepared()
    cuts = broken(mesh, shell, state, k)
    _, side, parts = SEQUENCE[k]
    before, strain = totals(state), cases.forces_of(shell, state)[0]
    strains, broken_length = state.strain.copy(), state.crack_length
    n_cable, n_node = state.n_cable, state.n_node
    pushed = state.node.contact_force[:n_node] / state.node.mass[:n_node, None]
    cases.break_side(cuts, shell, state, *side)
    after = totals(state)
    for name, value in before.items():
        scale = np.abs(value).max()
        np.testing.assert_allclose(after[name], value, rtol=0, atol=1e-12 * scale, err_msg=name)
    energy = cases.forces_of(shell, state)[0]
    assert energy == strain  # bitwise: the same quads at the same places
    np.testing.assert_array_equal(state.strain, strains)
    assert state.revision == k + 1
    length = np.linalg.norm(mesh.nodes[side[1]] - mesh.nodes[side[0]])
    assert state.crack_length - broken_length == pytest.approx(length, rel=1e-12)
    twins = np.arange(n_node, state.n_node)
    assert sorted(state.node.origin[twins].tolist()) == sorted(parts)
    n = state.node
    for twin in twins.tolist():
        halves = np.flatnonzero(n.origin[: state.n_node] == n.origin[twin])
        for name in ("X", "x", "t", "velocity_half", "spin_half"):
            rows = getattr(n, name)[halves]
            np.testing.assert_array_equal(rows, np.broadcast_to(rows[0], rows.shape))
        # Each half has its own quads, ascending, and nobody else's.
        for half in halves.tolist():
            held = [e for e in range(mesh.n_quad) if half in state.quads[e]]
            assert n.quads[half, : n.n_quad_at[half]].tolist() == held
            share = sum(shell.mass[e, state.quads[e].tolist().index(half)] for e in held)
            assert n.mass[half] == pytest.approx(share, rel=1e-14)
            assert n.halved[half]
            # Forces of the last evaluation are shared like the mass, lest the halves fly apart.
            kept = n.contact_force[half] / n.mass[half]
            was = pushed[half] if half < n_node else pushed[halves[0]]
            np.testing.assert_allclose(kept, was, rtol=1e-10)
    check_cables(mesh, state, [side for _, side, _ in SEQUENCE[: k + 1]])
    c = state.cable
    for new in range(n_cable, state.n_cable):
        np.testing.assert_array_equal(c.branch[new], [c.m[new], -c.m[new]])
    record = state.split_log[-1]
    assert record.kind == "criterion"
    if side[0] in parts:
        assert n.origin[record.node] == n.origin[record.twin] == side[0]
        assert record.node < record.twin in twins
    else:
        assert (record.node, record.twin) == (-1, -1)


def test_what_the_cables_do_not_take_over_from_the_node_is_told():
    # With the equilibrium start they take all of it: tests/verification/test_uniform_tension_split.
    mesh, shell, state = prepared()
    cuts, force = broken(mesh, shell, state, 1), np.array([0.3, 0.4, 0.5])
    cut = cases.break_side(cuts, shell, state, 17, 18)
    cuts.hand_over(state, cut, [force], FIBRES, exactly=False)
    c, new = state.cable, slice(FIBRES, 2 * FIBRES)
    pull = LAW.strength * c.area[new, None] * c.m[new]
    jump = np.linalg.norm(force - (1.0 - c.share[new]) @ pull)
    assert state.split_log[-1].force_jump == pytest.approx(jump, rel=1e-14)
    assert not c.start_force[new].any()


def test_many_splits_outgrow_the_reserve():
    # More twins than spare rows: arrays are replaced, and nothing of the above may break.
    mesh = rectangle(28.0, 20.0, n_x=28, n_y=20)
    shell, state = cases.set_up(mesh)
    cuts = Cuts(state, shell, LAW, fibres=FIBRES)
    mass, spare = state.node.mass[: mesh.n_node].sum(), len(state.node.x)
    nodes = [row * 29 + i for row in range(1, 20, 2) for i in range(28)]
    for node in nodes:
        cases.break_side(cuts, shell, state, node, node + 1)
    assert state.n_node == mesh.n_node + 290 > spare
    assert state.node.mass[: state.n_node].sum() == pytest.approx(mass, rel=1e-12)
    check_cables(mesh, state, [(node, node + 1) for node in nodes])


READERS = {
    "add_forces": cases.forces_of,
    "corner_forces": lambda shell, state: shell.corner_forces(
        state, np.zeros(1, int), state.quads[0, :1]
    ),
    "tangents": lambda shell, state: shell.tangents(state, np.zeros(1, int)),
    "tangent_product": lambda shell, state: shell.tangent_product(
        state, *np.zeros((2, state.n_node, 3))
    ),
    "evaluate_frequencies": lambda shell, state: shell.evaluate_frequencies(
        state, np.zeros(1, int)
    ),
}


@pytest.mark.parametrize("read", READERS.values(), ids=READERS)
def test_the_shell_follows_splits_and_other_states_by_itself(read):
    mesh, shell, state = prepared()
    at_rest = cases.set_up(mesh)[1]
    read(shell, state)
    broken(mesh, shell, state, len(SEQUENCE))
    for one in (state, at_rest, state):
        read(shell, one)
        np.testing.assert_array_equal(
            shell.blocks.corner.transpose(0, 2, 1), one.quads[shell.blocks.quad]
        )


def test_at_a_bridge_one_of_the_cracks_that_arrive_is_told():
    # Cracks from both sides have met at node 17, the fourth of a row of seven, which still holds.
    mesh = rectangle(6.0, 4.0, n_x=6, n_y=4).cut(list(range(14, 21)))
    state = cases.welded(initial_state(mesh), 17)
    ((node, far),) = crack_tips(state).items()
    origin = state.node.origin[: state.n_node]
    assert node == 17
    assert origin[far] in (16, 18)
    assert (crack_edges(state.quads, origin) == 17).any(axis=2).all(axis=1).sum() == 2
