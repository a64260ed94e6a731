"""Splits of every kind: what must not change, what goes with which half."""

import numpy as np
import pytest

from naive import cases
from naive import topology as naive
from shellcut.cables.cohesive_law import CohesiveLaw
from shellcut.fracture.criterion import Split
from shellcut.fracture.flanks import cable_ends
from shellcut.fracture.quad_fans import arriving, fans_of
from shellcut.fracture.split_node import split_node
from shellcut.mesh.structured import rectangle

LAW = CohesiveLaw()
H = 0.074

# Six by four quads; node j * 7 + i is the i-th of row j. Each split: the node, given by its
# reference node and the quad it must still own, the far reference nodes of the edges to open, and
# what it is.
SEQUENCE = [
    ("interior", 17, 14, (16, 18)),
    ("tip", 18, 15, (19,)),
    ("tip", 19, 16, (20,)),
    ("boundary bridge", 20, 17, ()),
    ("flank", 17, 8, (10,)),
    ("boundary", 3, 2, (10,)),
    ("bridge", 10, 2, ()),
    ("tip", 16, 13, (23,)),
    ("tip", 23, 20, (24,)),
]
KINDS = [f"{k}-{kind}" for k, (kind, *_) in enumerate(SEQUENCE)]


def warped_sheet():
    mesh = cases.skewed_flat(6, 4, seed=5, amount=0.12)
    nodes = mesh.nodes.copy()
    nodes[:, 2] = 0.1 * np.sin(nodes[:, 0]) * np.cos(0.7 * nodes[:, 1])
    return cases.moved_mesh(mesh, nodes)


def prepared():
    mesh = warped_sheet()
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


def wanted_split(mesh, state, entry):
    """The split of an entry from the quads alone; the lower of the two groups is minus."""
    _, origin, quad, fars = entry
    node = int(state.quads[quad, mesh.quads[quad].tolist().index(origin)])
    assert state.node.origin[node] == origin
    cut = [n for n in range(state.n_node) if state.node.origin[n] in fars]
    minus, plus = naive.parted(state, node, cut)
    before = {key for key in naive.open_ends(mesh, state) if key[0] == origin}
    # An edge opens at this node where its two quads fall into different groups.
    halves = []
    for (i, j), (e, f) in naive.reference_edges(mesh).items():
        if origin in (i, j) and {e, f} <= {*minus, *plus} and (e in minus) != (f in minus):
            far = j if i == origin else i
            if (origin, far) not in before:
                halves.append((far, 0.5 * float(np.linalg.norm(mesh.nodes[i] - mesh.nodes[j]))))
    centres = [state.node.x[state.quads[list(g)]].mean(axis=(0, 1)) for g in (minus, plus)]
    m = (centres[1] - centres[0]) / np.linalg.norm(centres[1] - centres[0])
    return Split(node, minus, plus, tuple(halves), m, 1.2, np.array([0.3, 0.4, 0.5]), False)


def totals(shell, state):
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


def check_cables(mesh, state):
    """Area and ends of all cables against the reference mesh."""
    c, live = state.cable, state.n_cable
    ends = naive.open_ends(mesh, state)
    length = naive.crack_length(mesh, state)
    assert state.crack_length == pytest.approx(length, rel=1e-12)
    assert c.area[:live].sum() == pytest.approx(H * length, rel=1e-12)
    seen = []
    for k in range(live):
        origin = int(state.node.origin[c.ends[k, 0]])
        assert state.node.origin[c.ends[k, 1]] == origin
        assert c.area[k] == pytest.approx(H * c.half_edge[k].sum(), rel=1e-14)
        for i in range(2):
            if c.half_edge[k, i] > 0:
                far = int(c.half_edge_far[k, i])
                seen.append((origin, far))
                assert frozenset(c.ends[k].tolist()) == ends[origin, far]
                reference = 0.5 * np.linalg.norm(mesh.nodes[origin] - mesh.nodes[far])
                assert c.half_edge[k, i] == pytest.approx(reference, rel=1e-14)
    assert sorted(seen) == sorted(ends)  # every open end has one half-edge, none has two


