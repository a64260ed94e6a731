"""Positions, directors and quads of one configuration, as kernels over single quads take them."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from shellcut.arrays import Floats, Ints
from shellcut.mesh.mesh import Mesh


class Surface(NamedTuple):
    """The film in its reference or in its present configuration."""

    x: Annotated[Floats, "(n_node, 3)"]
    """Positions [mm]."""
    t: Annotated[Floats, "(n_node, 3)"]
    """Directors."""
    quads: Annotated[Ints, "(n_quad, 4)"]
    """Node ids."""

    @classmethod
    def of(cls, mesh: Mesh) -> Surface:
        """Return the reference."""
        return cls(mesh.nodes, mesh.directors, mesh.quads)
