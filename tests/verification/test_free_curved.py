"""Cuts through the quads of curved films.

*Cylinders.* A strip is rolled onto a cylinder, its middle line along the axis, across it or at
30 degrees to the axis. The blade follows the middle line by the screw (or the straight line) that
maps the cylinder onto itself, with a short body, so that in steady cutting the whole deformed film
moves along with it: all energies stay, and the work of the tool goes into the cables and damping.
Force from the tool's work and from the cables' over whole node periods, in units of G h, within 2.5
and 1.5 per cent (discretisation; measured here, on 0.8 mm: 0.8 to 2.1 and at most 1.3).

*Surfaces of revolution*, meshed by Gmsh and read from a file: a blade pierces them from the side
and cuts them along its mid-plane, which leans against the film by up to 48 degrees.
"""

import numpy as np
import pytest

import shellcut as sc
from curved_films import Roll, moved, revolved, strip_with_hole
from shellcut.mesh.structured import rectangle
from shellcut.tool_shapes import straight_blade

SIZE, WIDTH, RADIUS, NOTCH = 0.8, 8.0, 15.0, 2.0
SPEED, RAMP = 6000.0, 1e-4
LAW = sc.CohesiveLaw()


def simulation(mesh, blade, motion, clamped):
    return sc.Simulation(
        mesh,
        sc.ShellMaterial.homogeneous(),
        supports=[sc.Support.clamped(name) for name in clamped],
        tool=blade,
        motion=motion,
        law=LAW,
        fracture=sc.Fracture(path="free"),
    )


def guillotine(strip, angle):
    """Return a simulation of a blade before a notch in a rolled strip, the roll and its way."""
    roll = Roll(angle, RADIUS)
    motion, per = roll.motion(SPEED, RAMP)
    # Six millimetres long: behind it the flanks close and give back what holds them open.
    blade = straight_blade(length=6.0, height=17.0).translated((-0.05, 0.0, 0.0))
    sim = simulation(roll.mesh(strip), blade, motion, ["bottom", "top"])
    # A hair off the line of nodes where there is one: the notch must not care.
    (start, end), _ = roll.onto([0.0, NOTCH], 1e-7)
    sim.cracks.free.notch(sim.state, start - 0.3 * (end - start), end)
    return sim, roll, per


def courses(sim, way, per=1.0):
    """Run until the tool has gone a way [mm]; return way, its work, the cables' and imbalance."""
    rows = []
    while (x := per * sim.motion.coordinate(sim.state.time)) < way:
        sim.step()
        if sim.state.step % 100 == 0:
            book = sim.close_ledger()
            rows.append((x, book.tool_work, book.cohesive_work, book.imbalance))
    return np.array(rows).T


def worst(tool, imbalance):
    """Return the largest imbalance after the first tenth of the tool's work, relative to that."""
    return np.abs(imbalance[tool > 0.1 * tool.max()]).max() / tool.max()


@pytest.mark.parametrize(
    ("angle", "kind", "amount"),
    [(0.0, "random", 0.2), (90.0, "offset", 0.3), (90.0, "turned", 20.0), (30.0, "random", 0.2)],
)
def test_force_on_a_cylinder_is_the_tearing_energy(angle, kind, amount):
    strip = moved(rectangle(24.0, WIDTH, size=SIZE), kind, amount, SIZE)
    sim, roll, per = guillotine(strip, angle)
    way, tool, cables, imbalance = courses(sim, 16.0, per)
    last = way[-1]
    first = last - SIZE * int((last - 8.8) / SIZE)
    unit = LAW.fracture_energy * sim.material.thickness * (last - first)
    by_tool, by_cables = (np.diff(np.interp([first, last], way, w))[0] / unit for w in (tool, cables))
    assert by_tool == pytest.approx(1.0, abs=0.025)
    assert by_cables == pytest.approx(1.0, abs=0.015)
    assert worst(tool, imbalance) < 1e-3
    places = np.array([cut.reference for cut in sim.state.splits])
    _, off = roll.unrolled(places)
    # A twentieth by which corners are met, and as much by which the blade moves the film aside.
    assert np.abs(off).max() < 0.1 * SIZE
