"""The force terms of a simulation: the loop over them, the work on the tool, and its balance.

:class:`ForceTerms` evaluates the list of :class:`shellcut.tool.force_term.ForceTerm`, sums the
wrenches, works out the work of the tool and adds the works of each term to the energy balance.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import fields
from math import sqrt
from typing import Annotated, Any, NamedTuple

import numpy as np

from shellcut.arrays import Floats, Ints
from shellcut.loads.film_motion import FilmMotion
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.jit import BoundOnce, kernel
from shellcut.numerics.table_address import TableWriter
from shellcut.numerics.vec3 import add, add_scaled, cross, dot, norm, scale, sub
from shellcut.state import State
from shellcut.tool.force_term import ForceTerm
from shellcut.tool.motion import Motion
from shellcut.tool.pose import Pose, to_body, turn_back
from shellcut.tool.pose_of_motion import pose_at
from shellcut.tool.touch import ON_TOOL, Booking

from .ledger import Ledger

_ENTRIES = {entry.name for entry in fields(Ledger)}
_OWN_NAMES = {"last", "added"}
"""Of parts of a checkpoint, that no term may have."""


class ForceTerms:
    """The force terms of a simulation, in the order of their evaluation.

    Parameters
    ----------
    terms : sequence of ForceTerm
        Later ones see the nodal forces of those before.
    motion : Motion, optional
        Of the tool, if there is one.
    film : FilmMotion, optional
        Of a film that its supports move.

    Raises
    ------
    ValueError
        If two have one name, or a term counts a sum that it does not have.
    """

    def __init__(
        self, terms: Sequence[ForceTerm], motion: Motion | None, film: FilmMotion | None = None
    ) -> None:
        self._terms, self._motion = tuple(terms), motion
        self._film = None if motion is None else film
        _check(self._terms)
        self._added = {term.name: _Added() for term in self._terms if not term.booked}
        """What the terms without ``booked`` have added to the nodal forces."""
        touches = [term.touch for term in self._terms]
        on_tool = (Booking.of_wrench("load_work"),)
        booked = [
            (k, *booking)
            for k, term in enumerate(self._terms)
            for booking in term.booked or on_tool
        ]
        self._entries = sorted({entry for _, entry, *_ in booked})
        # Rows: wrench of each term on the whole tool at t_{n-1}, of all together, and its integral
        # over the angle; if the film moves, that integral and the work as seen from the film.
        n_term = len(self._terms)
        self._last = np.zeros((n_term + 2 + 2 * (self._film is not None), 6))
        self._of_all, self._over_turn, self._in_film = np.split(self._last[n_term:], [1, 2])
        self._amounts = np.zeros(len(self._entries))
        self._book = TableWriter()(
            WorkBook(
                last=self._last,
                works=np.zeros(len(self._terms)),
                wrenches=tuple(touch.wrench for touch in touches),
                sums=tuple(touch.sums for touch in touches),
                row=np.array(
                    [(k, c, self._entries.index(e)) for k, e, c, _ in booked], np.int64
                ).reshape(-1, 3),
                factor=np.array([factor for *_, factor in booked]),
                amounts=self._amounts,
            )
        )
        self._work_on_tool, self._twist = BoundOnce(work_on_tool), np.zeros((2, 3))
        self._work_in_film = BoundOnce(work_in_film)

    def __iter__(self) -> Iterator[ForceTerm]:
        return iter(self._terms)

    @property
    def on_tool(self) -> list[ForceTerm]:
        """Those that touch the tool."""
        return [term for term in self._terms if len(term.touch.wrench)]

    @property
    def wrench(self) -> Floats:
        """Wrench on each tooth, of all terms together, shape (n_tooth, 6)."""
        first, *others = (term.touch.wrench for term in self.on_tool)
        return np.asarray(sum(others, first.copy()))

    def stored(self, state: State) -> dict[str, float]:
        """Return what the terms store, entry by entry of the energy balance [N·mm]."""
        sums: dict[str, float] = {}
        for term in self._terms:
            for entry, energy in term.stored(state).items():
                _check_entry(term, entry, "stores")
                sums[entry] = sums.get(entry, 0.0) + energy
        return sums

    def fixed_nodes(self, state: State) -> Ints:
        """Return the nodes that terms keep in place as supports do, ascending."""
        found = [np.zeros(0, np.int64), *(term.fixed_nodes(state) for term in self._terms)]
        return np.unique(np.concatenate(found))

    def by_row(self, state: State) -> dict[str, Floats]:
        """Return the numbers of each quad and copy that terms show in frames, by their names."""
        return {name: row for term in self._terms for name, row in term.by_row(state).items()}

    def summary(self) -> dict[str, float]:
        """Return the values of all terms for ``summary.json``."""
        return {name: value for term in self._terms for name, value in term.summary().items()}

    @property
    def wrench_over_turn(self) -> Floats:
        """Integral over the angle of the wrench in the world's axes and origin, (6,), [N, N·mm].

        As seen from a film that its supports move: over the angle there, in its axes and origin.
        """
        return np.asarray((self._over_turn if self._film is None else self._in_film)[0])

    @property
    def work_in_film(self) -> float:
        """Work of the tool as seen from a film that its supports move [N·mm]."""
        return -float(self._in_film[1, 0])

    def add_forces(self, state: State, pose: Pose, ledger: Ledger) -> None:
        """Add the forces of all terms at t_n; add their works over the last step to ``ledger``."""
        for term in self._terms:
            if (added := self._added.get(term.name)) is None:
                term.add_forces(state, pose)
            else:
                ledger.load_work += added.work(term, state, pose)
        tick, twist = state.tick, self._twist
        if self._motion is not None:  # it may give views of any kind; kernels take rows
            twist[0], twist[1] = self._motion.twist(state.time - 0.5 * tick)
        before = None if self._film is None else self._of_all[0].copy()
        ledger.tool_work -= self._work_on_tool.code(twist, pose.translation, tick, self._book)
        if self._film is not None and self._motion is not None and tick > 0.0:
            mean, then = 0.5 * (before + self._of_all[0]), state.time - tick
            film = map(self._film.pose, (then, state.time - 0.5 * tick, state.time))
            self._work_in_film.code(mean, *film, pose_at(self._motion, then), pose, self._in_film)
        entries = vars(ledger)
        for entry, amount in zip(self._entries, self._amounts.tolist(), strict=True):
            entries[entry] += amount

    def saved(self) -> dict[str, Any]:
        """Return what the terms keep, by their names, and wrenches and forces of the last step."""
        added = {name: added.last for name, added in self._added.items()}
        kept = {term.name: term.saved() for term in self._terms}
        return {"last": self._last, "added": added, **kept}

    def restore(self, state: State, pose: Pose, saved: dict[str, Any]) -> None:
        """Take over :meth:`saved`."""
        self._last[:] = saved["last"]
        for name, added in self._added.items():
            added.last = saved["added"][name]
        for term in self._terms:
            term.restore(state, pose, saved[term.name])


def _check(terms: Sequence[ForceTerm]) -> None:
    names = [term.name for term in terms]
    if odd := [name for name in names if not re.fullmatch(r"[\w.-]+", name)]:
        raise ValueError(
            "the name of a force term, which is that of its columns, must have letters, digits, "
            f"'.', '_' and '-' only, got {', '.join(map(repr, odd))}"
        )
    if len(set(names)) < len(names) or _OWN_NAMES & set(names):
        raise ValueError(
            f"force terms must have different names, and none of {', '.join(sorted(_OWN_NAMES))}; "
            f"got {', '.join(names)}"
        )
    for term in terms:
        for entry, column, _ in term.booked:
            _check_entry(term, entry, "adds to")
            if not ON_TOOL <= column < (n := term.touch.sums.size):
                raise ValueError(
                    f"{term.name} adds column {column} to {entry}: it must be one of the {n} "
                    "columns of touch.sums, from 0; of the wrench: Booking.of_wrench"
                )
    bodies = {term.name: len(term.touch.wrench) for term in terms if len(term.touch.wrench)}
    if len(set(bodies.values())) > 1:
        listed = ", ".join(f"{n} of {name}" for name, n in bodies.items())
        raise ValueError(f"touch.wrench must have a row for each tooth of the tool, got {listed}")


def _check_entry(term: ForceTerm, entry: str, does: str) -> None:
    if entry not in _ENTRIES:
        raise ValueError(
            f"{term.name} {does} {entry!r}: it must be an entry of the energy balance, one of "
            f"{', '.join(sorted(_ENTRIES))}"
        )


class _Added:
    """What a term without ``booked`` has added to the nodal forces, and the work of that.

    By the difference that it makes, with the increments of the step: ½ (f_{n-1} + f_n) · Δx and ½
    (m_{n-1} + m_n) · Δθ, where m = t x g is the moment of the force g conjugate to the director. A
    node that has been split since t_{n-1} kept all its force until then; its duplicate, which was
    at the same place, had none. Points on flanks move with the film, which gets their forces later.
    """

    def __init__(self) -> None:
        self.last: Floats = np.zeros((0, 6))
        """Forces [N] and moments [N·mm] at t_{n-1}, a row for each node of then."""

    def work(self, term: ForceTerm, state: State, pose: Pose) -> float:
        """Let the term add its forces at t_n; return their work since t_{n-1} [N·mm]."""
        n = state.node
        forces, before = n.force_rows[: n.count, :6], self.last
        added = forces.copy()
        term.add_forces(state, pose)
        np.subtract(forces, added, out=added)
        added[:, 3:] = np.cross(n.t[: n.count], added[:, 3:])
        self.last = added
        moved = state.dt * np.hstack([n.velocity_half[: n.count], n.spin_half[: n.count]])
        return 0.5 * float((before * moved[: len(before)]).sum() + (added * moved).sum())


class WorkBook(NamedTuple):
    """What the terms have done, and to which entries it is added."""

    last: Annotated[Floats, "(n_sum, 6)"]
    """Wrenches on the whole tool at t_{n-1}, of each term and of all; replaced by those at t_n. The
    row after is the integral over the angle of that of all, its moment about the world's origin."""
    works: Annotated[Floats, "(n_term,)"]
    """Of each term on the tool over the step [N·mm], written."""
    wrenches: tuple[Floats, ...]
    """Of each term, (n_tooth, 6)."""
    sums: tuple[Floats, ...]
    """Of each term, see :class:`shellcut.tool.touch.Touch`."""
    row: Annotated[Ints, "(n_booked, 3)"]
    """Term, column and entry of each sum that counts."""
    factor: Annotated[Floats, "(n_booked,)"]
    """Times which it is."""
    amounts: Annotated[Floats, "(n_entry,)"]
    """What is added to the entries over the step [N·mm], written."""


