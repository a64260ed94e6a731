"""Penalty contact of the film with the rigid tool.

May import ``state``, ``material``, ``tool`` and rows below. ``penalty_contact`` is the force term
of the nodes, ``settings`` gives its stiffness, ``coulomb_friction`` holds the nodes to the faces,
``point_contact`` lets corners and edges of the tool press on quads, ``point_friction`` holds them
there, ``edge_contact`` lets edges of the film touch edges of the tool, ``missed_penetration`` and
``flank_penetration`` measure what none of them feels. ``self_contact`` and ``self_friction`` act
between parts of the film.
"""

from .settings import Contact

__all__ = ["Contact"]
