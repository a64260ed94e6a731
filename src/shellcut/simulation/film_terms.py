"""Force terms that touch no tool: what each must give to a simulation.

Shells and loads have places of their own in a step. Any other force of the film on itself is a
:class:`FilmTerm`: forces on the nodes, works for the ledger, stiffness for the time step, and what
it keeps from step to step. Terms that touch the tool are :class:`.tool_terms.ToolTerm`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, Protocol

from shellcut.arrays import Held, HeldBy
from shellcut.state import State

from .ledger import Ledger


class FilmForces(Protocol):
    """What a term did in one evaluation."""

    def add_works(self, entries: dict[str, float]) -> None:
        """Add what it has done in this step to entries of the ledger, by their names [N·mm]."""
        ...


class FilmTerm(Protocol):
    """A force term that touches no tool; it is evaluated after those that do."""

    @property
    def name(self) -> str:
        """Of its part of a checkpoint."""
        ...

    def add_forces(self, state: State) -> FilmForces:
        """Add its forces at t_n to the nodal forces."""
        ...

    @property
    def n_search(self) -> int:
        """How often it has searched for what it may hold: the time step then looks at it anew.

        -1 if that changes from step to step; the time step then asks it at every look.
        """
        ...

    def stiffness(self, state: State, counted: HeldBy) -> Held:
        """Return the nodes that it holds until the next search, and a bound on each [N/mm].

        A node may come more than once: its stiffnesses add up. ``counted`` is what the terms
        before it hold: it may tell only what it adds to that.
        """
        ...

    def stored(self, state: State) -> Mapping[str, float]:
        """Return the entries of the ledger that are functions of the state [N·mm]."""
        ...

    def saved(self) -> dict[str, Any]:
        """Return what it keeps from step to step, for a checkpoint."""
        ...

    def restore(self, state: State, saved: dict[str, Any]) -> None:
        """Take over :meth:`saved`; ``state`` is restored already."""
        ...


class FilmTerms:
    """The terms of a simulation that touch no tool, in the order of their evaluation."""

    def __init__(self, terms: Sequence[FilmTerm]) -> None:
        self._terms = tuple(terms)

    def __iter__(self) -> Iterator[FilmTerm]:
        return iter(self._terms)

    def add_forces(self, state: State, ledger: Ledger) -> None:
        """Add the forces of all terms at t_n, and their works over the last step to the ledger."""
        for term in self._terms:
            term.add_forces(state).add_works(vars(ledger))

    def saved(self) -> dict[str, Any]:
        """Return what the terms keep, by their names."""
        return {term.name: term.saved() for term in self._terms}

    def restore(self, state: State, saved: Mapping[str, Any]) -> None:
        """Take over :meth:`saved`; ``state`` is restored already."""
        for term in self._terms:
            term.restore(state, saved[term.name])


class _Stores(Protocol):
    """A term of either kind."""

    def stored(self, state: State) -> Mapping[str, float]: ...


def sums_of_stored(terms: Iterable[_Stores], state: State) -> dict[str, float]:
    """Return what terms store, entry by entry of the ledger [N·mm]."""
    sums: dict[str, float] = {}
    for term in terms:
        for entry, energy in term.stored(state).items():
            sums[entry] = sums.get(entry, 0.0) + energy
    return sums
