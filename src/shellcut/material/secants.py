r"""How stiff the layers of a film still are where it carries a tension in all directions.

By deformation theory, for a tension T of a layer in both directions and the mean strain e of both
directions, with S the compliance, P the flow matrix of :mod:`.plastic` and 1 = (1, 1, 0),

    e = c T + ½ q p,    T = σ_y(p) / q,    c = ½ 1·S 1,    q² = 1·P 1,

of von Mises q = 1. Both products are the same in all axes of the plane. The layers share e, and
their secant modulus is c T / e of what it is before they yield. Strains are logarithmic; loading is
slow: factors by rate are left out.
"""

from __future__ import annotations

import math

import numpy as np

from shellcut.arrays import Floats
from shellcut.numerics.small_matrices import inverse

from .material import Material
from .plastic import Plastic
from .shell_material import ShellMaterial

FARTHEST = 2.5
"""Strain up to which films are followed."""

_HALVINGS = 60


def secants_at(film: ShellMaterial, tension: float) -> tuple[Floats, float]:
    """Return the secant moduli where a film carries a tension in all directions.

    Parameters
    ----------
    film : ShellMaterial
    tension : float
        Over the reference film [N/mm].

    Returns
    -------
    secants : ndarray, shape (n_layer,)
        Over the moduli: 1 of layers that do not yield. A law that is none of this package's counts
        as one of these.
    strain : float
        There; ``FARTHEST`` if the film carries less.

    Examples
    --------
    >>> secants, strain = secants_at(ShellMaterial.homogeneous(), 1.0)
    >>> secants.tolist(), round(strain, 4)
    ([1.0], 0.0056)
    """
    layers = [(layer.thickness, layer.material, _over(layer.material)) for layer in film.layers]
    low, high = 0.0, FARTHEST
    for _ in range(_HALVINGS):
        strain = 0.5 * (low + high)
        each = [h * _tension(material, c, strain) for h, material, c in layers]
        low, high = (low, strain) if math.fsum(each) > tension else (strain, high)
    secants = [c * _tension(material, c, strain) / strain for _, material, c in layers]
    plastic = [isinstance(material, Plastic) for _, material, _ in layers]
    return np.where(plastic, secants, 1.0), strain


def _over(material: Material) -> float:
    """Return c [1/MPa]."""
    S = inverse(material.plane_stress())
    return float(0.5 * (S[0, 0] + 2.0 * S[0, 1] + S[1, 1]))


def _tension(material: Material, c: float, strain: float) -> float:
    """Return T at a strain [MPa]."""
    if not isinstance(material, Plastic):
        return strain / c
    P = material.flow_matrix()
    q = math.sqrt(float(P[0, 0] + 2.0 * P[0, 1] + P[1, 1]))
    if strain <= c * material.hardening.first_yield / q:
        return strain / c
    low, high, tension = 0.0, 2.0 * strain / q, 0.0
    for _ in range(_HALVINGS):
        p = 0.5 * (low + high)
        tension = float(material.hardening.stress(p)) / q
        low, high = (low, p) if c * tension + 0.5 * q * p > strain else (p, high)
    return tension
