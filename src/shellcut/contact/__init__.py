"""Penalty contact of the film with the rigid tool.

May import ``state``, ``material``, ``tool`` and rows below. What touches is a point with weights on
some nodes of the film: ``press_kernel`` presses it, ``penalty_contact`` lists the nodes,
``edge_contact`` places on the film's edges. Or it is a point against a sheet of quads:
``sheet_press`` presses it, ``sheet_contact`` lists corners and edges of the tool, and nodes of the
film against other film. ``coulomb_friction`` holds the film where any of them presses, ``settings``
gives their stiffness. ``unfelt_depth`` measures what none of them feels.
"""

from .settings import Contact

__all__ = ["Contact"]
