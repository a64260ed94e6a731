"""Ready-made meshes; the code is in :mod:`shellcut.mesh.structured`.

>>> rectangle(12.0, 8.0, size=0.8).n_quad  # mm
150
"""

from .mesh.structured import OpeningName, annulus, cylinder, disc, opening_disc, rectangle

__all__ = ["OpeningName", "annulus", "cylinder", "disc", "opening_disc", "rectangle"]
