"""Elastic moduli that differ along and across the direction in which a film was made."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np

from shellcut.arguments import Option, checked
from shellcut.arrays import Floats, product
from shellcut.numerics.small_matrices import inverse

from .elastic import Elastic, linear_stress, thickness_stretch
from .material import Density, Material, refuse_density
from .point_law import PointLaw, register


def turned_moduli(moduli: Floats, angle_deg: float) -> Floats:
    """Return C of a layer whose axes are turned by an angle, shape (3, 3).

    For strains (E_11, E_22, 2 E_12): Cᵗ = RᵀCR with the R of :func:`strain_turn`.
    """
    R = strain_turn(angle_deg)
    return np.asarray(product(R.T, moduli, R))


def strain_turn(angle_deg: float) -> Floats:
    """Return R, shape (3, 3), that gives (E_11, E_22, 2 E_12) in axes turned by an angle."""
    angle = math.radians(angle_deg)
    return strain_turns(np.array(math.cos(angle)), np.array(math.sin(angle)))


def strain_turns(c: Floats, s: Floats) -> Floats:
    """Return the matrices that turn strains (e_11, e_22, 2 e_12) into other axes, (..., 3, 3).

    c, s : (...), cosine and sine of the angle by which these axes are ahead.
    """
    turn = np.empty((*c.shape, 3, 3))
    turn[..., 0, 0], turn[..., 0, 1], turn[..., 0, 2] = c * c, s * s, c * s
    turn[..., 1, 0], turn[..., 1, 1], turn[..., 1, 2] = s * s, c * c, -c * s
    turn[..., 2, 0], turn[..., 2, 1], turn[..., 2, 2] = -2.0 * c * s, 2.0 * c * s, c * c - s * s
    return turn


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
        which needs ν_12² < young_along/young_across.

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
            thickness_stretch,
            linear=True,
            oriented=True,
        )
    )

    young_along: Annotated[float, Option("MPa", "Young's modulus along axis 1", above=0)]
    young_across: Annotated[
        float,
        Option(
            "MPa",
            "modulus across the film's direction; young and poisson are then for tension along it",
            above=0,
        ),
    ]
    poisson: Annotated[
        float,
        Option(
            "",
            "Poisson's ratio; with young_across it is ν_12, contraction across for tension along",
        ),
    ]
    shear: Annotated[float, Option("MPa", "shear modulus in the plane", above=0)]
    density: Density
    shear_through: Annotated[
        float | None,
        Option("MPa", "G_13, transverse shear along young", above=0, unset="shear"),
    ] = None
    angle_deg: Annotated[float, Option("deg", "angle from the film's direction to axis 1")] = 0.0
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
                f"young_across, {most:.4g}, or the film would release energy when it is "
                f"stretched, got {self.poisson!r}"
            )

    @property
    def stretching_modulus(self) -> float:
        """The larger of the two moduli [MPa], however the axes lie in the film."""
        return max(self.young_along, self.young_across)

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
        """Return :meth:`moduli_row`."""
        return self.moduli_row()

    def transverse_shear(self) -> Floats:
        """Return G, shape (2, 2) [MPa], for (2 E_13, 2 E_23) in the film's axes."""
        along = self.shear if self.shear_through is None else self.shear_through
        across = along if self.shear_through_across is None else self.shear_through_across
        twice = 2.0 * math.radians(self.angle_deg)
        c, s = math.cos(twice), math.sin(twice)
        mean, half = 0.5 * (along + across), 0.5 * (along - across)
        return mean * np.eye(2) + half * np.array([[c, s], [s, -c]])

    def thickness_slope(self) -> Floats:
        """Return a, shape (3,), with E_33 = - a · (E_11, E_22, 2 E_12), in the film's axes.

        The film thins by the ratio of the plane, ν_13 = ν_23 = ν_12.
        """
        by_stress = self.poisson * np.array([1.0 / self.young_along, 1.0 / self.young_across, 0.0])
        in_axes = product(by_stress, inverse(self.compliance()))
        return np.asarray(product(in_axes, strain_turn(self.angle_deg)))


class WithElasticPart(Material):
    """A material whose moduli and density are those of its field ``elastic``."""

    elastic: Elastic | Orthotropic

    @property
    def density(self) -> float:  # type: ignore[override]
        """Reference density [t/mm³]."""
        return self.elastic.density

    @property
    def stretching_modulus(self) -> float:
        """Nominal modulus in tension [MPa], of the elastic part."""
        return self.elastic.stretching_modulus

    def plane_stress(self) -> Floats:
        """Return C, shape (3, 3) [MPa], of the moduli."""
        return self.elastic.plane_stress()

    def transverse_shear(self) -> Floats:
        """Return the transverse shear moduli, shape (2, 2) [MPa], without shear factor."""
        return self.elastic.transverse_shear()
