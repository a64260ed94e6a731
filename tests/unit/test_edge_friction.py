"""Friction where edges of the film cross edges of the tool."""

import itertools
from dataclasses import asdict, replace

import numpy as np
import pytest

from film_and_bar import GAP, ON, bar, pushed
from naive.booking import book
from naive.contact import smoothed
from naive.edge_friction import RubbedEdge
from notched_strip import cutting
from shellcut.contact.coulomb_friction import TANGENTIAL
from shellcut.contact.edge_contact import _same_edges
from shellcut.contact.settings import Contact, node_stiffness
from shellcut.models import opening_test
from shellcut.recording.checkpoint import load_checkpoint, save_checkpoint
from shellcut.state import SplitRecord
from shellcut.tool.pose import Pose

MU = 0.3
RUBS = replace(ON, friction=MU)
LIP = np.sqrt(2.0) - 1.0
"""What a rounded right angle loses, over the radius."""
CONTACT_TERMS = ("contact", "friction", "edges", "edge_friction")


def term(sim, name):
    return next(t for t in sim.terms if t.name == name)


def k_of(sim):
    n = sim.state.node
    return 0.25 * node_stiffness(n.contact_area[0], sim.contact.law)


def led(contact, **options):
    """A film whose motion is given, and the bar: no force moves it, so no rebound is limited."""
    sim = pushed(contact, **options)
    sim.state.node.supported[:] = True
    return sim


def evaluated(sim, pose, x=None, dt=1e-6):
    """Move film and tool there over a step and evaluate; what each term did, and its forces."""
    s = sim.state
    s.step += 10  # what rests is looked at again
    s.dt = dt
    if x is not None:
        s.node.velocity_half[: len(x)] = (x - s.node.x[: len(x)]) / dt
        s.node.x[: len(x)] = x
    s.node.force[:] = 0.0
    found, forces = {}, {}
    for name in CONTACT_TERMS:
        before = s.node.force[: s.n_node].copy()
        term(sim, name).add_forces(s, pose)
        found[name] = term(sim, name).forces
        forces[name] = s.node.force[: s.n_node] - before
    return found, forces


def dragged(sim, way):
    """Move the bar on over a film at rest; what the friction at its edges did, and its ledger."""
    entries = dict.fromkeys(("friction_work", "friction_dissipated"), 0.0)
    found, last, pressure = [], np.zeros(3), []
    for before, place in itertools.pairwise([way[0], *way]):
        did, _ = evaluated(sim, Pose(np.eye(3), place))
        forces = did["edge_friction"]
        on_tool = 0.5 * (last + forces.wrench[0, :3]) @ (place - before)
        book(term(sim, "edge_friction"), entries, on_tool)
        last = forces.wrench[0, :3].copy()
        found.append(forces)
        pressure.append(term(sim, "edges").carriers.pressure.sum())
    return found, entries, np.array(pressure)


def towards(depth, n=40):
    """Ways of the bar from where it begins until its edge is this deep in the rim."""
    return [np.array([GAP + x, 0.0, 0.0]) for x in np.linspace(-0.005, depth, n)]


# ---------------------------------------------------------------- the law


@pytest.mark.parametrize("direction", [(0.0, 1.0, 0.0), (0.0, 0.6, 0.8), (0.0, 0.0, 1.0)])
def test_a_bar_dragged_along_a_rim_takes_the_closed_form(direction):
    """Along the rim, along the bar and aslant, there and half way back: stick, slip, mu N."""
    depth, along, sim = 0.03, 0.3, led(RUBS, at=0.35)
    law, k = sim.contact.law, k_of(sim)
    dragged(sim, towards(depth))
    ways = np.concatenate([np.linspace(0.0, along, 400), np.linspace(along, 0.5 * along, 200)[1:]])
    found, entries, pressure = dragged(
        sim, [np.array([GAP + depth, 0.0, 0.0]) + w * np.array(direction) for w in ways]
    )
    # Nothing but the one edge of the film presses: its ends are half a millimetre off.
    normal = k * smoothed(depth - LIP * law.rounding, law.smoothing_depth)
    np.testing.assert_allclose(pressure, normal, rtol=1e-9)
    assert term(sim, "friction").forces.stored == 0.0
    k_t, stretched = TANGENTIAL * k, MU * normal / (TANGENTIAL * k)
    pulls = np.array([-f.wrench[0, :3] @ direction for f in found])
    np.testing.assert_allclose(
        pulls[:400], np.minimum(k_t * ways[:400], MU * normal), rtol=1e-9, atol=1e-9 * normal
    )
    assert pulls[-1] == pytest.approx(-MU * normal, rel=1e-9)
    assert [f.n_slipping for f in found] == [int(abs(p) > MU * normal * (1 - 1e-9)) for p in pulls]
    slip = 1.5 * along - 3.0 * stretched
    # Steps of 0.75 µm: the two in which it begins to slip.
    assert entries["friction_dissipated"] == pytest.approx(MU * normal * slip, rel=2e-3)
    assert entries["friction_work"] == pytest.approx(
        entries["friction_dissipated"] + found[-1].stored, rel=1e-9
    )
    (lifted,), lost, _ = dragged(sim, [np.zeros(3)])
    assert lifted.stored == 0.0
    assert lost["friction_dissipated"] > 0.0


