"""Dead loads, summed to the nodes: forces that keep their direction, scaled by a factor of time.

A split or cut changes the loads of its own nodes: these are summed anew over their quads.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np

from shellcut.arrays import Floats, Ints
from shellcut.mesh.mesh import Mesh
from shellcut.state import KnownTopology, State, columns

from .cut_quads import CutQuads
from .pressure import pressure_on_nodes, pressure_on_parts, pressure_rows, scatter_rows

OnCorners = Callable[[State, Ints, Floats, Floats], Floats]


class Rule(Protocol):
    """Force of a dead load at a factor of one."""

    def on(self, state: State, nodes: Ints) -> Floats:
        """Return the forces on some nodes [N], shape (n, 3)."""

    def through(self, state: State, quads: Ints, nodes: Ints) -> Floats | None:
        """Return what single quads bring to one of their nodes each [N], shape (n, 3).

        None if the load does not act on quads.
        """

    @property
    def on_corners(self) -> OnCorners | None:
        """The forces at the corners of some rows [N], shape (n, 4, 3), of which some have slid.

        None if the load does not act on quads. Takes the state, the rows, shape (n,), the places X
        of their corners in the reference, shape (n, 4, 3), and the masses there [t], shape (n, 4).
        """


class Weight:
    """Mass times an acceleration g : (3,)."""

    def __init__(self, g: Floats) -> None:
        self._g = g

    def on(self, state: State, nodes: Ints) -> Floats:
        """Return mass times g."""
        return np.asarray(state.node.mass[nodes, None] * self._g)

    def through(self, _state: State, _quads: Ints, _nodes: Ints) -> None:
        """Return nothing: weight accelerates both sides of a split alike."""

    def on_corners(self, _state: State, _rows: Ints, _X: Floats, mass: Floats) -> Floats:
        """Return mass times g."""
        return np.asarray(mass[:, :, None] * self._g)


class DeadPressure:
    """Dead pressure on some quads: area and direction of the reference.

    Parameters
    ----------
    mesh : Mesh
        Reference.
    quads : ndarray of int
        Which.
    value : float
        [MPa]
    cut : CutQuads
        Parts of cut quads.
    """

    def __init__(self, mesh: Mesh, quads: Ints, value: float, cut: CutQuads) -> None:
        self._mesh, self._value, self._cut = mesh, value, cut
        self._pressed = np.zeros(mesh.n_quad, np.bool_)
        self._pressed[quads] = True

    def on(self, state: State, nodes: Ints) -> Floats:
        """Return the forces on some nodes, of whole quads first."""
        force = np.zeros((nodes.size, 3))
        n, parts = state.node, self._cut.parts
        whole = self._pressed
        if parts.rows.size:
            whole = np.zeros(state.n_quad, np.bool_)
            whole[: self._pressed.size] = self._pressed
            whole[parts.rows] = False
        pressure_on_nodes(
            nodes,
            n.quads,
            n.n_quad_at,
            state.quads,
            whole,
            self._mesh.nodes,
            self._mesh.quads,
            self._value,
            force,
        )
        near = np.flatnonzero(np.isin(state.quads[parts.rows], nodes).any(axis=1))
        if near.size:
            every = np.zeros((state.n_node, 3))
            rows = parts.rows[near]
            scatter_rows(state.quads, rows, self._of_rows(state, rows), every)
            force += every[nodes]
        return force

    def through(self, state: State, quads: Ints, nodes: Ints) -> Floats:
        """Return what single quads bring to one of their nodes each."""
        rows = self._of_rows(state, quads)
        return np.asarray(rows[state.quads[quads] == nodes[:, None]])

    def _of_rows(self, state: State, which: Ints) -> Floats:
        """Return the forces at the corners of some rows [N], shape (n, 4, 3)."""
        parent = state.quad.parent[which]
        return self._of_quads(state, which, self._mesh.nodes, self._mesh.quads, parent)

    def on_corners(self, state: State, rows: Ints, X: Floats, _mass: Floats) -> Floats:
        """Return the forces at the corners of some rows, which may have slid."""
        every = np.arange(rows.size)
        corners = np.arange(4 * rows.size).reshape(-1, 4)
        return self._of_quads(state, rows, np.ascontiguousarray(X.reshape(-1, 3)), corners, every)

    def _of_quads(self, state: State, which: Ints, X: Floats, quads: Ints, at: Ints) -> Floats:
        """Return the forces on some rows [N], shape (n, 4, 3); row i has the corners quads[at[i]].

        X : (n_node, 3).  quads : (m, 4).  at : (n,).
        """
        mine = self._pressed[state.quad.parent[which]]
        some = np.empty((int(mine.sum()), 4, 3))
        pressure_rows(X, quads, at[mine], self._value, some)
        rows = np.zeros((which.size, 4, 3))
        rows[mine] = some
        cut, part = self._cut.among(which)
        if cut.any():
            film = self._cut.parts.film[part]
            some = np.empty((film.shape[0], 4, 3))
            pressure_on_parts(X, quads, at[cut], film, self._value, some)
            rows[cut] = some * mine[cut, None, None]
        return rows


class EdgeForces:
    """Forces along sides of quads, even over the length of the reference.

    Parameters
    ----------
    quads, sides : ndarray of int, shape (n,)
        Which sides.
    force : ndarray, shape (n, 3)
        On each, traction times length [N].
    cut : CutQuads
        Parts of cut quads.
    """

    on_corners = None

    def __init__(self, quads: Ints, sides: Ints, force: Floats, cut: CutQuads) -> None:
        self._quads, self._sides, self._force, self._cut = quads, sides, force, cut
        self._rows = _at_ends(sides, force, np.zeros(quads.size), np.ones(quads.size))

    def on(self, state: State, nodes: Ints) -> Floats:
        """Return the forces on some nodes, of whole quads first."""
        force = np.zeros((state.n_node, 3))
        scatter_rows(state.quads, *self._entries(state), force)
        return np.asarray(force[nodes])

    def through(self, state: State, quads: Ints, nodes: Ints) -> Floats:
        """Return what single quads bring to one of their nodes each."""
        force = np.zeros((quads.size, 3))
        which, rows = self._entries(state)
        for i in np.flatnonzero(np.isin(quads, which)).tolist():
            corner = state.quads[quads[i]] == nodes[i]
            force[i] = rows[which == quads[i]][:, corner].sum(axis=(0, 1))
        return force

    def _entries(self, state: State) -> tuple[Ints, Floats]:
        """Return rows that hold film at the sides, and the forces at their corners, (n, 4, 3)."""
        parts = self._cut.parts
        if not parts.rows.size:
            return self._quads, self._rows
        cut, _ = self._cut.among(self._quads)
        parent = state.quad.parent[parts.rows]
        near = np.flatnonzero(np.isin(parent, self._quads))
        k, i = np.nonzero(parent[near, None] == self._quads)
        k = near[k]
        start, stop = parts.sides[k, self._sides[i]].T
        rows = _at_ends(self._sides[i], self._force[i], start, stop)
        return (
            np.concatenate([self._quads[~cut], parts.rows[k]]),
            np.concatenate([self._rows[~cut], rows]),
        )


def _at_ends(sides: Ints, force: Floats, start: Floats, stop: Floats) -> Floats:
    """Return even forces on pieces of sides as forces at the corners of their quads, (n, 4, 3).

    sides : (n,).  force : (n, 3), on whole sides [N].  start, stop : (n,), of the pieces, as
    fractions of the sides.
    """
    rows, every = np.zeros((sides.size, 4, 3)), np.arange(sides.size)
    far = 0.5 * (stop * stop - start * start)
    rows[every, sides] = (stop - start - far)[:, None] * force
    rows[every, (sides + 1) % 4] = far[:, None] * force
    return rows


class DeadLoad:
    """A nodal force that keeps its direction, scaled by a factor of time.

    Each half of a split node takes the load of its own quads. What has been cut is summed anew, at
    the nodes of the cut only.
    """

    def __init__(self, factor: Callable[[float], float], rule: Rule) -> None:
        self.factor, self.rule = factor, rule
        self.force: Floats = np.zeros((0, 3))
        """Force at a factor of one [N], shape (n_node, 3)."""
        self._known = KnownTopology()

    def follow(self, state: State) -> None:
        """Process the splits and cuts since the last call."""
        if self.force.shape[0] < state.n_node:
            grown = columns(state.node.x.shape[0], 3)
            if self.force.shape[0] == 0:
                grown[: state.n_node] = self.rule.on(state, np.arange(state.n_node))
                self._known.take(state)
            else:
                grown[: self.force.shape[0]] = self.force
            self.force = grown
        if not self._known.is_of(state):
            nodes = np.unique(state.quads[self._known.changed_quads(state)])
            self.force[nodes] = self.rule.on(state, nodes)
            self._known.take(state)
