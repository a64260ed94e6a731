"""Dead loads, summed to the nodes: forces that keep their direction, scaled by a factor of time.

A split or cut changes the loads of its own nodes: these are summed anew over their quads.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from shellcut.arrays import Floats, Ints
from shellcut.mesh.mesh import Mesh
from shellcut.state import KnownTopology, State, columns

from .cut_quads import CutQuads
from .pressure import PressedQuads, pressure_rows, scatter_rows


class Rule:
    """Force of a dead load at a factor of 1."""

    def on(self, state: State, nodes: Ints) -> Floats:
        """Return the forces on some nodes [N], shape (n, 3), of whole quads first."""
        force = np.zeros((state.n_node, 3))
        rows, forces = self.entries(state, nodes)
        scatter_rows(state.quads[rows], forces, force)
        return np.asarray(force[nodes])

    def entries(self, state: State, nodes: Ints) -> tuple[Ints, Floats]:
        """Return the rows that load some nodes, and the forces at their corners, (n, 4, 3)."""
        raise NotImplementedError

    def on_rows(self, state: State, rows: Ints) -> Floats | None:
        """Return what single quads or copies bring to their corners [N], shape (n, 4, 3).

        None if the load does not act on quads, or accelerates both sides of a split alike.
        """
        return None


class Weight(Rule):
    """Mass times an acceleration g : (3,)."""

    def __init__(self, g: Floats) -> None:
        self._g = g

    def on(self, state: State, nodes: Ints) -> Floats:
        """Return mass times g."""
        return np.asarray(state.node.mass[nodes, None] * self._g)


class DeadPressure(Rule):
    """Dead pressure [MPa] on some quads: area and direction of the reference."""

    def __init__(self, mesh: Mesh, quads: Ints, value: float, cut: CutQuads) -> None:
        self._mesh, self._value = mesh, value
        self._pressed = PressedQuads(mesh, quads, cut)

    def entries(self, state: State, nodes: Ints) -> tuple[Ints, Floats]:
        """Return all quads at the nodes, and their forces."""
        n = state.node
        at = np.arange(n.quads.shape[1]) < n.n_quad_at[nodes, None]
        rows = self._pressed.whole_first(np.unique(n.quads[nodes][at]))
        return rows, self.on_rows(state, rows)

    def on_rows(self, state: State, rows: Ints) -> Floats:
        """Return what single quads or copies bring to their corners."""
        X = self._mesh.nodes[self._mesh.quads[state.quad.parent[rows]]]
        corners = np.arange(4 * rows.size, dtype=np.int32).reshape(-1, 4)
        X, force = np.asfortranarray(X.reshape(-1, 3)), np.empty((rows.size, 4, 3))
        pressure_rows(X, corners, self._pressed.film_of(state, rows), self._value, force)
        return force


class EdgeForces(Rule):
    """Forces along sides of quads, even over the length of the reference.

    quads, sides : (n,), which sides.  force : (n, 3), on each, traction times length [N].
    """

    def __init__(self, quads: Ints, sides: Ints, force: Floats, cut: CutQuads) -> None:
        self._quads, self._sides, self._force, self._cut = quads, sides, force, cut
        self._rows = _at_ends(sides, force, np.zeros(quads.size), np.ones(quads.size))

    def on_rows(self, state: State, rows: Ints) -> Floats:
        """Return what single quads or copies bring to their corners."""
        loaded, forces = self.entries(state, rows)
        found = np.zeros((rows.size, 4, 3))
        i, k = np.nonzero(rows[:, None] == loaded)
        np.add.at(found, i, forces[k])
        return found

    def entries(self, state: State, _nodes: Ints) -> tuple[Ints, Floats]:
        """Return all rows that carry film at the sides, and their forces."""
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

    Each half of a split node gets the load of its own quads. What has been cut is summed anew, at
    the nodes of the cut only.
    """

    def __init__(self, factor: Callable[[float], float], rule: Rule) -> None:
        self.factor, self.rule = factor, rule
        self.force: Floats = np.zeros((0, 3))
        """Force at a factor of 1 [N], shape (n_node, 3)."""
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
