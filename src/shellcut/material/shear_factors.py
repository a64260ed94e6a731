"""Transverse shear stiffness of layers, from the shear stress of cylindrical bending.

A shell has one transverse shear strain over its thickness, its layers have a shear stress that
follows from equilibrium. Where a film bends about an axis normal to n, the in-plane stress on
planes normal to n is, at the height z,

    s(z) = C_n (a + z b),      (C_n)_αβ = n_γ C_αγβδ n_δ,

with the moduli C of the layer at z; a and b are strain and curvature along n with their shear part.
Along n the membrane force stays and the moment grows by the shear force Q, so that their slopes are
A a' + B b' = 0 and B a' + D b' = Q with A, B, D = ∫ (1, z, z²) C_n dz. With τ' = - s', τ = 0 at the
faces and the neutral axis z_0 = A⁻¹ B, a height for each component,

    τ(z) = S(z) (D - B z_0)⁻¹ Q,       S(z) = ∫ C_n (z_0 - ζ) dζ from the bottom to z.

Q along the film's direction follows from bending along it, Q across it from bending across: they
are the columns of f(z) in τ = f Q. The shear stiffness that stores the energy of these stresses,
and the factor K on the layers' moduli that gives it, are

    (∫ fᵀ G⁻¹ f dz)⁻¹ = K ∫ G dz,

after [Whitney1973] and [Rohwer1988]. K couples both directions if the layers do. Without coupling
it is for each, with E' = C_11 or C_22 and z̄ counted from the neutral axis, ∫ E' z̄ dz = 0,

    k = (∫ E' z̄² dz)² / (∫ G dz ∫ S²/G dz),      S(z) = ∫ E' z̄ dζ from the bottom to z,

5/6 of one material, 0.011 of 56 µm of polyethylene between 9 µm of foil. K is the same in whatever
axes it is formed if all layers are isotropic or all have the same moduli. For others the energy of
bending along n with Q along n is no quadratic form of n: no K is right in all directions. This one
is right along and across the film's direction.
"""

from __future__ import annotations

import math

import numpy as np

from shellcut.arrays import Floats, each, product
from shellcut.numerics.small_matrices import inverse

# Of one material, where τ is a parabola: exactly what the integrals give, to the last digit.
_PARABOLA = 5.0 / 6.0

# Gauss points of a layer: τ is a parabola in each, its energy of the fourth degree.
_POINTS = 3

# Places of the stresses (11, 12) and (12, 22) on planes normal to the axes 1 and 2, among
# (11, 22, 12).
_ON_PLANE = ((0, 2), (2, 1))


def shear_factors(thickness: Floats, plane: Floats, shear: Floats) -> Floats:
    """Return K, shape (2, 2).

    Parameters
    ----------
    thickness : ndarray, shape (n,)
        Of the layers from the bottom up [mm].
    plane, shear : ndarray, shape (n, 3, 3) and (n, 2, 2)
        C for (E_11, E_22, 2 E_12) and G for (2 E_13, 2 E_23) of each in the film's axes [MPa].
    """
    if (plane == plane[0]).all() and (shear == shear[0]).all():
        return _PARABOLA * np.eye(2)
    place, weight = np.polynomial.legendre.leggauss(_POINTS)
    top = np.cumsum(thickness) - 0.5 * thickness.sum()
    bottom = top - thickness
    z = bottom[:, None] + 0.5 * thickness[:, None] * (1.0 + place)
    f = np.empty((*z.shape, 2, 2))
    for column, both in enumerate(_ON_PLANE):
        C = plane[:, both][:, :, both]
        A, B, D = (_between(C, bottom, top, power) for power in (1, 2, 3))
        neutral = product(inverse(A.sum(0)), B.sum(0))
        flow = inverse(D.sum(0) - product(B.sum(0), neutral))
        S = product(A, neutral) - B
        below = (np.cumsum(S, axis=0) - S)[:, None]
        C, low = C[:, None], bottom[:, None]
        S = below + product(_between(C, low, z, 1), neutral) - _between(C, low, z, 2)
        f[..., column] = product(S, flow)[..., column]
    energy = product(np.swapaxes(f, 2, 3), inverse(shear)[:, None], f)
    compliance = np.einsum("lp,lpij->ij", 0.5 * thickness[:, None] * weight, energy)
    whole = np.einsum("l,lij->ij", thickness, shear)
    return np.asarray(inverse(product(whole, compliance)))


def _between(C: Floats, low: Floats, high: Floats, power: int) -> Floats:
    """Return ∫ C z^(power - 1) dz between two heights."""
    rise = each(math.pow, high, power) - each(math.pow, low, power)
    return np.asarray(C * (rise / power)[..., None, None])
