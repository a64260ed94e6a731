"""What a term does that presses film and tool together."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

from shellcut.arrays import Floats, Ints
from shellcut.numerics.held_table import Holder
from shellcut.state import State
from shellcut.tool.force_term import ForceTerm
from shellcut.tool.touch import ON_TOOL, Booking, Touch

from .contact_tables import Carriers


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


WORK, ABSORBED, STORED, TOUCHING, DEEPEST = range(5)
"""Columns of :attr:`shellcut.tool.touch.Touch.sums`, in the order of the fields."""


class PressTerm(ForceTerm):
    """The part of a term that presses film and tool together that is the same for all.

    Parameters
    ----------
    name : str
        Of the term.
    n_body : int
        Teeth of the tool.
    carriers : Carriers
        Where it presses.
    kept : ndarray, shape (n_row,), optional
        Row that each of its list had in the one before, -1 for none; of nodes, which are told by
        their ids, none.
    """

    booked = (
        Booking("contact_work", WORK, -1.0),
        Booking("contact_work", ON_TOOL, -1.0),
        Booking("contact_absorbed", ABSORBED),
    )
    """What goes from the sums into the ledger."""
    tables: Any
    """What its kernel takes, anew with each list."""

    def __init__(self, name: str, n_body: int, carriers: Carriers, kept: Ints | None) -> None:
        self.name, self.carriers, self.kept = name, carriers, kept
        self.touch = Touch.none(n_body, len(PressForces._fields) - 1)
        self._touch = Holder()(self.touch)

    @property
    def forces(self) -> PressForces:
        """Results of the last evaluation."""
        work, absorbed, stored, n_touching, deepest = self.touch.sums.tolist()
        wrench = self.touch.wrench.copy()
        return PressForces(wrench, work, absorbed, stored, int(n_touching), deepest)

    def stored(self, _state: State) -> dict[str, float]:
        """Return the penalty energy at the last evaluation, by its name in the ledger [N·mm]."""
        return {"contact_stored": float(self.touch.sums[STORED])}

    def _take_carriers(self, saved: Mapping[str, Any]) -> None:
        """Take over ``_asdict()`` of other carriers, in place."""
        for name, rows in saved.items():
            getattr(self.carriers, name)[:] = rows
