"""Cracks through the quads of a film under pressure: what is released, and what the cables take."""

import numpy as np
import pytest

import shellcut as sc
from courses import course, largest_share
from curved_films import TORN, moved
from films import free_film
from naive import trial_cut
from shellcut.fracture.crack_path import CrackPath
from shellcut.fracture.cut_film import CutFilm
from shellcut.mesh.structured import cylinder, rectangle
from tip_domains import at_tip, force_on

RADIUS, PRESSURE, N_AROUND = 6.0, 0.1, 32


def slit_cylinder(notch, rise, **options):
    """A cylinder whose ends slide in their planes, with a slit along it through its quads."""
    mesh = cylinder(RADIUS, 14.0, n_around=N_AROUND, n_along=14)
    ends = [sc.Support(name, translation="y", rotation="") for name in ("bottom", "top")]
    sim = free_film(mesh, supports=ends, law=TORN, **options)
    # Between two columns of nodes, at ``rise`` of the side.
    a, b = mesh.nodes[mesh.quads[0, 0]], mesh.nodes[mesh.quads[0, 1]]
    start = a + rise * (b - a)
    sim.notch(start - [0.0, 0.3, 0.0], start + np.array([0.0, notch, 0.0]))
    return sim


@pytest.mark.parametrize(("rise", "error"), [(0.5, 1e-9), (0.2, 3e-3)])
def test_a_trial_cut_finds_the_hoop_tension(rise, error):
    load = sc.Pressure(PRESSURE, following=True)
    sim = slit_cylinder(3.2, rise, loads=[load], damping_beta=0.0)
    n, free = sim.state.node, sim.cracks
    (tip,) = free.tips
    segment = CrackPath(CutFilm(free.cuts.topology, sim.shell)).segment_from(
        sim.state, tip, tip.heading
    )
    # Blow it up evenly, the slit closed, to where its nodes are at rest.
    off_ends = np.flatnonzero((np.abs(n.X[: n.count, 1]) < 2.5) & (n.mass[: n.count] > 0.0))

    def outward(grown):
        n.x[: n.count] = n.X[: n.count] * [grown, 1.0, grown]
        sim.loads.begin_forces(sim.state)
        sim.shell.add_forces(sim.state)
        radial = n.X[off_ends] * [1.0, 0.0, 1.0]
        return float((n.force[off_ends] * radial).sum())

    low, high = 1.0, 1.02
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if outward(middle) > 0.0 else (low, middle)
    # Free body: half of the prism, cut through the middles of two facets.
    tension = PRESSURE * low * RADIUS * np.cos(np.pi / N_AROUND)
    film = trial_cut.Film(free.cuts.topology, sim.shell, sim.loads, sim.law.strength)
    measure = trial_cut.measures(film, sim.state, tip, segment)[0]
    # In the middle of a facet round-off of the forces of stiff quads; beside it the forces on the
    # two flanks are not alike: of the order of the squared angle between facets, measured 0.22 %.
    # The slit behind the tip, which no cable holds, opens with the segment ahead: twice its length.
    carried = sim.law.strength * sim.material.thickness
    assert measure * carried == pytest.approx(2.0 * tension, rel=error)


