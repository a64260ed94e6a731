"""Two tears that converge: a flap between two notches of a clamped sheet is folded back and pulled.

The fold between the two tips stores bending energy, the less the narrower it is, so each tear turns
towards the other until they meet and the strip comes off. The strip of [Brau2014] narrows as
w ~ x^(8/11), x the way to where it ends.
"""

import numpy as np
import pytest

import shellcut as sc
from shellcut.mesh.structured import rectangle
from shellcut.state.pieces import Pieces

LAW = sc.CohesiveLaw(
    strength=7.0, plateau=5.6, opening_a=0.1, opening_p=0.4, opening_u=0.6, onset=0.005
)
THICKNESS, SPEED, FOLDING = 0.07, 2000.0, 0.6


def folded_back(size, breadth, notch, length):
    """A flap of some breadth; its end goes over in a half circle, then along the sheet."""
    n_y = 2 * round(0.5 * (breadth + 4.0) / size)
    mesh = rectangle(length, n_y * size, size=size)
    X = mesh.nodes - [mesh.nodes[:, 0].min(), 0.0, 0.0]
    x, y = X[:, :2].T
    at_start, end = x < 1e-9, np.abs(y) < 0.5 * breadth - 1e-6
    rim = (x > length - 1e-9) | (np.abs(y) > 0.5 * n_y * size - 1e-9) | (at_start & ~end)
    over = FOLDING * np.pi * notch / SPEED  # s

    def place(time):
        """Of the end of a flap bent evenly, from its root."""
        part = min(time / over, 1.0)
        angle = np.pi * part**2 * (3.0 - 2.0 * part) + 1e-9
        return -notch * np.sinc(angle / np.pi), notch * (1.0 - np.cos(angle)) / angle

    def rate(axis, time):
        before = max(time - 1e-3 * over, 0.0)
        after = time + 1e-3 * over
        bent = (place(after)[axis] - place(before)[axis]) / (after - before)
        return bent + (axis == 0) * 2.0 * SPEED * np.clip((time - over) / (0.3 * over), 0.0, 1.0)

    rates = {"x": lambda time: rate(0, time), "z": lambda time: rate(1, time)}
    sim = sc.Simulation(
        sc.Mesh.from_arrays(X, mesh.quads),
        sc.ShellMaterial.homogeneous(thickness=THICKNESS),
        supports=[
            sc.Support(np.flatnonzero(rim).tolist(), translation="xyz", rotation="xyz"),
            sc.Support(np.flatnonzero(at_start & end).tolist(), rotation="", velocity=rates),
        ],
        law=LAW,
        fracture=sc.Fracture(path="free", check_every=20),
        damping_alpha=50.0,
    )
    for side in (-0.5, 0.5):
        sim.notch((-1.0, side * breadth, 0.0), (notch, side * breadth, 0.0))
    return sim


def torn_off(sim, longest):
    """Tear until the strip is off; return both ways, (n, 2) each, the upper one first."""
    ways, n = ([], []), 0
    ends = [np.array([0.0, side]) for side in (9.0, -9.0)]
    while sim.state.time < longest and len(Pieces.of(sim.state).mass) < 2:
        for _ in range(20):
            sim.step()
        for cut in sim.state.split_log[n:]:
            at = np.array(cut.reference[:2])
            mine = int(at[1] < 0.0) if cut.kind == "notch" else nearest(ends, at)
            ways[mine].append(at)
            ends[mine] = at
        n = len(sim.state.split_log)
    return [np.array(way) for way in ways]


def nearest(ends, at):
    return int(np.argmin([np.linalg.norm(at - end) for end in ends]))


def breadths(upper, lower, start):
    """Return places along the strip and its breadth there, until one way ends, shape (n,) each."""
    stop = min(upper[:, 0].max(), lower[:, 0].max())
    x = np.linspace(start, stop, 400)
    return x, np.interp(x, *upper.T) - np.interp(x, *lower.T)


def test_two_tears_that_converge_pinch_the_strip_off():
    sim = folded_back(0.5, breadth=2.0, notch=6.0, length=12.0)
    torn_off(sim, 1.2e-2)
    assert len(Pieces.of(sim.state).mass) == 2
    assert len(sim.cracks.free.tips) < 2
    assert abs(sim.ledger.relative(sim.ledger.imbalance)) < 1e-4


@pytest.mark.slow
@pytest.mark.parametrize("size", [0.5, 0.3])
def test_a_strip_narrows_by_a_power_of_what_is_left_of_it(size):
    sim = folded_back(size, breadth=6.0, notch=6.0, length=24.0)
    upper, lower = torn_off(sim, 1.5e-2)
    assert len(Pieces.of(sim.state).mass) == 2
    x, w = breadths(upper, lower, 7.5)
    slope = np.polyfit(x[-20:], w[-20:], 1)
    left = -np.polyval(slope, 0.0) / slope[0] - x
    print(size, w[0], w[-1], left[0], left[-1])
    decade = w > 0.1 * w[0]
    steps = np.geomspace(left[decade][-1], left[0], 20)
    power = np.polyfit(np.log(steps), np.log(np.interp(steps, left[::-1], w[::-1])), 1)[0]
    print(power)
    assert 0.70 < power < 0.80
