"""Cracks that come towards each other: on one side, with a third there, from a pierced cut."""

import numpy as np
import pytest

from free_strip import cut_strip, pieces_of, slanted_strip
from shellcut.fracture.crack_path import CrackPath
from shellcut.fracture.drawn_film import DrawnFilm
from shellcut.fracture.pierce import Begun
from shellcut.fracture.tip import Tip
from shellcut.mesh.structured import rectangle
from shellcut.recording.checkpoint import load_checkpoint, save_checkpoint

H = 0.4
NODE = np.array([2.4, 0.4, 0.0])
"""Where the second crack ends."""
WAY = np.array([-0.8, 0.6, 0.0])
"""Its direction: through the quad that touches the side above only at the node."""


def on_one_side(beside):
    """A strip with a crack that ends on the side above a node, by a part of it, and another tip.

    The second crack stands before the quad through which it comes to that node.
    """
    sim = cut_strip(mesh=rectangle(6.0, 3.2, n_x=15, n_y=8), notched=False)
    y = NODE[1] + beside * H
    sim.notch((-1.0, y, 0.0), (NODE[0], y, 0.0))
    sim.notch(NODE - 6.0 * WAY, NODE - 0.55 * WAY)
    assert len(sim.cracks.tips) == 2
    assert pieces_of(sim) == 1
    return sim


def advance(sim):
    """Advance the crack that comes last to the node."""
    free, tip = sim.cracks, sim.cracks.tips[-1]
    segment = CrackPath(free.cuts.topology, sim.shell).segment_from(
        sim.state, tip, WAY, None, free.tips
    )
    free._advance(sim.state, tip, segment, "criterion", 1.0)


@pytest.mark.parametrize(("beside", "joins"), [(0.2, True), (0.3, True), (0.45, False)])
def test_two_that_end_on_one_side_tear_it_between_them(beside, joins):
    sim = on_one_side(beside)
    x, length = sim.state.node.x[: sim.mesh.n_node].copy(), sim.state.crack_length
    mass = sim.state.node.mass[: sim.state.n_node].sum()
    advance(sim)
    state = sim.state
    assert len(sim.cracks.tips) == (0 if joins else 2)
    assert pieces_of(sim) == (2 if joins else 1)
    np.testing.assert_array_equal(state.node.x[: sim.mesh.n_node], x)
    assert state.node.mass[: state.n_node].sum() == pytest.approx(mass, rel=1e-12)
    if not joins:
        return
    last = state.split_log[-1]
    np.testing.assert_allclose(last.reference, NODE, atol=1e-12)
    segment = np.linalg.norm(np.subtract(state.split_log[-2].reference, NODE))
    assert state.crack_length - length == pytest.approx(segment + beside * H)
    # Cables hold all of it, and the picture shows it.
    area = state.cable.area[: state.n_cable].sum()
    assert area == pytest.approx(sim.material.thickness * (segment + beside * H), rel=1e-12)
    drawn = DrawnFilm.of(state, sim.cracks.cuts.topology)
    at = drawn.at_points(state.node.X)[drawn.crack_edges[:, 0]]
    on_it = (abs(at[..., 0] - NODE[0]) < 1e-9).all(axis=1)
    ends = np.sort(at[on_it][..., 1], axis=1)
    np.testing.assert_allclose(ends, [[NODE[1], NODE[1] + beside * H]], atol=1e-9)


def test_a_torn_side_goes_on_from_a_checkpoint_and_keeps_the_ledger(tmp_path):
    sims = [on_one_side(0.2) for _ in range(2)]
    while sims[0].state.step < 20:
        sims[0].step()
    advance(sims[0])
    save_checkpoint(sims[0], tmp_path / "c.h5")
    load_checkpoint(sims[1], tmp_path / "c.h5")
    for sim in sims:
        for _ in range(2000):
            sim.step()
        book = sim.close_ledger()
        assert abs(book.relative(book.imbalance)) < 2e-3
        assert sim.cables.n_broken + sim.cables.n_joint_made > 0
    np.testing.assert_array_equal(sims[0].state.node.x, sims[1].state.node.x)
    assert sims[0].ledger == sims[1].ledger


def test_a_third_tip_at_a_joint_stays():
    sim = on_one_side(0.2)
    free = sim.cracks
    first = free.tips[0]
    third = Tip(first.ends, first.s, first.quad, np.array([0.6, 0.8, 0.0]))
    free.tips.insert(0, third)
    # It comes straight towards the first, through the quad beyond.
    y = NODE[1] + 0.2 * H
    sim.notch((7.0, y, 0.0), (NODE[0] + 0.3, y, 0.0))
    assert any(tip is third for tip in free.tips)
    assert not any(tip is first for tip in free.tips)


def test_a_pierced_cut_joins_a_crack_that_comes_towards_it(monkeypatch):
    sim = cut_strip(mesh=slanted_strip(), notched=False)
    free, shell = sim.cracks, sim.shell
    middles = sim.mesh.nodes[sim.mesh.quads].mean(axis=1)
    row = int(np.linalg.norm(middles - [2.6, 0.0, 0.0], axis=1).argmin())
    right = sim.mesh.nodes[sim.mesh.quads[row], 0].max()
    sim.notch((7.0, middles[row, 1] + 0.06, 0.0), (right + 0.01, middles[row, 1] + 0.06, 0.0))
    (there,) = free.at_tips(sim.mesh.nodes)
    assert there[0] == pytest.approx(right, abs=0.1)
    monkeypatch.setattr(free._pierce, "found", lambda *_: [Begun(row, (0.0, 0.0), 0, 1.0)])
    free.cut_due(sim.state, sim.pose)
    (tip,) = free.tips
    assert free.at_tips(sim.mesh.nodes)[0, 0] < middles[row, 0]
    assert tip.heading[0] < 0.0
    assert len(shell.mesh_quads) == sim.state.n_quad
