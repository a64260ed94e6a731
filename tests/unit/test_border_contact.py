"""Places on edges of the film against the tool."""

from itertools import pairwise

import numpy as np
import pytest

from film_and_bar import ON, bar, flat_bar, pushed, round_bar
from free_strip import cut_strip
from naive.border_contact import depth_at, forces_on_ends
from naive.shell import shape
from notched_strip import cutting
from shellcut.contact.film_outline import FilmOutline, border_segments
from shellcut.contact.settings import STEEPEST, Contact
from shellcut.material.shell_material import ShellMaterial
from shellcut.mesh.structured import rectangle
from shellcut.models import opening_test
from shellcut.recording.unfelt_penetration import UnfeltPenetration
from shellcut.simulation.simulation import Simulation
from shellcut.tool.motion import StraightMotion
from shellcut.tool.pose import Pose

FAR = np.array([50.0, 0.0, 0.0])


def term(sim):
    return next(t for t in sim.terms if t.name == "edges")


def one_quad(corners):
    """A film of one quad anywhere near a bar that rests; the simulation, not stepped."""
    mesh = rectangle(1.0, 1.0, n_x=1, n_y=1)
    sim = Simulation(
        mesh,
        ShellMaterial.homogeneous(),
        tool=bar().translated(FAR),
        motion=StraightMotion((1.0, 0.0, 0.0), speed=1.0),
        contact=ON,
    )
    sim.corners = mesh.quads[0]
    place(sim, corners)
    return sim


def place(sim, corners):
    sim.state.node.x[sim.corners] = corners


def evaluated(sim):
    """Evaluate both contacts with the bar at its own place.

    Returns the forces on the corners, of the edges and of both, and what both terms did.
    """
    s = sim.state
    pose = Pose(np.eye(3), -FAR)
    # Whatever it was before is forgotten; it was deeper, so that no growth is a jump.
    s.node.contact_depth[:], s.node.contact_offset[:] = 1e3, 0.0
    s.node.contact_side[:] = 0
    sim.contact.near._age._known.revision = -1
    sim.contact._pose = term(sim)._pose = pose
    s.node.force[:] = 0.0
    sim.contact.add_forces(s, pose)
    alone = s.node.force[sim.corners].copy()
    term(sim)._renew(s, pose)
    term(sim).tables.table.memory.depth[:] = 1e3
    term(sim).add_forces(s, pose)
    both = s.node.force[sim.corners].copy()
    return both - alone, both, (sim.contact.forces, term(sim).forces)


def quad_with(a, b, inward=(1.0, 0.0, 0.0)):
    a, b = np.array(a, float), np.array(b, float)
    return np.array([a, b, b + inward, a + inward])


def beside_the_edge(x=-0.05):
    """A quad whose edge lies across the bar's edge, ``-x`` deep."""
    return quad_with((x, -0.4, 0.0), (x, 0.6, 0.0))


def random_quads(rng, n):
    """Quads around the bar's edge at the origin and its corner at the upper end, edges across."""
    for k in range(n):
        height = 0.0 if k % 3 else 1.5 + rng.uniform(-0.06, 0.02)
        along = rng.normal(size=3)
        along[0] *= 0.3
        along /= np.linalg.norm(along)
        middle = np.array([-rng.uniform(0.0, 0.06), rng.uniform(-0.02, 0.02), height])
        s = rng.uniform(0.15, 0.85)
        a, b = middle - s * along, middle + (1.0 - s) * along
        yield quad_with(a, b, [1.0, 0.0, 0.0] + 0.3 * rng.normal(size=3))


def test_forces_and_energy_are_those_of_a_plain_twin():
    rng = np.random.default_rng(4)
    sim = one_quad(beside_the_edge())
    # Of a corner of a quad of 1 mm²; an eighth of the bar's volume over its surface, which is less
    # than a quarter of the film's thickness; places less than a sixteenth of the edge apart, by
    # round-off, and edges of the tool so round that it cannot pass between two of them.
    k, depth, spacing = 1e4 * 0.25, 0.125 * 1.08 / 7.92, 1.0 / 16.0 - 1e-12
    pressed = 0
    for corners in random_quads(rng, 30):
        place(sim, corners)
        force, _, (_, found) = evaluated(sim)
        wanted, energy = np.zeros((4, 3)), 0.0
        for i in range(4):
            ends = [i, (i + 1) % 4]
            # Two edges end at each corner: an edge takes all that both ends have, half from each.
            on_ends, stored = forces_on_ends(
                *corners[ends], 1.0, spacing, bar(), spacing / 1.1, k, depth
            )
            wanted[ends] += on_ends
            energy += stored
        np.testing.assert_allclose(force, wanted, atol=1e-9 * k * depth)
        np.testing.assert_allclose(found.stored, energy, atol=1e-12)
        pressed += energy > 0.0
    assert pressed > 12


