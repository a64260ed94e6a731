"""P01 Plasticity on a path of stresses that turns: von Mises, isotropic hardening.

E = 195,000, nu = 0.3, yield stress 181, tangent 1,930 MPa (H = 1949.29). One point is led by
stresses from zero to A (151.2, 93.1) and on a straight line to B (257.2, 33.1), sigma_xx and
tau_xy. The law is that of the films, between logarithmic strain and its stress, where a path of
small strains is exact at any size.

Source: inputs of Code_Aster V6.03.015 (SSNP15); values integrated from the rate equations in small
steps, converged. The return at the end of the step is of the first order in the step on the leg
that turns, and one in all where it does not: the strains at B are extrapolated from 80 and 160
steps.
"""

import numpy as np

from harness import Check
from shellcut.material import Elastic, Linear, MaterialPoint, Plastic

ID, TITLE, FAST = "P01", "Plasticity on a path that turns", True

MODULUS = 1930.0 * 195000.0 / (195000.0 - 1930.0)
A, B = np.array([151.2, 0.0, 93.1]), np.array([257.2, 0.0, 33.1])
REFERENCE = (0.0148297, 0.0136014, 0.0205473), (0.0352649, 0.0204709, 0.0423293)
NAMES = ("strain xx", "strain xy", "equivalent plastic strain")


def walk(steps: int) -> list[np.ndarray]:
    """Return strain xx, strain xy and equivalent plastic strain at A and B."""
    film = Plastic(Elastic(195000.0, 0.3, 1e-9), Linear(181.0, MODULUS))
    point, found = MaterialPoint(film), []
    for start, end in ((np.zeros(3), A), (A, B)):
        for k in range(1, steps + 1):
            state = point.stress_to(start + k / steps * (end - start))
        p = state.history["equivalent plastic strain [-]"]
        found.append(np.array([state.strain[0], 0.5 * state.strain[2], p]))
    return found


def checks() -> list[Check]:
    rows = []
    for at, one, other, wanted in zip("AB", walk(80), walk(160), REFERENCE, strict=True):
        ours = 2.0 * other - one
        for quantity, value, mine in zip(NAMES, wanted, ours, strict=True):
            rows.append(
                Check(
                    f"{quantity} at {at}, isotropic",
                    value,
                    float(mine),
                    5e-5 if at == "B" else 5e-6,
                    "last digit of the reference" if at == "A" else "second order in the step",
                )
            )
    return rows
