"""Directional cohesive cables: what joins the two flanks of a crack until they have torn.

``directional_cable`` has their forces (paper, section 3), with the stress by ``cohesive_law``.
``meeting`` finds where a cutting edge meets a cable, ``bent_cable`` gives length and directions of
the two branches then, ``around_edge`` those at an edge with a radius, ``joint_slip`` the friction.

May import ``state``, ``tool`` and the layers below.
"""

from .cohesive_law import CohesiveLaw, CohesiveTable

__all__ = ["CohesiveLaw", "CohesiveTable"]
