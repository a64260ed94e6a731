"""The kernels of cracks through quads find what their plain references find, tip by tip."""

from contextlib import suppress
from itertools import pairwise

import numpy as np
import pytest

import shellcut as sc
from films import shaken
from free_strip import cut_strip, notched_sheet, path_in, segment_ahead, slanted_strip
from naive import blade_drive, crack_path, trial_cut
from round_tools import wheel
from shellcut.fracture.blade_drive import BladeDrive
from shellcut.fracture.entered_film import EnteredFilm, parts_quad
from shellcut.fracture.quad_polygon import WHOLE
from shellcut.fracture.ray_ahead import Aimed
from shellcut.fracture.rows_ahead import table_of
from shellcut.fracture.tip import Tip
from shellcut.fracture.tip_watch import TipWatch
from shellcut.fracture.trial_cut import TrialCut, TrialSums
from shellcut.mesh.structured import rectangle
from shellcut.tool.cutting_edge import CuttingEdges
from shellcut.tool.pose import Pose


class Rules:
    """The rules as plain code, and the watch, for the tips of a simulation."""

    def __init__(self, sim):
        self.sim, self.topology = sim, sim.cracks.cuts.topology
        self.path = path_in(sim)
        self.film = trial_cut.Film(self.topology, sim.shell, sim.loads, sim.law.strength)
        self.watch = TipWatch(
            self.path, trial_of(sim), BladeDrive(CuttingEdges.of(sim.tool), sim.motion)
        )

    def plain(self, tip, tips):
        """Return segment and measures of a tip, None without, and from which on it is due."""
        state, tool, motion = self.sim.state, self.sim.tool, self.sim.motion
        at, heading = crack_path.place_of(self.path, state, tip)
        edge, passed, speed = blade_drive.nearest_edge(tool, motion, at.x, at.size, state.time)
        if edge < 0:
            ways, lean = [heading - (heading @ at.t) * at.t], np.zeros(3)
        else:
            known = motion, at.x, at.size, edge, state.time, speed
            off, edge, then = blade_drive.beyond(tool, *known)
            ways, lean = blade_drive.directions(tool, motion, edge, off, at, heading, then)
        found = (crack_path.segment_from(self.path, state, tip, way, lean, tips) for way in ways)
        segment = next((one for one in found if one is not None), None)
        measures = segment and trial_cut.measures(self.film, state, tip, segment)
        return segment, measures, np.inf if edge < 0 else -np.inf if passed else 1.0

    def compare(self, tips):
        """Assert that the watch finds the same; return how many segments there are."""
        state = self.sim.state
        tips = self.watch.alive(state, tips)
        if not tips:
            return []
        due = self.watch.due(state, tips).copy()
        kinds = []
        for i, tip in enumerate(tips):
            segment, measures, limit = self.plain(tip, tips)
            mine = self.watch.segment(i)
            if segment is None:
                assert mine is None
                assert not due[i]
                continue
            assert mine.row == segment.row
            assert mine.along_side == segment.along_side
            assert (mine.corner, mine.side) == (segment.corner, segment.side)
            np.testing.assert_allclose(mine.entry, segment.entry, atol=1e-12)
            np.testing.assert_allclose(mine.exit, segment.exit, atol=1e-9)
            found = self.watch.weighed.measure[i], self.watch.weighed.magnitude[i]
            np.testing.assert_allclose(found, measures, rtol=1e-9, atol=1e-12)
            assert due[i] == (measures[0] >= limit)
            right, _ = trial_cut.shares(self.film, state, segment)
            assert mine.right == pytest.approx(right, rel=1e-9)  # round-off
            kinds.append((segment.corner >= 0, segment.along_side, segment.side < 0))
        return kinds


def jittered(seed):
    return shaken(rectangle(6.0, 3.2, n_x=15, n_y=8), 0.1, seed)


@pytest.mark.parametrize(
    "mesh", [slanted_strip(), jittered(1), jittered(2), slanted_strip(0.0)], ids="abcd"
)
def test_same_segments_and_measures_as_the_rules(mesh):
    sim = cut_strip(mesh=mesh)
    rules, free, kinds = Rules(sim), sim.cracks, []
    while len(sim.state.split_log) < 16 and sim.state.step < 4000:
        sim.step()
        if sim.state.step % 25 == 4:
            kinds += rules.compare(free.tips)
    assert len(kinds) > 20


