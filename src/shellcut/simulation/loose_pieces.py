"""Loose pieces: when they are taken out of a run, and what becomes of their energy.

A piece is loose if no support holds it (:mod:`shellcut.state.pieces`). It flies on as any film
does, until it is *clear*: no live cable joins it to other film, no node of it is near the tool, and
no node of it is nearer to a node of the rest than ``_CLEAR`` edges. Taking it out then changes
nothing for the rest, if it does not come back.

A piece that goes takes its kinetic energy ½ m v_{n-1/2} · v_{n+1/2} and its strain energy at t_n
with it; both move from their entries of the ledger to ``dropped``. Its quads lose their stiffness,
its nodes are held where they are and no longer seen by contact and cracks, and frames do not show
it.
"""

from __future__ import annotations

import numpy as np
import scipy

from shellcut.arrays import Ints
from shellcut.contact.penalty_contact import PenaltyContact
from shellcut.fracture.cracks import Cracks
from shellcut.mitc4.shell import MITC4Shell
from shellcut.state import BROKEN, DROPPED, KnownTopology, SplitRecord, State
from shellcut.state.pieces import Pieces

from .ledger import Ledger

# Distance from the rest of the film, in edge lengths.
_CLEAR = 2.0

# Steps between two looks.
_LOOK_EVERY = 100


class LoosePieces:
    """Takes loose pieces out of a run.

    Parameters
    ----------
    shell : MITC4Shell
        Of the film.
    cracks : Cracks
        Give up what ends in a piece that goes.
    contact : PenaltyContact, optional
        Knows the nodes near the tool.
    edge_length : float
        Of a typical quad [mm].
    damping_alpha : float
        Mass damping [1/s].
    """

    def __init__(
        self,
        shell: MITC4Shell,
        cracks: Cracks,
        contact: PenaltyContact | None,
        edge_length: float,
        damping_alpha: float,
    ) -> None:
        self._shell, self._cracks, self._contact = shell, cracks, contact
        self._clear, self._alpha = _CLEAR * edge_length, damping_alpha
        self._known = KnownTopology()
        self._pieces: Pieces | None = None

    def drop_due(self, state: State, book: Ledger, dt: float) -> float:
        """Take out the loose pieces that are clear, after the kick at t_n.

        Returns their mass damping in that kick [N·mm], half of which belongs to the next step.

        Parameters
        ----------
        state : State
            Written.
        book : Ledger
            Written.
        dt : float
            Duration of that kick [s].
        """
        if state.step % _LOOK_EVERY:
            return 0.0
        if self._pieces is None or not self._known.is_of(state):
            self._pieces = Pieces.of(state)
            self._known.take(state)
        damping = 0.0
        for piece in np.flatnonzero(self._pieces.loose).tolist():
            rows = np.flatnonzero(self._pieces.of_row == piece)
            nodes = _nodes_of(state, rows)
            if self._is_clear(state, nodes):
                damping += self._drop(state, rows, nodes, book, dt)
        return damping

    def _is_clear(self, state: State, nodes: Ints) -> bool:
        c, n = state.cable, state.node
        live = c.ends[: c.count][c.status[: c.count] != BROKEN]
        if np.isin(live, nodes).any():
            return False
        near = nodes[:0] if self._contact is None else self._contact.near_nodes(state)
        if np.isin(near, nodes).any():
            return False
        other = n.real[: n.count].copy()
        other[nodes] = False
        mine = nodes[n.real[nodes]]
        tree = scipy.spatial.cKDTree(n.x[: n.count][other])
        nearest, _ = tree.query(n.x[mine], distance_upper_bound=self._clear)
        return bool(np.isinf(nearest).all())

    def _drop(self, state: State, rows: Ints, nodes: Ints, book: Ledger, dt: float) -> float:
        translation, rotation, damping = _kinetic(state, nodes, self._alpha, dt)
        strain = self._shell.dropped.take_out(state, rows)
        book.kinetic_translation -= translation
        book.kinetic_rotation -= rotation
        book.strain -= strain
        book.dropped += translation + rotation + strain
        n = state.node
        state.quad.dropped[rows] = True
        n.velocity_half[nodes] = n.spin_half[nodes] = 0.0
        n.push[nodes] = 0.0
        n.supported[nodes] = n.support[nodes] = True
        n.support_rate[nodes] = n.reaction[nodes] = n.load_force[nodes] = 0.0
        n.real[nodes] = False
        n.halved[nodes] = True  # no blade begins a cut there
        place, reference = (tuple(x[nodes].mean(axis=0).tolist()) for x in (n.x, n.X))
        state.split_log.append(
            SplitRecord(state.time, -1, -1, place, reference, DROPPED, 0.0, 0.0, (-1, -1))
        )
        state.revision += 1
        self._cracks.forget(state)
        return damping


def _nodes_of(state: State, rows: Ints) -> Ints:
    """Return the nodes of some rows, flank points included, ascending."""
    f = state.flank
    tied = f.node[: f.count][np.isin(f.row[: f.count], rows)]
    return np.union1d(state.quads[rows], tied)


def _kinetic(state: State, nodes: Ints, alpha: float, dt: float) -> tuple[float, float, float]:
    """Return kinetic energies of translation and rotation of free nodes, and their mass damping.

    At t_n, [N·mm], as in the kick (:mod:`shellcut.central_difference`): the velocities before it
    follow from those after it and the forces.
    """
    n = state.node
    nodes = nodes[n.mass[nodes] > 0.0]
    moment = np.cross(n.t[nodes], n.director_force[nodes])
    energies, damping = [], 0.0
    for mass, velocity, force in (
        (n.mass, n.velocity_half, n.force[nodes]),
        (n.inertia, n.spin_half, moment),
    ):
        m, after = mass[nodes, None], velocity[nodes]
        before = (1.0 + 0.5 * alpha * dt) * after - dt * force / m
        before /= 1.0 - 0.5 * alpha * dt
        energies.append(0.5 * float((m * before * after).sum()))
        damping += 0.25 * alpha * dt * float((m * (before + after) ** 2).sum())
    return energies[0], energies[1], damping
