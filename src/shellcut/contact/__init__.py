"""Penalty contact of the film with the rigid tool.

May import ``state``, ``material``, ``tool`` and rows below. ``penalty_contact`` is the force term
of the nodes, ``settings`` gives its stiffness, ``point_contact`` lets corners and edges of the tool
press on quads, ``edge_contact`` lets edges of the film touch edges of the tool,
``coulomb_friction`` holds the film where any of them presses, ``missed_penetration`` and
``flank_penetration`` measure what none of them feels. ``self_contact`` and ``self_friction`` act
between parts of the film.
"""

from .settings import Contact

__all__ = ["Contact"]
