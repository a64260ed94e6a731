"""F01 the energy of the cohesive law, F02 that of a steady cut."""

import numpy as np

from cases.paths import curve
from courses import steady_works
from harness import Check, case, zero
from shellcut import CohesiveLaw, guillotine


@case("F01", "Cohesive law, dissipated energy", axes=("opening, mm", "traction, MPa"))
def f01():
    """The law of the 2010 paper, sigma_F = 18, sigma_C = 12 MPa, l_A = 0.5, l_P = 3, l_U = 4 mm,
    opened monotonically. Read: area below the traction, by the trapezoidal rule over its corners,
    and the law's own value.

    Source: Frangi and others (2010), 5.1: 1.5 + 42 = 43.5 N/mm, exact.
    """
    law = CohesiveLaw()
    opening = np.linspace(0.0, 4.0, 801)  # 0, 0.5, 3 and 4 among them
    traction = np.array([law.traction(float(w)) for w in opening])
    f01.CURVES["traction"] = curve(opening, traction, [0.0, 0.5, 3.0, 4.0], [18.0, 12.0, 12.0, 0.0])
    area = float(0.5 * ((traction[1:] + traction[:-1]) * np.diff(opening)).sum())
    return [
        Check("area below the traction, N/mm", 43.5, area, 1e-12, "round-off"),
        Check("fracture_energy, N/mm", 43.5, law.fracture_energy, 1e-12, "round-off"),
    ]


SIZE = 0.8  # mm
EXACT = 43.5 * 0.074


@case(
    "F02", "Steady cut, energy balance", axes=("path of the blade, mm", "work of the blade, N·mm")
)
def f02():
    """A clamped strip of the film of 2010, cut along its middle without friction. Read: mean force
    over whole node periods of the steady part, the cables' part of it, and the imbalance of the
    energies.

    Source: exact as a statement of energy (Atkins and Mai 1979): F = G h = 43.5 * 0.074 = 3.219 N.

    Bands: the force is a sawtooth with the node spacing, of which a mean over m periods keeps 1 / m
    at most; damping and waves come on top, at 6 m/s against 1300 m/s of the film's waves: 2 %. The
    energies balance to the second order of the step.
    """
    case = guillotine(SIZE, length=20.0)
    means, worst, (path, work, _) = steady_works(case, SIZE, 8.0, "tool_work", "cohesive_work")
    n = int((path[-1] - 8.0) / SIZE)
    ends = np.array([8.0, path[-1]])
    exact = np.interp(8.0, path, work) + EXACT * (ends - 8.0)
    f02.CURVES["work of the blade"] = curve(path, work, ends, exact)
    yield Check(f"mean force over {n} periods, N", EXACT, means[0], 0.02, "mesh, damping, waves")
    yield Check(f"cables' part over {n} periods, N", EXACT, means[1], 0.02, "mesh")
    yield zero("largest imbalance / work", worst, 1e-3, "time step")
