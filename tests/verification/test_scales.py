"""A model in other units gives the same curve in these units: no length or stress is hidden in it.

Lengths, times and stresses are multiplied by factors of their own, and all that is given with them.
With powers of two every bit must agree; other factors round otherwise, and the cut of a straight
blade must agree to 1e-8 of the largest value of each curve. (On the ring of teeth round-off decides
which of two facets is the closest.)
"""

import numpy as np

import shellcut as sc
from courses import recorded
from scaled import Factors
from shellcut.contact.unfelt_depth import ToolWires, missed_penetration
from shellcut.mesh.structured import opening_disc, rectangle
from shellcut.tool.shapes import straight_blade, tooth_ring

REFERENCE = Factors()
# Of stresses a power of four: square roots of an odd power of two round otherwise.
POWERS_OF_TWO = (Factors(1024.0, 512.0, 64.0), Factors(1 / 16, 1 / 32, 256.0))
OTHERS = (Factors(1000.0, 700.0, 100.0), Factors(0.05, 0.03, 100.0))
FILM = sc.ShellMaterial.homogeneous()
LAW = sc.CohesiveLaw()


def options(f):
    """Everything that is given in units of its own."""
    return {
        "material": f.material(FILM),
        "law": f.law(LAW),
        "contact": sc.Contact(penalty=1e4 * f.stress / f.length),
        "damping_alpha": 0.1 / f.time,
        "damping_beta": 5e-8 * f.time,
    }


def curve(sim, f, until):
    """Everything that a run shows, every ten steps, in the units of the reference."""
    wires = ToolWires(sim.tool)

    def read(sim):
        wrench = sim.tooth_wrenches
        n_missed, missed = missed_penetration(wires, sim.state, sim.pose)
        return [
            sim.state.step,
            sim.state.time / f.time,
            *(wrench[:, :3] / f.force).ravel(),
            *(wrench[:, 3:] / f.energy).ravel(),
            *(np.array(list(sim.ledger.entries().values())) / f.energy),
            sim.contact.deepest / f.length,
            n_missed,
            missed / f.length,
            len(sim.state.split_log),
            sim.cables.n_joint_made,
            sim.cables.n_broken,
        ]

    return recorded(sim, until * f.time, read, every=10).T


def opening(f, until=0.7e-3):
    """The opening test on the quick mesh at twice the speed, its tool made in the other units."""
    ring = tooth_ring(
        radius=9.4 * f.length,
        half_thickness=0.35 * f.length,
        length=1.5 * f.length,
        height=5.0 * f.length,
        tip_clearance=0.02 * f.length,
    )
    case = sc.opening_test(
        f.mesh(opening_disc("quick")),
        tool=ring,
        pitch=12.0 * f.length,
        duration=3e-3 * f.time,
        **options(f),
    )
    return curve(case.simulation, f, until)


def guillotine(f, until=0.9e-3):
    """A strip that a straight blade cuts along its middle."""
    strip = rectangle(8.0 * f.length, 4.8 * f.length, size=0.8 * f.length)
    within = (1.6 + 1e-9) * f.length
    strip = strip.cut(strip.nodes_where(lambda x, y, z: (abs(y) < 1e-9 * within) & (x < within)))
    blade = straight_blade(
        half_thickness=0.3 * f.length, length=8.0 * f.length, height=3.0 * f.length
    ).translated((-0.05 * f.length, 0.0, 0.0))
    speed = 6000.0 * f.length / f.time
    sim = sc.Simulation(
        strip,
        supports=[sc.Support.clamped("bottom"), sc.Support.clamped("top")],
        tool=blade,
        motion=sc.StraightMotion((1.0, 0.0, 0.0), speed=speed, ramp=1e-4 * f.time),
        **options(f),
    )
    return curve(sim, f, until)


def assert_agrees(scaled, reference, f):
    assert scaled.shape == reference.shape
    if f in POWERS_OF_TWO:
        np.testing.assert_array_equal(scaled, reference)
    largest = np.abs(reference).max(axis=0)
    # Round-off that the cut lets grow, also where edges of the blade are rounded: measured 3e-9.
    assert (np.abs(scaled - reference) <= 1e-8 * largest).all()


def test_the_opening_test_has_no_scale_of_its_own():
    reference = opening(REFERENCE)
    n_split, n_joint, n_broken = reference[-1, -3:]
    assert n_split >= 16
    assert n_joint >= 16
    assert n_broken > 0
    for f in POWERS_OF_TWO:
        assert_agrees(opening(f), reference, f)


def test_the_guillotine_has_no_scale_of_its_own():
    reference = guillotine(REFERENCE)
    assert (reference[-1, -3:] > 2).all()
    for f in OTHERS:
        assert_agrees(guillotine(f), reference, f)


def test_a_static_solution_has_no_scale_of_its_own():
    def solution(f):
        mesh = f.mesh(rectangle(4.0, 3.0, size=0.5))
        model = sc.Statics(
            mesh,
            f.material(FILM),
            supports=[sc.Support.clamped(side) for side in ("left", "right", "bottom", "top")],
            loads=[sc.Pressure(0.05 * f.stress)],
        )
        return model.load_steps([0.2, 0.5, 1.0])[-1].displacement[:, :3] / f.length

    reference = solution(REFERENCE)
    largest = np.abs(reference).max()
    assert largest > 0.074  # far from linear
    for f in POWERS_OF_TWO + OTHERS:
        np.testing.assert_allclose(solution(f), reference, rtol=0.0, atol=1e-9 * largest)
