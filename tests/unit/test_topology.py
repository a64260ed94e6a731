"""Splits of every kind: what must not change, what goes with which half."""

import numpy as np
import pytest

from naive import cases
from naive import topology as naive
from shellcut.cables.cohesive_law import CohesiveLaw
from shellcut.fracture.criterion import Split
from shellcut.fracture.quad_fans import arriving, fans_of
from shellcut.fracture.quad_polygon import CORNERS
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
    centres = [state.node.x[state.quads[list(g)]].mean(axis=(0, 1)) for g in (minus, plus)]
    m = (centres[1] - centres[0]) / np.linalg.norm(centres[1] - centres[0])
    return Split(node, minus, plus, m, 1.2, np.array([0.3, 0.4, 0.5]), False)


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
        origins = set()
        for end in range(2):
            row, corner = c.row[k, end], c.corner[k, end]
            inward = c.inward[k, end] - CORNERS[corner]
            after = CORNERS[(corner + 1) % 4]
            along = inward @ np.subtract(after, CORNERS[corner]) > 0.0
            quad = mesh.quads[row]
            origins.add((int(quad[corner]), int(quad[(corner + (1 if along else 3)) % 4])))
            assert state.quads[row, corner] == c.ends[k, end]
        ((origin, far),) = origins  # both flanks agree on it
        seen.append((origin, far))
        assert frozenset(c.ends[k].tolist()) == ends[origin, far]
        reference = 0.5 * np.linalg.norm(mesh.nodes[origin] - mesh.nodes[far])
        assert c.length[k] == pytest.approx(reference, rel=1e-14)
        assert c.area[k] == pytest.approx(H * reference, rel=1e-14)
    assert sorted(seen) == sorted(ends)  # every open end has one cable


@pytest.mark.parametrize("k", range(len(SEQUENCE)), ids=KINDS)
def test_split_keeps_mass_momentum_energy_and_cohesive_area(k):
    mesh, shell, state = prepared()
    cracks = cases.edge_cracks(mesh, shell, state, LAW)
    for entry in SEQUENCE[:k]:
        cracks.split(state, wanted_split(mesh, state, entry))
    kind = SEQUENCE[k][0]
    split = wanted_split(mesh, state, SEQUENCE[k])
    arrives = bool(arriving(state, fans_of(state, split.node)))
    assert ("tip" in kind or "bridge" in kind) == arrives
    before, strain = totals(shell, state), cases.forces_of(shell, state)[0]
    strains = state.strain.copy()
    n_cable, n_node = state.n_cable, state.n_node
    mass, pushed = state.node.mass[split.node], state.node.contact_force[split.node].copy()
    twin = cracks.split(state, split)
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
    low, high = sorted((split.minus, split.plus), key=min)
    for half, quads in ((split.node, low), (twin, high)):
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
    c = state.cable
    for new in range(n_cable, state.n_cable):
        assert set(c.ends[new].tolist()) == {split.node, twin}
        # From the minus to the plus side, whichever of the halves is the twin.
        quads = [split.minus, split.plus]
        assert [c.row[new, end] in quads[end] for end in range(2)] == [True, True]
        assert c.m[new] @ split.m > 0.5
        np.testing.assert_array_equal(c.branch[new], [c.m[new], -c.m[new]])
    record = state.split_log[-1]
    assert (record.node, record.twin, record.kind) == (split.node, twin, "criterion")


def test_a_cable_goes_with_the_half_that_owns_its_flank():
    mesh, shell, state = prepared()
    cracks = cases.edge_cracks(mesh, shell, state, LAW)
    cracks.split(state, wanted_split(mesh, state, SEQUENCE[0]))
    c = state.cable
    assert state.n_cable == 2  # one to either side of the node
    for k in range(2):
        c.force[k], c.work[k], c.opening_max[k], c.status[k] = k + np.ones((2, 3)), k, 0.3 + k, k
    before, ends = state.saved()["cable"], c.ends[:2].copy()
    kept = {name: before[name].copy() for name in ("force", "work", "opening_max", "status")}
    flank = wanted_split(mesh, state, SEQUENCE[4])
    twin = cracks.split(state, flank)
    c = state.cable
    assert state.n_cable == 3
    for name, rows in kept.items():
        np.testing.assert_array_equal(getattr(c, name)[:2], rows, err_msg=name)
    # The flank of one of the two is now that of the twin, and nothing else of them has changed.
    moved = c.ends[:2] != ends
    assert moved.sum() == 1
    assert ends[moved] == flank.node
    assert c.ends[:2][moved] == twin
    check_cables(mesh, state)


def test_equilibrium_start_takes_over_what_the_node_carried():
    mesh, shell, state = prepared()
    split = wanted_split(mesh, state, SEQUENCE[0])
    state.time = 0.25
    cases.edge_cracks(mesh, shell, state, LAW, equilibrium_start=True).split(state, split)
    c = state.cable
    pull = LAW.strength * c.area[:2, None] * c.m[:2]
    begins = c.start_force[:2] + pull
    np.testing.assert_allclose(begins.sum(axis=0), split.force, atol=1e-15)
    # Shared like the areas.
    share = c.area[0] / c.area[:2].sum()
    np.testing.assert_allclose(begins[0], share * split.force, atol=1e-15)
    assert (c.birth[:2] == 0.25).all()
    assert (c.traction[:2] == LAW.strength).all()
    assert state.split_log[0].force_jump == 0.0
    mesh, shell, state = prepared()
    cases.edge_cracks(mesh, shell, state, LAW).split(state, split)
    jump = np.linalg.norm(split.force - pull.sum(axis=0))
    assert state.split_log[0].force_jump == pytest.approx(jump, rel=1e-14)
    assert not state.cable.start_force[:2].any()


def test_a_notch_in_the_mesh_has_no_cables():
    mesh = rectangle(6.0, 4.0, n_x=6, n_y=4).cut([14, 15, 16, 17])
    shell, state = cases.set_up(mesh)
    cracks = cases.edge_cracks(mesh, shell, state, LAW)
    assert cracks.tips == [17]
    twin = cracks.split(state, wanted_split(mesh, state, ("tip", 17, 14, (18,))))
    assert cracks.tips == [18]
    assert state.n_cable == 1
    assert state.cable.length[0] == state.crack_length == 0.5
    assert state.cable.ends[0].tolist() == [17, twin]


def test_many_splits_outgrow_the_reserve():
    # More twins than spare rows: arrays are replaced, and nothing of the above may break.
    mesh = rectangle(40.0, 20.0, n_x=40, n_y=20)
    shell, state = cases.set_up(mesh)
    cracks = cases.edge_cracks(mesh, shell, state, LAW)
    mass = state.node.mass[: mesh.n_node].sum()
    for row in range(1, 20, 2):
        for i in range(1, 40):
            node = row * 41 + i
            fan = fans_of(state, node)[0]
            first = [e for e in fan.quads if state.node.X[state.quads[e], 1].mean() < row - 10]
            rest = [e for e in fan.quads if e not in first]
            m = np.array([0, 1.0, 0])
            cracks.split(state, Split(node, tuple(first), tuple(rest), m, 1.0, np.zeros(3), False))
    assert state.n_node == mesh.n_node + 390
    assert state.n_cable == 780
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
    cracks = cases.edge_cracks(mesh, shell, state, LAW)
    for entry in SEQUENCE:
        cracks.split(state, wanted_split(mesh, state, entry))
    for one in (state, at_rest, state):
        read(shell, one)
        np.testing.assert_array_equal(
            shell.blocks.corner.transpose(0, 2, 1), one.quads[shell.blocks.quad]
        )
