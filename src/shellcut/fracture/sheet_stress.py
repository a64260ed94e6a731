"""The stress of a sheet with a crack, from the stress that the crack adds ahead of its tip.

A crack of length 2a under a stress p, with zones at its ends that carry the strength sigma_F, has
([Dugdale1960]; the stress ahead by [Tada2000]), with phi = pi p / 2 sigma_F and b = a sec phi,

    J = (8 sigma_F² a h / pi E) ln sec phi,
    cot²(pi sigma / 2 sigma_F) = (1 - (b / (b + x))²) cot² phi    at x ahead of a zone.

Of a tip J and sigma are known, p and a are not. With c = pi E J / 8 sigma_F² h, the length of the
zone where p is small, a = c / ln sec phi is left out and phi remains,

    tan² phi = (1 - (1 + x / b)^-2) tan²(pi sigma / 2 sigma_F),    b = c / (cos phi ln sec phi).

There is no more than one such phi. It is 0, all stress is that of the tip, up to
tan²(pi sigma / 2 sigma_F) = c / x. At the strength all stress is that of the sheet.
"""

from __future__ import annotations

import math

import scipy

# A smaller phi [rad] is none.
_LEAST = 1e-3


def sheet_stress(stress: float, length: float) -> float:
    """Return the stress of the sheet.

    Parameters
    ----------
    stress : float
        What is measured ahead, over the strength, not negative.
    length : float
        c over the distance at which it is measured, not negative.

    Returns
    -------
    float
        p over the strength, ``stress`` at most.

    Examples
    --------
    >>> sheet_stress(0.4, 1.0), sheet_stress(1.2, 1.0)
    (0.0, 1.2)
    >>> round(sheet_stress(0.8, 1.0), 3)
    0.736
    """
    if stress >= 1.0 or length == 0.0:
        return stress
    ahead = math.tan(0.5 * math.pi * stress) ** 2

    def excess(phi: float) -> float:
        farther = -math.cos(phi) * math.log(math.cos(phi)) / length
        tangent, grown = math.tan(phi), 1.0 + farther
        return ahead * (1.0 - 1.0 / (grown * grown)) - tangent * tangent

    if excess(_LEAST) <= 0.0:
        return 0.0
    return float(scipy.optimize.brentq(excess, _LEAST, 0.5 * math.pi * stress)) / (0.5 * math.pi)
