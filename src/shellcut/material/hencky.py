"""The elastic law between logarithmic strain and its stress, T = C ε ([Hencky1928])."""

from __future__ import annotations

import functools
from dataclasses import dataclass

from shellcut.arguments import checked
from shellcut.arrays import Floats, Number, Vector
from shellcut.numerics.jit import always_inline
from shellcut.numerics.lane_exponentials import exponential

from .elastic import Elastic
from .logarithmic_strain import (
    is_small,
    logarithmic_strain,
    second_piola_kirchhoff,
    small_isotropic,
)
from .orthotropic import Orthotropic, WithElasticPart
from .point_law import History, PointLaw, register


@always_inline
def _any_stress(
    p: Floats, strain: Vector, history: History, dt: float
) -> tuple[Vector, Number, Number, History]:
    """Return S and ½ ε·C·ε; p : (9,), the upper triangle of C and the slope of ε_33."""
    (e1, e2, e12), transform = logarithmic_strain(strain)
    t1 = p[0] * e1 + p[1] * e2 + p[2] * e12
    t2 = p[1] * e1 + p[3] * e2 + p[4] * e12
    t12 = p[2] * e1 + p[4] * e2 + p[5] * e12
    S = second_piola_kirchhoff((t1, t2, t12), transform)
    return S, 0.5 * (t1 * e1 + t2 * e2 + t12 * e12), 0.0, history


def _isotropic_stress(
    p: Floats, strain: Vector, history: History, dt: float
) -> tuple[Vector, Number, Number, History]:
    """Return the same without axes."""
    if is_small(strain):
        S, _, _, stored = small_isotropic(strain, 0.5 * (p[0] + p[1]), p[5])
        return S, stored, 0.0, history
    return _any_stress(p, strain, history, dt)


def _thickness_stretch(p: Floats, strain: Vector, history: History) -> Number:
    """Return exp ε_33."""
    e, _ = logarithmic_strain(strain)
    return exponential(-(p[6] * e[0] + p[7] * e[1] + p[8] * e[2]))


@functools.cache
def _law(oriented: bool) -> PointLaw:
    name = "orthotropic Hencky" if oriented else "Hencky"
    stress = _any_stress if oriented else _isotropic_stress
    return register(PointLaw(name, stress, _thickness_stretch, oriented=oriented, elastic=True))


@checked
@dataclass(frozen=True)
class Hencky(WithElasticPart):
    """Elastic by the logarithmic strain, for stretches beyond some 10 %.

    Where St.Venant-Kirchhoff grows ever stiffer in tension and loses all stiffness when squeezed to
    58 %, its stress is E ln λ / λ per reference area, as measured on rubber and polymers up to
    stretches of 1.5 or so.

    Parameters
    ----------
    elastic : Elastic or Orthotropic
        Moduli and density.

    Examples
    --------
    >>> film = Hencky(Elastic(young=200.0, poisson=0.42, density=0.92e-9))
    >>> film.stretching_modulus
    200.0
    """

    elastic: Elastic | Orthotropic

    @property
    def law(self) -> PointLaw:  # type: ignore[override]
        """The Hencky law, with axes or without."""
        return _law(isinstance(self.elastic, Orthotropic))

    def parameters(self) -> Floats:
        """Return the upper triangle of C [MPa] and the slope of ε_33, shape (9,)."""
        return self.elastic.moduli_row()
