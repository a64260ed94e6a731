"""When and where the film parts: criteria, candidate splits of a node, and the split itself.

May import ``mitc4``, ``cables``, ``contact``, ``loads`` and rows below. Only ``split_node``
and ``cut_state`` change the topology.
"""

from .anisotropy import Anisotropy
from .criterion import Fracture

__all__ = ["Anisotropy", "Fracture"]
