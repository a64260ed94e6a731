"""The isotropic St.Venant-Kirchhoff law in plane stress, S = C E, linear at all strains."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np

from shellcut.arguments import Option, checked
from shellcut.arrays import Floats, Number, Vector
from shellcut.numerics.lane_functions import larger, square_root

from .material import Density, Material, refuse_density
from .point_law import History, PointLaw, register


def linear_stress(
    p: Floats, strain: Vector, history: History, dt: float
) -> tuple[Vector, Number, Number, History]:
    """Return S = C E and ½ E·C·E; p : the upper triangle of C, first."""
    e1, e2, e12 = strain
    s1 = p[0] * e1 + p[1] * e2 + p[2] * e12
    s2 = p[1] * e1 + p[3] * e2 + p[4] * e12
    s12 = p[2] * e1 + p[4] * e2 + p[5] * e12
    return (s1, s2, s12), 0.5 * (s1 * e1 + s2 * e2 + s12 * e12), 0.0, history


def thickness_stretch(p: Floats, strain: Vector, history: History) -> Number:
    """Return √(1 + 2 E_33); p : (9,), the upper triangle of C and the slope of E_33."""
    thinner = p[6] * strain[0] + p[7] * strain[1] + p[8] * strain[2]
    return square_root(larger(1.0 - 2.0 * thinner, 0.0))


@checked
@dataclass(frozen=True)
class Elastic(Material):
    """Isotropic St.Venant-Kirchhoff material in plane stress ([Frangi2010] 5.1).

    Examples
    --------
    >>> aluminium = Elastic(young=70_000.0, poisson=0.33, density=2.7e-9)
    >>> round(float(aluminium.plane_stress()[0, 0]))
    78555
    """

    law: ClassVar[PointLaw] = register(
        PointLaw("St.Venant-Kirchhoff", linear_stress, thickness_stretch, linear=True)
    )

    young: Annotated[float, Option("MPa", "Young's modulus", above=0)]
    poisson: Annotated[float, Option("", "Poisson's ratio", above=-1, most=0.5)]
    density: Density

    def __post_init__(self) -> None:
        refuse_density(self.density)

    def plane_stress(self) -> Floats:
        """Return C, shape (3, 3) [MPa], with S = C (E_11, E_22, 2 E_12) in a Cartesian frame."""
        e, nu = self.young, self.poisson
        return np.array([[1.0, nu, 0.0], [nu, 1.0, 0.0], [0.0, 0.0, 0.5 * (1.0 - nu)]]) * (
            e / (1.0 - nu * nu)
        )

    def parameters(self) -> Floats:
        """Return :meth:`moduli_row`."""
        return self.moduli_row()

    def transverse_shear(self) -> Floats:
        """Return the transverse shear moduli, shape (2, 2) [MPa], without shear factor."""
        return np.eye(2) * (0.5 * self.young / (1.0 + self.poisson))

    @property
    def stretching_modulus(self) -> float:
        """Young's modulus [MPa]."""
        return self.young

    def thickness_slope(self) -> Floats:
        """Return nu/(1 - nu) (1, 1, 0)."""
        return self.poisson / (1.0 - self.poisson) * np.array([1.0, 1.0, 0.0])