def test_same_beside_other_cracks():
    # The notch ends among cracks across its way: sides with crossings, copies, flanks ahead.
    rng = np.random.default_rng(4)
    kinds = []
    for turn in range(4):
        sim = cut_strip(mesh=jittered(10 + turn))
        free = sim.cracks
        for x in rng.uniform(1.0, 1.8, 3):
            slant = rng.uniform(-0.4, 0.4)
            with suppress(ValueError):  # it begins where another has left no film
                sim.notch((x - slant, -2.0, 0.0), (x + slant, rng.uniform(0.0, 1.2), 0.0))
        rules = Rules(sim)
        for _ in range(60):
            sim.step()
            kinds += rules.compare(free.tips) if sim.state.step % 10 == 4 else []
    assert len(kinds) > 20


def test_each_of_several_crossings_of_one_side_is_met():
    """Three cracks through the quad above end on its lower side; a tip below is aimed at it."""
    sim = cut_strip(mesh=rectangle(6.0, 3.2, n_x=15, n_y=8), notched=False)
    path, X, shares = Rules(sim).path, sim.mesh.nodes, [0.2, 0.5, 0.8]
    corners = (2.0, 0.0), (2.4, 0.0), (2.0, -0.4), (2.4, -0.4)
    nodes = (int(np.hypot(X[:, 0] - x, X[:, 1] - y).argmin()) for x, y in corners)
    left, right, far_left, far_right = nodes
    rings = sim.mesh.quads.tolist()
    (above,) = (q for q, ring in enumerate(rings) if ring[:2] == [left, right])
    for share in shares:
        at = 2.0 * share - 1.0
        path.film.topology.cut(above, (at, -1.0), (at, 1.0))  # the row keeps what is to the right
    assert sorted(path.film.topology.crossings(left, right)) == pytest.approx(shares)
    (under,) = (q for q, ring in enumerate(rings) if ring[2:] == [far_right, far_left])
    ends = min(far_left, far_right), max(far_left, far_right)
    tip, met = Tip(ends, 0.5, under, np.array([0.0, 1.0, 0.0])), set()
    for share in np.linspace(0.06, 0.94, 23):
        way = np.array([0.4 * (share - 0.5), 0.4, 0.0])
        mine = path.segment_from(sim.state, tip, way)
        plain = crack_path.segment_from(path, sim.state, tip, way)
        assert (mine.row, mine.side, mine.corner) == (plain.row, plain.side, plain.corner)
        np.testing.assert_allclose(mine.exit, plain.exit, atol=1e-9)
        met |= {k for k, one in enumerate(shares) if abs(0.5 + 0.5 * mine.exit[0] - one) < 1e-6}
    assert met == {0, 1, 2}


@pytest.mark.parametrize("broken", [False, True])
def test_same_along_sides_and_where_they_are_broken(broken):
    sim = cut_strip(mesh=slanted_strip(0.0))
    rules, X = Rules(sim), sim.mesh.nodes
    line = np.flatnonzero(np.abs(X[:, 1]) < 1e-9)
    line = line[np.argsort(X[line, 0])].tolist()
    if broken:
        for a, b in pairwise(line):
            rules.topology.break_side(a, b)
    heading = np.array([1.0, 0.0, 0.0])
    tips = [Tip((n, n), 0.0, -1, heading) for n in line[3:10]]
    kinds = rules.compare(tips)
    assert any(along for _, along, _ in kinds) != broken


def test_a_tip_that_an_edge_cannot_lead_on_is_asked_whether_it_tears():
    # At nodes before the blade, of cracks across its way: some are led back out of what they face.
    sim = cut_strip(mesh=jittered(3))
    path, X = Rules(sim).path, sim.mesh.nodes
    drive = BladeDrive(CuttingEdges.of(sim.tool), sim.motion)
    watch = TipWatch(path, trial_of(sim), drive)
    near = np.flatnonzero((X[:, 0] > 0.5) & (X[:, 0] < 5.0) & (np.abs(X[:, 1]) < 0.9)).tolist()
    ways = np.array([[0.0, sign, 0.0] for sign in (-1.0, 1.0)])
    tips = watch.alive(sim.state, [Tip((n, n), 0.0, -1, way) for n in near for way in ways])
    watch.due(sim.state, tips)
    driven = drive.driven.edge_of >= 0
    lost = {id(t) for i, t in enumerate(tips) if driven[i] and watch.segment(i) is None}
    assert lost
    assert {id(tip) for tip in watch.may_tear(0)} >= lost
    assert not {id(tip) for tip in watch.may_tear(1)} & lost


