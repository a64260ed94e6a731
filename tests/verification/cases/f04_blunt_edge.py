"""F04 Blunt edge: the cutting force over the radius of the edge.

The guillotine of F02 with an edge of radius 0 to 0.2 mm, r / h up to 2.7. Read: work of the blade
per length over whole node periods, its part that friction takes, imbalance.

Source: exact as statements of energy. Without friction F = G h for every radius. With friction mu =
0.3 the force is G h and what friction takes; a cable whose ends lie on the blade gives that in
closed form (tests/verification/blunt_edge.py).

Bands: without friction 3 % for waves, on the force less what is damped, which has run-to-run
scatter (test_steady_cut.py): 8 %. A radius of 1 µm is to be within 0.5 % of the sharp edge. With
friction it adds 3e-4 of G h, as much as waves, so force and friction have to grow from there on.
For information: the ends of the cables are not on the blade but oscillate beside it.
"""

import numpy as np

from blunt_edge import FRICTION, THICKNESS, cut, on_the_blade
from cases.paths import curve
from harness import Check, case, zero

RADII = (0.0, 1e-3, 0.01, 0.02, 0.05, 0.1, 0.2)  # mm


@case(
    "F04",
    "Blunt edge",
    fast=False,
    axes=("radius of the edge over the thickness, r / h", "F / G h"),
)
def f04():
    free = np.array([cut(radius, joint="adhesion") for radius in RADII])
    for radius, (force, _, _, damped, _) in zip(RADII, free, strict=True):
        name = f"no friction, r = {radius:g} mm"
        yield Check(f"{name}: F less damping / G h", 1.0, force - damped, 0.03, "waves")
        yield zero(f"{name}: damping / G h", damped, 0.08, "run-to-run scatter")
        yield Check(f"{name}: F / G h", 1.0, force, 0.03, "damping, waves", gate=False)
    ratio = free[1, 0] / free[0, 0]
    yield Check("r = 1 um: F over that of the sharp edge", 1.0, ratio, 5e-3, "aim")
    rubbed = np.array([cut(radius, joint="slip", joint_friction=FRICTION) for radius in RADII])
    exact = [on_the_blade(radius, FRICTION) for radius in RADII]
    for radius, row, of_blade in zip(RADII, rubbed, exact, strict=True):
        name, (force, cables, friction, damped, _) = f"mu = {FRICTION:g}, r = {radius:g} mm", row
        parts = cables + friction + damped
        yield Check(f"{name}: F over its parts", parts, force, 0.02, "waves")
        what, why = f"{name}: friction / G h", "cable ends beside the blade"
        yield Check(what, of_blade, friction, 0.04, why, gate=False, absolute=True)
    for what, column in (("the force", 0), ("friction", 2)):
        grows = float((np.diff(rubbed[1:, column]) > 0.0).all())
        said = f"mu = 0.3: {what} grows with r from 1 um on (1: yes)"
        yield Check(said, 1.0, grows, 0.0, "exact", absolute=True)
    worst = max(free[:, 4].max(), rubbed[:, 4].max())
    yield zero("largest imbalance / work", worst, 5e-3, "time step")
    ratio = np.array(RADII) / THICKNESS
    f04.CURVES["μ = 0.3"] = curve(ratio, rubbed[:, 0], ratio, 1.0 + np.array(exact))
    f04.CURVES["no friction"] = curve(ratio, free[:, 0], ratio, np.ones(len(RADII)))
