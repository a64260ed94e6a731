"""A toy law with history in a file of its own: isotropic damage by the largest strain so far.

With psi = ½ E·C·E and the strain measure r = √(2 psi / E), the largest r so far is kappa and

    d = D (1 - kappa_0 / kappa)  for kappa > kappa_0, else 0,      S = (1 - d) C E.

Stored is (1 - d) psi. Where kappa grows, psi dd is dissipated, in all ½ E D kappa_0 (kappa -
kappa_0), whatever the path. Pulled with free sides, kappa is the strain itself.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from shellcut.material import Material, PointLaw, register
from shellcut.numerics.lane_functions import larger, square_root

E, NU, ONSET, LARGEST = 0, 1, 2, 3


def stress(p, strain, history, dt):
    e1, e2, e12 = strain
    stiffness = p[E] / (1.0 - p[NU] * p[NU])
    s1 = stiffness * (e1 + p[NU] * e2)
    s2 = stiffness * (e2 + p[NU] * e1)
    s12 = (0.5 * stiffness * (1.0 - p[NU])) * e12
    psi = 0.5 * (s1 * e1 + s2 * e2 + s12 * e12)
    before = larger(history[0], p[ONSET])
    kappa = larger(before, square_root(2.0 / p[E] * psi))
    damage = p[LARGEST] * (1.0 - p[ONSET] / kappa)
    left = 1.0 - damage
    lost = 0.5 * p[E] * p[LARGEST] * p[ONSET] * (kappa - before)
    return (left * s1, left * s2, left * s12), left * psi, lost, (kappa, damage)


def thickness_stretch(p, strain, history):
    return square_root(larger(1.0 - 2.0 * p[NU] / (1.0 - p[NU]) * (strain[0] + strain[1]), 0.0))


@dataclass(frozen=True)
class Damaging(Material):
    """Softens from the strain ``onset`` on, down to 1 - ``largest`` of its stiffness."""

    law: ClassVar[PointLaw] = register(
        PointLaw("damaging", stress, thickness_stretch, ("largest strain [-]", "damage [-]"))
    )

    young: float = 1678.0
    poisson: float = 0.3
    density: float = 1e-9
    onset: float = 0.002
    largest: float = 0.8

    def parameters(self):
        return np.array([self.young, self.poisson, self.onset, self.largest])

    def plane_stress(self):
        nu = self.poisson
        rows = np.array([[1.0, nu, 0.0], [nu, 1.0, 0.0], [0.0, 0.0, 0.5 * (1.0 - nu)]])
        return self.young / (1.0 - nu * nu) * rows

    def transverse_shear(self):
        return np.eye(2) * (0.5 * self.young / (1.0 + self.poisson))
