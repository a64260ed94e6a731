"""When and where the film parts: cracks along sides of the mesh or through its quads, and the cut.

May import ``mitc4``, ``cables``, ``contact``, ``loads`` and rows below. Only ``cuts`` and what it
calls change the topology.
"""

from .anisotropy import Anisotropy
from .options import Fracture

__all__ = ["Anisotropy", "Fracture"]