def test_what_counts_in_the_step_bounds_the_tangent_of_nodes_and_edges():
    rng = np.random.default_rng(7)
    sim = one_quad(beside_the_edge())
    eps, shares = 1e-6, []
    for corners in random_quads(rng, 60):
        place(sim, corners)
        _, pressed, (_, found) = evaluated(sim)
        if found.stored == 0.0:
            continue
        held = {"contact": sim.contact.stiffness(sim.state, {})}
        held["edges"] = term(sim).stiffness(sim.state, held)
        k = sum(np.bincount(nodes, some, sim.state.n_node) for nodes, some in held.values())
        for moved in (pressed / np.abs(pressed).max(), *rng.normal(size=(8, *corners.shape))):
            forces = []
            for sign in (1.0, -1.0):
                place(sim, corners + sign * eps * moved)
                forces.append(evaluated(sim)[1])
            tangent = -((forces[0] - forces[1]) * moved).sum() / (2.0 * eps)
            shares.append(tangent / (k[sim.corners] * (moved**2).sum(axis=1)).sum())
    assert 0.05 < max(shares) < 1.0


def test_edges_add_nothing_to_the_step_where_their_nodes_count():
    sim = one_quad(quad_with((-0.02, -0.4, 0.0), (-0.02, 0.6, 0.0), inward=(3.0, 0.0, 0.0)))
    evaluated(sim)
    nodes = sim.corners
    k = STEEPEST * float(sim.contact.law.of_nodes(sim.state.node.contact_area[0]))
    added = term(sim).stiffness(sim.state, {"contact": (nodes, np.full(4, k))})
    assert added[0].size == 0
    # Where an end does not count, it has half of each of its two edges: all that a node has. The
    # edge at the far side is not near, and those that lead there are.
    added = term(sim).stiffness(sim.state, {"contact": (nodes[:1], np.full(1, k))})
    near = dict(zip(*(rows.tolist() for rows in added), strict=True))
    assert near == pytest.approx(dict(zip(nodes[1:].tolist(), (k, 0.5 * k, 0.5 * k), strict=True)))


PATHS = {
    # The bar's edge from the middle of the film's over its end.
    "along the film's edge": lambda s: ((-0.06, -0.5 - 0.7 * s, 0.1), (-0.06, 0.5 - 0.7 * s, -0.1)),
    # Turned until it lies on a face.
    "onto a face": lambda s: ((-0.03 - 0.8 * s, -0.8, 0.1), (-0.03 + 0.2 * s, 0.2, 0.0)),
    # Along the bar and off its end.
    "off a corner": lambda s: ((-0.06, -0.4, 1.3 + 0.3 * s), (-0.06, 0.6, 1.3 + 0.3 * s)),
}


@pytest.mark.parametrize("name", PATHS)
def test_the_force_does_not_jump(name):
    sim = one_quad(quad_with(*PATHS[name](0.0)))
    k = float(sim.contact.law.of_nodes(sim.state.node.contact_area[0]))
    last, worst, most = None, 0.0, 0.0
    for s in np.linspace(0.0, 1.0, 200):
        corners = quad_with(*PATHS[name](s))
        place(sim, corners)
        _, both, (_, found) = evaluated(sim)
        total = np.concatenate([both.sum(axis=0), np.cross(corners, both).sum(axis=0)])
        if last is not None:
            way = np.abs(corners - last[0]).max()
            worst = max(worst, np.abs(total - last[1]).max() / (k * way))
        last, most = (corners, total), max(most, found.stored)
    assert most > 0.0
    # Steepest slope of f 27/16, moments with arms of less than 2 mm. A jump would be hundreds.
    assert worst < 3.0


