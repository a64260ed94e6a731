"""Ready-made meshes; the code is in :mod:`shellcut.mesh.structured`."""

from .mesh.structured import OpeningName, annulus, cylinder, disc, opening_disc, rectangle

__all__ = ["OpeningName", "annulus", "cylinder", "disc", "opening_disc", "rectangle"]
