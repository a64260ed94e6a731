r"""What a film carries at most: Considère's maximum of the nominal stress, from its layers.

The law of cables gives force over reference area, so the strength of a crack is a nominal stress.
True stress of a film that yields may rise without end; its nominal stress does not. The stress T of
:mod:`.plastic` is Kirchhoff's, so at the logarithmic strain ε of the direction of pull

    nominal stress = Σ T(ε) exp(-ε) h / Σ h,    largest where Σ (dT/dε - T) exp(-ε) h = 0

([Considere1885]: dT/dε = T for a single layer). Beyond, a strip or a row of quads necks. Three
states of strain are compared, with the flow matrix P of a layer turned to the pull,
σ_eq² = T · P T:

===============  ==========================  ==================================
uniaxial         T_2 = 0                     T = σ_y / √P_11
plane strain     ε_2 = 0, T_2 = -P_12/P_22   T = σ_y / √(P_11 - P_12²/P_22)
equibiaxial      T_2 = T                     T = σ_y / √(P_11 + 2 P_12 + P_22)
===============  ==========================  ==================================

each with the plastic strain p σ_eq,T of the direction of pull, by the flow rule, and σ_y the
hardening at p. Elastic strain is added by Hooke's law in the same
ratio of stresses, which is exact uniaxially and right to the elastic strain (½ - ν) otherwise.
For σ_y = K ε^n, von Mises, the maximum is at ε = n in all three: K n^n exp(-n), times
(2/√3)^(n+1) in plane strain and 2^n equibiaxially.

Loading is slow: factors by rate are left out.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, TypeAlias, get_args

import numpy as np

from shellcut.arrays import Floats

from .elastic import Elastic
from .hencky import Hencky
from .material import Material
from .orthotropic import Orthotropic, strain_turn
from .plastic import Plastic
from .shell_material import ShellMaterial

Pull: TypeAlias = Literal["uniaxial", "plane strain", "equibiaxial"]

FARTHEST = 2.5
"""Logarithmic strain up to which curves are followed: to 12 times the length."""
_N_PLASTIC, _N_STRAIN = 1200, 4000  # points of a layer's curve, and of the sum over layers
_FIRST = 1e-5  # least strain of both, after 0


@dataclass(frozen=True)
class LargestNominalStress:
    """The maximum of a film's nominal stress.

    Attributes
    ----------
    stress : float
        Over the reference thickness [MPa].
    strain : float
        Engineering strain of the direction of pull [-].
    pull : {"uniaxial", "plane strain", "equibiaxial"}
        State of strain.
    across : bool
        Whether the pull is across the film's direction.
    """

    stress: float
    strain: float
    pull: Pull
    across: bool = False


def largest_nominal_stress(
    film: ShellMaterial, pull: Pull | None = None, *, across: bool = False
) -> LargestNominalStress | None:
    """Return what a film carries at most, None if a layer's law is not known here.

    Parameters
    ----------
    film : ShellMaterial
    pull : {"uniaxial", "plane strain", "equibiaxial"}, optional
        By default that along or across the film's direction which carries most.
    across : bool
        Pull across the film's direction instead of along it.

    Examples
    --------
    The film hardens by K ε^n with n = 0.2, and necks near a strain of exp(0.2) - 1:

    >>> from shellcut.material import Elastic, Layer, Plastic, Swift
    >>> steel = Plastic(Elastic(2e5, 0.3, 7.8e-9), Swift(500.0, 1e-4, 0.2))
    >>> most = largest_nominal_stress(ShellMaterial([Layer(steel, 0.05)]), "uniaxial")
    >>> round(most.stress, 1), round(most.strain, 2)
    (296.2, 0.23)
    """
    if pull is None:
        every = [
            one
            for state in get_args(Pull)
            for side in (False, True)
            if (one := largest_nominal_stress(film, state, across=side)) is not None
        ]
        return max(every, key=lambda peak: peak.stress, default=None)
    found = nominal_curve(film, pull, across=across)
    if found is None:
        return None
    strain, stress = found
    top = int(np.argmax(stress))
    return LargestNominalStress(
        stress=float(stress[top]),
        strain=float(strain[top]),
        pull=pull,
        across=across,
    )


def nominal_curve(
    film: ShellMaterial, pull: Pull = "uniaxial", *, across: bool = False
) -> tuple[Floats, Floats] | None:
    """Return engineering strain and nominal stress [MPa] of a film that is pulled slowly.

    Parameters
    ----------
    film : ShellMaterial
    pull : {"uniaxial", "plane strain", "equibiaxial"}
        State of strain.
    across : bool
        Pull across the film's direction instead of along it.

    Returns
    -------
    strain, stress : ndarray, shape (n,)
        None if a layer's law is none of this package's.

    Notes
    -----
    Layers contract freely: where they differ in Poisson's ratio, a uniaxial pull of the laminate
    is stiffer by the second order of the difference. Shear that is coupled to the pull of a layer
    whose axes are turned is left out.

    Examples
    --------
    >>> strain, stress = nominal_curve(ShellMaterial.homogeneous(young=1000.0))
    >>> float(strain[0]), float(stress[0])
    (0.0, 0.0)
    """
    log_strain = _log_strains()
    force = np.zeros(len(log_strain))
    for layer in film.layers:
        known = _true_curve(layer.material, pull, across)
        if known is None:
            return None
        strain, stress = known
        force += layer.thickness * np.interp(log_strain, strain, stress)
    return np.expm1(log_strain), force * np.exp(-log_strain) / film.thickness


def _log_strains() -> Floats:
    fine = np.geomspace(_FIRST, 0.1, _N_STRAIN // 4)
    return np.concatenate([[0.0], fine, np.linspace(0.1, FARTHEST, _N_STRAIN)[1:]])


def _true_curve(material: Material, pull: Pull, across: bool) -> tuple[Floats, Floats] | None:
    """Return logarithmic strain and Kirchhoff stress [MPa] of the direction of pull."""
    turn = 90.0 if across else 0.0
    if isinstance(material, Elastic | Orthotropic):
        strain = _log_strains()
        # St.Venant-Kirchhoff: T = λ² S
        green = 0.5 * np.expm1(2.0 * strain)
        return strain, np.exp(2.0 * strain) * green / _compliance(material, pull, turn, None)
    if isinstance(material, Hencky):
        strain = np.array([0.0, FARTHEST])
        return strain, strain / _compliance(material.elastic, pull, turn, None)
    if not isinstance(material, Plastic):
        return None
    # matrices of stresses turn by the inverse transpose of those of strains
    R = np.linalg.inv(strain_turn(-turn)).T
    P = R.T @ material.flow_matrix() @ R
    ratio = {"uniaxial": 0.0, "plane strain": -P[0, 1] / P[1, 1], "equibiaxial": 1.0}[pull]
    equivalent = math.sqrt(P[0, 0] + 2.0 * ratio * P[0, 1] + ratio * ratio * P[1, 1])
    flow = (P[0, 0] + ratio * P[0, 1]) / equivalent
    compliance = _compliance(material.elastic, pull, turn, ratio)
    plastic = np.append(0.0, np.geomspace(_FIRST, FARTHEST / flow, _N_PLASTIC))
    plastic = np.union1d(plastic, material.hardening.plastic_strain)  # its corners
    stress = material.hardening.stress(plastic) / equivalent
    strain = flow * plastic + compliance * stress
    return np.append(0.0, strain), np.append(0.0, stress)


def _compliance(
    moduli: Elastic | Orthotropic, pull: Pull, turn: float, ratio: float | None
) -> float:
    """Return strain over stress of the direction of pull [1/MPa]."""
    R = strain_turn(-turn)
    S = np.linalg.inv(R.T @ moduli.plane_stress() @ R)
    if ratio is None:
        ratio = {
            "uniaxial": 0.0,
            "plane strain": -S[0, 1] / S[1, 1],
            "equibiaxial": (S[0, 0] - S[0, 1]) / (S[1, 1] - S[0, 1]),
        }[pull]
    return float(S[0, 0] + ratio * S[0, 1])
