"""Checks of supports: no piece of the film is free to move away, no blade meets fixed film.

A rigid motion has six parameters, a velocity a and an angular velocity w: a node at x moves with
v = a + w × (x - c), its director with the part of w normal to it, because a director has no
drilling rotation. Supports give linear conditions on the six parameters; the tool sets the
remaining motions going. Loads do not count as support.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from shellcut.arrays import Bools, Floats, Ints
from shellcut.formats.errors import point_text
from shellcut.mesh.mesh import Mesh
from shellcut.numerics.connected_parts import by_first_appearance, connected_parts

from .finding import Finding, doubt
from .sweep import Sweep

ONE_MOTION = 0.1
"""Of the speed of the cutting edges, by which supported nodes may move otherwise than the film."""
_LEVER = 1e-4
"""Arm of a supported node over the size of its piece that is round-off, and fixes nothing."""
_WAYS = ("along x", "along y", "along z", "about x", "about y", "about z")


def check_hold(mesh: Mesh, support: Bools) -> Iterator[Finding]:
    """Yield a doubt for each piece of the film that can move away as a rigid body.

    The support is that of each node, six components, as in :func:`pieces_of`.
    """
    pieces = pieces_of(mesh.quads, mesh.nodes, mesh.directors, support, _LEVER)
    for nodes, free in pieces:
        if not free:
            continue
        n_quad = int(np.isin(mesh.quads[:, 0], nodes).sum())
        who = f"the piece of {n_quad:,} quads" if len(pieces) > 1 else "the film"
        held = int(support[nodes].any(axis=1).sum())
        left = f"whose {held:,} supported nodes leave it free to move {', '.join(free)}"
        yield doubt(
            "every piece of the film must be supported, or the tool pushes it away without cutting",
            f"{who} about {point_text(mesh.nodes[nodes].mean(axis=0), 4)} mm, "
            f"{left if held else 'which has no support'}",
            "clamp some of its nodes ([membrane] clamp, [[supports]], or Support in Python)",
        )


def check_held_film(sweep: Sweep, support: Bools) -> Iterator[Finding]:
    """Yield a doubt if a cutting edge passes through quads that cannot move."""
    node = np.asarray(support[:, :3].all(axis=1))
    held = np.flatnonzero(node[sweep.mesh.quads[sweep.quad]].all(axis=1))
    if held.size:
        yield doubt(
            "the cutting edges must pass through film that can move",
            f"{np.unique(sweep.quad[held]).size:,} quads under their path with all four nodes "
            f"fixed, the first at {point_text(sweep.place[held[0]], 4)} mm",
            "support fewer nodes ([membrane] clamp, [[supports]]), or move the tool away from them",
        )


def check_one_motion(misfit: float, speed: float) -> Iterator[Finding]:
    """Yield a doubt if supports move parts of the film so differently that no path is that of all.

    misfit : of supported nodes against the rigid motion of the film.  speed : largest of the
    cutting edges in the film, [mm/s] both.
    """
    if misfit > ONE_MOTION * speed:
        yield doubt(
            "supports must move the film as one body, or the path of the tool in the film, and "
            "with it force and torque, is that in the mean of its supports",
            f"supported nodes that move by up to {misfit:.4g} mm/s otherwise, where the cutting "
            f"edges move by {speed:.4g} mm/s in the film",
            "model sheets that move apart in runs of their own, or take works in place of forces",
        )


def pieces_of(
    quads: Ints, x: Floats, directors: Floats, support: Bools, lever: float
) -> list[tuple[Ints, list[str]]]:
    """Return nodes and free motions, in words, of each piece of a film, quads that share nodes.

    ``support`` has the fixed components of each node, three of position and three of director
    spin, shape (n_node, 6). A supported node whose arm over the size of its piece is below
    ``lever`` prevents no rotation.

    Examples
    --------
    >>> from shellcut.mesh.structured import rectangle
    >>> mesh = rectangle(2.0, 1.0, size=1.0)
    >>> support = np.zeros((mesh.n_node, 6), bool)
    >>> support[mesh.node_set("left"), 0] = True
    >>> [(_, free)] = pieces_of(mesh.quads, mesh.nodes, mesh.directors, support, 1e-9)
    >>> free
    ['along y', 'along z', 'about x', 'about y']
    """
    first, others = np.repeat(quads[:, 0], 3), quads[:, 1:].ravel()
    piece = by_first_appearance(connected_parts(first, others, len(x)))
    found: list[tuple[Ints, list[str]]] = []
    for k in range(int(piece.max()) + 1):
        nodes = np.flatnonzero(piece == k)
        rows = _conditions(x[nodes], directors[nodes], support[nodes])
        _, size, way = np.linalg.svd(np.concatenate([rows, np.zeros((6, 6))]), full_matrices=False)
        free = way[size <= lever * max(float(size[0]), np.finfo(float).tiny)]
        found.append((nodes, _in_words(free)))
    return found


def _in_words(free: Floats) -> list[str]:
    """Name the motions spanned by a basis, shape (n, 6)."""
    pure = np.flatnonzero(np.linalg.norm(free, axis=0) > 1.0 - 1e-6)
    names = [_WAYS[c] for c in pure]
    n_other = len(free) - len(pure)
    if n_other != 1:
        return [*names, *["about another axis"] * n_other]
    mixed = free.copy()
    mixed[:, pure] = 0.0
    motion = mixed[np.argmax(np.linalg.norm(mixed, axis=1))]
    turns = bool(np.linalg.norm(motion[3:]) > 1e-6)
    way = motion[3:] if turns else motion[:3]
    way = way / np.abs(way).max()
    x, y, z = np.round(way * (1.0 if way.sum() >= 0.0 else -1.0), 6) + 0.0
    return [*names, f"{'about an axis ' if turns else ''}along ({x:.3g}, {y:.3g}, {z:.3g})"]


def _conditions(x: Floats, directors: Floats, support: Bools) -> Floats:
    """Return the supports of a piece as rows acting on (a, w size), shape (n, 6)."""
    arms = x - x.mean(axis=0)
    arms /= float(np.linalg.norm(np.ptp(x, axis=0))) or 1.0
    node, axis = np.nonzero(support[:, :3])
    e = np.eye(3)[axis]
    moves = np.concatenate([e, np.cross(arms[node], e)], axis=1)  # e · (w × r) = w · (r × e)
    node, axis = np.nonzero(support[:, 3:])
    e, t = np.eye(3)[axis], directors[node]
    spins = e - (e * t).sum(axis=1, keepdims=True) * t
    return np.concatenate([moves, np.concatenate([np.zeros_like(spins), spins], axis=1)])
