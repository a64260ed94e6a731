"""Loads and supports: forces, pressure, gravity, tractions; fixed or moved nodes, symmetry planes.

May import ``state``, ``mesh`` and the layers below.
"""

from .loads import EdgeTraction, Gravity, Load, NodalForce, NodalMoment, Pressure
from .supports import Support

__all__ = ["EdgeTraction", "Gravity", "Load", "NodalForce", "NodalMoment", "Pressure", "Support"]
