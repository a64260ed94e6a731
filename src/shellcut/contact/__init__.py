"""Penalty contact of the film's nodes with the faces of the rigid tool.

May import ``state``, ``material``, ``tool`` and rows below. ``penalty_contact`` is the force term,
``settings`` its stiffness, ``missed_penetration`` measures how deep the tool goes between nodes,
which nodal contact misses.
"""

from .settings import Contact

__all__ = ["Contact"]
