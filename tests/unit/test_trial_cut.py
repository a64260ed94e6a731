"""The nodal force of a trial cut under a uniform stress: the stress times the length it opens."""

import numpy as np
import pytest

import shellcut as sc
from naive import trial_cut
from shellcut.fracture.crack_path import CrackPath
from shellcut.fracture.trial_cut import TrialCut, TrialSums
from shellcut.mesh.structured import rectangle

SIZE, STRETCH = 0.5, 0.004


def trial_of(sim):
    return TrialCut(sim.cracks.cuts.topology, sim.shell, sim.loads, sim.law.strength)


def measures_of(sim, segment):
    """Return the force across the segment, by the plain twin, and that of a tear."""
    trial = trial_of(sim)
    return (
        trial_cut.measure(trial, sim.state, segment),
        TrialSums(trial).of_tear(sim.state, segment),
    )


def notched(rise):
    """A sheet notched ``rise`` above the middle line, and the segment ahead of its tip."""
    mesh = rectangle(5.0, 4.0, size=SIZE)
    film = sc.ShellMaterial.homogeneous(young=1678.0, poisson=0.3, density=1e-9, thickness=0.074)
    fracture = sc.Fracture(path="free")
    sim = sc.Simulation(mesh, film, law=sc.CohesiveLaw(), fracture=fracture, damping_beta=0.0)
    rim = mesh.nodes[:, 0].min()
    sim.notch((rim - 1.0, rise, 0.0), (rim + 2.2, rise, 0.0))
    (tip,) = sim.cracks.tips
    path = CrackPath(sim.cracks.cuts.topology, sim.shell)
    return sim, tip, path.segment_from(sim.state, tip, tip.heading)


@pytest.mark.parametrize("rise", [0.1, 0.37, 0.5, 0.9])
def test_uniform_stress_is_found_wherever_in_the_quads_the_crack_runs(rise):
    """The crack runs along rows of equal quads, ``rise`` of an edge above the row's lower side."""
    sim, tip, segment = notched(rise * SIZE)
    n = sim.state.node
    n.x[: n.count, 1] = (1.0 + STRETCH) * n.X[: n.count, 1]  # the notch's flanks stay closed
    # First Piola-Kirchhoff stress: force over reference length and thickness.
    strain = STRETCH + 0.5 * STRETCH**2
    stress = (1.0 + STRETCH) * 1678.0 / (1.0 - 0.3**2) * strain
    # Round-off of the products of the quads' strains with their stiffness.
    for found in measures_of(sim, segment):
        # The notch, which no cable holds, opens with the segment ahead: twice its length.
        assert found == pytest.approx(2.0 * stress / sim.law.strength, rel=1e-9)
    assert np.isclose(tip.s, rise) or np.isclose(1.0 - tip.s, rise)


def test_a_tear_counts_the_force_across_the_sheet_and_pressure_only_against_what_opens_it():
    """A trial cut of a sheet at rest, with forces on the flanks given by its quads' strains."""
    sim, _, segment = notched(0.1)
    n = sim.state.node
    # Corners of the upper copy behind the tip that no other part of the film has.
    ((_, (lower, upper)), *_) = trial_of(sim).pairs(sim.state, segment)
    parent, quads = sim.state.quad.parent, sim.state.quads
    behind = next((a, b) for a in lower.rows for b in upper.rows if a < b and parent[b] == a)
    raised = np.setdiff1d(quads[behind[1]], [*quads[behind[0]], *quads[segment.row]])

    def measures(stretch, shear, opened=0.0):
        n.x[: n.count] = n.X[: n.count]
        n.x[: n.count, 1] *= 1.0 + stretch
        n.x[: n.count, 2] += shear * n.X[: n.count, 1]
        n.x[raised, 2] += opened
        return measures_of(sim, segment)

    plain, tear = measures(0.002, 0.0)
    assert tear == pytest.approx(plain, rel=1e-9)  # round-off
    plain, tear = measures(0.002, 0.001)  # directors stay upright: the sheet is sheared
    shear = 5.0 / 6.0 * 1678.0 / 2.6 * 0.001
    across = 2.0 * shear * 1.002 / sc.CohesiveLaw().strength  # with the notch behind the tip
    # Kinematics: forces by the small shear in space, of the relative size of the strains.
    assert np.sqrt(tear**2 - plain**2) == pytest.approx(across, rel=0.01)
    pressed = -0.0002
    plain, tear = measures(pressed, 0.001)
    assert plain < 0.0
    assert tear == 0.0
    _, closing = measures(pressed, 0.001, opened=-1e-7)
    assert closing == 0.0
    _, opening = measures(pressed, 0.001, opened=1e-7)
    assert opening == pytest.approx(across + plain, rel=0.01)  # kinematics, as above
    assert opening > 0.1 * across
    _, squeezed = measures(-0.002, 0.001, opened=1e-7)
    assert squeezed == 0.0
