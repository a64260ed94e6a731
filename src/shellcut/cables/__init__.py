"""Directional cohesive cables: what joins the two halves of a split node until it has torn.

May import ``state``, ``tool`` and rows below. ``cohesive_law`` gives the force of an opening,
``directional_cable`` bends the cable around the cutting edge that meets it (paper, section 3).
"""

from .cohesive_law import CohesiveLaw, CohesiveTable

__all__ = ["CohesiveLaw", "CohesiveTable"]
