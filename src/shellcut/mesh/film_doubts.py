"""Signs of damage in a film: places where a quad, a node or an entry of a set seems to be missing.

A text file without counts can be read even if a line is missing. The mesh is then valid, but no
mesher makes such a mesh: a hole of one quad in the middle, a notch of one quad in the rim, a rim
set without three nodes of the rim. Each may be intended; so each is a sentence, not an error.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from shellcut.arrays import Floats, Ints, angles, norm, product
from shellcut.formats.errors import counted, named, point_text
from shellcut.numerics.connected_parts import connected_parts

from .checks import place
from .quad_geometry import corner_vectors

if TYPE_CHECKING:
    from .mesh import Mesh

_MOST_EDGES = 8
"""Edges around a hole that may be a few missing quads."""
_MOST_LOST = 4.0
"""Quads that would fill it."""
_FEW = 3
"""Up to this many isolated items look like slips."""
_MANY = 10
"""Number of members from which a set has a recognisable shape."""
_MOST_OF = 0.75
"""Part of a boundary from which a set seems to mean all of it."""
_CORNER_DEG = 30.0
_USUAL, _MUCH_WORSE, _AROUND_A_NODE = 0.05, 0.5, 4
"""Largest share of bad quads, how much worse a bad quad is, how many quads one node can spoil."""
_FLAT = 1e-6
"""Relative to the film's size: nodes closer than this to a plane lie in it."""


def film_doubts(mesh: Mesh) -> list[str]:
    """Return a sentence for every sign of a loss in a valid mesh.

    Examples
    --------
    >>> from shellcut.mesh.mesh import Mesh
    >>> from shellcut.mesh.structured import rectangle
    >>> sheet = rectangle(5.0, 5.0, size=1.0)
    >>> film_doubts(sheet)
    []
    >>> film_doubts(Mesh.from_arrays(sheet.nodes, np.delete(sheet.quads, 12, axis=0)))
    ['a hole of 4 edges around (2.5, 0, 0) mm has the size of 1 quad: is one missing there?']
    """
    rim = _Rim(mesh)
    return [
        *_parts(mesh),
        *_holes(mesh, rim),
        *_notches(mesh, rim),
        *_off_plane(mesh),
        *_out_of_shape(mesh),
        *_gaps_in_rim_sets(mesh, rim),
        *_slips_in_node_sets(mesh),
        *_lone_quads(mesh),
    ]


class _Rim:
    """The boundary: closed loops of edges with one quad, in the direction of their quads."""

    def __init__(self, mesh: Mesh) -> None:
        table = mesh.edges()
        ends = table.nodes[table.n_quad == 1]
        quads = mesh.quads[table.quads[table.n_quad == 1, 0]]
        # the quad runs from the first end to the second if the second follows the first in it
        at = np.argmax(quads == ends[:, :1], axis=1)
        forward = quads[np.arange(len(quads)), (at + 1) % 4] == ends[:, 1]
        start = np.where(forward, ends[:, 0], ends[:, 1])
        self.next = np.full(mesh.n_node, -1, np.int64)
        self.next[start] = np.where(forward, ends[:, 1], ends[:, 0])
        self.nodes = np.sort(start)
        self.loop = np.full(mesh.n_node, -1, np.int64)
        label = connected_parts(start, self.next[start], mesh.n_node)
        _, self.loop[self.nodes] = np.unique(label[self.nodes], return_inverse=True)
        self.angle = _angles(mesh)  # angle of the film at each node [deg]

    def loops(self) -> list[Ints]:
        """Return the nodes of each loop, ascending."""
        order = np.argsort(self.loop[self.nodes], kind="stable")
        ends = np.cumsum(np.bincount(self.loop[self.nodes], minlength=1))
        return [loop for loop in np.split(self.nodes[order], ends[:-1]) if len(loop)]

    def along(self, first: int, n: int) -> list[int]:
        """Return n nodes of a loop in order, starting at a node."""
        walked = [first]
        while len(walked) < n:
            walked.append(int(self.next[walked[-1]]))
        return walked


def _angles(mesh: Mesh) -> Floats:
    total = np.zeros(mesh.n_node)
    for a in range(4):
        p, q = corner_vectors(mesh.nodes, mesh.quads, a)
        angle = angles(p, q)
        total += np.bincount(mesh.quads[:, a], weights=angle, minlength=mesh.n_node)
    return np.asarray(np.degrees(total))


