"""The force terms that touch the tool: what each must give, and the loop over them.

Contact and cables touch the tool, each in its own way. :class:`ToolTerm` names what the simulation
asks of such a term: forces on the nodes with the wrench on the tool, its stiffness for the time
step, its entries in the ledger, and what it keeps from step to step. :class:`ToolTerms` goes
through the list, sums the wrenches and works out the work of the tool.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Annotated, Any, NamedTuple, Protocol

import numpy as np

from shellcut.arrays import Floats, Held, HeldBy
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.held_table import Holder
from shellcut.numerics.jit import BoundOnce, kernel
from shellcut.state import State
from shellcut.tool.motion import Motion
from shellcut.tool.pose import Pose

from .ledger import Ledger


class TouchForces(Protocol):
    """What a term did in one evaluation."""

    @property
    def wrench(self) -> Floats:
        """Force [N] and moment about the body origin [N·mm] on each tooth, shape (n_body, 6)."""
        ...

    def add_works(self, entries: dict[str, float], on_tool: float) -> None:
        """Add what it has done in this step to entries of the ledger, by their names [N·mm].

        ``on_tool`` is the work of the wrench on the tool since t_{n-1}.
        """
        ...


class ToolTerm(Protocol):
    """A force term that touches the tool."""

    @property
    def name(self) -> str:
        """Of its part of the wrench in the columns of the history."""
        ...

    @property
    def forces(self) -> TouchForces:
        """What it did in the last evaluation; zeros before the first."""
        ...

    def add_forces(self, state: State, pose: Pose) -> TouchForces:
        """Add its forces at t_n to the nodal forces, with the tool at its pose of t_n."""
        ...

    @property
    def n_search(self) -> int:
        """How often it has searched for what it may hold: the time step then looks at it anew.

        -1 if that changes from step to step; the time step then asks it at every look.
        """
        ...

    def stiffness(self, state: State, counted: HeldBy) -> Held:
        """Return the nodes that it holds and a bound of its stiffness on each [N/mm].

        It is good until the next search, if it searches, or cut. A node may come more than once:
        its stiffnesses add up. ``counted`` is what the terms before it hold: it may tell only what
        it adds to that.
        """
        ...

    def stored(self, state: State) -> Mapping[str, float]:
        """Return the entries of the ledger that are functions of the state [N·mm]."""
        ...

    def saved(self) -> dict[str, Any]:
        """Return what it keeps from step to step, for a checkpoint."""
        ...

    def restore(self, state: State, pose: Pose, saved: dict[str, Any]) -> None:
        """Take over :meth:`saved`, for ``state`` and the tool at its present pose."""
        ...


class ToolTerms:
    """The terms of a simulation that touch the tool, in the order of their evaluation.

    Parameters
    ----------
    terms : sequence of ToolTerm
        Later ones see the nodal forces of those before.
    motion : Motion, optional
        Of the tool, if there is one.
    n_body : int
        Number of teeth.
    """

    def __init__(self, terms: Sequence[ToolTerm], motion: Motion | None, n_body: int) -> None:
        self._terms, self._motion = tuple(terms), motion
        # Wrenches on the whole tool at t_{n-1}: of each term, and of all.
        self._last = np.zeros((len(self._terms) + 1, 6))
        self._works = np.zeros(len(self._terms))
        self._none = self._works.tolist()
        self._book = Holder()(WorkBook(last=self._last, works=self._works))
        self._work_on_tool = BoundOnce(work_on_tool)

    def __iter__(self) -> Iterator[ToolTerm]:
        return iter(self._terms)

    @property
    def wrench(self) -> Floats:
        """Wrench on each tooth, of all terms together, shape (n_body, 6)."""
        first, *others = (term.forces.wrench for term in self._terms)
        return np.asarray(sum(others, first))

    def add_forces(self, state: State, pose: Pose, ledger: Ledger) -> None:
        """Add the forces of all terms at t_n, and their works over the last step to the ledger."""
        wrenches = []
        for term in self._terms:
            wrenches.append(term.add_forces(state, pose).wrench)
        works = self._none
        if self._motion is not None:
            spin, velocity = self._motion.twist(state.time - 0.5 * state.dt)
            # A motion may give views of any kind; kernels take rows.
            spin = np.ascontiguousarray(spin, float)
            velocity = np.ascontiguousarray(velocity, float)
            ledger.tool_work -= self._work_on_tool.code(
                tuple(wrenches), spin, velocity, state.dt, self._book
            )
            works = self._works.tolist()
        entries = vars(ledger)
        for term, on_tool in zip(self._terms, works, strict=True):
            term.forces.add_works(entries, on_tool)

    def saved(self) -> dict[str, Any]:
        """Return what the terms keep, by their names, and the wrenches of the last step."""
        return {"last": self._last, **{term.name: term.saved() for term in self._terms}}

    def restore(self, state: State, pose: Pose, saved: dict[str, Any]) -> None:
        """Take over :meth:`saved`."""
        self._last[:] = saved["last"]
        for term in self._terms:
            term.restore(state, pose, saved[term.name])


class WorkBook(NamedTuple):
    """Wrenches and works, which the kernel writes."""

    last: Annotated[Floats, "(n_sum, 6)"]
    """Wrenches on the whole tool at t_{n-1}, of each term and of all; replaced by those at t_n."""
    works: Annotated[Floats, "(n_term,)"]
    """Of each term over the step [N·mm]."""


@kernel
def work_on_tool(
    wrenches: tuple[Floats, ...],
    spin: Floats,
    velocity: Floats,
    dt: float,
    book: WorkBook,
) -> float:
    """Return the work on the tool over a step [N·mm]; write that of each term.

    wrenches : of each term (n_body, 6), force [N] and moment [N·mm] on each tooth at t_n.  spin,
    velocity : (3,), of the body's origin [rad/s, mm/s] at t_{n-1/2}.
    """
    last, works = borrowed(book)
    n_term = len(wrenches)
    works[:] = 0.0
    work = 0.0
    for c in range(6):
        moved = dt * (velocity[c] if c < 3 else spin[c - 3])
        total = 0.0
        for k in range(n_term):
            one = 0.0
            for body in range(wrenches[k].shape[0]):
                one += wrenches[k][body, c]
            works[k] += 0.5 * (last[k, c] + one) * moved
            last[k, c] = one
            total += one
        work += 0.5 * (last[n_term, c] + total) * moved
        last[n_term, c] = total
    return work