def test_force_and_works_are_those_of_a_plain_twin():
    """The film's edges move at random over a bar that turns; ends in the tool now and then."""
    rng, sim = np.random.default_rng(7), led(RUBS)
    mesh, law = sim.mesh, sim.contact.law
    rim = np.flatnonzero(np.isclose(mesh.nodes[:, 0], mesh.nodes[:, 0].min()))
    rim = rim[np.argsort(mesh.nodes[rim, 1])]
    left = mesh.nodes[rim, 0].min()
    tool = bar().translated((left - GAP, 0.3, 0.0))
    k = k_of(sim)
    edges = {(a, b): RubbedEdge(MU, k, TANGENTIAL * k) for a, b in itertools.pairwise(rim)}
    for to in towards(0.02):
        evaluated(sim, Pose(np.eye(3), to))
    x, pose = sim.state.node.x[: mesh.n_node].copy(), Pose(np.eye(3), towards(0.02)[-1])
    slipped = rubbed = shared = 0
    for _ in range(60):
        a, b, c = rng.normal(size=3) * 2e-3
        turn = np.linalg.qr([[1.0, -c, b], [c, 1.0, -a], [-b, a, 1.0]])[0]
        turn = turn * np.sign(np.diag(turn))
        moved = x + rng.uniform(-1.0, 1.0, x.shape) * [4e-3, 1e-2, 1e-2]
        if rng.random() < 0.4:  # a node in the bar, beside its edge
            moved[rim[2], :2] = left, 0.3 - rng.uniform(0.005, 0.02)
        after = Pose.of(turn, [GAP + rng.uniform(0.01, 0.035), rng.uniform(-0.01, 0.01), 0.0])
        did, forces = evaluated(sim, after, moved)
        wanted, sums = np.zeros_like(x), np.zeros(3)
        for ends, edge in edges.items():
            ends = list(ends)
            on_ends, *energies = edge.step(
                moved[ends], x[ends], (after, pose), tool, (law.rounding, law.smoothing_depth)
            )
            wanted[ends] += on_ends
            sums += energies
            rubbed += energies[0] > 0.0
            slipped += edge.slips
            inside = sim.state.node.contact_depth[ends] > 0.0
            shared += energies[0] > 0.0 and inside.any()
        found, scale = did["edge_friction"], TANGENTIAL * k * 1e-2
        # The search for the place ends at 1e-6 of the edge.
        np.testing.assert_allclose(forces["edge_friction"], wanted, atol=1e-5 * scale)
        np.testing.assert_allclose(
            [found.stored, found.dissipated, found.node_work], sums, atol=1e-7 * scale
        )
        np.testing.assert_allclose(found.wrench[0, :3], -wanted.sum(axis=0), atol=1e-5 * scale)
        moment = np.cross(moved - after.translation, forces["edge_friction"]).sum(axis=0)
        np.testing.assert_allclose(found.wrench[0, 3:], -moment, atol=1e-10 * scale)
        x, pose = moved, after
    assert rubbed > 20
    assert slipped > 10
    assert shared > 3


