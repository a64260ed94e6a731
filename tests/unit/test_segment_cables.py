"""Fibres across a segment: their places, their forces, and what the blade touches."""

import numpy as np
import pytest

import shellcut as sc
from free_strip import cut_strip, notched_sheet, path_in, segment_ahead
from naive.cable import straight
from naive.shell import shape
from shellcut.fracture.flank_points import FlankPoints
from shellcut.fracture.tip import Segment

SIZE, NOTCH, FIBRES = 0.5, 2.2, 5
LAW = sc.CohesiveLaw()


def segment_cut(rise=0.3):
    """Return a notched film and one segment cut ahead of its tip."""
    sim = notched_sheet(rise, fibres=FIBRES)
    tip, segment = segment_ahead(sim)
    sim.cracks.growth.along(sim.state, tip, segment, "criterion", 1.0)
    return sim, segment


def forces(sim):
    """Return the forces of all cables on the nodes that have film, (n_node, 3)."""
    s, n = sim.state, sim.state.node
    flanks = FlankPoints()
    flanks.follow(s)
    n.force_rows[: n.count] = 0.0
    s.dt = 0.0
    sim.cables.add_forces(s, sim.pose)
    if s.flank.count:
        flanks.hand_on_forces(s)
    return n.force[: n.count].copy()


def by_hand(sim):
    """Return the same, each fibre alone, from the chord between its flanks' copies.

    They hold equal parts of the segment's film, at the middles of these, and pull across it.
    """
    s, n, c = sim.state, sim.state.node, sim.state.cable
    area, m = sim.material.thickness * SIZE / FIBRES, np.array([0.0, 1.0, 0.0])
    wanted = np.zeros((n.count, 3))
    for k in range(c.count):
        weights, nodes = [], [s.quads[row] for row in c.row[k]]
        for chord in c.chord[k]:
            start, stop = (shape(*place)[0] for place in chord)
            share = (k + 0.5) / FIBRES
            weights.append((1.0 - share) * start + share * stop)
        minus, plus = (w @ n.x[q] for w, q in zip(weights, nodes, strict=True))
        _, *force = straight(minus, plus, m, area, 0.0, LAW)
        for w, q, one in zip(weights, nodes, force, strict=True):
            np.add.at(wanted, q, np.outer(w, one))
    return wanted


def check_forces(sim):
    """Open the flanks, in the sheet and out of it, and compare."""
    n = sim.state.node
    n.x[: n.count] += 0.02 * np.random.default_rng(7).normal(size=(n.count, 3))
    film, wanted = n.mass[: n.count] > 0.0, by_hand(sim)
    assert np.abs(wanted).max() > 0.05
    np.testing.assert_allclose(forces(sim)[film], wanted[film], atol=1e-12)  # round-off


@pytest.mark.parametrize("rise", [0.3, 0.0])  # through a quad, and along a side of the mesh
def test_fibres_hold_a_segment_evenly_as_soon_as_it_is_cut(rise):
    sim, segment = segment_cut(rise)
    n, c = sim.state.node, sim.state.cable
    assert c.count == FIBRES  # the notch has none
    assert segment.along_side == (rise == 0.0)
    X = c.at_ends(n.X)
    np.testing.assert_allclose(X[:, 0], X[:, 1], atol=1e-14)
    start = NOTCH + 0.3 + sim.mesh.nodes[:, 0].min()  # the first side behind the notch's end
    along = start + SIZE * (np.arange(FIBRES) + 0.5) / FIBRES
    np.testing.assert_allclose(X[:, 0, 0], along, atol=1e-12)
    np.testing.assert_allclose(c.area[:FIBRES].sum(), SIZE * sim.material.thickness, rtol=1e-12)
    check_forces(sim)


def test_the_blade_touches_flanks_where_they_have_parted():
    sim, _ = segment_cut()
    n, f = sim.state.node, sim.state.flank
    points = f.node[: f.count]
    x = n.X[points, 0]
    behind, tip = points[x < x.mean()], points[x > x.mean()]
    assert n.real[behind].sum() == 2  # a flank each
    assert not n.real[tip].any()
    ends = (f.nodes[k][f.weight[k] > 1e-9] for k in np.flatnonzero(np.isin(points, tip)))
    assert len({frozenset(pair.tolist()) for pair in ends}) == 1  # closed


def test_fibres_go_with_the_part_of_a_copy_that_holds_them():
    sim, segment = segment_cut()
    s, c = sim.state, sim.state.cable
    cuts = sim.cracks.cuts
    row = segment.row  # the copy to the right, below the crack
    middle = tuple(0.5 * np.add(segment.entry, segment.exit))
    below = (0.0, -1.0)
    cuts.along(s, Segment(row, below, middle, -1, -1), "notch", 0.0)
    cuts.renew(s)
    right, left = row, s.n_quad - 1
    # In the quad of the copies the crack runs in the way of xi.
    sides = [right if share > 0.5 + 1e-9 else left for share in c.share[:FIBRES]]
    at_middle = np.isclose(c.share[:FIBRES], 0.5)
    np.testing.assert_array_equal(c.row[:FIBRES, 0][~at_middle], np.array(sides)[~at_middle])
    check_forces(sim)


def test_a_segment_that_opens_nowhere_is_held_and_its_fibres_rest():
    """The chord of a puncture: its flanks have the same nodes."""
    sim = cut_strip(notched=False)
    free, s = sim.cracks, sim.state
    middles = sim.mesh.nodes[sim.mesh.quads].mean(axis=1)
    row = int(np.linalg.norm(middles - middles.mean(axis=0), axis=1).argmin())
    ways = [np.array([sign, 0.1, 0.0]) for sign in (-1.0, 1.0)]
    back, ahead = (path_in(sim).segment(s, row, (0.0, 0.0), way) for way in ways)
    free.growth.through(s, back, ahead, "puncture", 1.0)
    free.cuts.renew(s)
    assert s.n_cable == 6
    assert not s.node.real[s.flank.node[: s.flank.count]].any()
    film = s.node.mass[: s.n_node] > 0.0
    assert np.abs(forces(sim)[film]).max() < 1e-15 * LAW.strength
