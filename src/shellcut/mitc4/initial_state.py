"""State of an unloaded mesh at rest: start of a simulation or a static solution."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

import numpy as np

from shellcut.arrays import Floats, Ints, SmallIds
from shellcut.mesh.mesh import MAX_VALENCE, Mesh
from shellcut.numerics.lanes import aligned_zeros
from shellcut.state import RESERVE, CableTable, FlankTable, NodeTable, QuadTable, State, columns


def initial_state(mesh: Mesh) -> State:
    """Allocate the state of an unloaded mesh at rest; the shell adds strains and history."""
    return State(
        node=_nodes(mesh),
        cable=_cables(),
        flank=_flank_points(),
        quad=_quads(mesh),
        strain=np.zeros((0, 0, 0)),
        strain_before=np.zeros((0, 0, 0)),
        history=np.zeros((0, 0, 0)),
    )


def _nodes(mesh: Mesh) -> NodeTable:
    n, cap = mesh.n_node, mesh.n_node + RESERVE

    def rows(*shape: int) -> Floats:
        return np.zeros((cap, *shape))

    X, x, t = columns(cap, 3), columns(cap, 3), columns(cap, 3)
    X[:n] = mesh.nodes
    x[:n], t[:n] = mesh.nodes, mesh.directors
    origin = np.zeros(cap, np.int64)
    origin[:n] = mesh.origin
    halved = np.zeros(cap, np.bool_)
    halved[:n] = np.bincount(mesh.origin, minlength=n)[mesh.origin] > 1
    quads_at, n_quad_at = quads_of_nodes(mesh.quads, cap)
    return NodeTable(
        count=n,
        X=X,
        x=x,
        t=t,
        velocity_half=columns(cap, 3),
        spin_half=columns(cap, 3),
        force_rows=aligned_zeros((cap, 8)),
        mass=rows(),
        inertia=rows(),
        push=columns(cap, 2),
        contact_mass=rows(),
        contact_area=rows(),
        contact_share=np.ones(cap),
        origin=origin,
        halved=halved,
        real=np.ones(cap, np.bool_),
        quads=quads_at,
        n_quad_at=n_quad_at,
        supported=np.zeros(cap, np.bool_),
        support=np.zeros((cap, 6), np.bool_),
        support_rate=rows(6),
        reaction=rows(6),
        load_force=rows(3),
        contact_side=np.zeros(cap, np.int8),
        contact_depth=rows(),
        contact_offset=rows(),
        contact_work=rows(),
        contact_force=rows(3),
        friction_spring=rows(3),
        friction_force=rows(3),
    )


def _cables() -> CableTable:
    names = [f.name for f in fields(CableTable) if f.name != "count"]
    rows: dict[str, Any] = {
        name: np.zeros((RESERVE, *shape), dtype)
        for name, (shape, dtype) in zip(names, _CABLE_ROWS, strict=True)
    }
    return CableTable(count=0, **rows)


def _flank_points() -> FlankTable:
    return FlankTable(
        count=0,
        node=np.zeros(RESERVE, np.int64),
        row=np.zeros(RESERVE, np.int64),
        place=np.zeros((RESERVE, 2)),
        inward=np.zeros((RESERVE, 2)),
        nodes=np.zeros((RESERVE, 4), np.int64),
        weight=np.zeros((RESERVE, 4)),
    )


def _quads(mesh: Mesh) -> QuadTable:
    return QuadTable(
        count=mesh.n_quad,
        nodes=mesh.quads.astype(np.int32),
        parent=np.arange(mesh.n_quad),
        share=np.ones(mesh.n_quad),
        mass_share=np.ones(mesh.n_quad),
        centre=np.full((mesh.n_quad, 4), 0.25),
        dropped=np.zeros(mesh.n_quad, np.bool_),
    )


# Shape and type of a row, in the order of CableTable's fields.
_CABLE_ROWS: list[tuple[tuple[int, ...], type]] = [
    ((2,), np.int64),
    ((), np.int8),
    ((), np.float64),
    ((), np.float64),
    ((2,), np.int64),
    ((2,), np.int64),
    ((2, 2), np.float64),
    ((3,), np.float64),
    ((3,), np.float64),
    ((), np.float64),
    ((), np.float64),
    ((), np.float64),
    ((), np.int64),
    ((3,), np.float64),
    ((3,), np.float64),
    ((), np.float64),
    ((), np.float64),
    ((), np.float64),
    ((), np.float64),
    ((), np.float64),
    ((2, 3), np.float64),
    ((2, 3), np.float64),
    ((), np.float64),
    ((), np.float64),
    ((), np.float64),
    ((), np.float64),
    ((), np.float64),
]


def quads_of_nodes(quads: Ints, capacity: int) -> tuple[SmallIds, SmallIds]:
    """Return the quads at every node, ascending, (capacity, MAX_VALENCE), and their number."""
    n_quad_at = np.bincount(quads.ravel(), minlength=capacity).astype(np.int32)
    table = np.zeros((capacity, MAX_VALENCE), np.int32)
    order = np.argsort(quads.ravel(), kind="stable")
    start = np.concatenate([[0], np.cumsum(n_quad_at)[:-1]])
    rank = np.arange(order.size) - np.repeat(start, n_quad_at)
    table[quads.ravel()[order], rank] = order // 4
    return table, n_quad_at
