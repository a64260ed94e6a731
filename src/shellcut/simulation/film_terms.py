"""Force terms that touch no tool: what each must give to a simulation.

Shells and loads have places of their own in a step. Any other force of the film on itself is a
:class:`FilmTerm`: forces on the nodes, works for the ledger, stiffness for the time step, and what
it keeps from step to step. Terms that touch the tool are :class:`.tool_terms.ToolTerm`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol

from shellcut.arrays import Floats, Ints
from shellcut.state import State


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
        """How often it has searched for what it may hold: the time step then looks at it anew."""
        ...

    def stiffness(self, state: State) -> tuple[Ints, Floats]:
        """Return the nodes that it holds until the next search, and a bound on each [N/mm].

        A node may come more than once: its stiffnesses add up.
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
