"""Check that supports keep every piece of the film from moving as a rigid body.

A rigid motion has six parameters, a velocity a and an angular velocity w: a node at x moves with
v = a + w × (x - c), its director with the part of w normal to it, because a director has no
drilling rotation. Supports give linear conditions on the six parameters; the tool sets the
remaining motions going. Loads do not count as support.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from shellcut.arrays import Bools, Floats, Ints
from shellcut.mesh.mesh import Mesh
from shellcut.numerics.connected_parts import connected_parts

from .finding import DOUBT, Finding

_FREE = 1e-8  # relative to the mean square motion of held nodes: round-off, not leverage
_WAYS = ("along x", "along y", "along z", "about x", "about y", "about z")


def check_hold(mesh: Mesh, support: Bools) -> Iterator[Finding]:
    """Yield a doubt for each piece of the film that can move away as a rigid body.

    Parameters
    ----------
    mesh : Mesh
        Pieces are quads that share nodes.
    support : ndarray of bool, shape (n_node, 6)
        Held components of each node, three of position and three of director spin.
    """
    piece = connected_parts(np.repeat(mesh.quads[:, 0], 3), mesh.quads[:, 1:].ravel(), mesh.n_node)
    of_quad = piece[mesh.quads[:, 0]]
    several = len(np.unique(of_quad)) > 1
    for k in np.unique(of_quad).tolist():
        nodes = np.flatnonzero(piece == k)
        free = free_motions(mesh, support, nodes)
        if not free:
            continue
        n_quad = int((of_quad == k).sum())
        x, y, z = mesh.nodes[nodes].mean(axis=0) + 0.0
        who = f"the piece of {n_quad:,} quads" if several else "the film"
        held = int(support[nodes].any(axis=1).sum())
        came = (
            f"{who} about ({x:.4g}, {y:.4g}, {z:.4g}) mm, which nothing holds"
            if held == 0
            else f"{who} about ({x:.4g}, {y:.4g}, {z:.4g}) mm, whose {held:,} held nodes leave it "
            f"free to move {', '.join(free)}"
        )
        yield Finding(
            DOUBT,
            "every piece of the film must be held, or the tool pushes it away instead of cutting",
            came,
            "clamp some of its nodes ([membrane] clamp, [[supports]], or Support in Python)",
        )


def free_motions(mesh: Mesh, support: Bools, nodes: Ints) -> list[str]:
    """Return in words the rigid motions that the supports of some nodes leave free.

    Examples
    --------
    >>> from shellcut.mesh.structured import rectangle
    >>> mesh = rectangle(2.0, 1.0, size=1.0)
    >>> support = np.zeros((mesh.n_node, 6), bool)
    >>> support[mesh.node_set("left"), 0] = True
    >>> free_motions(mesh, support, np.arange(mesh.n_node))
    ['along y', 'along z', 'about x', 'about y']
    """
    rows = _conditions(mesh, support, nodes)
    square = rows.T @ rows / max(len(rows), 1)
    value, vector = np.linalg.eigh(square)
    n_free = int((value <= _FREE * max(float(value[-1]), np.finfo(float).tiny)).sum())
    if value[-1] == 0.0:
        n_free = 6
    pure = [way for c, way in enumerate(_WAYS) if np.linalg.norm(vector[c, :n_free]) > 1.0 - 1e-6]
    left = n_free - len(pure)
    if left == 1 and not pure:
        turn = vector[3:, 0] / np.abs(vector[3:, 0]).max()
        x, y, z = np.round(turn * (1.0 if turn.sum() >= 0.0 else -1.0), 6) + 0.0
        return [f"about an axis along ({x:.3g}, {y:.3g}, {z:.3g})"]
    return [*pure, f"in {left} more ways"] if left else pure


def _conditions(mesh: Mesh, support: Bools, nodes: Ints) -> Floats:
    """Return the supports as rows acting on (a, w size), shape (n, 6)."""
    centre = mesh.nodes[nodes].mean(axis=0)
    size = float(np.linalg.norm(np.ptp(mesh.nodes[nodes], axis=0))) or 1.0
    rows = []
    for c in range(3):
        held = nodes[support[nodes, c]]
        arm = (mesh.nodes[held] - centre) / size
        row = np.zeros((len(held), 6))
        row[:, c] = 1.0
        row[:, 3:] = np.cross(arm, np.eye(3)[c])  # e_c · (w × r) = w · (r × e_c)
        rows.append(row)
        turned = nodes[support[nodes, 3 + c]]
        t = mesh.directors[turned]
        row = np.zeros((len(turned), 6))
        row[:, 3:] = np.eye(3)[c] - t[:, [c]] * t
        rows.append(row)
    return np.concatenate(rows)