def test_nodes_and_edges_together_never_rub_more_than_all_that_presses():
    """A bar is dragged along the rim over a node, which meets its faces."""
    sim = pushed(RUBS)
    depth, rubbed, most = 0.04, [], []
    for to in towards(depth):
        evaluated(sim, Pose(np.eye(3), to))
    for y in np.linspace(0.0, 1.5, 750):
        did, forces = evaluated(sim, Pose(np.eye(3), np.array([GAP + depth, y, 0.0])))
        n = sim.state.node
        edges = term(sim, "edges")
        # At nodes and edges together; what edges take from nodes counts once.
        on_nodes = np.linalg.norm(n.contact_force[: n.count], axis=1)
        whole = on_nodes.sum() + edges.carriers.pressure.sum()
        springs = term(sim, "edge_friction").springs
        each = [np.linalg.norm(forces["friction"], axis=1), np.linalg.norm(springs.force, axis=1)]
        assert sum(f.sum() for f in each) <= MU * whole * (1.0 + 1e-12)
        assert (each[1] <= MU * edges.carriers.pressure * (1.0 + 1e-12)).all()
        rubbed.append(-(did["friction"].wrench + did["edge_friction"].wrench)[0, 1])
        most.append(whole)
    rubbed, most = np.array(rubbed), np.array(most)
    # Past the first stretch it slips all the way, whichever holds it: the drag follows mu N. On the
    # bar's faces, at 45 deg, the rim's drag along y is less than what nodes press with.
    late = slice(100, None)
    assert (rubbed[late] > 0.6 * MU * most[late]).all()
    assert most.min() > 0.0


def test_it_counts_in_the_step():
    sim = pushed(RUBS)
    for to in towards(0.03):
        evaluated(sim, Pose(np.eye(3), to))
    # Where nothing is counted that presses at the ends.
    nothing = {"contact": (np.zeros(0, np.int64), np.zeros(0))}
    edges = term(sim, "edges").stiffness(sim.state, nothing)
    rub = term(sim, "edge_friction").stiffness(sim.state, {"edges": edges})
    assert edges[0].size
    # Of wall, slider and spring on the ends of an edge that nothing else presses: at all places.
    steepest, k_t = 27.0 / 16.0, TANGENTIAL
    n_node, alone = sim.state.n_node, term(sim, "edges").stiffness_alone()
    sums = sum(np.bincount(nodes, k, n_node) for nodes, k in (edges, rub)) / k_of(sim)
    n_edge = np.bincount(alone[0], minlength=n_node)
    total = (sums[edges[0]] / n_edge[edges[0]]).min()
    for s in np.linspace(0.0, 1.0, 11):
        shares = np.array([1.0 - s, s])
        across, along = np.append(shares, [0.0, 0.0]), np.append([0.0, 0.0], shares)
        tangent = steepest * np.outer(across, across) + k_t * np.outer(along, along)
        tangent += MU * steepest * np.outer(along, across)
        assert np.linalg.svd(tangent, compute_uv=False)[0] <= total


def test_edges_add_only_what_the_contact_of_their_ends_does_not_bear():
    sim = pushed(RUBS)
    for to in towards(0.03):
        evaluated(sim, Pose(np.eye(3), to))
    edges = term(sim, "edges")
    ends, alone = edges.stiffness_alone()
    whole = np.bincount(ends, alone, sim.state.n_node)
    for share in (0.0, 0.3, 1.0, 5.0):
        counted = {"contact": (np.arange(sim.state.n_node), share * whole)}
        nodes, more = edges.stiffness(sim.state, counted)
        np.testing.assert_array_equal(nodes, np.unique(ends))
        np.testing.assert_allclose(more, np.maximum(1.0 - share, 0.0) * whole[nodes], rtol=1e-12)


# ---------------------------------------------------------------- runs


def test_a_rim_that_is_rubbed_closes_momentum_and_energy():
    sim = pushed(RUBS, direction=(0.6, 0.5, 0.62))
    n, film = sim.state.node, sim.mesh.n_node
    slipped = 0
    while sim.motion.coordinate(sim.state.time) < 0.25:
        sim.step()
        slipped += term(sim, "edge_friction").forces.n_slipping
    rubs = term(sim, "edge_friction")
    force = rubs.springs.force
    wrench = rubs.forces.wrench[0]
    np.testing.assert_allclose(force.sum(axis=0), -wrench[:3], rtol=1e-12)
    nodes, weight = rubs.springs.node, rubs.springs.weight
    at = np.einsum("ia,iac->ic", weight, n.x[nodes]) - sim.pose.translation
    scale = np.abs(np.cross(at, force)).max()
    np.testing.assert_allclose(np.cross(at, force).sum(axis=0), -wrench[3:], atol=1e-12 * scale)
    assert slipped > 50
    assert film == sim.state.n_node
    book = sim.close_ledger()
    assert book.friction_dissipated > 0.02 * book.tool_work
    # Forces' own works beside what they store and dissipate: poses turn by nothing.
    left = book.friction_work - book.friction_dissipated - book.friction_stored
    assert abs(left) < 1e-9 * book.friction_work
    # Discretisation, measured 4e-5: the rim springs out of the plane and swings on by itself.
    assert abs(book.imbalance) < 1e-4 * book.tool_work


