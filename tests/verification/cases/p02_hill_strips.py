"""P02 Strips of a rolled sheet: strength and r-value by angle, from Hill's criterion.

r = 0.8, 1.2, 1.6 at 0, 45 and 90°; a strip along MD yields at 1. Strips are cut at angles of 0 to
90° and pulled far beyond yield; their strength and the ratio of plastic strains in width and
thickness are those of the closed form,

    r(theta) = [H + (2N - F - G - 4H) s² c²] / (F s² + G c²).

Source: Hill 1948.
"""

import numpy as np

from harness import Check
from shellcut.material import Elastic, Linear, MaterialPoint, Plastic

ID, TITLE, FAST = "P02", "Hill's strips", True

R0, R45, R90 = 0.8, 1.2, 1.6
G, H, F = 1.0 / (1.0 + R0), R0 / (1.0 + R0), R0 / (R90 * (1.0 + R0))
N = (R0 + R90) * (1.0 + 2.0 * R45) / (2.0 * R90 * (1.0 + R0))
STRENGTH = {45.0: 1.04447, 90.0: 1.17670}
ROUND_OFF = "closed form; the rest is elastic"


def film(angle: float) -> Plastic:
    """Return the film in the axes of a strip cut at an angle [degrees]."""
    return Plastic(Elastic(1e4, 0.3, 1e-9), Linear(1.0), (R0, R45, R90), angle_deg=-angle)


def checks() -> list[Check]:
    rows = []
    for angle in (0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 90.0):
        s, c = np.sin(np.radians(angle)), np.cos(np.radians(angle))
        state = MaterialPoint(film(angle)).pull(0.5)
        along = state.history["plastic strain 11 [-]"]
        across = state.history["plastic strain 22 [-]"]
        r = (H + (2.0 * N - F - G - 4.0 * H) * s * s * c * c) / (F * s * s + G * c * c)
        ours = across / (-along - across)
        rows.append(Check(f"r at {angle:g}°", r, ours, 1e-7, ROUND_OFF))
        if angle in STRENGTH:
            name, value = f"strength at {angle:g}°", STRENGTH[angle]
            rows.append(Check(name, value, float(state.stress[0]), 5e-6, "last digit"))
    # Where both stresses agree the normal to the surface, and so the flow, has the ratio G : F.
    both = MaterialPoint(film(0.0)).strain_to([0.4 * G, 0.4 * F, 0.0])
    rows.append(Check("equibiaxial strength", 1.09545, float(both.stress[0]), 1e-4, "elastic part"))
    shear = MaterialPoint(film(0.0)).strain_to([0.0, 0.0, 0.8])
    rows.append(Check("strength in shear", 0.59409, float(shear.stress[2]), 1e-5, "last digit"))
    return rows