def test_chords_part_whole_quads_as_the_rules_say():
    sim, rng, said = cut_strip(mesh=jittered(3)), np.random.default_rng(8), []
    s, path = sim.state, Rules(sim).path
    at_flank = s.node.halved[s.quads].any(axis=1)
    whole = np.flatnonzero((s.quad.share[: s.n_quad] == 1.0) & ~at_flank)
    quad, chord = table_of(s, path.film, [(int(whole[0]), (0.0, 0.0))], [()]), Aimed.of(2)
    s.node.x[: s.n_node, 2] = 0.1 * np.sin(s.node.x[: s.n_node, 0])
    for _ in range(1000):
        row = int(rng.choice(whole))
        place = tuple(np.clip(rng.uniform(-1.03, 1.03, 2), -0.999, 0.999).tolist())
        angle = rng.choice([0.0, 0.5 * np.pi, rng.uniform(0.0, np.pi)]) + rng.normal() * 0.02
        b = np.array([np.cos(angle), np.sin(angle), rng.uniform(-0.2, 0.2)])
        normal, size = tuple(b.tolist()), path.film.size(row)
        mine = parts_quad(quad, chord, s.node.x, s.node.t, s.quads, row, *place, normal, size)
        t = crack_path.shape_functions(place) @ s.node.t[s.quads[row]]
        trace = np.cross(t, b) / np.linalg.norm(np.cross(t, b))
        ends = [crack_path.segment(path, s, row, place, sign * trace) for sign in (-1.0, 1.0)]
        rules = None not in ends and (
            crack_path.common_side(WHOLE, *(end.exit for end in ends)) is None
            or (min(end.corner for end in ends) >= 0 and ends[0].corner != ends[1].corner)
        )
        assert mine == rules
        said.append(rules)
    assert 70 < sum(said) < 995


def test_a_tip_before_a_vertex_of_a_bulging_edge_is_driven():
    z = np.linspace(-2.0, 2.0, 5)
    nose = np.stack([0.05 * z**2, 0.0 * z, z], axis=1)  # turns by 6 degrees at its vertices
    backs = [nose * [0.0, 1.0, 1.0] + [3.0, side, 0.0] for side in (0.5, -0.5)]
    triangles = [(0, 5, 10), (4, 14, 9)]
    for a, b in ((0, 5), (5, 10), (10, 0)):
        for k in range(4):
            triangles += [(b + k, a + k, b + k + 1), (b + k + 1, a + k, a + k + 1)]
    corners = np.concatenate([nose, *backs])
    tool = sc.Tool.from_triangles(corners, triangles, edges=[(k + 1, k) for k in range(4)])
    drive = BladeDrive(CuttingEdges.of(tool), sc.StraightMotion((-1.0, 0.0, 0.0), 1.0))
    places = np.array([[-1.0, 0.0, h] for h in (-1.5, -1.0, 0.0, 0.3, 1.0, 2.5)])
    found = drive.find(places, np.full(len(places), 0.5), 0.0).edge_of
    assert (found[:-1] >= 0).all()
    assert found[-1] < 0  # beside the end of the edge nothing drives it


@pytest.mark.parametrize("degrees", [0.0, 20.0, 45.0])
def test_an_edge_drives_the_tips_that_it_will_meet(degrees):
    # The blade points along x and moves obliquely: what lies before its mid-plane it passes by.
    way = np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees)), 0.0])
    tool = sc.tool_shapes.straight_blade(length=3.0, height=4.0)
    drive = BladeDrive(CuttingEdges.of(tool), sc.StraightMotion(tuple(way), 1.0))
    ahead = np.array([0.2, 0.7, 1.9])
    places = np.concatenate([ahead[:, None] * way, ahead[:, None] * [1.0, 0.0, 0.0]])
    found = drive.find(places, np.full(6, 0.1), 0.0).edge_of >= 0
    assert found[:3].all()
    assert found[3:].tolist() == (ahead * np.tan(np.radians(degrees)) <= 0.05).tolist()
    # Tips farther ahead than twenty edges are not its own yet.
    places = np.array([1.99, 2.01])[:, None] * way / way[0]
    found = drive.find(places, np.full(2, 0.1), 0.0).edge_of >= 0
    assert found.tolist() == [True, False]