def test_an_edge_does_not_press_inside_the_tool():
    sim = one_quad(beside_the_edge())
    evaluated(sim)
    t, memory = term(sim), term(sim).tables.table.memory
    memory.depth[:], memory.offset[:] = 0.0, 0.0  # as if they had just been made
    sim.state.node.force[:] = 0.0
    t.add_forces(sim.state, t._pose)
    assert t.forces.stored == 0.0
    assert not sim.state.node.force.any()
    # What they part by goes from the offset, and presses when they come back.
    for x, pressing in ((-0.03, False), (-0.045, True)):
        place(sim, beside_the_edge(x))
        sim.contact.clock.walked[:] += 1.0
        sim.state.node.velocity_half[:] = 1e9  # it came there by motion
        sim.state.dt = 1e-9
        t.add_forces(sim.state, t._pose)
        assert (t.forces.stored > 0.0) == pressing


def test_an_edge_inside_keeps_its_side_and_does_not_press_across_the_tool():
    sim = one_quad(beside_the_edge())
    _, _, (_, found) = evaluated(sim)
    assert found.stored > 0.0
    t, side = term(sim), sim.state.node.contact_side
    memory = t.tables.table.memory
    inside = memory.depth > 0.0
    for had in (-1, 1):
        for ends, wanted in (((0, 0), had), ((had, 0), had), ((0, -had), -had)):
            memory.side[inside] = had
            side[sim.corners[:2]] = ends
            t.add_forces(sim.state, t._pose)
            assert (memory.side[inside] == wanted).all()
    side[sim.corners[:2]] = 1, -1
    t.add_forces(sim.state, t._pose)
    assert t.forces.stored == 0.0


@pytest.mark.parametrize("on", [False, True])
def test_a_rim_pushed_between_nodes_is_felt(on):
    sim = pushed(Contact(film_edges=on))
    while sim.motion.coordinate(sim.state.time) < 0.15:
        sim.step()
    n, thickness = sim.state.node, sim.material.thickness
    rim = np.flatnonzero(np.isclose(n.X[:25, 0], n.X[:25, 0].min()))
    rim = rim[np.argsort(n.X[rim, 1])]
    a, b = n.x[rim[2]], n.x[rim[3]]
    s = (0.3 - a[1]) / (b[1] - a[1])
    edge = sim.pose.to_space(sim.tool.vertices)[:, 0].max()
    deep = edge - ((1.0 - s) * a + s * b)[0]
    unfelt, book = UnfeltPenetration(sim).now().film_edges, sim.close_ledger()
    if on:
        assert deep < thickness
        assert sum(t.forces.wrench[0, 0] for t in sim.terms) < -5.0
        # It gives back all that it takes, and the works of both sides are booked, to 3e-6 and
        # 6e-8; a quarter of that with half the step, so this is the time integration's error.
        assert book.contact_work == pytest.approx(book.contact_stored, rel=1e-5)
        assert abs(book.imbalance) < 1e-6 * book.tool_work
        # Between places depths are interpolated: 0.095 of the thickness, whatever the step.
        assert unfelt < 0.1 * thickness
        return
    assert deep > 0.13
    assert book.tool_work == 0.0  # it goes through the rim, and nothing feels it
    r, ends = sim.contact.law.rounding, sim.pose.to_body(n.x[rim])
    shares = [k / 16 for k in range(1, 16)]
    places = [(1.0 - t) * p + t * q for p, q in pairwise(ends) for t in shares]
    depths = [depth_at(p, sim.tool, r)[0] for p in places]
    assert unfelt == pytest.approx(max(depths), rel=1e-12)  # the same, but for round-off
    assert unfelt > 0.5 * thickness


@pytest.mark.parametrize(("tool", "at"), [(round_bar, 0.5), (flat_bar, 0.3)], ids=["round", "flat"])
def test_bars_are_felt_between_nodes(tool, at):
    sim = pushed(at=at, tool=tool())
    measured, unfelt = UnfeltPenetration(sim), 0.0
    while sim.motion.coordinate(sim.state.time) < 0.06:
        sim.step()
        if sim.state.step % 20 == 0:
            unfelt = max(unfelt, measured.now().film_edges)
    assert unfelt < 0.1 * sim.material.thickness
    assert abs(sim.close_ledger().imbalance) < 1e-5 * sim.ledger.tool_work


