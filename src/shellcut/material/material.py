"""Material of a layer: all its properties except the point law itself."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from typing import Annotated, ClassVar, TypeAlias

import numpy as np

from shellcut.arguments import Option
from shellcut.arrays import Floats
from shellcut.card import card, figures_of
from shellcut.numerics.small_matrices import inverse

from .point_law import PointLaw


class Material(ABC):
    """A material of one layer: its point law with the law's parameters, density and stiffness.

    A subclass is a frozen dataclass whose fields are numbers, or tuples of numbers: a checkpoint
    compares them. It sets ``law`` and implements the abstract methods.

    Examples
    --------
    :class:`shellcut.material.elastic.Elastic` is the shortest subclass.
    """

    law: ClassVar[PointLaw]
    """Relation of stress and strain at a thickness point."""
    density: float
    """Reference density [t/mm³]."""

    @abstractmethod
    def parameters(self) -> Floats:
        """Return the parameters ``p`` of the law's functions, shape (n_parameter,)."""

    @abstractmethod
    def plane_stress(self) -> Floats:
        """Return C, shape (3, 3) [MPa], for (E_11, E_22, 2 E_12) in the layer's frame.

        It bounds the law's tangent dS/dE in every state, as the elastic moduli do for a material
        that softens or yields: time step and stiffness-proportional damping are derived from it.
        """

    @abstractmethod
    def transverse_shear(self) -> Floats:
        """Return the transverse shear moduli, shape (2, 2) [MPa], without shear factor."""

    def _repr_html_(self) -> str:
        return card(type(self).__name__, figures_of(self))

    @property
    def stretching_modulus(self) -> float:
        """Nominal modulus in tension [MPa], for contact penalty, guards and checks.

        Young's modulus; if it depends on the direction, the larger of those along two axes.
        """
        compliance = inverse(self.plane_stress())
        return float(1.0 / min(compliance[0, 0], compliance[1, 1]))

    @property
    def wave_speed(self) -> float:
        """Speed of tension waves in a strip [mm/s]."""
        return math.sqrt(self.stretching_modulus / self.density)

    def thickness_slope(self) -> Floats:
        """Return a, shape (3,), with E_33 = - a · (E_11, E_22, 2 E_12); linear laws only."""
        raise NotImplementedError(f"{type(self).__name__} has a linear law but no thickness_slope")

    def moduli_row(self) -> Floats:
        """Return the upper triangle of C [MPa] and :meth:`thickness_slope`, shape (9,)."""
        return np.concatenate([self.plane_stress()[np.triu_indices(3)], self.thickness_slope()])


Density: TypeAlias = Annotated[
    float,
    Option(
        "t/mm^3",
        "reference density; 1 g/cm^3 is 1e-9 t/mm^3",
        above=0,
        why="a polymer film has about 1e-9",
    ),
]


def refuse_density(density: float) -> None:
    """Refuse a density [t/mm³] in another unit."""
    if density > 1e-7:
        raise ValueError(
            f"density must be in t/mm³, got {density!r}, heavier than any matter: 1000 kg/m³, or "
            "1 g/cm³, is 1e-9 t/mm³"
        )


def refuse(problems: list[str]) -> None:
    """Raise a ValueError that lists all problems, if there are any."""
    if problems:
        raise ValueError("; ".join(problems))
