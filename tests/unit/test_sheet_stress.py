"""The stress of a sheet, found again from the field of a crack with zones of its strength."""

import numpy as np
import pytest
from scipy.integrate import quad

from shellcut.fracture.sheet_stress import sheet_stress


def ahead_of_a_crack(p, x, a=1.0):
    """Return the stress at x ahead of a zone over the strength, and c / x.

    A crack of length 2b under p, less what pairs of forces do that hold its zones together.
    """
    b = a / np.cos(0.5 * np.pi * p)
    at = b + x

    def pair(angle):  # at b sin(angle) on either side
        return 2.0 * b * np.cos(angle) * b * np.cos(angle) / (at**2 - (b * np.sin(angle)) ** 2)

    zones = quad(pair, np.arcsin(a / b), 0.5 * np.pi)[0]
    stress = (p - zones / np.pi) * at / np.sqrt(at**2 - b**2)
    return stress, -np.log(np.cos(0.5 * np.pi * p)) * a / x


@pytest.mark.parametrize("p", [0.05, 0.3, 0.6, 0.9, 0.99])
@pytest.mark.parametrize("x", [0.01, 0.3, 3.0, 100.0])
def test_the_stress_of_the_sheet_is_found_again(p, x):
    stress, length = ahead_of_a_crack(p, x)
    assert p < stress < 1.0
    assert sheet_stress(stress, length) == pytest.approx(p, abs=1e-6)
