"""What the film is made of: layers of plane-stress material through the thickness."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from shellcut.arrays import Floats

from .point_law import ELASTIC

# Gauss points a layer when a section is integrated through the thickness. The integrand is a
# rational function of xi^3 whose departure from a cubic is of order (thickness / radius)^4.
POINTS_PER_LAYER = 4


def _refuse(problems: list[str]) -> None:
    if problems:
        raise ValueError("; ".join(problems))


@dataclass(frozen=True)
class Elastic:
    """Isotropic St.Venant-Kirchhoff material in plane stress ([Frangi2010] 5.1).

    Parameters
    ----------
    young : float
        Young's modulus [MPa].
    poisson : float
        Poisson's ratio.
    density : float
        Reference density [t/mm³].

    Examples
    --------
    >>> aluminium = Elastic(young=70_000.0, poisson=0.33, density=2.7e-9)
    >>> round(float(aluminium.plane_stress()[0, 0]))
    78555
    """

    young: float
    poisson: float
    density: float

    def __post_init__(self) -> None:
        problems = []
        if not (math.isfinite(self.young) and self.young > 0):
            problems.append(f"young must be a positive modulus in MPa, got {self.young!r}")
        if not -1.0 < self.poisson <= 0.5:
            problems.append(f"poisson must lie above -1 and not above 0.5, got {self.poisson!r}")
        if not (math.isfinite(self.density) and self.density > 0):
            problems.append(
                f"density must be positive in t/mm³, got {self.density!r}; "
                "a polymer film has about 1e-9"
            )
        elif self.density > 1e-7:
            problems.append(
                f"density must be in t/mm³, got {self.density!r}, heavier than any matter; "
                "1 g/cm³ is 1e-9 t/mm³"
            )
        _refuse(problems)

    def plane_stress(self) -> Floats:
        """Return C, shape (3, 3) [MPa], with S = C (E_11, E_22, 2 E_12) in a Cartesian frame."""
        e, nu = self.young, self.poisson
        return np.array([[1.0, nu, 0.0], [nu, 1.0, 0.0], [0.0, 0.0, 0.5 * (1.0 - nu)]]) * (
            e / (1.0 - nu * nu)
        )

    @property
    def kind(self) -> int:
        """Branch of :func:`shellcut.material.point_law.point_stress`."""
        return ELASTIC

    @property
    def n_history(self) -> int:
        """History numbers kept at a thickness point."""
        return 0

    def parameters(self) -> Floats:
        """Return what the point law takes: the upper triangle of C, shape (6,) [MPa]."""
        return np.asarray(self.plane_stress()[np.triu_indices(3)])

    def transverse_shear(self) -> Floats:
        """Return the transverse shear moduli, shape (2, 2) [MPa], without shear factor."""
        return np.eye(2) * (0.5 * self.young / (1.0 + self.poisson))


@dataclass(frozen=True)
class Layer:
    """One ply of a film.

    Parameters
    ----------
    material : Elastic
        What it is made of.
    thickness : float
        Its thickness [mm].

    Raises
    ------
    ValueError
        If the thickness is not positive.

    Examples
    --------
    Aluminium foil on polyethylene:

    >>> foil = Layer(Elastic(young=70_000.0, poisson=0.33, density=2.7e-9), thickness=0.009)
    >>> liner = Layer(Elastic(young=200.0, poisson=0.42, density=0.92e-9), thickness=0.065)
    >>> ShellMaterial([liner, foil]).thickness
    0.074
    """

    material: Elastic
    thickness: float

    def __post_init__(self) -> None:
        if not (math.isfinite(self.thickness) and self.thickness > 0):
            _refuse([f"thickness must be positive in mm, got {self.thickness!r}"])


@dataclass(frozen=True)
class ShellMaterial:
    """The section of a shell: layers from the bottom (xi^3 = -h/2) to the top.

    Parameters
    ----------
    layers : sequence of Layer
        At least one.
    shear_factor : float
        Factor on the transverse shear stiffness, 5/6 by default.
    points_per_layer : int, optional
        Integrate by so many points (1 to 9) in each layer, as a material with history needs;
        without it the section is integrated once, before the run.

    Notes
    -----
    :meth:`homogeneous` builds the single layer that [Frangi2010] uses. Its paper gives no density:
    1.0e-9 t/mm³ fits its time steps (LDPE 0.92e-9, aluminium 2.7e-9: the laminate's average is
    about 1.1e-9).

    Examples
    --------
    >>> film = ShellMaterial.homogeneous(young=1678.0, poisson=0.3, density=1e-9, thickness=0.074)
    >>> film.thickness
    0.074
    """

    layers: Sequence[Layer]
    shear_factor: float = 5.0 / 6.0
    points_per_layer: int | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "layers", tuple(self.layers))
        problems = []
        if not self.layers:
            problems.append("layers must name at least one layer, got none")
        if not (math.isfinite(self.shear_factor) and self.shear_factor > 0):
            problems.append(f"shear_factor must be positive, got {self.shear_factor!r}")
        if self.points_per_layer is not None and self.points_per_layer not in range(1, 10):
            problems.append(
                f"points_per_layer must be a count from 1 to 9, got {self.points_per_layer!r}"
            )
        _refuse(problems)

    @classmethod
    def homogeneous(
        cls,
        *,
        young: float = 1678.0,
        poisson: float = 0.3,
        density: float = 1.0e-9,
        thickness: float = 0.074,
        shear_factor: float = 5.0 / 6.0,
        points_per_layer: int | None = None,
    ) -> ShellMaterial:
        """Build a single isotropic layer; the defaults are the film of [Frangi2010] 5.1."""
        layer = Layer(Elastic(young, poisson, density), thickness)
        return cls([layer], shear_factor, points_per_layer)

    @property
    def thickness(self) -> float:
        """Total thickness h [mm]."""
        return float(sum(layer.thickness for layer in self.layers))

    @property
    def is_symmetric(self) -> bool:
        """Whether the layers read the same from below and from above."""
        return tuple(self.layers) == tuple(reversed(self.layers))

    @property
    def bending_ratio(self) -> float | None:
        """Bending over membrane stiffness [mm²], None unless one number says it and they part.

        h²/12 of a single layer; layers of different Poisson's ratio, or that do not read the same
        from below and from above, have none.
        """
        if not self.is_symmetric:
            return None
        place, weight, materials = self.thickness_points()
        plane = [w * m.plane_stress() for w, m in zip(weight, materials, strict=True)]
        membrane = np.sum(plane, axis=0)
        bending = np.sum([z * z * one for z, one in zip(place, plane, strict=True)], axis=0)
        ratio = float(bending[0, 0] / membrane[0, 0])
        round_off = 1e-14 * bending[0, 0]
        return ratio if np.abs(bending - ratio * membrane).max() <= round_off else None

    def thickness_points(
        self, points_per_layer: int = POINTS_PER_LAYER
    ) -> tuple[Floats, Floats, list[Elastic]]:
        """Return places xi^3 [mm], weights [mm] and materials of the thickness quadrature."""
        place, weight = np.polynomial.legendre.leggauss(points_per_layer)
        z, w, materials = [], [], []
        bottom = -0.5 * self.thickness
        for layer in self.layers:
            half = 0.5 * layer.thickness
            z.append(bottom + half * (1.0 + place))
            w.append(half * weight)
            materials += [layer.material] * points_per_layer
            bottom += layer.thickness
        return np.concatenate(z), np.concatenate(w), materials
