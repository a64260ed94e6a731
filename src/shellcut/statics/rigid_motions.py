"""Rigid motions of a film that its supports leave free: they meet no stiffness.

Each connected part of the film has six, translations along x, y, z and rotations about axes through
its middle. Expressed in freedoms they are six columns; the rows of held freedoms must vanish, so
the null space of these rows is free.
"""

from __future__ import annotations

import numpy as np

from shellcut.arrays import Floats, Ints
from shellcut.numerics.connected_parts import by_first_appearance, connected_parts
from shellcut.state import State

from .freedoms import Freedoms

# Singular values below this, for columns with entries of size one, indicate free motions.
_FREE = 1e-10

_NAMES = [f"{kind} {axis}" for kind in ("translation along", "rotation about") for axis in "xyz"]


def free_rigid_motions(freedoms: Freedoms, state: State) -> list[str]:
    """Return in words the free rigid motions of the present state.

    Examples
    --------
    >>> from shellcut import Support
    >>> from shellcut.mesh.structured import rectangle
    >>> from shellcut.mitc4.initial_state import initial_state
    >>> from shellcut.loads.supports import SupportSet
    >>> mesh = rectangle(2.0, 1.0, n_x=2, n_y=1)
    >>> state = initial_state(mesh)
    >>> SupportSet(mesh, [Support("left", "xyz", "")]).initialise(state)
    >>> free_rigid_motions(Freedoms(state), state)
    ['rotation about a line along y']
    """
    columns = _columns(freedoms, state)
    held = np.ones(5 * freedoms.n_node, np.bool_)
    held[freedoms.free] = False
    part = _parts(state.quads, freedoms.n_node)
    motions: list[str] = []
    n_part = int(part.max()) + 1
    for k in range(n_part):
        rows = columns[held & np.repeat(part == k, 5)]
        _, size, directions = np.linalg.svd(np.concatenate([rows, np.zeros((6, 6))]))
        left = directions[size <= _FREE]
        where = f" of part {k + 1} of {n_part}" if n_part > 1 else ""
        motions += [name + where for name in _in_words(left)]
    return motions


def _columns(freedoms: Freedoms, state: State) -> Floats:
    """Return the six motions of every part's nodes as freedoms, shape (5 n_node, 6)."""
    n = freedoms.n_node
    part = _parts(state.quads, n)
    columns = np.zeros((n, 5, 6))
    for k in range(int(part.max()) + 1):
        nodes = np.flatnonzero(part == k)
        arm = state.node.x[nodes] - state.node.x[nodes].mean(axis=0)
        size = float(np.abs(arm).max())
        for axis in range(3):
            spin = np.eye(3)[axis]
            columns[nodes, axis, axis] = 1.0
            columns[nodes, :3, 3 + axis] = np.cross(spin, arm) / size
            columns[nodes, 3, 3 + axis] = freedoms.basis[nodes, 1] @ spin
            columns[nodes, 4, 3 + axis] = -freedoms.basis[nodes, 0] @ spin
    return columns.reshape(5 * n, 6)


def _parts(quads: Ints, n_node: int) -> Ints:
    ends = quads[:, [0, 1, 2]].ravel(), quads[:, [1, 2, 3]].ravel()
    return by_first_appearance(connected_parts(*ends, n_node))


def _in_words(left: Floats) -> list[str]:
    """Name the motions spanned by a basis, shape (n, 6)."""
    # Distance of each pure motion from the span: zero if it lies in it.
    pure = np.flatnonzero(np.linalg.norm(np.eye(6) - left.T @ left, axis=1) < 1e-6)
    names = [_NAMES[k] for k in pure]
    other = len(left) - pure.size
    if other != 1:
        return names + ["rotation about a line"] * other
    mixed = left.copy()
    mixed[:, pure] = 0.0
    motion = mixed[np.argmax(np.linalg.norm(mixed, axis=1))]
    turns = float(np.linalg.norm(motion[3:])) > 1e-6
    way = motion[3:] if turns else motion[:3]
    way = way / np.linalg.norm(way)
    axis = np.flatnonzero(np.abs(way) > 1.0 - 1e-6)
    along = "xyz"[axis[0]] if axis.size else f"({way[0]:.3g}, {way[1]:.3g}, {way[2]:.3g})"
    return [*names, f"{'rotation about a line' if turns else 'translation'} along {along}"]
