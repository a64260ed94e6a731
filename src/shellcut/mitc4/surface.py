"""Positions, directors and quads of one configuration, for kernels over single quads."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from shellcut.arrays import Floats, Ints
from shellcut.mesh.mesh import Mesh


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
