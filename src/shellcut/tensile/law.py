"""A cohesive law from the falling part of tensile curves: :func:`proposed_law`.

The stress of a cable is nominal, as that of the specimen. Its area is kept: opening_u follows from
the fracture energy and the other three numbers, which are fitted to the mean curve.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from shellcut.arrays import Floats
from shellcut.cables.cohesive_law import CohesiveLaw

from .figures import Figures

_N_POINT = 101  # of the mean curve
_N_GRID = 16
_N_ZOOM = 6
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
    """Return the law nearest to a falling curve, with the given area.

    Parameters
    ----------
    opening : ndarray, shape (n,), [mm]
        From 0.
    stress : ndarray, shape (n,), [MPa]
        The first is the strength.
    fracture_energy : float, [N/mm]
    """
    strength, end = float(stress[0]), float(opening[-1])
    low, high = np.array([0.02, 1e-3, 1e-3]), np.array([1.0, 1.0, 1.0])
    first_low, first_high = low, high
    best = low
    for _ in range(_N_ZOOM):
        axes = [np.linspace(a, b, _N_GRID) for a, b in zip(low, high, strict=True)]
        trial = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
        miss = _misses(trial, opening / end, stress / strength, fracture_energy / strength / end)
        best = trial[int(np.argmin(miss))]
        reach = 1.5 * (high - low) / (_N_GRID - 1)
        low, high = np.maximum(best - reach, first_low), np.minimum(best + reach, first_high)
    plateau, drop, flat = best.tolist()
    a, p = drop, drop + flat * (1.0 - drop)
    u = _end(plateau, a, p, fracture_energy / strength / end)
    return CohesiveLaw(
        strength=strength,
        plateau=plateau * strength,
        opening_a=a * end,
        opening_p=p * end,
        opening_u=float(u) * end,
        onset=float(u) * end * _ONSET,
    )


def _end(plateau: Floats, a: Floats, p: Floats, area: float) -> Floats:
    # opening_u of a law of this area; all over strength and end of the curve
    end: Floats = (2.0 * area - (1.0 - plateau) * a) / plateau - p
    return end


def _misses(trial: Floats, opening: Floats, stress: Floats, area: float) -> Floats:
    # mean square distance of each law from the curve; infinite where there is no such law
    plateau, a = trial[:, :1], trial[:, 1:2]
    p = a + trial[:, 2:] * (1.0 - a)
    u = _end(plateau, a, p, area)
    with np.errstate(divide="ignore", invalid="ignore"):
        drop = 1.0 - (1.0 - plateau) * opening / a
        tail = plateau * np.clip((u - opening) / (u - p), 0.0, 1.0)
    law = np.where(opening < a, drop, np.where(opening < p, plateau, tail))
    miss: Floats = ((law - stress) ** 2).mean(axis=1)
    miss[(u <= 1.001 * p)[:, 0]] = np.inf
    return miss
