"""Cables at the Gauss points of segments: their places, forces, and what the blade touches."""

import numpy as np
import pytest

import shellcut as sc
from free_strip import cut_strip
from naive.cable import straight
from naive.shell import shape
from shellcut.fracture.crack_path import CrackPath
from shellcut.mesh.structured import rectangle

SIZE, NOTCH = 0.5, 2.2
LAW = sc.CohesiveLaw()
POINTS = 0.5 * (1.0 - np.array([1.0, -1.0]) / np.sqrt(3.0))


def segment_cut(places, rise=0.3):
    """Return a film with a notch through its quads and one segment cut ahead of it."""
    mesh = rectangle(5.0, 4.0, size=SIZE)
    sim = sc.Simulation(
        mesh,
        sc.ShellMaterial.homogeneous(),
        law=LAW,
        fracture=sc.Fracture(path="free", cable_places=places),
    )
    rim, y = mesh.nodes[:, 0].min(), rise * SIZE
    sim.notch((rim - 1.0, y, 0.0), (rim + NOTCH, y, 0.0))
    free = sim.cracks
    (tip,) = free.tips
    segment = CrackPath(free.cuts.topology, sim.shell).segment_from(sim.state, tip, tip.heading)
    free._advance(sim.state, tip, segment, "criterion", 1.0)
    return sim, segment


@pytest.mark.parametrize("rise", [0.3, 0.0])  # through a quad, and along a side of the mesh
def test_two_cables_hold_a_segment_by_the_rule_of_gauss(rise):
    sim, segment = segment_cut("gauss", rise)
    s = sim.state
    n, c = s.node, s.cable
    assert c.count == 2  # awake as soon as the segment is cut; the notch has none
    assert segment.along_side == (rise == 0.0)
    X = n.X[c.ends[:2]]
    np.testing.assert_allclose(X[:, 0], X[:, 1], atol=1e-14)
    start = NOTCH + 0.3  # the first side of the mesh behind the notch's end
    along = np.sort(X[:, 0, 0] - sim.mesh.nodes[:, 0].min())
    np.testing.assert_allclose(along, start + SIZE * POINTS, atol=1e-12)
    np.testing.assert_allclose(c.area[:2], 0.5 * SIZE * sim.material.thickness, rtol=1e-12)
    assert not n.real[c.ends[:2]].any()  # the blade does not touch them
    # The flanks open, in the sheet and out of it, as at any place of the film.
    rng = np.random.default_rng(7)
    n.x[: n.count] += 0.02 * rng.normal(size=(n.count, 3))
    sim._flanks.follow(s)
    n.force_rows[: n.count] = 0.0
    s.dt = 0.0
    sim.cables.add_forces(s, sim.pose)
    sim._flanks.hand_on_forces(s)
    wanted = np.zeros((n.count, 3))
    f = s.flank
    for cable in range(2):
        ends = [np.flatnonzero(f.node[: f.count] == end)[0] for end in c.ends[cable]]
        weights = [shape(*f.place[k])[0] for k in ends]
        nodes = [s.quads[f.row[k]] for k in ends]
        minus, plus = (w @ n.x[q] for w, q in zip(weights, nodes, strict=True))
        _, *force = straight(minus, plus, c.m[cable], c.area[cable], 0.0, LAW)
        for w, q, one in zip(weights, nodes, force, strict=True):
            np.add.at(wanted, q, np.outer(w, one))
    free = n.mass[: n.count] > 0.0
    assert np.abs(wanted).max() > 0.1
    np.testing.assert_allclose(n.force[: n.count][free], wanted[free], atol=1e-12)  # round-off


def test_flanks_are_touched_where_they_are_with_cables_at_the_ends():
    seen = []
    for places in ("ends", "gauss"):
        sim = cut_strip(fracture=sc.Fracture(path="free", check_every=5, cable_places=places))
        for _ in range(1500):
            sim.step()
        n, f = sim.state.node, sim.state.flank
        points = f.node[: f.count]
        seen.append(n.X[points[n.real[points]]])
        cables = sim.state.cable.ends[: sim.state.n_cable]
        assert n.real[cables].any() == (places == "ends")
    # Sides of the mesh that both cracks have crossed: the same places, to the push of the blade.
    first, second = (np.sort(points[:, 0]) for points in seen)
    both = min(len(first), len(second))
    assert both > 8
    np.testing.assert_allclose(first[:both], second[:both], atol=0.05 * 0.4)


def test_what_is_behind_a_tip_has_its_cables():
    sim, _ = segment_cut("gauss")
    other, _ = segment_cut("ends")
    carried = []
    for one in (sim, other):
        (tip,) = one.cracks.tips
        carried.append(one.cracks._trial.behind(tip))
    assert carried == [0.0, pytest.approx(SIZE)]


def test_along_edges_there_are_no_gauss_points():
    with pytest.raises(ValueError, match="cable_places is of cracks through the quads only"):
        sc.Fracture(path="edges", cable_places="gauss")
    with pytest.raises(ValueError, match="cable_places must be 'ends' or 'gauss'"):
        sc.Fracture(path="free", cable_places="middle")
