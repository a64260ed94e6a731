"""The opening test between piercing and steady cutting: the tool's work, and its axial force.

The tool advances by s along the circle and by 0.2032 s down. Its edges, 60 degrees steep, meet the
film 1.1173 s onward, and a cable that the edge has met is bent around it: each branch spans the
advance and the half of the wedge, 12 degrees, that has come by there,

    l = 2 s sqrt(1 + 0.2032² + (1.1173 tan 12°)²) = 2.096 s.

With A(l), the area below the law, four teeth then take the power

    P = 1.1173 · 4 h A(l) + rate of the film's energy,    s from where the first tip pierces.
"""

from itertools import pairwise

import numpy as np
import pytest

from courses import course
from films import unstructured_disc
from page_tables import row
from shellcut import Fracture, opening_test

DOWN = 12.0 / (2.0 * np.pi * 9.4)
FRONT = 1.0 + DOWN / np.tan(np.radians(60.0))
DRAWN = 2.0 * np.sqrt(1.0 + DOWN**2 + (FRONT * np.tan(np.radians(12.0))) ** 2)
DEPTHS = np.arange(0.2, 0.51, 0.05)


def courses(film):
    """Return the depths of the tips [mm], at which one pierces, and work and energy [N·mm]."""
    case = opening_test(film, fracture=Fracture(path="free"))
    sim = case.simulation

    def depth(angle):
        return 1.9099 * angle - 0.02

    def deep(one):
        deep = depth(one.motion.coordinate(one.state.time)) > DEPTHS[-1]
        return deep and one.state.step % 20 == 0

    way, work, *energies = course(sim, deep, "tool_work", "strain", "kinetic", every=20)
    pierced = depth(sim.motion.coordinate(sim.state.split_log[0].time))
    return pierced, (depth(way), work, sum(energies)), sim


def theory(pierced, law, thickness):
    """Return the work of the cables up to DEPTHS [N·mm]."""
    s = np.linspace(0.0, (DEPTHS[-1] - pierced) / DOWN, 4000)
    area = sum(law.energies(DRAWN * s, DRAWN * s))
    power = FRONT * 4.0 * thickness * area
    work = np.concatenate([[0.0], np.cumsum(0.5 * (power[1:] + power[:-1]) * np.diff(s))])
    return np.interp((DEPTHS - pierced) / DOWN, s, work)


@pytest.mark.parametrize("film", ["quick", pytest.param("M1", marks=pytest.mark.slow), "raw"])
def test_the_power_between_piercing_and_steady_cutting(film):
    pierced, (depth, work, energy), sim = courses(unstructured_disc() if film == "raw" else film)
    ours = np.diff(np.interp(DEPTHS, depth, work))
    expected = theory(pierced, sim.law, sim.material.thickness)
    stored = np.interp(DEPTHS, depth, energy)
    # Discretisation.
    taken = np.ptp(expected) + stored[-1] - stored[0]
    assert ours.sum() == pytest.approx(taken, rel=0.08)
    told = row("docs/verification.md", "opening, tips 0.2 to 0.5 mm deep")[2].split("; ")
    of_film = float(told[["quick", "M1", "raw"].index(film)])
    assert ours.sum() / taken == pytest.approx(of_film, abs=2e-3)  # by chance, and the last digit
    for one, (a, b) in zip(ours, pairwise(expected + stored), strict=True):
        assert one == pytest.approx(b - a, rel=0.12)
