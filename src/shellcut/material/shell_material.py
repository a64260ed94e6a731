"""Section of the film: layers of plane-stress material through the thickness."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Annotated, TypeAlias

import numpy as np

from shellcut.arguments import Option, checked
from shellcut.arrays import Floats, product
from shellcut.card import Figures, card, figures_of, section
from shellcut.numerics.small_matrices import inverse

from .elastic import Elastic
from .material import Material, refuse
from .shear_factors import shear_factors

# Gauss points per layer when a section is integrated through the thickness. The integrand is a
# rational function of xi^3 whose departure from a cubic is of order (thickness / radius)^4.
POINTS_PER_LAYER = 4

# Default points per layer of elastic laws: two integrate a linear stress exactly, three leave of a
# nonlinear one an error of the sixth power of the height.
POINTS_OF_ELASTIC = {True: 2, False: 3}

# Default points per layer if a law has a history: yielding or damage begins at the faces, and of
# five Gauss points the outermost lie at 0.91 of half the layer.
POINTS_OF_HISTORY = 5

Direction: TypeAlias = tuple[float, float, float] | Callable[[Floats], Floats]


@checked
@dataclass(frozen=True)
class Layer:
    """One ply of a film.

    Examples
    --------
    Aluminium foil on polyethylene:

    >>> foil = Layer(Elastic(young=70_000.0, poisson=0.33, density=2.7e-9), thickness=0.009)
    >>> liner = Layer(Elastic(young=200.0, poisson=0.42, density=0.92e-9), thickness=0.065)
    >>> ShellMaterial([liner, foil]).thickness
    0.074
    """

    material: Material
    thickness: Annotated[float, Option("mm", "thickness of the layer", above=0)]


@checked
@dataclass(frozen=True)
class ShellMaterial:
    """The section of a shell: layers from the bottom (xi^3 = -h/2) to the top.

    Parameters
    ----------
    layers : sequence of Layer
        At least one.
    direction : sequence of float, or callable
        Direction of the film, usually the machine direction MD, for layers with axes of their own:
        a vector, of which the part in the sheet counts, or a function that returns a vector, shape
        (n, 3), at each of some reference positions, shape (n, 3) [mm].

    Notes
    -----
    :meth:`homogeneous` builds the single layer that [Frangi2010] uses. The paper gives no density:
    1.0e-9 t/mm³ fits its time steps (LDPE 0.92e-9, aluminium 2.7e-9: the laminate's average is
    about 1.1e-9).

    Examples
    --------
    >>> film = ShellMaterial.homogeneous(young=1678.0, poisson=0.3, density=1e-9, thickness=0.074)
    >>> film.thickness
    0.074
    """

    layers: Sequence[Layer]
    shear_factor: Annotated[
        float | None,
        Option(
            "",
            "factor on the transverse shear moduli of every layer; many published benchmarks take "
            "1",
            above=0,
            unset="computed from the layers, 5/6 for one layer",
        ),
    ] = None
    points_per_layer: Annotated[
        int | None,
        Option(
            "",
            "integration points through the thickness of each layer, evaluated at every step",
            least=1,
            most=9,
            unset="2 to 5; for a linear law none, its layers are integrated once before the run",
        ),
    ] = None
    direction: Direction = (1.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        object.__setattr__(self, "layers", tuple(self.layers))
        problems = []
        if not callable(self.direction):
            along = np.asarray(self.direction, float)
            if along.shape != (3,) or not np.isfinite(along).all() or not along.any():
                problems.append(
                    "direction must be a vector of three numbers that is not zero, or a function "
                    f"of positions, got {self.direction!r}"
                )
            else:
                object.__setattr__(self, "direction", tuple(along.tolist()))
        if not self.layers:
            problems.append("layers must name at least one layer, got none")
        refuse(problems)

    def _repr_html_(self) -> str:
        figures: Figures = [
            ("thickness", self.thickness, "mm"),
            ("mass over area", self.area_density, "t/mm^2"),
            ("stiffness in tension, Σ E h", self.stretching_stiffness, "N/mm"),
        ]
        named = []
        for number, layer in enumerate(self.layers, 1):
            name = f"layer {number}: {type(layer.material).__name__}"
            figures += [(name, layer.thickness, "mm"), *figures_of(layer.material)]
            named.append((name, layer.thickness))
        return card("Film, layers from the bottom", figures, picture=section(named))

    @classmethod
    @checked
    def homogeneous(
        cls,
        *,
        young: float = 1678.0,
        poisson: float = 0.3,
        density: float = 1.0e-9,
        thickness: float = 0.074,
        shear_factor: float | None = None,
        points_per_layer: int | None = None,
    ) -> ShellMaterial:
        """Build a single isotropic layer; the defaults are the film of [Frangi2010] 5.1."""
        layer = Layer(Elastic(young, poisson, density), thickness)
        return cls([layer], shear_factor, points_per_layer)

    @property
    def thickness(self) -> float:
        """Total thickness h [mm]."""
        return float(np.add.reduce([layer.thickness for layer in self.layers]))

    @property
    def is_linear(self) -> bool:
        """Whether stress is linear in strain in all layers, at any strain, and has no axes."""
        return all(layer.material.law.linear for layer in self.layers) and not self.has_axes

    @property
    def timed_laws(self) -> list[str]:
        """Names of the laws whose stress depends on the rate of strain."""
        laws = {layer.material.law for layer in self.layers}
        return sorted(law.name for law in laws if law.timed)

    @property
    def has_axes(self) -> bool:
        """Whether any layer needs :attr:`direction`."""
        return any(layer.material.law.oriented for layer in self.layers)

    def direction_at(self, places: Floats) -> Floats:
        """Return the film's direction at reference positions, shape (n, 3); of any length."""
        if callable(self.direction):
            directions = np.asarray(self.direction(places), float)
            if directions.shape != places.shape or not np.isfinite(directions).all():
                raise ValueError(
                    f"direction must return finite vectors of shape {places.shape}, got "
                    f"{directions.shape}"
                )
            return directions
        return np.broadcast_to(np.asarray(self.direction, float), places.shape)

    @property
    def integration_points(self) -> int | None:
        """Points per layer if the section is integrated at every step, else None."""
        if self.points_per_layer is None and not self.is_linear:
            laws = [layer.material.law for layer in self.layers]
            if any(law.history for law in laws):
                return POINTS_OF_HISTORY
            return POINTS_OF_ELASTIC[all(law.linear for law in laws)]
        return self.points_per_layer

    @property
    def stretching_stiffness(self) -> float:
        """Nominal stiffness in tension, the sum of E h over the layers [N/mm]."""
        moduli = [layer.material.stretching_modulus * layer.thickness for layer in self.layers]
        return float(np.add.reduce(moduli))

    @property
    def area_density(self) -> float:
        """Mass over area, the sum of rho h over the layers [t/mm²]."""
        return float(
            np.add.reduce([layer.material.density * layer.thickness for layer in self.layers])
        )

    @property
    def is_symmetric(self) -> bool:
        """Whether the layers are the same from below and from above."""
        return tuple(self.layers) == tuple(reversed(self.layers))

    @property
    def membrane_stiffness(self) -> Floats:
        """A, the integral of C over the thickness, shape (3, 3) [N/mm]."""
        points = zip(*self.thickness_points(), strict=True)
        return np.asarray(np.sum([w * law.plane_stress() for _, w, law in points], axis=0))

    @property
    def bending_stiffness(self) -> Floats:
        """Stiffness against bending about the neutral plane, shape (3, 3) [N*mm]."""
        z, weight, materials = self.thickness_points()
        laws = np.array([law.plane_stress() for law in materials])
        coupling, second = (np.einsum("i,ijk->jk", w, laws) for w in (weight * z, weight * z * z))
        return np.asarray(second - product(coupling, inverse(self.membrane_stiffness), coupling))

    @property
    def shear_stiffness(self) -> Floats:
        """The integral of the effective transverse shear moduli, shape (2, 2) [N/mm]."""
        points = zip(*self.thickness_points(), strict=True)
        moduli = np.sum([w * law.transverse_shear() for _, w, law in points], axis=0)
        return self.transverse_shear(moduli)

    @property
    def bending_ratio(self) -> float | None:
        """Bending over membrane stiffness [mm²] if it is one number without coupling, else None.

        h²/12 for a single layer; there is none for layers that differ in Poisson's ratio, are not
        symmetric from below and above, or are not isotropic in their plane.
        """
        if not self.is_symmetric:
            return None
        membrane, points = self.membrane_stiffness, zip(*self.thickness_points(), strict=True)
        bending = np.sum([z * z * (w * law.plane_stress()) for z, w, law in points], axis=0)
        ratio = float(bending[0, 0] / membrane[0, 0])
        shear = 0.5 * (membrane[0, 0] - membrane[0, 1])
        aside = [membrane[1, 1] - membrane[0, 0], membrane[2, 2] - shear, *membrane[:2, 2]]
        if np.abs(aside).max() > 1e-14 * membrane[0, 0]:
            return None
        round_off = 1e-14 * bending[0, 0]
        return ratio if np.abs(bending - ratio * membrane).max() <= round_off else None

    @cached_property
    def shear_factors(self) -> Floats:
        """K of :mod:`.shear_factors`, shape (2, 2), in the film's axes; of the elastic moduli."""
        if self.shear_factor is not None:
            return self.shear_factor * np.eye(2)
        return shear_factors(
            np.array([layer.thickness for layer in self.layers]),
            np.array([layer.material.plane_stress() for layer in self.layers]),
            np.array([layer.material.transverse_shear() for layer in self.layers]),
        )

    def transverse_shear(self, moduli: Floats) -> Floats:
        """Return the effective transverse shear moduli of G, the symmetric part of K G."""
        effective = product(self.shear_factors, moduli)
        return np.asarray(0.5 * (effective + effective.T))

    def thickness_points(
        self, points_per_layer: int = POINTS_PER_LAYER
    ) -> tuple[Floats, Floats, list[Material]]:
        """Return positions xi^3 [mm], weights [mm] and materials of the thickness quadrature."""
        place, weight = _gauss_points(points_per_layer)
        z, w, materials = [], [], []
        bottom = -0.5 * self.thickness
        for layer in self.layers:
            half = 0.5 * layer.thickness
            z.append(bottom + half * (1.0 + place))
            w.append(half * weight)
            materials += [layer.material] * points_per_layer
            bottom += layer.thickness
        return np.concatenate(z), np.concatenate(w), materials


@cache
def _gauss_points(n: int) -> tuple[Floats, Floats]:
    """Return places and weights of Gauss-Legendre quadrature from -1 to 1; not to be written."""
    place, weight = np.polynomial.legendre.leggauss(n)
    return place, weight
