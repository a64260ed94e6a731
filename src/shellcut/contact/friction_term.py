"""What all frictions share: springs across the pressure of another term.

*Stiffness.* k_t is ``TANGENTIAL`` times the k of the penalty: what is pressed slips by mu N / k_t =
2 mu f(g) from rest, less than its own depth for mu up to ½. The spring acts across the normal, the
penalty along it; slip adds the unsymmetric term mu k f'. With a = 27/16 the steepest slope of the
penalty, the largest singular value of the two together is at most k sqrt(a² (1 + mu²) +
TANGENTIAL²). What that is more than a k enters the bound on the step, 4 % of a k for mu = 0.2, so
2 % of the step at most.
"""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np

from shellcut.arrays import Floats, Held, HeldBy
from shellcut.numerics.held_table import Holder
from shellcut.state import State
from shellcut.tool.touch import ON_TOOL, Booking, Touch

from .press_forces import TOUCHING
from .settings import STEEPEST

TANGENTIAL = 0.5
"""Stiffness of the tangential spring over that of the penalty."""


def stiffer_by(coefficient: float) -> float:
    """Return what friction adds to the steepest penalty in the bound on the step, over that."""
    coupled = (1.0 + coefficient**2) + (TANGENTIAL / STEEPEST) ** 2
    return float(np.sqrt(coupled)) - 1.0


class _Pressing(Protocol):
    @property
    def n_search(self) -> int: ...

    @property
    def name(self) -> str: ...


class _PressingOnTool(_Pressing, Protocol):
    @property
    def touch(self) -> Touch: ...


class FrictionTerm:
    """The part of a term that is the same whatever presses.

    Parameters
    ----------
    pressing : term
        Whose pressure it acts across; evaluated before this in every step.
    coefficient : float
        mu.
    """

    def __init__(self, pressing: _Pressing, coefficient: float) -> None:
        self.coefficient = coefficient
        self._pressing = pressing

    @property
    def n_search(self) -> int:
        """Searches of the other term: this one acts where that does."""
        return self._pressing.n_search

    def stiffness(self, _state: State, counted: HeldBy) -> Held:
        """Return the nodes that may be pressed soon and what friction adds there [N/mm]."""
        near, penalty = counted[self._pressing.name]
        return near, stiffer_by(self.coefficient) * penalty


class FrictionForces(NamedTuple):
    """Results of one evaluation of the friction."""

    wrench: Floats
    """Force [N] and moment about the body origin [N·mm] on each tooth, shape (n_body, 6)."""
    node_work: float
    """Work of the friction on the nodes since t_{n-1} [N·mm]."""
    dissipated: float
    """Energy dissipated by slip since t_{n-1} [N·mm]."""
    stored: float
    """Energy of the springs at t_n [N·mm]."""
    n_slipping: int
    """Number of nodes, points of the tool or edges of the film that slip."""

    @classmethod
    def of(cls, touch: Touch) -> FrictionForces:
        """Return what a kernel has written."""
        work, dissipated, stored, n_slipping = touch.sums.tolist()
        return cls(touch.wrench.copy(), work, dissipated, stored, int(n_slipping))


WORK, DISSIPATED, STORED = 0, 1, 2
"""Columns of :attr:`shellcut.tool.touch.Touch.sums`, in the order of the fields."""


class ToolFriction(FrictionTerm):
    """The part of a friction on the tool that is the same whatever presses.

    Parameters
    ----------
    name : str
        Of the term.
    pressing : term
        Whose pressure it acts across; evaluated before this in every step.
    coefficient : float
        mu.
    """

    booked = (
        Booking("friction_work", WORK, -1.0),
        Booking("friction_work", ON_TOOL, -1.0),
        Booking("friction_dissipated", DISSIPATED),
    )
    """What goes from the sums into the ledger."""

    def __init__(self, name: str, pressing: _PressingOnTool, coefficient: float) -> None:
        super().__init__(pressing, coefficient)
        self.name, self._pressed_by = name, pressing.touch
        n_body = len(pressing.touch.wrench)
        self.touch = Touch.none(n_body, len(FrictionForces._fields) - 1)
        self._touch = Holder()(self.touch)
        self._rests = True  # no evaluation would change what the last one has written

    @property
    def forces(self) -> FrictionForces:
        """Results of the last evaluation."""
        return FrictionForces.of(self.touch)

    def _is_quiet(self) -> bool:
        """Whether nothing presses and no spring is held."""
        pressed = self._pressed_by.sums[TOUCHING] > 0.0
        return not pressed and bool(self.touch.sums[STORED] == 0.0)

    def stored(self, _state: State) -> dict[str, float]:
        """Return the energy of the springs at the last evaluation, by its name in the ledger."""
        return {"friction_stored": float(self.touch.sums[STORED])}
