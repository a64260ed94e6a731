"""A strip with an oblique notch is pulled apart: the crack turns across the pull on any mesh.

It leans a little towards the end that rests, because the notch at 45 degrees does: by 0.13 mm in
5.4 on quads of 0.2 mm moved at random. On other such quads its path is that one, on rectangles the
line of the mesh that it meets, within a quarter of an edge.
"""

import numpy as np
import pytest

import shellcut as sc
from curved_films import TORN, moved, torn_across
from films import free_film
from shellcut.mesh.structured import rectangle
from shellcut.tool.shapes import straight_blade

LENGTH, WIDTH = 16.0, 8.0
HEIGHTS = [-1.5, 0.0, 1.5, 3.0]
LEAN = np.array([-0.002, -0.047, -0.093, -0.128])
"""Of the path on 0.2 mm quads moved at random, at these heights, from its start [mm]."""


# A blade far from the film, on its way to farther off.
ELSEWHERE = {
    "tool": straight_blade().translated((-20.0, 0.0, 0.0)),
    "motion": sc.StraightMotion((-1.0, 0.0, 0.0), speed=1.0),
}


@pytest.mark.parametrize(
    ("size", "amount", "tool"), [(0.4, 0.0, {}), (0.8, 0.2, {}), (0.4, 0.2, ELSEWHERE)]
)
def test_a_crack_turns_across_the_pull(size, amount, tool):
    mesh = moved(rectangle(LENGTH, WIDTH, size=size), "random", amount, size, seed=1)
    middle, rim = LENGTH / 2, -WIDTH / 2
    notch = (middle - 0.3, rim - 0.3, 0.0), (middle + 1.5, rim + 1.5, 0.0)
    sim = torn_across(mesh, notch, fracture=sc.Fracture(path="free", fibres=0), **tool)
    cuts = [cut.reference[:2] for cut in sim.state.split_log if cut.kind != "notch"]
    x, y = np.array(sorted(cuts, key=lambda place: place[1])).T - [[LENGTH / 2], [0.0]]
    start = x[0]
    path = np.interp(HEIGHTS, y, x) - start
    # A line of nodes within a twentieth of an edge holds a crack (SNAP of crack_path).
    expected = LEAN if amount else 0.0
    # Discretisation: places on sides of the mesh; measured within 0.1 edges.
    assert np.abs(path - expected).max() < 0.25 * size
    assert 1.4 < start < 1.5 + size
    assert y.max() > WIDTH / 2 - 2.0 * size


def passing(size, amount, half=4.0):
    """A square pulled across two notches, from its left below y = 0 and from its right above."""
    mesh = moved(rectangle(2.0 * half, 2.0 * half, size=size), "random", amount, size, seed=1)
    pull = {"y": lambda time: 600.0 * min(1.0, time / 2e-4)}
    sim = free_film(
        sc.Mesh.from_arrays(mesh.nodes - [half, 0, 0], mesh.quads, node_sets=mesh.node_sets),
        supports=[sc.Support.clamped("bottom"), sc.Support("top", velocity=pull)],
        law=TORN,
        damping_alpha=2000.0,
    )
    for side in (-1.0, 1.0):
        y = 0.75 * side
        sim.notch((side * (half + 1.0), y, 0.0), (side * 0.3 * half, y, 0.0))
    return sim


def ways_of(sim):
    """Return where the crack from the left and that from the right have been, (n, 2) each."""
    ways = [[np.array([side * 9.0, 0.75 * side])] for side in (-1.0, 1.0)]
    for cut in sim.state.split_log:
        at = np.array(cut.reference[:2])
        gaps = [np.linalg.norm(at - way[-1]) for way in ways]
        if cut.kind == "notch":
            gaps = [at[1], -at[1]]
        ways[int(np.argmin(gaps))].append(at)
    return [np.array(way) for way in ways]


@pytest.mark.parametrize(
    ("size", "amount"),
    [
        (0.5, 0.2),
        pytest.param(0.5, 0.0, marks=pytest.mark.slow),
        pytest.param(0.25, 0.2, marks=pytest.mark.slow),
    ],
)
def test_cracks_that_pass_turn_to_each_others_flanks(size, amount):
    """They shun each other's ends a little and hook behind them ([Fender2010])."""
    sim = passing(size, amount)
    # On rectangles of 0.5 mm one tip waits 0.75 mm before the other's flank at 1.5 ms, and on quads
    # of 0.25 mm both wait until 3.1 ms: a tip comes to the flank as the pull continues.
    while sim.state.time < 3.5e-3 and len(sim.cracks.tips) == 2:
        sim.step()
    left, right = ways_of(sim)
    tips = sim.cracks.at_tips(sim.state.node.X)[:, :2]
    others = [right[::-1] if tip.heading[0] > 0.0 else left for tip in sim.cracks.tips]
    gaps = [abs(np.interp(x, *way.T) - y) for (x, y), way in zip(tips, others, strict=True)]
    # One that has come to a flank has no tip any more; then the sheet is in two parts.
    assert len(tips) < 2 or max(gaps) < size
