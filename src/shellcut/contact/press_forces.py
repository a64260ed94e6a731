"""What a term does that presses film and tool together."""

from __future__ import annotations

from typing import NamedTuple

from shellcut.arrays import Floats
from shellcut.tool.touch import ON_TOOL, Booking, Touch


class PressForces(NamedTuple):
    """Results of one evaluation."""

    wrench: Floats
    """Force [N] and moment about the body origin [N·mm] on each tooth, shape (n_body, 6)."""
    node_work: float
    """Work of the contact on the nodes since t_{n-1} [N·mm]."""
    absorbed: float
    """Energy since t_{n-1} of springs that have let go, and of absorbed jumps; negative: given to
    the film [N·mm]."""
    stored: float
    """Penalty energy k ∫ f dg at t_n [N·mm]."""
    n_touching: int
    """Number of nodes in the tool; of points of the tool, or edges of the film, that press."""
    deepest: float
    """Largest depth of them [mm]."""

    @classmethod
    def of(cls, touch: Touch) -> PressForces:
        """Return what a kernel has written."""
        work, absorbed, stored, n_touching, deepest = touch.sums.tolist()
        return cls(touch.wrench.copy(), work, absorbed, stored, int(n_touching), deepest)


N_SUM = len(PressForces._fields) - 1
WORK, ABSORBED, STORED, TOUCHING = 0, 1, 2, 3
"""Columns of :attr:`shellcut.tool.touch.Touch.sums`, in the order of the fields."""

BOOKED = (
    Booking("contact_work", WORK, -1.0),
    Booking("contact_work", ON_TOOL, -1.0),
    Booking("contact_absorbed", ABSORBED),
)
"""What goes from the sums into the ledger."""
