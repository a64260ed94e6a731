"""F02 Steady straight cut: the blade's work is the fracture energy.

A clamped strip of the film of 2010, cut along its middle without friction. Read: mean force over
whole node periods of the steady part, the cables' part of it, and the imbalance of the energies.

Source: exact as a statement of energy (Atkins and Mai 1979): F = G h = 43.5 * 0.074 = 3.219 N.

Bands: the force is a sawtooth with the node spacing, of which a mean over m periods keeps 1 / m at
most; damping and waves come on top, at 6 m/s against 1300 m/s of the film's waves: 2 %. The
energies balance to the second order of the step.
"""

import numpy as np

from cases.paths import curve
from courses import steady_works
from harness import Check, zero
from shellcut import guillotine

ID, TITLE, FAST = "F02", "Steady cut, energy balance", True

SIZE = 0.8  # mm
EXACT = 43.5 * 0.074

CURVES = {}
AXES = "path of the blade, mm", "work of the blade, N·mm"


def checks():
    case = guillotine(SIZE, length=20.0)
    means, worst, (path, work, _) = steady_works(case, SIZE, 8.0, "tool_work", "cohesive_work")
    n = int((path[-1] - 8.0) / SIZE)
    ends = np.array([8.0, path[-1]])
    exact = np.interp(8.0, path, work) + EXACT * (ends - 8.0)
    CURVES["work of the blade"] = curve(path, work, ends, exact)
    yield Check(f"mean force over {n} periods, N", EXACT, means[0], 0.02, "mesh, damping, waves")
    yield Check(f"cables' part over {n} periods, N", EXACT, means[1], 0.02, "mesh")
    yield zero("largest imbalance / work", worst, 1e-3, "time step")
