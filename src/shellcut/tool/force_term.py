"""A force term: what a simulation needs of all that pulls or presses on the film.

Shells and loads have places of their own in a step. Whatever else puts forces on the nodes,
contact, friction and cables, is a :class:`ForceTerm`. It must say what it adds to the forces; all
else has a default: its work counts as that of a load, no stiffness, nothing stored, nothing kept. A
term whose force depends on positions must give its stiffness, or the step is too long for it and
the run loses its energy balance. A new one is a class of its own and an entry in
``Simulation(terms=...)``, also of the ready models (``opening_test(terms=...)``); a model file has
no key for it. A checkpoint compares the fields of a term that is a dataclass, of another only its
class.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from shellcut.arrays import Floats, Ints, NodeStiffness, StiffnessBy

from .pose import Pose
from .touch import Booking, Touch

if TYPE_CHECKING:
    from shellcut.material.shell_material import ShellMaterial
    from shellcut.mesh.mesh import Mesh
    from shellcut.state import State


class ForceTerm:
    """Forces on the nodes that are neither the shells' nor loads.

    A term without ``booked`` is one more load: the simulation evaluates what it has added to the
    nodal forces and counts its work as ``load_work``, with that of its wrench on the tool. A term
    that stores or dissipates energy writes its works to ``touch``, and ``booked`` says in which
    entries of the energy balance they count. They are then all its work, ½ (f_{n-1} + f_n) · Δx.

    Examples
    --------
    A spring between a node and the place where it was at first, 2 N/mm:

    >>> import numpy as np
    >>> import shellcut as sc
    >>> class Spring(sc.ForceTerm):
    ...     name = "spring"
    ...     def __init__(self, node, place):
    ...         self.node, self.place = node, place
    ...     def add_forces(self, state, pose):
    ...         state.node.force[self.node] += 2.0 * (self.place - state.node.x[self.node])
    ...     def stiffness(self, state, counted):
    ...         return np.array([self.node]), np.array([2.0])

    A film that falls on it; the energy balance closes:

    >>> from shellcut.meshing import rectangle
    >>> mesh, film = rectangle(4.0, 2.0, size=1.0), sc.ShellMaterial.homogeneous()
    >>> weight = [sc.Gravity((0.0, 0.0, -1e7))]
    >>> sim = sc.Simulation(mesh, film, loads=weight, terms=[Spring(7, mesh.nodes[7])])
    >>> sim.run(until=1e-4)
    >>> energies = sim.close_ledger()
    >>> abs(energies.relative(energies.imbalance)) < 1e-6
    True
    """

    name: str
    """Name of its part of the wrench in the history's columns and in a checkpoint."""
    touch: Touch = Touch.none(0, 0)
    """What it did in the last evaluation, on each tooth of the tool and in sums of its own. The
    arrays stay in their place; their contents count again after every step."""
    booked: Sequence[Booking] = ()
    """What the energy balance gets from there at every step. If nothing does, the simulation works
    out what the term adds to the nodal forces, and the work of that."""
    n_search: int = 0
    """How often it has searched for what it may act on: the time step then evaluates
    :meth:`stiffness` anew. -1 if that changes from step to step, as that of a magnet does; the time
    step then evaluates it at every check. If it stays 0, only a cut makes it ask again."""

    def for_film(
        self, mesh: Mesh, material: ShellMaterial, part_of: Callable[[int], Any]
    ) -> ForceTerm:
        """Return what acts on a film in its place: itself, if nothing depends on the film.

        part_of : returns the polygon of a row that a crack has cut, points (xi, eta) in order and
        the side of the quad on which the edge from each lies, -1 for a flank.
        """
        return self

    def begin(self, state: State) -> None:
        """Take the film where it lies now as its start; by default nothing depends on that.

        Called before the first evaluation, and when :meth:`.Simulation.relax` has displaced the
        film.
        """

    def add_forces(self, state: State, pose: Pose) -> None:
        """Add its forces at t_n to the nodal forces, with the tool at its pose of t_n.

        t_n is the time of the state given, which a step has just reached.

        Writes ``touch``, if it has one, at every call.
        """
        raise NotImplementedError

    def stiffness(self, state: State, counted: StiffnessBy) -> NodeStiffness:
        """Return the nodes that it acts on and a bound of its stiffness on each [N/mm].

        It is good until the next search, if it searches, or cut. A node may be listed more than
        once: its stiffnesses add up. ``counted`` has those of the terms before it, by their names:
        it may tell only what it adds to them.
        """
        return np.zeros(0, np.int64), np.zeros(0)

    def add_corner_forces(self, state: State, rows: Ints, nodes: Ints, force: Floats) -> None:
        """Add its force on a node from a single row, at the present positions [N].

        A crack asks for it where it tries a cut through the node: only a term whose forces come
        from rows, as those of the loads and the shells do, has such forces.
        rows, nodes : (n,), quad or copy, and one of its nodes.  force : (n, 3), added to.
        """

    def fixed_nodes(self, state: State) -> Ints:
        """Return the nodes whose positions it keeps in place, as supports do; by default none."""
        return np.zeros(0, np.int64)

    def by_row(self, state: State) -> Mapping[str, Floats]:
        """Return numbers of each quad and copy to show in frames, shape (n_row,), by their names.

        A name has letters, digits and underscores.
        """
        return {}

    def summary(self) -> Mapping[str, float]:
        """Return values for ``summary.json``; names end with the unit, as ``_mm`` or ``_rel``."""
        return {}

    def stored(self, state: State) -> Mapping[str, float]:
        """Return the entries of the energy balance that are functions of the state [N·mm]."""
        return {}

    def saved(self) -> dict[str, Any]:
        """Return what it keeps from step to step, for a checkpoint."""
        return {}

    def restore(self, state: State, pose: Pose, saved: dict[str, Any]) -> None:
        """Take over :meth:`saved`, for the tool at its present pose; ``state`` is restored."""