@kernel
def work_on_tool(twist: Floats, origin: Floats, dt: float, book: WorkBook) -> float:
    """Return the work on the tool over a step [N·mm]; write that of each term, and the amounts.

    twist : (2, 3), spin and velocity of the body's origin [rad/s, mm/s] at t_{n-1/2}; origin :
    (3,), where that is at t_n [mm].
    """
    last, works, wrenches, sums, row, factor, amounts = borrowed(book)
    n_term, spin, velocity = len(wrenches), twist[0], twist[1]
    works[:] = 0.0
    work = 0.0
    turn = dt * sqrt(spin[0] ** 2 + spin[1] ** 2 + spin[2] ** 2)
    for c in range(6):
        moved = dt * (velocity[c] if c < 3 else spin[c - 3])
        total = 0.0
        for k in range(n_term):
            force = 0.0
            for body in range(wrenches[k].shape[0]):
                force += wrenches[k][body, c]
            works[k] += 0.5 * (last[k, c] + force) * moved
            last[k, c] = force
            total += force
        mean = 0.5 * (last[n_term, c] + total)
        work += mean * moved
        last[n_term + 1, c] += turn * mean
        if c < 3:  # r x f, with the origin at t_{n-1/2}
            a, b = (c + 1) % 3, (c + 2) % 3
            last[n_term + 1, 3 + a] += turn * (origin[b] - 0.5 * dt * velocity[b]) * mean
            last[n_term + 1, 3 + b] -= turn * (origin[a] - 0.5 * dt * velocity[a]) * mean
        last[n_term, c] = total
    amounts[:] = 0.0
    for i in range(row.shape[0]):
        k, column = row[i, 0], row[i, 1]
        done = works[k] if column == ON_TOOL else sums[k][column]
        amounts[row[i, 2]] += factor[i] * done
    return work