@pytest.mark.parametrize("k", range(len(SEQUENCE)), ids=KINDS)
def test_split_keeps_mass_momentum_energy_and_cohesive_area(k):
    mesh, shell, state = prepared()
    for entry in SEQUENCE[:k]:
        split_node(state, wanted_split(mesh, state, entry), shell, LAW, equilibrium_start=False)
    kind = SEQUENCE[k][0]
    split = wanted_split(mesh, state, SEQUENCE[k])
    cracks = arriving(state, fans_of(state, split.node))
    assert ("tip" in kind or "bridge" in kind) == bool(cracks)
    before, strain = totals(shell, state), cases.forces_of(shell, state)[0]
    strains = state.strain.copy()
    n_cable, n_node = state.n_cable, state.n_node
    mass, pushed = state.node.mass[split.node], state.node.contact_force[split.node].copy()
    twin = split_node(state, split, shell, LAW, equilibrium_start=False)
    after = totals(shell, state)
    for name, value in before.items():
        scale = np.abs(value).max()
        np.testing.assert_allclose(after[name], value, rtol=0, atol=1e-12 * scale, err_msg=name)
    energy = cases.forces_of(shell, state)[0]
    assert energy == strain  # bitwise: the same quads at the same places
    np.testing.assert_array_equal(state.strain, strains)
    assert twin == n_node
    assert state.n_node == n_node + 1
    assert state.revision == k + 1
    # Each half has its own quads, ascending, and nobody else's.
    for half, quads in ((split.node, split.minus), (twin, split.plus)):
        held = [e for e in range(mesh.n_quad) if half in state.quads[e]]
        assert held == sorted(quads)
        assert state.node.quads[half, : state.node.n_quad_at[half]].tolist() == held
        share = sum(shell.mass[e, state.quads[e].tolist().index(half)] for e in held)
        assert state.node.mass[half] == pytest.approx(share, rel=1e-14)
        assert state.node.halved[half]
        # Forces of the last evaluation are shared like the mass, lest the halves fly apart.
        kept = state.node.contact_force[half]
        np.testing.assert_allclose(kept, share / mass * pushed, rtol=1e-12)
    for name in ("X", "x", "t", "velocity_half", "spin_half", "origin"):
        rows = getattr(state.node, name)
        np.testing.assert_array_equal(rows[twin], rows[split.node])
    assert state.n_cable > n_cable
    check_cables(mesh, state)
    new = state.n_cable - 1 if kind != "flank" else None
    if new is not None:
        assert state.cable.ends[new].tolist() == [split.node, twin]
        np.testing.assert_array_equal(state.cable.m[new], split.m)
        np.testing.assert_array_equal(state.cable.branch[new], [split.m, -split.m])
    record = state.split_log[-1]
    assert (record.node, record.twin, record.kind) == (split.node, twin, "criterion")


def test_a_cable_is_divided_when_its_flank_splits():
    mesh, shell, state = prepared()
    split_node(state, wanted_split(mesh, state, SEQUENCE[0]), shell, LAW, equilibrium_start=True)
    c = state.cable
    c.force[0], c.work[0], c.start_work[0] = np.arange(6.0).reshape(2, 3), 0.7, 0.2
    c.opening[0], c.opening_max[0], c.traction[0], c.status[0] = 0.3, 0.4, 11.0, 1
    c.joint_body[0], c.joint_slack[0], c.overshoot[0] = [1, 2, 3], 0.01, 0.005
    whole = {k: getattr(c, k)[0].copy() for k in ("force", "work", "start_work", "start_force")}
    area, halves, fars = c.area[0], c.half_edge[0].copy(), c.half_edge_far[0].copy()
    flank = wanted_split(mesh, state, SEQUENCE[4])
    twin = split_node(state, flank, shell, LAW, equilibrium_start=False)
    c = state.cable
    assert state.n_cable == 3  # the two parts and the new one
    assert sorted(c.half_edge_far[:2, 0].tolist()) == sorted(fars.tolist())
    share = np.array([c.half_edge[k, 0] for k in (0, 1)]) / halves.sum()
    for name, value in whole.items():
        for k in (0, 1):
            np.testing.assert_allclose(getattr(c, name)[k], share[k] * value, rtol=1e-14)
    assert c.area[:2].sum() == pytest.approx(area, rel=1e-14)
    for name in ("opening", "opening_max", "traction", "status", "joint_body", "joint_slack"):
        np.testing.assert_array_equal(getattr(c, name)[0], getattr(c, name)[1])
    assert not c.half_edge[:2, 1].any()
    # One part went with each copy, the other end stayed.
    assert {c.ends[0, 0], c.ends[1, 0]} == {flank.node, twin} or {
        c.ends[0, 1],
        c.ends[1, 1],
    } == {flank.node, twin}
    assert sorted(k for k, _ in cable_ends(state, twin)) == [1, 2]
    check_cables(mesh, state)


