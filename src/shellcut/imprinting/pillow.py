"""Insert a layer of quads on both sides of a chain of edges: "pillowing" ([MitchellTautges1995]).

Every node c_k of the chain gets a copy L_k on its left and R_k on its right; the quads on the left
of c_k now use L_k, those on the right R_k; and the gap is filled by the quads

    c_k  c_{k+1}  L_{k+1}  L_k        c_{k+1}  c_k  R_k  R_{k+1}.

So every chain node joins four quads whose edges run along the chain and across it, for any mesh: if
the chain turned through the corner of a quad, that corner is now at L or R, and need not open to
180 degrees. A chain that ends inside the film has no copies of its last node; one quad with corners
at c_0, R_1, c_1, L_1 closes the layer there. At the rim the copies lie on the rim.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from shellcut.arrays import Floats, Ints
from shellcut.mesh.mesh import Mesh

from .chain import Chain
from .film_plane import FilmPlane

OFFSET = 0.4
"""Initial distance of the copies from the path, in edge lengths; smoothing changes it."""


@dataclass(frozen=True, eq=False)
class Pillowed:
    """A mesh with layers of quads inserted; old nodes and quads keep their ids."""

    x: Floats
    """Initial positions in the plane, chains on their paths, shape (n_node, 2); may be tangled."""
    quads: Ints
    """Shape (n_quad, 4)."""
    parent: Ints
    """Chain node of every new node, the node itself for an old one, shape (n_node,)."""
    rim_neighbour: dict[int, int]
    """For each new node on the rim: the old node next to it on the rim."""
    beside: list[tuple[int, ...]]
    """Old quads next to each new quad, in order."""


class _Layers:
    # grows the lists of nodes and quads chain by chain

    def __init__(self, film: FilmPlane) -> None:
        self.film = film
        self.quads = film.mesh.quads.copy()
        self.new_x: list[Floats] = []
        self.parents: list[int] = []
        self.rim_neighbour: dict[int, int] = {}
        self.new_quads: list[tuple[int, int, int, int]] = []
        self.beside: list[tuple[int, ...]] = []

    def add(self, chain: Chain, touched: Ints) -> None:
        nodes = chain.nodes.tolist()
        n = len(nodes)
        fans = _Fans(self.film.mesh.quads, touched)
        left: dict[int, int] = {}
        right: dict[int, int] = {}
        kept = range(n)[chain.on_path]
        at = chain.course.curve.point(chain.u)
        t = chain.course.curve.tangent(chain.u)
        for k in kept:
            c = nodes[k]
            before = nodes[k - 1] if k > 0 or chain.closed else None
            after = nodes[(k + 1) % n] if k < n - 1 or chain.closed else None
            offset = OFFSET * self.film.edge_length[c] * np.array([-t[k, 1], t[k, 0]])
            sides = fans.left(c, before, after), fans.right(c, before, after)
            for copies, (quads, rim), sign in zip((left, right), sides, (1.0, -1.0), strict=True):
                copy = self.film.mesh.n_node + len(self.parents)
                copies[k] = copy
                self.parents.append(c)
                self.new_x.append(at[k] + sign * offset)
                for e in quads:
                    self.quads[e, self.film.mesh.quads[e] == c] = copy
                if rim is not None:
                    self.rim_neighbour[copy] = rim
        for k in range(n if chain.closed else n - 1):
            m = (k + 1) % n
            a, b = nodes[k], nodes[m]
            one, two = fans.side[a, b], fans.side[b, a]  # the quads left and right of the edge
            if k in left and m in left:
                self.new_quads += [(a, b, left[m], left[k]), (b, a, right[k], right[m])]
                self.beside += [(one,), (two,)]
            else:
                end = m if m in left else k
                self.new_quads.append((a, right[end], b, left[end]))
                self.beside.append((one, two))


def pillow(film: FilmPlane, chains: Sequence[Chain]) -> Pillowed:
    """Insert a layer of quads on both sides of each chain and move the chains onto their paths.

    Parameters
    ----------
    film : FilmPlane
    chains : sequence of Chain
        No two of them may touch a common quad.
    """
    mesh = film.mesh
    layers = _Layers(film)
    x = film.x.copy()
    for chain in chains:
        layers.add(chain, np.flatnonzero(np.isin(mesh.quads, chain.nodes).any(axis=1)))
        on = chain.on_path
        x[chain.nodes[on]] = chain.course.curve.point(chain.u[on])
    return Pillowed(
        x=np.concatenate([x, np.reshape(layers.new_x, (-1, 2))]),
        quads=np.concatenate([layers.quads, np.array(layers.new_quads, dtype=np.int64)]),
        parent=np.concatenate([np.arange(mesh.n_node), layers.parents]).astype(np.int64),
        rim_neighbour=layers.rim_neighbour,
        beside=layers.beside,
    )


def pillowed_mesh(film: FilmPlane, layers: Pillowed, x: Floats, moved: Ints) -> Mesh:
    """Return the mesh of pillowed quads at the positions ``x``, with the sets of the old one.

    A new quad is in a quad set if the old quads beside it are. A new node on the rim is in a node
    set if both old nodes of its side of the rim are; one inside the film if all nodes of the quads
    around its chain node are: sets that are areas stay areas, lines are not widened.

    Parameters
    ----------
    film : FilmPlane
    layers : Pillowed
    x : ndarray, shape (n_node, 2)
        Places in the plane [mm].
    moved : ndarray of int
        Old nodes that move to ``x``; the others stay bit for bit.
    """
    mesh = film.mesh
    old, n_new = mesh.n_node, len(x) - mesh.n_node
    nodes = np.concatenate([mesh.nodes, film.lift(x[old:])])
    nodes[moved] = film.lift(x[moved])
    parents = layers.parent[old:]
    node_sets = {}
    for name, members in mesh.node_sets.items():
        within = np.zeros(old, np.bool_)
        within[members] = True
        around = np.ones(old, np.bool_)  # all nodes of the quads around are in the set
        np.logical_and.at(around, mesh.quads.ravel(), np.repeat(within[mesh.quads].all(axis=1), 4))
        joins = around[parents]
        for copy, neighbour in layers.rim_neighbour.items():
            joins[copy - old] = within[parents[copy - old]] and within[neighbour]
        node_sets[name] = np.concatenate([members, old + np.flatnonzero(joins)])
    quad_sets = {}
    for name, members in mesh.quad_sets.items():
        inside = set(members.tolist())
        new = [mesh.n_quad + k for k, e in enumerate(layers.beside) if inside.issuperset(e)]
        quad_sets[name] = np.concatenate([members, np.array(new, dtype=np.int64)])
    return Mesh.from_arrays(
        nodes,
        layers.quads,
        node_sets=node_sets,
        quad_sets=quad_sets,
        directors=np.concatenate([mesh.directors, mesh.directors[parents]]),
        origin=np.concatenate([mesh.origin, old + np.arange(n_new)]),
    )


class _Fans:
    # the quads around the nodes of a chain, by walking from edge to edge

    def __init__(self, quads: Ints, touched: Ints) -> None:
        self.side: dict[tuple[int, int], int] = {}  # quad on the left of a directed edge
        self._third: dict[tuple[int, int], int] = {}  # (node, node after) -> node before, per quad
        self._first: dict[tuple[int, int], int] = {}  # (node, node before) -> node after
        for e in touched.tolist():
            corners = quads[e].tolist()
            for a in range(4):
                node, after, before = corners[a], corners[(a + 1) % 4], corners[a - 1]
                self.side[node, after] = e
                self._third[node, after] = before
                self._first[node, before] = after

    def left(self, c: int, before: int | None, after: int | None) -> tuple[list[int], int | None]:
        """Return the quads from the edge ahead counter-clockwise to the edge behind.

        At the rim there is no edge behind (ahead); the second value is then the rim node at which
        the fan ends (begins), otherwise None.
        """
        if after is not None:
            return self._counter_clockwise(c, after, before)
        assert before is not None
        return self._clockwise(c, before, None)

    def right(self, c: int, before: int | None, after: int | None) -> tuple[list[int], int | None]:
        """Return the quads from the edge ahead clockwise to the edge behind, like ``left``."""
        if after is not None:
            return self._clockwise(c, after, before)
        assert before is not None
        return self._counter_clockwise(c, before, None)

    def _counter_clockwise(
        self, c: int, start: int, stop: int | None
    ) -> tuple[list[int], int | None]:
        quads, spoke = [], start
        while spoke != stop and (c, spoke) in self.side:
            quads.append(self.side[c, spoke])
            spoke = self._third[c, spoke]
        return quads, None if spoke == stop else spoke

    def _clockwise(self, c: int, start: int, stop: int | None) -> tuple[list[int], int | None]:
        quads, spoke = [], start
        while spoke != stop and (spoke, c) in self.side:
            quads.append(self.side[spoke, c])
            spoke = self._first[c, spoke]
        return quads, None if spoke == stop else spoke
