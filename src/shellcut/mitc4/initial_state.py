"""State of an unloaded mesh at rest: start of a simulation or a static solution."""

from __future__ import annotations

import numpy as np

from shellcut.arrays import Floats, Ints, SmallIds, product
from shellcut.mesh.mesh import MAX_VALENCE, Mesh
from shellcut.numerics.small_matrices import inverse
from shellcut.state import RESERVE, CableTable, FlankTable, NodeTable, QuadTable, State


def initial_state(mesh: Mesh) -> State:
    """Allocate the state of an unloaded mesh at rest; the shell adds strains and history."""
    n, capacity = mesh.n_node, mesh.n_node + RESERVE
    node = NodeTable.blank(
        n,
        capacity,
        X=mesh.nodes,
        x=mesh.nodes,
        t=mesh.directors,
        contact_share=1.0,
        origin=mesh.origin,
        halved=np.bincount(mesh.origin, minlength=n)[mesh.origin] > 1,
        real=True,
    )
    node.quads, node.n_quad_at = quads_of_nodes(mesh.quads, capacity)
    quad = QuadTable.blank(
        mesh.n_quad,
        mesh.n_quad,
        nodes=mesh.quads,
        parent=np.arange(mesh.n_quad),
        share=1.0,
        mass_share=1.0,
        centre=0.25,
    )
    return State(
        node=node,
        cable=CableTable.blank(0, RESERVE),
        flank=FlankTable.blank(0, RESERVE),
        quad=quad,
        strain=np.zeros((0, 0, 0)),
        strain_before=np.zeros((0, 0, 0)),
        history=np.zeros((0, 0, 0)),
    )


def director_spins(mesh: Mesh, velocity: Floats) -> Floats:
    """Return spins that keep the directors' angles to the surface, shape (n_node, 3) [rad/s].

    A director t has a constant component along each line d to a node of its quads if

        dt/dt · d = -t · (v_other - v_own).

    dt/dt, which is normal to t, solves this by least squares; the spin is t × dt/dt. It is exact
    where the film moves as a rigid body, whatever its shape, and makes no transverse shear.

    velocity : (n_node, 3), [mm/s].
    """
    t = mesh.directors
    matrix, right = np.zeros((len(t), 3, 3)), np.zeros_like(t)
    for a in range(4):
        own = mesh.quads[:, a]
        for b in (1, 2, 3):
            other = mesh.quads[:, (a + b) % 4]
            line = mesh.nodes[other] - mesh.nodes[own]
            line -= (line * t[own]).sum(axis=1)[:, None] * t[own]
            rate = -(t[own] * (velocity[other] - velocity[own])).sum(axis=1)
            np.add.at(matrix, own, line[:, :, None] * line[:, None])
            np.add.at(right, own, rate[:, None] * line)
    # The part along t, which the lines leave open, is none.
    size = np.einsum("nii->n", matrix)
    matrix += size[:, None, None] * t[:, :, None] * t[:, None]
    return np.cross(t, product(inverse(matrix), right[:, :, None])[:, :, 0])


def quads_of_nodes(quads: Ints, capacity: int) -> tuple[SmallIds, SmallIds]:
    """Return the quads at every node, ascending, (capacity, MAX_VALENCE), and their number."""
    n_quad_at = np.bincount(quads.ravel(), minlength=capacity).astype(np.int32)
    table = np.zeros((capacity, MAX_VALENCE), np.int32)
    order = np.argsort(quads.ravel(), kind="stable")
    start = np.concatenate([[0], np.cumsum(n_quad_at)[:-1]])
    rank = np.arange(order.size) - np.repeat(start, n_quad_at)
    table[quads.ravel()[order], rank] = order // 4
    return table, n_quad_at