@pytest.mark.parametrize("arc", [96, 30])
@pytest.mark.parametrize("spin", [0.0, 1.0, -1.0, 3.0, -6.0, 8.0])
def test_a_round_edge_drives_what_it_will_meet_however_it_turns(spin, arc):
    # It moves along x, the axis along y; places near the plane y = 0 before a part of the rim.
    points, triangles = wheel()
    edges = [(k, (k + 1) % 96) for k in range(arc)]
    tool = sc.Tool.from_triangles(points, triangles, edges=edges)
    time = np.linspace(0.0, 1.0, 41)
    turns = np.outer(spin * time, [0.0, 1.0 / 5.0, 0.0])
    motion = sc.TableMotion(time, np.outer(time, [1.0, 0.0, 0.0]), turns)
    drive, rng, size, now = (
        BladeDrive(CuttingEdges.of(tool), motion),
        np.random.default_rng(6),
        0.3,
        0.5,
    )
    places = rng.uniform([3.5, -0.3, -3.0], [9.0, 0.3, 3.0], (80, 3))
    found = drive.find(places, np.full(80, size), now)
    plain = [blade_drive.nearest_edge(tool, motion, x, size, now) for x in places]
    assert (found.edge_of >= 0).tolist() == [edge >= 0 for edge, _, _ in plain]
    for i in np.flatnonzero(found.edge_of >= 0).tolist():
        edge, _, speed = plain[i]
        off, there, _ = blade_drive.beyond(tool, motion, places[i], size, edge, now, speed)
        assert found.edge_of[i] == there
        assert found.off[i] == pytest.approx(off, abs=1e-9)
    if arc == 96:
        ahead = np.hypot(places[:, 0] - 0.5, places[:, 2]) > 5.0
        near = np.abs(places[:, 1]) <= 0.5 * size
        assert (found.edge_of >= 0)[ahead].tolist() == near[ahead].tolist()
    assert (found.edge_of >= 0).any()


def test_teeth_on_a_screw_drive_the_tips_on_their_circle():
    tool, motion = sc.tool_shapes.tooth_ring(), sc.ScrewMotion(300.0, pitch=12.0)
    drive, rng, size = BladeDrive(CuttingEdges.of(tool), motion), np.random.default_rng(3), 0.2
    radius, angle = rng.uniform(9.1, 9.7, 60), rng.uniform(-0.5, 0.5, 60)
    places = np.stack([radius * np.cos(angle), radius * np.sin(angle), rng.uniform(0, 4, 60)], 1)
    found = drive.find(places, np.full(60, size), 0.0)
    plain = [blade_drive.nearest_edge(tool, motion, x, size, 0.0)[:2] for x in places]
    assert list(zip(found.edge_of.tolist(), found.passed.tolist(), strict=True)) == plain
    assert 5 < sum(edge >= 0 for edge, _ in plain) < 55


def through(a, b, corners):
    """Return xi, eta where the line from a to b goes through a quad, split into two triangles."""
    square = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
    for triangle in ((0, 1, 2), (0, 2, 3)):
        p, place = corners[list(triangle)], square[list(triangle)]
        u, v, along = np.linalg.solve(np.column_stack([*(p[1:] - p[0]), a - b]), a - p[0])
        if min(u, v, 1.0 - u - v) >= -1e-9 and -1e-9 <= along <= 1.0 + 1e-9:
            return place[0] + u * (place[1] - place[0]) + v * (place[2] - place[0])
    raise AssertionError("the line passes the quad by")


def test_list_of_near_rows_never_changes_what_is_pierced():
    """The blade goes through film that nothing cuts and whose nodes wander."""
    sim, rng, found = cut_strip(), np.random.default_rng(2), 0
    s, n, path = sim.state, sim.state.node, Rules(sim).path
    edges = CuttingEdges.of(sim.tool)

    def fresh():
        chain = sim.tool.edge_chain
        return EnteredFilm(s, path.film, sim.shell, edges, chain, everywhere=True)

    kept = fresh()
    dt = 2.6e-4 / 450
    for step in range(450):
        if step % 15 == 0:
            n.velocity_half[: n.count] = rng.uniform(-0.02, 0.02, (n.count, 3)) / (15 * dt)
        n.x[: n.count] += n.velocity_half[: n.count] * dt
        s.step, s.time = step, step * dt
        pose = Pose.of(*sim.motion.pose(s.time))
        rows = kept.entered_rows(s, pose)
        if step % 5 == 0:
            again = fresh().entered_rows(s, pose)
            assert rows == again
            found += len(rows)
            a, b = pose.to_space(sim.tool.vertices[sim.tool.edges[0]])
            for begun in rows:
                place = through(a, b, n.x[s.quads[begun.row]])
                np.testing.assert_allclose(begun.place, place, atol=1e-9)
    assert 3 < kept._near.n_search < 150
    assert found > 10


