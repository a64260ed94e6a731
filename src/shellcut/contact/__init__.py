"""Penalty contact of the film with the rigid tool.

May import ``state``, ``material``, ``tool`` and the layers below. A contact point is a place with
weights on some nodes of the film: ``press_kernel`` presses it, ``penalty_contact`` lists the nodes,
``border_contact`` places on the film's border. Or it is a point against a sheet of quads:
``sheet_press`` presses it, ``sheet_contact`` lists corners and edges of the tool, and nodes of the
film against other film. ``coulomb_friction`` adds the friction wherever any of them presses,
``settings`` gives their stiffness. ``unfelt_depth`` measures the penetration that none of them
resists.
"""

from .settings import Contact

__all__ = ["Contact"]