def test_a_strongly_bent_strip_releases_what_a_longer_crack_does():
    """Flanks bent by six thicknesses: J against a difference of potentials, strip at rest."""
    film = sc.ShellMaterial.homogeneous(young=1678.0, poisson=0.3, density=1e-9, thickness=0.1)
    potential, J = {}, {}
    for end in (5.0, 6.0, 7.0):
        mesh = rectangle(12.0, 4.0, size=0.25)
        sim = sc.Simulation(
            mesh,
            film,
            supports=[sc.Support.clamped("bottom"), sc.Support.clamped("top")],
            loads=[sc.Pressure(0.05)],
            law=sc.CohesiveLaw(strength=1e3),
            fracture=sc.Fracture(path="free"),
        )
        start = mesh.nodes[:, 0].min()
        sim.notch((start - 1.0, 0.0, 0.0), (start + end, 0.0, 0.0))
        sim.relax(tolerance=1e-3)
        n = sim.state.node
        sim.loads.begin_forces(sim.state)  # the load is dead
        done = (n.force[: n.count] * (n.x[: n.count] - n.X[: n.count])).sum()
        potential[end] = sim.ledger.initial - done
        for reach in (1.0, 1.8):
            J[end, reach] = force_on(sim, at_tip(sim), reach).of(sim.state)
    released = 0.5 * (potential[5.0] - potential[7.0])
    assert n.x[: n.count, 2].max() > 0.5
    for reach in (1.0, 1.8):
        # Discretisation: 0.99 and 0.98; 1.3 and 2.4 without what the load does.
        assert J[6.0, reach][0] == pytest.approx(released, rel=0.035)
        assert abs(J[6.0, reach][1]) < 5e-3 * released  # rest


def test_a_blade_cuts_a_strip_under_pressure():
    length, size = 8.0, 0.8
    mesh = moved(rectangle(length, 6.4, size=size), "random", 0.2, size, seed=4)
    law = sc.CohesiveLaw(opening_a=0.1, opening_p=0.3, opening_u=0.6)
    ramp = {"factor": lambda time: min(time / 2e-4, 1.0)}
    sim = sc.guillotine(
        mesh=mesh,
        notch=1.6,
        travel=length,
        speed=12000.0,
        law=law,
        loads=[
            sc.Pressure(0.001, following=True, **ramp),
            sc.Pressure(0.001, **ramp),
            sc.EdgeTraction("right", (0.002, 0.0, 0.001), **ramp),
        ],
        fracture=sc.Fracture(path="free"),
    ).simulation
    _, tool, imbalance = course(sim, (length + 3.0) / 12000.0, "tool_work", "imbalance", every=50)
    assert largest_share(imbalance, tool, 0.3) < 5e-3  # measured 0.06 %
    book, cables = sim.close_ledger(), sim.state.cable
    assert not sim.cracks.tips
    assert sim.cables.n_broken == cables.count
    tearing = law.fracture_energy * sim.material.thickness * sim.state.crack_length
    assert book.cohesive_work == pytest.approx(tearing, rel=3e-3)  # measured 0.9997


def test_a_pressurised_cylinder_bursts():
    load = sc.Pressure(PRESSURE, following=True, factor=lambda time: min(time / 2e-4, 1.0))
    # A cable breaks in a few steps of this burst; with the default 0.95 its work is 0.9 % less.
    step = sc.Stepping(safety=0.45)
    sim = slit_cylinder(3.2, 0.37, loads=[load], damping_alpha=3000.0, stepping=step)

    def burst(one):
        return not one.cracks.tips or one.state.time >= 4e-4

    _, work, imbalance = course(sim, burst, "load_work", "imbalance", every=20)
    assert largest_share(imbalance, work, 0.5) < 5e-3  # measured 0.07 %
    assert not sim.cracks.tips
    while sim.cables.n_broken < sim.state.n_cable and sim.state.time < 5e-4:
        sim.step()
    book = sim.close_ledger()
    tearing = sim.law.fracture_energy * sim.material.thickness * sim.state.crack_length
    assert book.cohesive_work == pytest.approx(tearing, rel=1e-3)  # measured 1.0001
    # Straight along the cylinder, as is even; until the domain of the tip's force, of four edges,
    # comes to the end of the cylinder at 7 mm. Without the pressure's part it winds by 40°.
    place = np.array([cut.reference for cut in sim.state.split_log if cut.kind != "notch"])
    angle = np.degrees(np.arctan2(place[:, 2], place[:, 0]))[place[:, 1] <= 3.0]
    assert len(angle) >= 6
    assert np.ptp(angle) < 4.0  # measured 2.5, of quads of 11°
