"""Nodal force by trial cut: the force with which the flanks ahead of a tip hold each other.

The cut is tried on the topology. Its classes of corners at the tip, with their masses m and the
nodal forces f that go with them (internal, damping, loads, cables), give the relative acceleration
of the two flanks at the place P of the tip, and that of a pair of unit forces there:

    d = sum N_a (f_a+ / m_a+ - f_a- / m_a-),      kappa = sum N_a² (1 / m_a+ + 1 / m_a-),

N_a being the shape functions at P. The force F_c = d / kappa would keep the flanks together; it is
the force that the new cables take over. Its measure is F_c · m / (sigma_F h (L_in + L_out) / 2)
with the normal m from the minus to the plus side and the lengths of the segments before and behind
the tip; the cut is due at 1. At a node it is the nodal force parted between the two sides
(:mod:`shellcut.fracture.criterion`).
"""

from __future__ import annotations

import numpy as np

from shellcut.arrays import Floats
from shellcut.loads.loads import LoadSet
from shellcut.mitc4.shell import MITC4Shell
from shellcut.state import BROKEN, State

from .crack_path import Segment, Tip
from .cut_state import sides_of
from .cut_topology import Corner, CutTopology
from .quad_polygon import density, shape_functions, share_of

# Shape functions below this are round-off.
_UNUSED = 1e-9


class TrialCut:
    """Tries cuts.

    Parameters
    ----------
    topology : CutTopology
        As it was when a trial is over.
    shell, loads : MITC4Shell, LoadSet
        Give the nodal forces.
    strength : float
        sigma_F [MPa].
    """

    def __init__(
        self, topology: CutTopology, shell: MITC4Shell, loads: LoadSet, strength: float
    ) -> None:
        self._topology, self._shell, self._loads = topology, shell, loads
        self._carried = strength * shell.material.thickness

    def measure(self, state: State, tip: Tip, segment: Segment) -> float:
        """Return F_c · m over what the cables would carry; the cut is due at 1."""
        ring = self._shell.mesh_quads[segment.row].tolist()
        weights = shape_functions(segment.entry)
        corners = [c for c in range(4) if weights[c] > _UNUSED]
        rows, shares, classes = self._tried(state, segment, [ring[c] for c in corners])
        d, kappa = np.zeros(3), 0.0
        for c, groups in zip(corners, classes, strict=True):
            minus, plus = (
                next((g for g in groups if any(r == row for r, _ in g)), None) for row in rows
            )
            if minus is None or plus is None or minus is plus:
                continue
            for sign, members in ((-1.0, minus), (1.0, plus)):
                force, mass = self._force_and_mass(state, members, shares, segment.row)
                d += sign * weights[c] * force / mass
                kappa += weights[c] ** 2 / mass
        if kappa == 0.0:
            return -np.inf
        nodes = state.quads[segment.row]
        start, stop = np.array(weights), np.array(shape_functions(segment.exit))
        x, t = state.node.x[nodes], start @ state.node.t[nodes]
        m = np.cross(t, (stop - start) @ x)
        out = float(np.linalg.norm((stop - start) @ state.node.X[nodes]))
        carried = self._carried * 0.5 * (tip.length + out)
        return float(d @ m / np.linalg.norm(m) / kappa / carried)

    def _tried(
        self, state: State, segment: Segment, nodes: list[int]
    ) -> tuple[list[int], dict[int, float], list[list[list[Corner]]]]:
        """Return the rows on both sides of a trial cut, their shares of the cut row, and classes.

        The classes are those around some nodes of the mesh.
        """
        topology = self._topology
        if segment.along_side:
            a, b, rows, _ = sides_of(topology, self._shell, segment)
            topology.break_side(a, b)
            classes = [topology.classes(node) for node in nodes]
            topology.mend_side(a, b)
            return rows, {}, classes
        whole = topology.polygon(segment.row)
        new = topology.cut(segment.row, segment.entry, segment.exit)
        rows = [segment.row, new]
        J = density(state.node.X[state.quads[segment.row]])
        parts = [share_of(topology.polygon(row), J) for row in rows]
        classes = [topology.classes(node) for node in nodes]
        topology.mend(segment.row, new, whole)
        shares = {row: part / sum(parts) for row, part in zip(rows, parts, strict=True)}
        return rows, shares, classes

    def _force_and_mass(
        self, state: State, members: list[Corner], shares: dict[int, float], cut: int
    ) -> tuple[Floats, float]:
        """Return nodal force [N] and mass [t] of a class of a trial cut of the row ``cut``."""
        rows = np.array([row if row < state.n_quad else cut for row, _ in members])
        part = np.array([shares.get(row, 1.0) for row, _ in members])
        corner = np.array([corner for _, corner in members])
        nodes = state.quads[rows, corner].astype(np.int64)
        force = self._shell.corner_forces(state, rows, nodes)
        self._loads.add_corner_forces(state, rows, nodes, force)
        total = part @ force
        f, c = state.flank, state.cable
        for k in np.flatnonzero(np.isin(f.row[: f.count], rows)).tolist():
            weight = f.weight[k, corner[rows == f.row[k]][0]]
            if weight > _UNUSED:
                cable, end = np.nonzero(c.ends[: c.count] == f.node[k])
                live = c.status[cable] != BROKEN
                total += weight * c.force[cable[live], end[live]].sum(axis=0)
        return total, float(part @ self._shell.mass[rows, corner])
