"""Elastic moduli that differ along and across the direction in which a film was made."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np

from shellcut.arguments import Option, checked
from shellcut.arrays import Floats, Number, Vector, product
from shellcut.numerics.lane_functions import larger, square_root
from shellcut.numerics.small_matrices import inverse

from .elastic import linear_stress
from .material import Density, Material, refuse_density
from .point_law import History, PointLaw, register


def turned_moduli(moduli: Floats, angle_deg: float) -> Floats:
    """Return C of a layer whose axes are turned by an angle, shape (3, 3).

    For strains (E_11, E_22, 2 E_12): Cᵗ = RᵀCR with the R of :func:`strain_turn`.
    """
    R = strain_turn(angle_deg)
    return np.asarray(product(R.T, moduli, R))


def strain_turn(angle_deg: float) -> Floats:
    """Return R, shape (3, 3), that gives (E_11, E_22, 2 E_12) in axes turned by an angle."""
    c, s = math.cos(math.radians(angle_deg)), math.sin(math.radians(angle_deg))
    return np.array(
        [[c * c, s * s, c * s], [s * s, c * c, -c * s], [-2 * c * s, 2 * c * s, c * c - s * s]]
    )


def _thickness_stretch(p: Floats, strain: Vector, history: History) -> Number:
    """Return √(1 + 2 E_33); p : (9,), the upper triangle of C and the slope of E_33."""
    thinner = p[6] * strain[0] + p[7] * strain[1] + p[8] * strain[2]
    return square_root(larger(1.0 - 2.0 * thinner, 0.0))


@checked
@dataclass(frozen=True)
class Orthotropic(Material):
    """Orthotropic St.Venant-Kirchhoff material in plane stress.

    Axis 1 is the film's direction (:attr:`.shell_material.ShellMaterial.direction`), usually the
    machine direction MD, turned by ``angle_deg`` about the film's normal.

    Raises
    ------
    ValueError
        If a modulus is not positive, or if the moduli store no positive energy in every strain,
        which takes ν_12² < young_along/young_across.

    Examples
    --------
    >>> bopp = Orthotropic(2000.0, 4000.0, 0.25, 900.0, 0.9e-9)
    >>> C = bopp.plane_stress()
    >>> bool(C[1, 1] > C[0, 0])
    True
    """

    law: ClassVar[PointLaw] = register(
        PointLaw(
            "orthotropic St.Venant-Kirchhoff",
            linear_stress,
            _thickness_stretch,
            linear=True,
            oriented=True,
        )
    )

    young_along: Annotated[float, Option("MPa", "Young's modulus along axis 1", above=0)]
    young_across: Annotated[
        float,
        Option(
            "MPa",
            "modulus across the film's direction; young, poisson are then along it",
            above=0,
        ),
    ]
    poisson: Annotated[
        float,
        Option(
            "", "Poisson's ratio; with young_across ν_12, the contraction across of a pull along"
        ),
    ]
    shear: Annotated[float, Option("MPa", "shear modulus in the plane", above=0)]
    density: Density
    shear_through: Annotated[
        float | None,
        Option("MPa", "G_13, transverse shear along young", above=0, unset="shear"),
    ] = None
    poisson_through: Annotated[
        float | None,
        Option("", "ν_13 = ν_23 of the thinning", above=-1, below=1, unset="that of the plane"),
    ] = None
    angle_deg: Annotated[float, Option("deg", "from the film's direction to axis 1")] = 0.0
    shear_through_across: Annotated[
        float | None,
        Option("MPa", "G_23, along young_across", above=0, unset="shear_through"),
    ] = None

    def __post_init__(self) -> None:
        refuse_density(self.density)
        most = math.sqrt(self.young_along / self.young_across)
        if not -most < self.poisson < most:
            raise ValueError(
                "poisson must lie between minus and plus the root of young_along over "
                f"young_across, {most:.4g}, or the film would give energy when it is "
                f"stretched, got {self.poisson!r}"
            )

    def compliance(self) -> Floats:
        """Return C⁻¹ in the material's own axes, shape (3, 3) [1/MPa]."""
        e1, e2 = self.young_along, self.young_across
        between = -self.poisson / e1
        return np.array(
            [[1 / e1, between, 0.0], [between, 1 / e2, 0.0], [0.0, 0.0, 1 / self.shear]]
        )

    def plane_stress(self) -> Floats:
        """Return C, shape (3, 3) [MPa], in the film's axes."""
        return turned_moduli(np.asarray(inverse(self.compliance())), self.angle_deg)

    def parameters(self) -> Floats:
        """Return the upper triangle of C [MPa] and :meth:`thickness_slope`, shape (9,)."""
        return np.concatenate([self.plane_stress()[np.triu_indices(3)], self.thickness_slope()])

    def transverse_shear(self) -> Floats:
        """Return G, shape (2, 2) [MPa], for (2 E_13, 2 E_23) in the film's axes."""
        along = self.shear if self.shear_through is None else self.shear_through
        across = along if self.shear_through_across is None else self.shear_through_across
        twice = 2.0 * math.radians(self.angle_deg)
        c, s = math.cos(twice), math.sin(twice)
        mean, half = 0.5 * (along + across), 0.5 * (along - across)
        return mean * np.eye(2) + half * np.array([[c, s], [s, -c]])

    def thickness_slope(self) -> Floats:
        """Return a, shape (3,), with E_33 = - a · (E_11, E_22, 2 E_12), in the film's axes."""
        through = self.poisson if self.poisson_through is None else self.poisson_through
        by_stress = through * np.array([1.0 / self.young_along, 1.0 / self.young_across, 0.0])
        in_axes = product(by_stress, inverse(self.compliance()))
        return np.asarray(product(in_axes, strain_turn(self.angle_deg)))
