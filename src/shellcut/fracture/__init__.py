"""When and where the film parts: cracks along sides of the mesh or through its quads, and the cut.

``cracks.Cracks.cut_due`` asks, every few steps, where film is due to part:

==================================  =================================  =========================
where                               it is due                          decided in
==================================  =================================  =========================
tip that a cutting edge drives      when the edge has passed it, or    ``tip_watch``
                                    the trial cut's measure is 1       (``trial_cut``)
tip without a blade, through quads  at that measure                    ``cracks``
tip without a blade, along sides    at that measure, or the stress's   ``side_tears``
whole film pressed by a tool        at the force that pierces it       ``pressed_film``, ``pierce``
film that an edge enters            when the edge is in it             ``entered_film``, ``pierce``
==================================  =================================  =========================

``crack_path`` and ``free_direction`` give the segment and the direction of a crack, no condition.
``growth`` then extends a crack by a quad or a side: ``cuts`` carries a cut out, ``cut_topology``
knows which copies share nodes, ``cut_state`` makes copies and nodes, ``cut_film`` reads the result.

May import ``mitc4``, ``cables``, ``contact``, ``loads`` and the layers below. Only ``cuts`` and
what it calls change the topology.
"""

from .anisotropy import Anisotropy
from .options import Fracture

__all__ = ["Anisotropy", "Fracture"]
