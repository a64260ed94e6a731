"""The kernels of cracks through quads find what their plain twins find, tip by tip."""

from itertools import pairwise

import numpy as np
import pytest

from free_strip import cut_strip, slanted_strip
from naive import blade_drive, crack_path, trial_cut
from shellcut.fracture.blade_drive import BladeDrive
from shellcut.fracture.crack_path import CrackPath
from shellcut.fracture.pierce import Pierce, parts_quad
from shellcut.fracture.quad_polygon import WHOLE, common_side, shape_functions
from shellcut.fracture.ray_ahead import Aimed
from shellcut.fracture.rows_ahead import table_of
from shellcut.fracture.tip import Tip
from shellcut.fracture.tip_watch import TipWatch
from shellcut.fracture.trial_cut import TrialCut
from shellcut.mesh.mesh import Mesh
from shellcut.mesh.structured import rectangle
from shellcut.tool.cutting_edge import CuttingEdges
from shellcut.tool.pose import Pose


class Rules:
    """The rules as plain code, and the watch, for the tips of a simulation."""

    def __init__(self, sim):
        self.sim, self.topology = sim, sim.cracks.cuts.topology
        self.edges, self.path = CuttingEdges.of(sim.tool), CrackPath(self.topology, sim.shell)
        self.trial = TrialCut(self.topology, sim.shell, sim.loads, sim.law.strength)
        self.watch = TipWatch(self.path, self.trial, BladeDrive(self.edges, sim.motion))

    def plain(self, tip, tips):
        """Return segment and measures of a tip, None without, and from which on it is due."""
        state, motion = self.sim.state, self.sim.motion
        at, heading = crack_path.place_of(self.path, state, tip)
        edge, passed = blade_drive.nearest_edge(self.edges, at.x, at.size, self.sim.pose)
        if edge < 0:
            ways, lean = [heading - (heading @ at.t) * at.t], np.zeros(3)
        else:
            off, then = blade_drive.beyond(self.edges, motion, at.x, at.size, edge, state.time)
            ways, lean = blade_drive.directions(self.edges, edge, off, at, heading, then)
        found = (crack_path.segment_from(self.path, state, tip, way, lean, tips) for way in ways)
        segment = next((one for one in found if one is not None), None)
        measures = segment and trial_cut.measures(self.trial, state, segment)
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
            found = self.watch.weighed.measure[i], self.watch.weighed.size[i]
            np.testing.assert_allclose(found, measures, rtol=1e-9, atol=1e-12)
            assert due[i] == (measures[0] >= limit)
            right, _ = trial_cut.shares(self.trial, state, segment)
            assert mine.right == pytest.approx(right, rel=1e-9)  # round-off
            kinds.append((segment.corner >= 0, segment.along_side, segment.side < 0))
        return kinds


def jittered(seed):
    mesh = rectangle(6.0, 3.2, n_x=15, n_y=8)
    X = mesh.nodes.copy()
    inside = ~np.isin(np.arange(mesh.n_node), mesh.boundary_nodes())
    X[inside, :2] += np.random.default_rng(seed).uniform(-0.1, 0.1, (inside.sum(), 2))
    return Mesh.from_arrays(X, mesh.quads, node_sets=mesh.node_sets)


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
    for turn in range(6):
        sim = cut_strip(mesh=jittered(10 + turn))
        free = sim.cracks
        for x in rng.uniform(1.0, 1.8, 3):
            slant = rng.uniform(-0.4, 0.4)
            sim.notch((x - slant, -2.0, 0.0), (x + slant, rng.uniform(0.0, 1.2), 0.0))
        rules = Rules(sim)
        for _ in range(60):
            sim.step()
            kinds += rules.compare(free.tips) if sim.state.step % 10 == 4 else []
    assert len(kinds) > 20


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


def test_chords_part_whole_quads_as_the_rules_say():
    sim, rng, said = cut_strip(mesh=jittered(3)), np.random.default_rng(8), []
    s, path = sim.state, Rules(sim).path
    at_flank = s.node.halved[s.quads].any(axis=1)
    whole = np.flatnonzero((s.quad.share[: s.n_quad] == 1.0) & ~at_flank)
    quad, chord = table_of(s, path, [(int(whole[0]), (0.0, 0.0))], [()]), Aimed.of(2)
    s.node.x[: s.n_node, 2] = 0.1 * np.sin(s.node.x[: s.n_node, 0])
    for _ in range(3000):
        row = int(rng.choice(whole))
        place = tuple(np.clip(rng.uniform(-1.03, 1.03, 2), -0.999, 0.999).tolist())
        angle = rng.choice([0.0, 0.5 * np.pi, rng.uniform(0.0, np.pi)]) + rng.normal() * 0.02
        b = np.array([np.cos(angle), np.sin(angle), rng.uniform(-0.2, 0.2)])
        normal, size = tuple(b.tolist()), path.size(row)
        mine = parts_quad(quad, chord, s.node.x, s.node.t, s.quads, row, *place, normal, size)
        t = np.array(shape_functions(place)) @ s.node.t[s.quads[row]]
        trace = np.cross(t, b) / np.linalg.norm(np.cross(t, b))
        ends = [crack_path.segment(path, s, row, place, sign * trace) for sign in (-1.0, 1.0)]
        rules = None not in ends and (
            common_side(WHOLE, *(end.exit for end in ends)) is None
            or (min(end.corner for end in ends) >= 0 and ends[0].corner != ends[1].corner)
        )
        assert mine == rules
        said.append(rules)
    assert 200 < sum(said) < 2985


def test_list_of_near_rows_never_changes_what_is_pierced():
    """The blade goes through film that nothing cuts and whose nodes wander."""
    sim, rng, found = cut_strip(), np.random.default_rng(2), 0
    s, n, path = sim.state, sim.state.node, Rules(sim).path
    drive = BladeDrive(CuttingEdges.of(sim.tool), sim.motion)
    parts = s, path, drive, sim.shell, (1.0, 1.0), None, sim.tool.edge_chain
    kept, none = Pierce(*parts), np.zeros((0, 3))
    dt = 2.6e-4 / 900
    for step in range(900):
        if step % 30 == 0:
            n.velocity_half[: n.count] = rng.uniform(-0.02, 0.02, (n.count, 3)) / (30 * dt)
        n.x[: n.count] += n.velocity_half[: n.count] * dt
        s.step, s.time = step, step * dt
        pose = Pose.of(*sim.motion.pose(s.time))
        rows = kept.found(s, pose, none)
        if step % 5 == 0:
            again = Pierce(*parts).found(s, pose, none)
            assert rows == again
            found += len(rows)
    assert 3 < kept._near.n_search < 300
    assert found > 20
