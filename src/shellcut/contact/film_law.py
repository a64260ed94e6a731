"""The penalty law of the film's contact with itself, and how it follows the film.

Two mid-surfaces may come as close as the thickness h, half of it on either side. A point deeper
than that by g is pushed out by k f(g), f and g_M = h/4 being those of the contact with a tool
(:mod:`shellcut.contact.settings`).

*k follows mass.* k = ``STIFFNESS`` E h m / (rho h l²), with the mass m that the force feels at the
point and the edge length l of its quads. So k / m is the same at every node, a fixed part of
(E / rho l²), a tenth or so of the largest frequency² of the film: a sliver at a crack shortens the
step as little as a whole node. At a split the halves share the mass, hence the stiffness, and at
the same depth their forces and energies add up to what they were.

*It need not be stiffer.* A point that comes at the speed v goes v / sqrt(k / m) deep, 9 µm at
10 m/s with edges of 0.4 mm and a wave speed of 1300 m/s, whatever the thickness. A film thinner
than that is not passed: the side from which a point came is remembered.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from shellcut.arrays import Floats, Ints
from shellcut.material.shell_material import ShellMaterial
from shellcut.state import NodeTable, local_edge_length

from .settings import STEEPEST, Contact

STIFFNESS = 0.125
"""Stiffness of a whole node over E h."""


class FilmLaw(NamedTuple):
    """Parameters of the contact of one film with itself, for kernels."""

    thickness: float
    """h [mm]."""
    smoothing_depth: float
    """g_M [mm]."""
    stretching: float
    """E h [N/mm]."""
    area_density: float
    """rho h [t/mm²]."""

    @classmethod
    def of(cls, contact: Contact, film: ShellMaterial) -> FilmLaw:
        """Return the law of a film.

        Examples
        --------
        >>> FilmLaw.of(Contact(), ShellMaterial.homogeneous(thickness=0.04)).smoothing_depth
        0.01
        """
        return cls(
            thickness=film.thickness,
            smoothing_depth=contact.smoothing * film.thickness,
            stretching=film.stretching_stiffness,
            area_density=film.area_density,
        )

    def stiffness(self, nodes: NodeTable, which: Ints) -> Floats:
        """Return k of some nodes or flank points [N/mm], which : (n,)."""
        whole = self.area_density * local_edge_length(nodes.contact_area[which]) ** 2
        part = np.minimum(nodes.contact_mass[which] / whole, 1.0)
        return np.asarray(STIFFNESS * self.stretching * part)

    @property
    def steepest(self) -> float:
        """Largest slope of f."""
        return STEEPEST