@pytest.mark.parametrize("friction", [0.0, 0.2])
def test_same_bits_over_threads_and_a_restart(friction, tmp_path):
    """Teeth that enter a film and cut it; edges press, and rub, for some steps."""

    def opening(**options):
        contact = Contact(film_edges=True, friction=friction)
        return opening_test("quick", contact=contact, **options).simulation

    def go(sim, until):
        while sim.state.step < until:
            sim.step()
        n = sim.state.node
        return n.x[: n.count].copy(), asdict(sim.close_ledger()), sim.dt

    first, rubs = opening(), []
    while len(rubs) < 40:
        first.step()
        if term(first, "edge_friction" if friction else "edges").forces.stored > 0.0:
            rubs.append(first.state.step)
        if len(rubs) == 20:  # within a touch
            save_checkpoint(first, tmp_path / "half.h5")
    assert len(first.state.split_log) > 3
    wanted = go(first, rubs[-1] + 100)
    again = opening()
    load_checkpoint(again, tmp_path / "half.h5")
    for x, ledger, dt in (go(opening(threads=2), rubs[-1] + 100), go(again, rubs[-1] + 100)):
        np.testing.assert_array_equal(x, wanted[0])
        assert (ledger, dt) == wanted[1:]


def test_springs_survive_a_new_list():
    sim = pushed(RUBS)
    for to in towards(0.03):
        evaluated(sim, Pose(np.eye(3), to))
    evaluated(sim, Pose(np.eye(3), np.array([GAP + 0.03, 1e-4, 0.0])))
    kept = term(sim, "edge_friction").springs
    assert kept.slip.any()
    sim.contact.near._known.revision = -1  # the nodes are listed anew
    did, _ = evaluated(sim, Pose(np.eye(3), np.array([GAP + 0.03, 1e-4, 0.0])))
    now = term(sim, "edge_friction").springs
    assert now is not kept
    # Where it presses is found anew, to 1e-9 of the edge.
    np.testing.assert_allclose(now.slip, kept.slip, rtol=0.0, atol=1e-12)
    assert did["edge_friction"].dissipated == pytest.approx(0.0, abs=1e-15)


def test_an_edge_that_leaves_the_list_dissipates_what_its_spring_held():
    sim = pushed(RUBS)
    for to in [*towards(0.03), np.array([GAP + 0.03, 1e-4, 0.0])]:
        did, _ = evaluated(sim, Pose(np.eye(3), to))
    assert did["edge_friction"].stored > 0.0
    held = did["edge_friction"].stored
    did, _ = evaluated(sim, Pose(np.eye(3), np.array([-9.0, 1e-4, 0.0])))
    assert term(sim, "edges").tables.pairs.node.size == 0
    # The last force was across the way that it left by, 9 mm, but for 1e-9 of its place.
    assert did["edge_friction"].dissipated == pytest.approx(held, rel=1e-4)
    assert did["edge_friction"].stored == 0.0


def split(node, twin):
    return SplitRecord(0.0, node, twin, (0.0,) * 3, (0.0,) * 3, "blade", 1.0, 0.0)


def test_the_edge_of_a_twin_goes_on_for_the_one_that_has_split():
    was = np.array([[1, 2], [2, 3], [7, 3]])
    now = np.array([[1, 2], [9, 3], [7, 10], [3, 9]])
    kept = _same_edges(was, now, [split(2, 8), split(8, 9), split(3, 10)])
    np.testing.assert_array_equal(kept, [0, 1, 2, -1])
    # An edge that is still there keeps what is its own.
    np.testing.assert_array_equal(_same_edges(was, was, [split(2, 8)]), [0, 1, 2])
    both = np.array([[1, 2], [1, 8]])
    np.testing.assert_array_equal(_same_edges(was, both, [split(2, 8)]), [0, -1])


def test_without_friction_or_film_edges_there_is_no_such_term():
    for contact in (Contact(film_edges=True), Contact(friction=0.2)):
        sim = cutting(contact=contact)
        assert "edge_friction" not in [t.name for t in sim.terms]
    names = [t.name for t in cutting(contact=Contact(film_edges=True, friction=0.2)).terms]
    assert names[-3:] == ["edges", "edge_friction", "joints"]