def _parts(mesh: Mesh) -> Iterator[str]:
    part = _part_of_nodes(mesh)[mesh.quads[:, 0]]
    names, first, sizes = np.unique(part, return_index=True, return_counts=True)
    if len(names) > 1:
        order = np.argsort(sizes, kind="stable")
        told = named(order.tolist(), lambda k: f"{sizes[k]} at {_centre(mesh, first[k])}")
        yield f"the film is in {len(names)} parts that share no node, of so many quads: {told}"


def _part_of_nodes(mesh: Mesh) -> Ints:
    return connected_parts(mesh.quads[:, [0, 0, 0]].ravel(), mesh.quads[:, 1:].ravel(), mesh.n_node)


def _holes(mesh: Mesh, rim: _Rim) -> Iterator[str]:
    # small loops beside the outer boundary of their part, which is the longest
    known = {frozenset(ids.tolist()) for ids in mesh.node_sets.values()}
    part, areas = _part_of_nodes(mesh), mesh.quad_areas()
    longest: dict[int, int] = {}
    for members in rim.loops():
        key = int(part[members[0]])
        longest[key] = max(longest.get(key, 0), len(members))
    for members in rim.loops():
        is_outer = len(members) == longest[int(part[members[0]])]
        is_cut = len(np.unique(mesh.origin[members])) < len(members)
        if len(members) > _MOST_EDGES or is_outer or is_cut:
            continue
        points = mesh.nodes[rim.along(int(members[0]), len(members))]
        spokes = points - points.mean(axis=0)
        vector = 0.5 * np.cross(spokes, np.roll(spokes, -1, axis=0)).sum(axis=0)
        around = areas[np.isin(mesh.quads, members).any(axis=1)].mean()
        size = float(norm(vector) / around)
        place = f"{len(members)} edges around {point_text(points.mean(axis=0))} mm"
        if product(vector, mesh.directors[members].sum(axis=0)) > 0.0:
            yield f"quads overlap within a loop of {place}: is a corner of one wrong there?"
        elif size < _MOST_LOST + 0.5 and frozenset(members.tolist()) not in known:
            n = max(1, round(size))
            yield (
                f"a hole of {place} has the size of {counted(n, 'quad', 'quads')}: "
                f"{'are some' if n > 1 else 'is one'} missing there?"
            )


def _notches(mesh: Mesh, rim: _Rim) -> Iterator[str]:
    # in along one edge, across one, and out along one: the shape of one quad
    a = rim.nodes
    b = rim.next[a]
    c = rim.next[b]
    d = rim.next[c]
    outer, inner = 180.0 - _CORNER_DEG, 180.0 + _CORNER_DEG
    found = (rim.angle[a] < outer) & (rim.angle[b] > inner)
    found &= (rim.angle[c] > inner) & (rim.angle[d] < outer) & (rim.next[d] != a)
    if found.any():
        corners = np.stack([a, b, c, d], axis=1)[found]
        told = named(corners.tolist(), lambda k: point_text(mesh.nodes[k].mean(axis=0)) + " mm")
        n = len(corners)
        yield (
            f"{counted(n, 'notch', 'notches')} in the rim of the size of one quad, at {told}: is "
            "a quad missing there?"
        )


