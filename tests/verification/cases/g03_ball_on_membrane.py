"""G03 A ball pressed into a stretched film: force over depth, between the nodes too.

A round film under an isotropic tension, clamped at its border; a triangulated ball moves down
slowly, a little off its middle. On the coarse mesh the circle of contact is smaller than a quad:
the film is met by the ball's corners between its nodes. Read: the force at a given depth.

Source: membrane under a load F at the distance d from the middle of a disc of radius a, and the
ball of radius R touching it within the radius c, frictionless (slopes small, tension T constant):
outside w = F / (2 pi T) ln((a² - d²) / (a r)), inside the ball itself; with equal slopes at c

    F = 2 pi T c² / R,    depth = c² / (2 R) + c² / R ln((a² - d²) / (a c)).

Bands: mesh. The mean slope of 0.05 raises the tension by 1 %; the ball's facets, 0.5 mm wide, lie
3 µm inside the sphere, 2 % of the depth. A quad of the coarse mesh is 2.7 c wide.
"""

import numpy as np

from blunt_tools import ball
from courses import moved_by, recorded
from harness import Check, zero
from shellcut import Contact, ShellMaterial, Simulation, StraightMotion, Support
from shellcut.mesh.structured import disc

ID, TITLE, FAST = "G03", "Ball on a membrane", True

RIM, BALL, TOUCHED, STRETCH = 10.0, 10.0, 0.7, 1.2  # mm, mm, mm, -
ASIDE = np.array([0.3, 0.17])  # mm
YOUNG, POISSON, THICKNESS = 1678.0, 0.3, 0.02
GAP = 0.002


def pressed(n_side, n_layer, depth):
    """Return the force at a depth, and the imbalance over the work."""
    mesh = disc(RIM / STRETCH, n_side=n_side, n_layer=n_layer)
    sim = Simulation(
        mesh,
        ShellMaterial.homogeneous(young=YOUNG, poisson=POISSON, thickness=THICKNESS),
        supports=[Support.clamped("rim")],
        tool=ball(BALL, 5).translated((ASIDE[0], ASIDE[1], BALL + GAP)),
        motion=StraightMotion((0.0, 0.0, -1.0), speed=100.0, ramp=2e-4),
        contact=Contact(),
        damping_alpha=3000.0,
    )
    sim.relax((STRETCH - 1.0) * mesh.nodes)
    forces = recorded(sim, moved_by(depth + GAP), lambda sim: sim.tooth_wrenches[0, 2])
    # Over a swing of the film on its springs; meanwhile it goes 2 µm down.
    ledger = sim.ledger
    return float(np.mean(forces[-100:])), abs(ledger.imbalance) / ledger.tool_work


def checks():
    tension = THICKNESS * YOUNG / (1.0 - POISSON) * 0.5 * (STRETCH**2 - 1.0)
    force = 2.0 * np.pi * tension * TOUCHED**2 / BALL
    reach = (RIM**2 - ASIDE @ ASIDE) / RIM
    depth = TOUCHED**2 / BALL * (0.5 + np.log(reach / TOUCHED))
    for n_side, n_layer, band in ((4, 2, 0.1), (12, 6, 0.05)):
        found, imbalance = pressed(n_side, n_layer, depth)
        edge = 2.0 * RIM / (n_side + 2.0 * n_layer)
        said = f"quads of {edge:.1f} mm, circle of {TOUCHED} mm"
        yield Check(f"force on the ball, N, {said}", force, found, band, "mesh, facets, slope")
        yield zero(f"imbalance / work, {said}", imbalance, 1e-6, "round-off")
