"""Penalty contact of the film's nodes with the faces of the rigid tool.

May import ``state``, ``material``, ``tool`` and rows below. ``penalty_contact`` is the force term,
``settings`` gives its stiffness, ``missed_penetration`` measures penetration between nodes, which
nodal contact misses.
"""

from .settings import Contact

__all__ = ["Contact"]
