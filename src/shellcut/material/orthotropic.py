"""Elastic moduli that differ along and across the direction in which a film was made."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from shellcut.arguments import checked
from shellcut.arrays import Floats, Number, Vector, product
from shellcut.numerics.lane_functions import larger, square_root
from shellcut.numerics.small_matrices import inverse

from .elastic import linear_stress
from .material import Material, density_problems, refuse
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

    Parameters
    ----------
    young_along, young_across : float
        Young's moduli along and across [MPa].
    poisson : float
        ν_12, the contraction across of a pull along; ν_21 = ν_12 young_across/young_along.
    shear : float
        Shear modulus in the plane [MPa].
    density : float
        Reference density [t/mm³].
    shear_through : float, optional
        Transverse shear modulus G_13 [MPa]; that of the plane by default.
    poisson_through : float, optional
        ν_13 = ν_23 of the thinning; that of the plane by default.
    angle_deg : float
        From the film's direction to axis 1 [degrees].
    shear_through_across : float, optional
        Transverse shear modulus G_23 [MPa]; that of ``shear_through`` by default.

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

    young_along: float
    young_across: float
    poisson: float
    shear: float
    density: float
    shear_through: float | None = None
    poisson_through: float | None = None
    angle_deg: float = 0.0
    shear_through_across: float | None = None

    def __post_init__(self) -> None:
        problems = []
        moduli = ("young_along", "young_across", "shear", "shear_through", "shear_through_across")
        for name in moduli:
            value = getattr(self, name)
            if not (value is None or (math.isfinite(value) and value > 0.0)):
                problems.append(f"{name} must be a positive modulus in MPa, got {value!r}")
        if not math.isfinite(self.angle_deg):
            problems.append(f"angle_deg must be an angle in degrees, got {self.angle_deg!r}")
        if not problems:
            most = math.sqrt(self.young_along / self.young_across)
            if not -most < self.poisson < most:
                problems.append(
                    "poisson must lie between minus and plus the root of young_along over "
                    f"young_across, {most:.4g}, or the film would give energy when it is "
                    f"stretched, got {self.poisson!r}"
                )
            through = self.poisson_through
            if through is not None and not -1.0 < through < 1.0:
                problems.append(f"poisson_through must lie between -1 and 1, got {through!r}")
        refuse(problems + density_problems(self.density))

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
