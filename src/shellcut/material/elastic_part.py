"""Materials with an elastic part of their own: its moduli and density."""

from __future__ import annotations

from shellcut.arrays import Floats

from .elastic import Elastic
from .material import Material
from .orthotropic import Orthotropic


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
