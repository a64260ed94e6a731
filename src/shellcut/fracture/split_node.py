"""Split a node: the only file that changes the topology.

The node keeps the quads on the minus side; its twin, a new row, takes those on the plus side.
Position, director, velocity and spin are copied; mass and rotary inertia are the sums over each
half's own quads, so that mass, momentum, angular momentum and kinetic energy stay as they were to
round-off, and the strain energy exactly. A cable joins the halves. Cables that already held the
node go, half-edge by half-edge, with the half that owns their flank.
"""

from __future__ import annotations

import numpy as np

from shellcut.cables.cohesive_law import CohesiveLaw
from shellcut.mitc4.shell import MITC4Shell
from shellcut.state import NOT_MET, SplitRecord, State

from .criterion import Split
from .flanks import cable_ends, half_edges, owned_half_edges


def split_node(
    state: State, split: Split, shell: MITC4Shell, law: CohesiveLaw, *, equilibrium_start: bool
) -> int:
    """Carry out one split and return the id of the twin.

    Writes nodes, quads, cables, crack length and split log; the caller re-evaluates the step.
    """
    n = state.node
    node = split.node
    loose = cable_ends(state, node)
    before = n.mass[node]
    twin = n.append_copy(node)
    n = state.node
    for e in split.plus:
        corner = int(np.flatnonzero(state.quads[e] == node)[0])
        state.quads[e, corner] = twin
    for half, quads in ((node, split.minus), (twin, split.plus)):
        n.n_quad_at[half] = len(quads)
        n.quads[half, : len(quads)] = sorted(quads)
        mass, inertia, n.contact_area[half] = shell.node_inertia(state, half)
        n.weigh(half, mass, inertia)
        # Forces of the last evaluation, shared like the mass, enter the next work increment only.
        share = n.mass[half] / before
        n.contact_force[half] *= share
        n.contact_work[half] *= share
        n.load_force[half] *= share
        n.contact_side[half] = 0
        n.halved[half] = True
    for cable, end in loose:
        _reattach(state, cable, end, twin, split.plus, shell.material.thickness)
    if split.half_edges:
        _join(state, split, twin, shell.material.thickness, law, equilibrium_start)
    length = sum(half for _, half in split.half_edges)
    area = shell.material.thickness * length
    state.crack_length += length
    state.revision += 1
    # With the equilibrium start the cable begins with the very force that the node carried.
    new_force = split.force if equilibrium_start else law.strength * area * split.m
    state.split_log.append(
        SplitRecord(
            time=state.time,
            node=node,
            twin=twin,
            place=tuple(n.x[node].tolist()),
            reference=tuple(n.X[node].tolist()),
            kind="blade" if split.blade else "criterion",
            measure=split.measure,
            force_jump=float(np.linalg.norm(split.force - new_force)),
        )
    )
    return twin


def _join(
    state: State,
    split: Split,
    twin: int,
    thickness: float,
    law: CohesiveLaw,
    equilibrium_start: bool,
) -> None:
    k = state.cable.append_blank()
    c = state.cable
    c.ends[k] = split.node, twin
    c.edge[k] = NOT_MET
    for i, (far, half) in enumerate(split.half_edges):
        c.half_edge[k, i] = half
        c.half_edge_far[k, i] = far
    c.area[k] = thickness * c.half_edge[k].sum()
    c.m[k] = split.m
    c.branch[k] = split.m, -split.m
    c.birth[k] = state.time
    # The force that a new cable is about to exert: at zero opening it has done no work yet.
    c.traction[k] = law.strength
    if equilibrium_start:
        c.start_force[k] = split.force - law.strength * c.area[k] * split.m


def _reattach(
    state: State, cable: int, end: int, twin: int, plus: tuple[int, ...], thickness: float
) -> None:
    """Give the twin, which has the quads ``plus``, what it owns of a cable that held the node."""
    c = state.cable
    moving = owned_half_edges(state, cable, twin, plus)
    staying = [i for i in half_edges(state, cable) if i not in moving]
    if not moving:
        return
    if not staying:
        c.ends[cable, end] = twin
        return
    # One half-edge each way: the cable is divided in two with one history.
    other = c.append_copy(cable)
    c = state.cable
    total = c.half_edge[cable].sum()
    for k, kept in ((cable, staying[0]), (other, moving[0])):
        share = c.half_edge[k, kept] / total
        half, far = c.half_edge[k, kept], c.half_edge_far[k, kept]
        c.half_edge[k] = half, 0.0
        c.half_edge_far[k] = far, 0
        c.area[k] = thickness * half
        for extensive in (c.start_force, c.force, c.work, c.start_work):
            extensive[k] *= share
    c.ends[other, end] = twin
