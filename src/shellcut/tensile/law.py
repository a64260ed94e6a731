"""A cohesive law from the falling part of tensile curves: :func:`proposed_law`.

The stress of a cable is nominal, as that of the specimen. Its area is kept: opening_u follows from
the fracture energy and the other three numbers, which are fitted to the mean curve.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy

from shellcut.arrays import Floats
from shellcut.cables.cohesive_law import CohesiveLaw

from .figures import Figures

_N_POINT = 101  # of the mean curve
_BOUNDS = [(0.02, 1.0), (1e-3, 1.0), (1e-3, 1.0)]  # of plateau, l_A and length of the plateau
_ONSET = 1.0 / 800.0  # over opening_u, as in the paper's law


def falling_curve(figures: Sequence[Figures], gauge_length: float) -> tuple[Floats, Floats]:
    """Return opening [mm] and mean nominal stress [MPa] after the strength.

    Shapes, ends and strengths are averaged apart, so that one early break does not make a step.
    """
    share = np.linspace(0.0, 1.0, _N_POINT)
    shapes, ends = [], []
    for one in figures:
        ends.append(gauge_length * one.opening_per_length[-1])
        of_end = one.opening_per_length / one.opening_per_length[-1]
        shapes.append(np.interp(share, of_end, one.falling_stress / one.falling_stress[0]))
    strength = np.mean([one.strength for one in figures])
    return share * np.mean(ends), strength * np.mean(shapes, axis=0)


def proposed_law(opening: Floats, stress: Floats, fracture_energy: float) -> CohesiveLaw:
    """Return the law nearest to a falling curve, with the given area [N/mm].

    The openings [mm] begin at 0, the stresses [MPa] with the strength.
    """
    strength, end = float(stress[0]), float(opening[-1])
    area, x, y = fracture_energy / strength / end, opening / end, stress / strength

    def miss(shape: Floats) -> float:
        plateau, a, p, u = _openings(shape, area)
        if u <= 1.001 * p:
            return float("inf")
        drop, tail = 1.0 - (1.0 - plateau) * x / a, plateau * np.clip((u - x) / (u - p), 0.0, 1.0)
        law = np.where(x < a, drop, np.where(x < p, plateau, tail))
        return float(np.mean((law - y) ** 2))

    found = scipy.optimize.differential_evolution(miss, _BOUNDS, seed=0, tol=1e-6, polish=False)
    plateau, a, p, u = map(float, _openings(found.x, area))
    return CohesiveLaw(
        strength=strength,
        plateau=plateau * strength,
        opening_a=a * end,
        opening_p=p * end,
        opening_u=u * end,
        onset=u * end * _ONSET,
    )


def _openings(shape: Floats, area: float) -> tuple[float, float, float, float]:
    """Return plateau and l_A, l_P, l_U of a law of this area, over strength and end of the curve.

    ``shape`` is the plateau, l_A, and the share of the plateau in what is left to the end.
    """
    plateau, a, flat = shape.tolist()
    p = a + flat * (1.0 - a)
    return plateau, a, p, (2.0 * area - (1.0 - plateau) * a) / plateau - p
