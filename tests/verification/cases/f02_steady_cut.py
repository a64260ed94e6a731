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
from harness import Check
from shellcut import guillotine
from steady_cut_works import steady_works

ID, TITLE, FAST = "F02", "Steady cut, energy balance", True

SIZE = 0.8  # mm
EXACT = 43.5 * 0.074

CURVES = {}
AXES = "path of the blade, mm", "work of the blade, N·mm"


def checks() -> list[Check]:
    case = guillotine(SIZE, length=20.0)
    means, worst, (path, work, _) = steady_works(case, SIZE, 8.0, "tool_work", "cohesive_work")
    n = int((path[-1] - 8.0) / SIZE)
    CURVES["work of the blade"] = curve(
        path,
        work,
        [8.0, float(path[-1])],
        [float(np.interp(8.0, path, work)) + EXACT * d for d in (0.0, path[-1] - 8.0)],
    )
    return [
        Check(f"mean force over {n} periods, N", EXACT, means[0], 0.02, "mesh, damping, waves"),
        Check(f"cables' part over {n} periods, N", EXACT, means[1], 0.02, "mesh"),
        Check("largest imbalance / work", 0.0, worst, 1e-3, "time step", absolute=True),
    ]