def _off_plane(mesh: Mesh) -> Iterator[str]:
    normal = mesh.directors.mean(axis=0)
    length = float(norm(normal))
    if length < 0.5:  # closed or strongly curved
        return
    height = product(mesh.nodes, normal / length)
    for axis in np.eye(3):  # unlike the mean normal, these do not tilt with one wrong node
        if abs(product(axis, normal)) > 0.9 * length:
            height = product(mesh.nodes, axis)
    away = np.abs(height - np.median(height)) > _FLAT * float(np.ptp(mesh.nodes, axis=0).max())
    n = int(away.sum())
    if 0 < n <= min(_FEW, mesh.n_node // _MANY):
        yield (
            f"all but {counted(n, 'node', 'nodes')} lie in one plane: "
            f"{named(np.flatnonzero(away), lambda k: place(k, mesh.nodes))} mm"
        )


def _out_of_shape(mesh: Mesh) -> Iterator[str]:
    # one misplaced node spoils the quads around it, and no others
    lengths = mesh.edge_lengths()
    shape = np.minimum(mesh.scaled_jacobian(), lengths.min(axis=1) / lengths.max(axis=1))
    usual = float(np.quantile(shape, _USUAL))
    worse = np.flatnonzero(shape < _MUCH_WORSE * usual)
    if 0 < len(worse) <= _AROUND_A_NODE and mesh.n_quad >= 5 * _AROUND_A_NODE:
        told = named(worse, lambda e: f"quad {e} at {_centre(mesh, e)} mm, {shape[e]:.2g}")
        yield (
            f"{counted(len(worse), 'quad has', 'quads have')} far less shape than all others, "
            f"{usual:.2g} or more: {told}: is a node out of its place?"
        )


def _gaps_in_rim_sets(mesh: Mesh, rim: _Rim) -> Iterator[str]:
    straight = np.abs(rim.angle - 180.0) < _CORNER_DEG
    for name, ids in mesh.node_sets.items():
        held = np.zeros(mesh.n_node, np.bool_)
        held[ids] = True
        for members in rim.loops():
            share = held[members].mean()
            if len(members) < _MANY or not _MOST_OF <= share < 1.0:
                continue
            lost = members[~held[members]]
            # a gap's end where the boundary continues straight is not the end of a side
            before = members[held[members] & ~held[rim.next[members]] & straight[members]]
            after = rim.next[lost]
            after = after[held[after] & straight[after]]
            if len(before) or len(after):
                yield (
                    f"node set {name!r} leaves out {len(lost)} of the {len(members)} nodes of a "
                    f"boundary: {named(lost, lambda k: place(k, mesh.nodes))} mm"
                )


def _slips_in_node_sets(mesh: Mesh) -> Iterator[str]:
    # members without a neighbour in the set, and nodes between two ends of a line that it forms
    a, b = mesh.edges().nodes.T
    for name, ids in mesh.node_sets.items():
        held = np.zeros(mesh.n_node, np.bool_)
        held[ids] = True
        both = held[a] & held[b]
        n_held = np.bincount(np.concatenate([a[both], b[both]]), minlength=mesh.n_node)
        alone = ids[n_held[ids] == 0]
        if _looks_like_slips(alone, ids):
            yield (
                f"of the {len(ids)} nodes of set {name!r} {counted(len(alone), 'has', 'have')} no "
                f"neighbour in it: {named(alone, lambda k: place(k, mesh.nodes))} mm"
            )
        is_end = held & (n_held == 1)
        n_end = np.bincount(a, weights=is_end[b], minlength=mesh.n_node)
        n_end += np.bincount(b, weights=is_end[a], minlength=mesh.n_node)
        between = np.flatnonzero(~held & (n_end == 2))
        if _looks_like_slips(between, ids):
            yield (
                f"node set {name!r} of {len(ids)} nodes ends on both sides of "
                f"{named(between, lambda k: place(k, mesh.nodes))} mm: is it missing in the set?"
            )


def _lone_quads(mesh: Mesh) -> Iterator[str]:
    table = mesh.edges()
    one, two = table.quads[table.n_quad == 2].T
    n_beside = np.bincount(np.concatenate([one, two]), minlength=mesh.n_quad)
    for name, ids in mesh.quad_sets.items():
        held = np.zeros(mesh.n_quad, np.bool_)
        held[ids] = True
        n_held = np.bincount(one, weights=held[two], minlength=mesh.n_quad)
        n_held += np.bincount(two, weights=held[one], minlength=mesh.n_quad)
        alone = ids[(n_held[ids] == 0) & (n_beside[ids] > 0)]
        left = np.flatnonzero(~held & (n_held == n_beside) & (n_beside > 0))
        for few, told in ((alone, "only others beside it"), (left, "none but members beside it")):
            if _looks_like_slips(few, ids):
                places = named(few, lambda e: f"quad {e} at {_centre(mesh, e)}")
                what = "its" if few is alone else "beside its"
                yield f"quad set {name!r} of {len(ids)}: {places} mm, {what} members, has {told}"


def _looks_like_slips(few: Ints, ids: Ints) -> bool:
    return 0 < len(few) <= _FEW and len(ids) >= _MANY


def _centre(mesh: Mesh, quad: int) -> str:
    return point_text(mesh.nodes[mesh.quads[quad]].mean(axis=0))
