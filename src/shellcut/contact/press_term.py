"""What is the same for all terms that press film and tool, or film and film, together."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar, NamedTuple

import numpy as np

from shellcut.arrays import Floats, Ints
from shellcut.numerics.kept import saved_of
from shellcut.numerics.table_address import TableWriter
from shellcut.state import State
from shellcut.tool.force_term import ForceTerm
from shellcut.tool.pose import Pose
from shellcut.tool.touch import ON_TOOL, Booking, Touch

from .contact_tables import ContactPoints


class PressForces(NamedTuple):
    """Results of one evaluation."""

    wrench: Floats
    """Force [N] and moment about the body origin [N·mm] on each tooth, shape (n_tooth, 6)."""
    node_work: float
    """Work of the contact on the nodes since t_{n-1} [N·mm]."""
    stored: float
    """Penalty energy k ∫ f dg at t_n [N·mm]."""
    n_touching: int
    """Number of nodes in the tool; of points of the tool, or segments of its border, that press."""
    deepest: float
    """Largest depth of them [mm]."""


WORK, STORED, TOUCHING, DEEPEST = range(4)
"""Columns of :attr:`shellcut.tool.touch.Touch.sums`, in the order of the fields."""


class PressTerm(ForceTerm):
    """The part of a term that presses film and tool together that is the same for all.

    Parameters
    ----------
    name : str
        Of the term.
    n_tooth : int
        Teeth of the tool.
    kept : ndarray, shape (n_row,), optional
        Row that each of its list had in the one before, -1 for none; of nodes, which are known by
        their ids, none.
    """

    booked: Sequence[Booking] = (
        Booking("contact_work", WORK, -1.0),
        Booking("contact_work", ON_TOOL, -1.0),
    )
    """What the energy balance gets from the sums."""
    kept_names: ClassVar[tuple[str, ...]] = ("touch", "carriers")
    """Attributes that a checkpoint keeps, see :mod:`shellcut.numerics.kept`."""

    def __init__(self, name: str, n_tooth: int, kept: Ints | None) -> None:
        self.name, self.kept = name, kept
        self.carriers = ContactPoints.of(np.zeros((0, 4), np.int64))
        """Where it presses."""
        self.touch = Touch.none(n_tooth, len(PressForces._fields) - 1)
        self._touch, self._address_of = TableWriter()(self.touch), TableWriter()
        self._pose: Pose | None = None
        self.tables: Any = None
        """Arguments of its kernel, anew with each list."""

    @property
    def forces(self) -> PressForces:
        """Results of the last evaluation."""
        work, stored, n_touching, deepest = self.touch.sums.tolist()
        wrench = self.touch.wrench.copy()
        return PressForces(wrench, work, stored, int(n_touching), deepest)

    def stored(self, _state: State) -> dict[str, float]:
        """Return the penalty energy at the last evaluation, by its name in the balance [N·mm]."""
        return {"contact_stored": float(self.touch.sums[STORED])}

    def saved(self) -> dict[str, Any]:
        """Return what it presses on, the last forces, and what it keeps besides."""
        return saved_of(self, self.kept_names)