def test_waiting_misses_nothing():
    waits, looks = (pushed(direction=(0.8, 0.6, 0.0)) for _ in range(2))
    waited = 0
    while waits.motion.coordinate(waits.state.time) < 0.1:
        for t in (looks.contact, term(looks)):
            if t.tables is not None:
                t.tables.table.queries.until[:] = 0.0
                t.tables.table.queries.free[:] = 0.0
        waits.step()
        looks.step()
        table = term(waits).tables.table
        waited += int((table.queries.until > table.clock.walked[0]).sum())
        for mine, other in zip(term(waits).forces[1:4], term(looks).forces[1:4], strict=True):
            assert mine == pytest.approx(other, rel=1e-6, abs=1e-9)
    assert waited > waits.state.step
    np.testing.assert_allclose(waits.state.node.x, looks.state.node.x, atol=1e-10)


def test_places_of_a_new_list_keep_their_memory_and_count_at_once():
    sim = pushed()
    edges = term(sim)
    while edges.forces.stored == 0.0 or sim.motion.coordinate(sim.state.time) < 0.05:
        sim.step()
    before, searched, stored = edges.tables.table.memory, edges.n_search, edges.forces.stored
    sim.contact.near._age._known.revision = -1
    sim.step()
    assert edges.n_search == searched + 1
    assert edges.tables.table.memory is not before
    assert edges.forces.stored == pytest.approx(stored, rel=0.2)


def ends_by_place(state, outline):
    """Places of both ends of all open edges, by the rows' polygons; where nodes or points are."""
    found, flank = [], state.flank
    tied_to = [set(nodes[w > 1e-9]) for nodes, w in zip(flank.nodes, flank.weight, strict=True)]
    parted = np.array([tied_to[k] != tied_to[flank.twin[k]] for k in range(flank.count)], bool)
    of_row = flank.row[: flank.count]
    for row in range(state.n_quad):
        n = outline.n_edge[row]
        points = outline.point[row, :n]
        x = [shape(*point)[0] @ state.node.x[state.quads[row]] for point in points]
        # Where a crack starts its flanks have not parted, and nothing is touched.
        tied = flank.place[: flank.count][(of_row == row) & parted]
        there = [(abs(p) == 1).all() or np.isin(p, tied).all() for p in points]
        for k in range(n):
            if outline.open[row, k] and not outline.absent[row]:
                found += [(x[k], x[(k + 1) % n])] * int(there[k] and there[(k + 1) % n])
    return np.array(found)


@pytest.mark.parametrize("path", ["edges", "free"])
def test_open_edges_are_those_of_rim_and_flanks(path):
    sim = cut_strip(contact=ON, notched=False) if path == "free" else cutting(contact=ON)
    while sim.state.n_cable < 6:
        sim.step()
    s = sim.state
    outline = FilmOutline(sim.cracks.cuts.topology.polygon).of(s)
    edges = border_segments(s, outline, sim.contact.law)
    ends = edges.node
    np.testing.assert_allclose(s.node.x[ends], ends_by_place(s, outline), atol=1e-12)
    # Where two edges of a flank meet they share the node.
    flanks = ends[s.node.halved[ends].any(axis=1)]
    assert np.unique(flanks).size < 0.8 * flanks.size
    # What edges take, nodes give up: together they have what nodes have alone.
    n = s.node
    own = n.contact_share[: n.count] * sim.contact.law.of_nodes(n.contact_area[: n.count])
    taken = np.bincount(ends.ravel(), np.repeat(0.5 * edges.stiffness, 2), n.count)
    np.testing.assert_allclose(edges.left + taken, own, rtol=1e-12)
    assert (np.diff(edges.key) > 0).all()


@pytest.mark.parametrize(("on", "present"), [(None, True), (False, False)])
def test_the_opening_has_it_unless_told_otherwise(on, present):
    sim = opening_test("quick", angle_deg=5.0, contact=Contact(film_edges=on)).simulation
    assert any(t.name == "edges" for t in sim.terms) == present
