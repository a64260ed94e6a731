"""Positions, directors and quads of one configuration, for kernels over single quads.

:func:`smallest_area_ratio` finds quads that have been folded flat: their area has shrunk to nothing
somewhere. The logarithmic strain of a film without area is infinite. The laws limit it to a finite
number (:mod:`shellcut.material.logarithmic_strain`), which is no state of a film any more: a run
with such laws is given up when it is close to that.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from shellcut.arrays import Floats, Ints
from shellcut.mesh.mesh import Mesh
from shellcut.numerics.jit import inline, kernel
from shellcut.numerics.vec3 import combine, cross, load, norm, sub

from .element import GAUSS

LEAST_AREA = 2e-3
"""Of the reference area, at which a quad counts as folded flat."""


class Surface(NamedTuple):
    """The film in its reference or present configuration."""

    x: Annotated[Floats, "(n_node, 3)"]
    """Positions [mm]."""
    t: Annotated[Floats, "(n_node, 3)"]
    """Directors."""
    quads: Annotated[Ints, "(n_quad, 4)"]
    """Node ids."""

    @classmethod
    def of(cls, mesh: Mesh) -> Surface:
        """Return the reference configuration."""
        return cls(mesh.nodes, mesh.directors, mesh.quads)


@kernel
def smallest_area_ratio(reference: Surface, present: Surface) -> tuple[float, int]:
    """Return the least ratio of present to reference area at the Gauss points, and its quad."""
    least, quad = np.inf, -1
    for e in range(present.quads.shape[0]):
        for q in range(4):
            xi, eta = GAUSS[q]
            area = _area(reference.x, reference.quads, e, xi, eta)
            # At the Gauss points, where the law is evaluated; the factor 16 cancels.
            ratio = _area(present.x, present.quads, e, xi, eta) / area
            if ratio < least:
                least, quad = ratio, e
    return least, quad


@inline
def _area(x: Floats, quads: Ints, e: int, xi: float, eta: float) -> float:
    """Return sixteen times the area of quad e per natural coordinates squared at a point."""
    x0, x1 = load(x, quads[e, 0]), load(x, quads[e, 1])
    x2, x3 = load(x, quads[e, 2]), load(x, quads[e, 3])
    along = combine(1.0 - eta, sub(x1, x0), 1.0 + eta, sub(x2, x3))
    across = combine(1.0 - xi, sub(x3, x0), 1.0 + xi, sub(x2, x1))
    return norm(cross(along, across))
