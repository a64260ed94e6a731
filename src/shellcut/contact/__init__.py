"""Penalty contact of the film with the rigid tool.

May import ``state``, ``material``, ``tool`` and rows below. What touches is a point with weights on
some nodes of the film: ``press_kernel`` presses it, ``penalty_contact`` lists the nodes,
``edge_contact`` places on the film's edges. ``point_contact`` lets corners and edges of the tool
press on quads, ``coulomb_friction`` holds the film where any of them presses, ``settings`` gives
their stiffness. ``unfelt_depth`` measures what none of them feels. ``self_contact`` and
``self_friction`` act between parts of the film.
"""

from .settings import Contact

__all__ = ["Contact"]
