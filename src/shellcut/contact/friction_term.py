"""What all frictions share: springs across the pressure of another term.

*Stiffness.* k_t is ``TANGENTIAL`` times the k of the penalty: what is pressed slips by mu N / k_t =
2 mu f(g) from rest, less than its own depth for mu up to ½. The spring acts across the normal, the
penalty along it; slip adds the unsymmetric term mu k f'. With a = 27/16 the steepest slope of the
penalty, the largest singular value of the two together is at most k sqrt(a² (1 + mu²) +
TANGENTIAL²). What that is more than a k enters the bound on the step, 4 % of a k for mu = 0.2, so
2 % of the step at most.
"""

from __future__ import annotations

from typing import Generic, Protocol, TypeVar

import numpy as np

from shellcut.arrays import Held, HeldBy
from shellcut.state import State

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


class _Stored(Protocol):
    @property
    def stored(self) -> float: ...


_Forces = TypeVar("_Forces", bound=_Stored)


class FrictionTerm(Generic[_Forces]):
    """The part of a term that is the same whatever presses.

    Parameters
    ----------
    pressing : term
        Whose pressure it acts across; evaluated before this in every step.
    coefficient : float
        mu.
    """

    forces: _Forces
    """Results of the last evaluation."""

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

    def stored(self, _state: State) -> dict[str, float]:
        """Return the energy of the springs at the last evaluation, by its name in the ledger."""
        return {"friction_stored": self.forces.stored}
