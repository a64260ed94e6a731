"""Two tears that converge: the end of a flap between two notches of a clamped sheet is pulled up.

The fold between the two tips stores bending energy, the less the narrower it is, so each tear turns
towards the other until they meet and the strip comes off. [Brau2014] has w ~ x^(8/11) for an
elastic ridge, x being the way to where the strip ends; a straight fold gives 2/3.
"""

import functools

import numpy as np
import pytest

import shellcut as sc
from shellcut.mesh.structured import rectangle
from shellcut.state.pieces import Pieces

LAW = sc.CohesiveLaw(
    strength=7.0, plateau=5.6, opening_a=0.1, opening_p=0.4, opening_u=0.6, onset=0.005
)
SHORT = sc.CohesiveLaw(
    strength=14.0, plateau=11.2, opening_a=0.05, opening_p=0.2, opening_u=0.3, onset=0.0025
)
THICKNESS, SPEED, RISE = 0.07, 2000.0, 3e-4
FILM = sc.ShellMaterial.homogeneous(young=1678.0, poisson=0.3, thickness=THICKNESS)


def pulled_up(size, breadth, notch, length, margin=2.0, law=LAW):
    """A flap of some breadth in a sheet; its end goes straight up, and along as it likes."""
    mesh = rectangle(length, breadth + 2.0 * margin, size=size)
    X = mesh.nodes - [mesh.nodes[:, 0].min(), 0.0, 0.0]
    x, y = X[:, 0], np.abs(X[:, 1])
    at_start, flap = x < 1e-9, y < 0.5 * breadth - 1e-6
    rim = (x > length - 1e-9) | (y > y.max() - 1e-9) | (at_start & (y > 0.5 * breadth + 1e-6))
    rate = {"z": lambda time: SPEED * min(1.0, time / RISE)}
    end = np.flatnonzero(at_start & flap).tolist()
    sim = sc.Simulation(
        sc.Mesh.from_arrays(X, mesh.quads),
        FILM,
        supports=[
            sc.Support(np.flatnonzero(rim).tolist(), rotation="xyz"),
            sc.Support(end, translation="yz", rotation="", velocity=rate),
        ],
        law=law,
        fracture=sc.Fracture(path="free", check_every=20),
        damping_alpha=50.0,
    )
    for side in (-0.5, 0.5):
        sim.notch((-1.0, side * breadth, 0.0), (notch, side * breadth, 0.0))
    return sim


def torn_off(sim, longest):
    """Tear until the strip is off; return both ways, (n, 2) each, the upper one first."""
    ways, n = ([], []), 0
    while sim.state.time < longest and len(Pieces.of(sim.state).mass) < 2:
        for _ in range(20):
            sim.step()
        for cut in sim.state.split_log[n:]:
            at = np.array(cut.reference[:2])
            ways[nearest(ways, at)].append(at)
        n = len(sim.state.split_log)
    return [np.array(way) for way in ways]


def nearest(ways, at):
    """Return which of two ways leads to a place, 0 of the upper one."""
    if min(len(way) for way in ways) < 4:
        return int(at[1] < 0.0)
    lines = [np.polyfit(*np.array(way[-4:]).T, 1) for way in ways]
    return int(np.argmin([abs(np.polyval(line, at[0]) - at[1]) for line in lines]))


def breadths(upper, lower, start):
    """Return places along the strip and its breadth there, until one way ends, shape (n,) each."""
    stop = min(upper[:, 0].max(), lower[:, 0].max())
    x = np.linspace(start, stop, 400)
    return x, np.interp(x, *upper.T) - np.interp(x, *lower.T)


def test_two_tears_that_converge_pinch_the_strip_off():
    sim = pulled_up(0.5, breadth=2.0, notch=4.0, length=12.0)
    upper, lower = torn_off(sim, 4e-3)
    assert len(Pieces.of(sim.state).mass) == 2
    # Measured 1.9 mm from the notches; 2.2 by the closed form. Side by side
    # with film from across the other tear in the domain: 4 mm.
    assert max(upper[-1, 0], lower[-1, 0]) < 4.0 + 2.5
    assert len(sim.cracks.free.tips) < 2
    assert abs(sim.ledger.relative(sim.ledger.imbalance)) < 1e-3


@functools.cache
def narrowed(size):
    """Return whether a strip of 6 mm came off, its last breadth [mm] and m of w ~ x^m."""
    sim = pulled_up(size, breadth=6.0, notch=5.0, length=26.0, law=SHORT)
    upper, lower = torn_off(sim, 1.5e-2)
    x, w = breadths(upper, lower, 6.0)
    left = max(upper[:, 0].max(), lower[:, 0].max()) - x
    decade = (w > 0.5) & (w < 5.0)
    power = np.polyfit(np.log(left[decade]), np.log(w[decade]), 1)[0]
    return len(Pieces.of(sim.state).mass) == 2, w[-1], power


@pytest.mark.slow
@pytest.mark.parametrize("size", [0.5, 0.3])
def test_a_strip_narrows_until_its_tears_meet(size):
    is_off, breadth, _ = narrowed(size)
    assert is_off
    # Measured 0.08 and 0.07 mm.
    assert breadth < 0.25


@pytest.mark.slow
@pytest.mark.parametrize(
    "size",
    [
        pytest.param(
            0.5, marks=pytest.mark.xfail(reason="m = 0.83: the process zone is two edges long")
        ),
        0.3,
    ],
)
def test_a_strip_narrows_by_a_power_law(size):
    # Around the 8/11 of [Brau2014]; measured 0.74 on 0.3 mm, 0.69 on 0.2 mm.
    assert 0.70 < narrowed(size)[2] < 0.80