# --- the nodal force of a trial cut under a uniform stress: the stress times the length it opens


STRETCH = 0.004


def trial_of(sim):
    return TrialCut(sim.cracks.cuts.topology, sim.shell, sim.loads, sim.law.strength)


def measures_of(sim, tip, segment):
    """Return the force across the segment, by the plain reference, and that of a tear."""
    film = trial_cut.Film(sim.cracks.cuts.topology, sim.shell, sim.loads, sim.law.strength)
    return (
        trial_cut.measures(film, sim.state, tip, segment)[0],
        TrialSums(trial_of(sim)).of_tear(sim.state, tip, segment),
    )


@pytest.mark.parametrize("rise", [0.1, 0.5, 0.9])
def test_uniform_stress_is_found_wherever_in_the_quads_the_crack_runs(rise):
    """The crack runs along rows of equal quads, ``rise`` of an edge above the row's lower side."""
    sim = notched_sheet(rise)
    tip, segment = segment_ahead(sim)
    n = sim.state.node
    n.x[: n.count, 1] = (1.0 + STRETCH) * n.X[: n.count, 1]  # the notch's flanks stay closed
    # First Piola-Kirchhoff stress: force over reference length and thickness.
    strain = STRETCH + 0.5 * STRETCH**2
    stress = (1.0 + STRETCH) * 1678.0 / (1.0 - 0.3**2) * strain
    # Round-off of the products of the quads' strains with their stiffness.
    for found in measures_of(sim, tip, segment):
        # The notch, which no cable holds, opens with the segment ahead: twice its length.
        assert found == pytest.approx(2.0 * stress / sim.law.strength, rel=1e-9)
    assert np.isclose(tip.s, rise) or np.isclose(1.0 - tip.s, rise)


def test_a_tear_counts_the_force_across_the_sheet_and_pressure_only_against_what_opens_it():
    """A trial cut of a sheet at rest, with forces on the flanks given by its quads' strains."""
    sim = notched_sheet(0.2)
    tip, segment = segment_ahead(sim)
    n, quads, parent = sim.state.node, sim.state.quads, sim.state.quad.parent
    # Corners of the upper copy behind the tip that no other part of the film has.
    ((_, (lower, upper)), *_) = trial_of(sim).pairs(sim.state, segment)
    behind = next((a, b) for a in lower.rows for b in upper.rows if a < b and parent[b] == a)
    raised = np.setdiff1d(quads[behind[1]], [*quads[behind[0]], *quads[segment.row]])

    def measures(stretch, shear, opened=0.0):
        n.x[: n.count] = n.X[: n.count]
        n.x[: n.count, 1] *= 1.0 + stretch
        n.x[: n.count, 2] += shear * n.X[: n.count, 1]
        n.x[raised, 2] += opened
        return measures_of(sim, tip, segment)

    plain, tear = measures(0.002, 0.0)
    assert tear == pytest.approx(plain, rel=1e-9)  # round-off
    plain, tear = measures(0.002, 0.001)  # directors stay upright: the sheet is sheared
    shear = 5.0 / 6.0 * 1678.0 / 2.6 * 0.001
    across = 2.0 * shear * 1.002 / sc.CohesiveLaw().strength  # with the notch behind the tip
    # Kinematics: forces by the small shear in space, of the relative size of the strains.
    assert np.sqrt(tear**2 - plain**2) == pytest.approx(across, rel=0.01)
    plain, opening = measures(-0.0002, 0.001, opened=1e-7)
    assert plain < 0.0
    assert opening == pytest.approx(across + plain, rel=0.01)  # kinematics, as above
    assert opening > 0.1 * across
    for pressed, opened in ((-0.0002, 0.0), (-0.0002, -1e-7), (-0.002, 1e-7)):
        assert measures(pressed, 0.001, opened)[1] == 0.0