def test_a_broken_cable_keeps_its_area():
    mesh, shell, state = prepared()
    for entry in SEQUENCE[:2]:
        split_node(state, wanted_split(mesh, state, entry), shell, LAW, equilibrium_start=False)
    state.cable.status[0] = 2
    flank = wanted_split(mesh, state, SEQUENCE[4])
    split_node(state, flank, shell, LAW, equilibrium_start=False)
    assert (state.cable.status[:4] == [2, 0, 2, 0]).all()
    check_cables(mesh, state)


def test_equilibrium_start_takes_over_what_the_node_carried():
    mesh, shell, state = prepared()
    split = wanted_split(mesh, state, SEQUENCE[0])
    state.time = 0.25
    split_node(state, split, shell, LAW, equilibrium_start=True)
    c = state.cable
    np.testing.assert_allclose(
        c.start_force[0] + LAW.strength * c.area[0] * split.m, split.force, atol=1e-15
    )
    assert c.birth[0] == 0.25
    assert c.traction[0] == LAW.strength
    assert state.split_log[0].force_jump == 0.0
    mesh, shell, state = prepared()
    split_node(state, split, shell, LAW, equilibrium_start=False)
    jump = np.linalg.norm(split.force - LAW.strength * state.cable.area[0] * split.m)
    assert state.split_log[0].force_jump == pytest.approx(jump, rel=1e-14)
    assert not state.cable.start_force[0].any()


def test_a_split_of_free_edges_makes_no_cable():
    # Two notches meet at a node that alone still holds: nothing cohesive is left to open.
    mesh = rectangle(6.0, 4.0, n_x=6, n_y=4).cut(list(range(14, 21)))
    shell, state = cases.set_up(mesh)
    cases.welded(state, 17)
    first, second = fans_of(state, 17)
    split = Split(
        17, first.quads, second.quads, (), np.array([0, 1.0, 0]), np.inf, np.zeros(3), True
    )
    twin = split_node(state, split, shell, LAW, equilibrium_start=False)
    assert state.n_cable == 0
    assert state.crack_length == 0.0
    assert [e for e in range(mesh.n_quad) if twin in state.quads[e]] == sorted(second.quads)
    assert state.split_log[0].kind == "blade"


def test_many_splits_outgrow_the_reserve():
    # More twins than spare rows: arrays are replaced, and nothing of the above may break.
    mesh = rectangle(40.0, 20.0, n_x=40, n_y=20)
    shell, state = cases.set_up(mesh)
    mass = state.node.mass[: mesh.n_node].sum()
    for row in range(1, 20, 2):
        for i in range(1, 40):
            node = row * 41 + i
            fan = fans_of(state, node)[0]
            first = [e for e in fan.quads if state.node.X[state.quads[e], 1].mean() < row - 10]
            rest = [e for e in fan.quads if e not in first]
            halves = [(node + 1, 0.5), (node - 1, 0.5)]
            split = Split(
                node, tuple(first), tuple(rest), tuple(halves), np.array([0, 1.0, 0]), 1.0,
                np.zeros(3), False,
            )  # fmt: skip
            split_node(state, split, shell, LAW, equilibrium_start=False)
    assert state.n_node == mesh.n_node + 390
    assert state.n_cable == 390
    assert state.node.mass[: state.n_node].sum() == pytest.approx(mass, rel=1e-12)
    check_cables(mesh, state)


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
    for entry in SEQUENCE:
        split_node(state, wanted_split(mesh, state, entry), shell, LAW, equilibrium_start=False)
    for one in (state, at_rest, state):
        read(shell, one)
        np.testing.assert_array_equal(
            shell.blocks.corner.transpose(0, 2, 1), one.quads[shell.blocks.quad]
        )
