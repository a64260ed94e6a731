"""F01 Cohesive law of the 2010 paper: dissipated energy.

sigma_F = 18, sigma_C = 12 MPa, l_A = 0.5, l_P = 3, l_U = 4 mm, opened monotonically. Read: area
below the traction, by the trapezoidal rule over its corners, and the law's own value.

Source: Frangi and others (2010), 5.1: 1.5 + 42 = 43.5 N/mm, exact.
"""

import numpy as np

from cases.paths import curve
from harness import Check
from shellcut import CohesiveLaw

ID, TITLE, FAST = "F01", "Cohesive law, dissipated energy", True
AXES = "opening, mm", "traction, MPa"

CURVES = {}


def checks():
    law = CohesiveLaw()
    opening = np.linspace(0.0, 4.0, 801)  # 0, 0.5, 3 and 4 among them
    traction = np.array([law.traction(float(w)) for w in opening])
    CURVES["traction"] = curve(opening, traction, [0.0, 0.5, 3.0, 4.0], [18.0, 12.0, 12.0, 0.0])
    area = float(0.5 * ((traction[1:] + traction[:-1]) * np.diff(opening)).sum())
    return [
        Check("area below the traction, N/mm", 43.5, area, 1e-12, "round-off"),
        Check("fracture_energy, N/mm", 43.5, law.fracture_energy, 1e-12, "round-off"),
    ]