@kernel
def work_in_film(
    wrench: Floats,
    film_before: Pose,
    film: Pose,
    film_after: Pose,
    before: Pose,
    after: Pose,
    sums: Floats,
) -> None:
    """Add a step to what is summed as seen from a film that its supports move.

    wrench : (6,), on the tool, mean over the step, about the body's origin. film_before, film,
    film_after : the film's poses at t_{n-1}, between and at t_n; before, after : the tool's. sums :
    (2, 6): the wrench in the film's axes and about its origin, times the angle by which the tool
    turns there; the work, first of the second row [N·mm].
    """
    force = turn_back((wrench[0], wrench[1], wrench[2]), film)
    moment = turn_back((wrench[3], wrench[4], wrench[5]), film)
    r, s = before.translation, after.translation
    start, end = to_body((r[0], r[1], r[2]), film_before), to_body((s[0], s[1], s[2]), film_after)
    R, S = before.rotation, after.rotation
    vector = (0.0, 0.0, 0.0)  # of the turn, to second order, as the sums are
    for c in range(3):
        axis = turn_back((R[0, c], R[1, c], R[2, c]), film_before)
        turned = turn_back((S[0, c], S[1, c], S[2, c]), film_after)
        vector = add_scaled(vector, 0.5, cross(axis, turned))
    angle, arm = norm(vector), scale(0.5, add(start, end))
    about_origin = add(moment, cross(arm, force))
    for c in range(3):
        sums[0, c] += angle * force[c]
        sums[0, 3 + c] += angle * about_origin[c]
    sums[1, 0] += dot(force, sub(end, start)) + dot(moment, vector)
