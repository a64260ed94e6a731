"""The mesh: reference nodes, quads, directors and named sets, checked once and then frozen.

:meth:`Mesh.from_arrays` casts and checks all arrays from the user; the rest of the library relies
on it. The conditions are those of five-parameter shell nodes and of cutting: one smooth,
consistently oriented sheet (or several), every node with a single fan of quads.

Corners of a quad are numbered 0 to 3 counter-clockwise about its normal. At corner ``a`` the side
vectors are ``p`` (to corner a+1) and ``q`` (to corner a-1), and ``p × q`` is the corner's area
vector, along the normal.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from shellcut.arguments import checked
from shellcut.arrays import ArrayLike, Floats, Ints, norm
from shellcut.card import FILM, Figures, card, drawing, extent
from shellcut.formats.errors import named
from shellcut.numerics.connected_parts import connected_parts

from .checks import MAX_VALENCE, MeshError, cast_sets, checked_arrays, error, look_up, place
from .quad_geometry import QuadSides, corner_vectors, edge_lengths, scaled_jacobian

__all__ = ["MAX_VALENCE", "Edges", "Mesh", "MeshError"]

# Width of a lane of nodes in :meth:`Mesh.ordered`, in side lengths.
_LANE = 4.0


class Edges(NamedTuple):
    """The sides of the quads of a mesh, each once."""

    nodes: Ints
    """Ends, shape (n_edge, 2), lower id first, rows in lexicographic order."""
    quads: Ints
    """Quads beside it, shape (n_edge, 2); a single quad is repeated."""
    n_quad: Ints
    """Number of quads beside it, shape (n_edge,): 1 on the border, 2 inside."""


@dataclass(frozen=True, eq=False)
class Mesh:
    """Reference mid-surface of a shell as four-node quads.

    Build it with :meth:`from_arrays`, which checks; the plain constructor does not check its arrays
    and makes them read-only.

    Examples
    --------
    >>> mesh = Mesh.from_arrays(
    ...     [[0, 0], [1, 0], [2, 0], [0, 1], [1, 1], [2, 1]],
    ...     [[0, 1, 4, 3], [1, 2, 5, 4]],
    ...     node_sets={"left": [0, 3]},
    ... )
    >>> mesh.n_node, mesh.n_quad, mesh.directors[0].tolist()
    (6, 2, [0.0, 0.0, 1.0])
    >>> mesh.cut([1, 4]).n_node
    8
    """

    nodes: Floats
    """Reference positions X [mm], shape (n_node, 3)."""
    quads: Ints
    """Corner node ids, counter-clockwise about the normal, shape (n_quad, 4)."""
    directors: Floats
    """Unit reference directors T, on the side of the normals, shape (n_node, 3)."""
    node_sets: Mapping[str, Ints]
    """Named node ids; each array in the order given."""
    quad_sets: Mapping[str, Ints]
    """Named quad ids; each array in the order given."""
    origin: Ints
    """Node of the uncut mesh that a node was duplicated from, or itself; shape (n_node,)."""

    def __post_init__(self) -> None:
        for name in ("node_sets", "quad_sets"):
            object.__setattr__(self, name, MappingProxyType(dict(getattr(self, name))))
        for array in (
            *(self.nodes, self.quads, self.directors, self.origin),
            *self.node_sets.values(),
            *self.quad_sets.values(),
        ):
            array.flags.writeable = False

    def __reduce__(self) -> tuple[Any, ...]:
        # a mapping proxy cannot be pickled: pickle plain dicts; the constructor makes proxies again
        node_sets, quad_sets = dict(self.node_sets), dict(self.quad_sets)
        return Mesh, (self.nodes, self.quads, self.directors, node_sets, quad_sets, self.origin)

    def __repr__(self) -> str:
        return (
            f"Mesh({self.n_node} nodes, {self.n_quad} quads, node_sets={sorted(self.node_sets)}, "
            f"quad_sets={sorted(self.quad_sets)})"
        )

    def _repr_html_(self) -> str:
        lengths = edge_lengths(self.nodes, self.quads)
        figures: Figures = [
            ("nodes", self.n_node, ""),
            ("quads", self.n_quad, ""),
            ("sides, least and median", f"{lengths.min():.4g}, {np.median(lengths):.4g}", "mm"),
            extent(self.nodes),
            ("sets", ", ".join([*self.node_sets, *self.quad_sets]) or "none", ""),
        ]
        ends = self._edges.nodes[self._edges.n_quad == 1]
        _, first, count = np.unique(
            np.sort(self.origin[ends], axis=1), axis=0, return_index=True, return_counts=True
        )
        notch = self.nodes[ends[first[count == 2]]]
        picture = drawing([(self.nodes, self.quads, FILM)], notch, "#000000")
        return card("Mesh", figures, picture=picture)

    @classmethod
    @checked
    def from_arrays(
        cls,
        nodes: ArrayLike,
        quads: ArrayLike,
        *,
        node_sets: Mapping[str, ArrayLike] | None = None,
        quad_sets: Mapping[str, ArrayLike] | None = None,
        directors: ArrayLike | None = None,
        origin: ArrayLike | None = None,
        max_fold_deg: float = 60.0,
    ) -> Mesh:
        """Cast, check and freeze a mesh.

        Parameters
        ----------
        nodes : array_like, shape (n_node, 3) or (n_node, 2), [mm]
            Reference mid-surface; two columns mean z = 0.
        quads : array_like of int, shape (n_quad, 4)
            Corner node ids, in the same sense of rotation for all quads seen from one side.
        node_sets, quad_sets : mapping of str to array_like of int, optional
            Named ids, each id at most once in a set.
        directors : array_like, shape (n_node, 3), optional
            Unit directors on the side of the normals; scaled to exact unit length. By default the
            area-weighted mean of the corner normals at each node. Each must lie within 10° of the
            default, 45° at the border, and the mean of a quad's four within 5° of its normal, more
            only where quads make folds: thickness is measured along the director.
        origin : array_like of int, shape (n_node,), optional
            For a mesh that was cut before: the node from which each node was duplicated.
        max_fold_deg : float
            Largest angle [degrees] between the normals of two neighbouring quads. Angles above the
            default, on a very coarse mesh of a curved film, reduce accuracy; these shells cannot
            model a real fold, whatever the limit.

        Returns
        -------
        Mesh

        Raises
        ------
        MeshError
            Lists all problems, one per line.
        """
        return cls(
            *checked_arrays(nodes, quads, node_sets, quad_sets, directors, origin, max_fold_deg)
        )

    @property
    def n_node(self) -> int:
        """Number of nodes."""
        return len(self.nodes)

    @property
    def n_quad(self) -> int:
        """Number of quads."""
        return len(self.quads)

    @cached_property
    def _edges(self) -> Edges:
        sides = QuadSides(self.quads, self.n_node, np.arange(self.n_quad))
        ends = sides.start, sides.start + sides.n_quad - 1
        table = Edges(sides.nodes, np.stack([sides.quads[k] for k in ends], axis=1), sides.n_quad)
        for array in table:
            array.flags.writeable = False
        return table

    def edges(self) -> Edges:
        """Return the sides of the quads, each once, with the quads beside it; built on first use.

        Returns
        -------
        Edges
            ``nodes`` (n_edge, 2), ``quads`` (n_edge, 2) and ``n_quad`` (n_edge,), read-only.
        """
        return self._edges

    def boundary_nodes(self) -> Ints:
        """Return the ids of the nodes on sides with one quad, ascending; notches included."""
        return np.unique(self._edges.nodes[self._edges.n_quad == 1])

    def quad_areas(self) -> Floats:
        """Return the area of every quad, shape (n_quad,), [mm²].

        Area of the bilinear surface by 2x2 Gauss points: exact for a plane quad. The area vector
        is linear over the quad, because the mixed term cancels in the cross product.
        """
        corners = [corner_vectors(self.nodes, self.quads, a) for a in range(4)]
        vectors = [np.cross(p, q) for p, q in corners]
        areas = np.zeros(self.n_quad)
        near, far = 0.5 * (1.0 + 1.0 / np.sqrt(3.0)), 0.5 * (1.0 - 1.0 / np.sqrt(3.0))
        for a in range(4):
            weights = near * near, near * far, far * far, near * far
            terms = (w * vectors[(a + b) % 4] for b, w in enumerate(weights))
            areas += 0.25 * norm(sum(terms, start=np.zeros(3)))
        return areas

    def scaled_jacobian(self) -> Floats:
        """Return the smallest scaled Jacobian over the corners of every quad, shape (n_quad,).

        (p × q)·n of the unit vectors p, q along the sides with the mean normal n: the sine of the
        corner angle, 1 for a rectangle, 0 or less where a corner is straight or re-entrant.
        """
        return scaled_jacobian(self.nodes, self.quads)

    def edge_lengths(self) -> Floats:
        """Return the side lengths of every quad, shape (n_quad, 4), [mm], from corner a to a+1."""
        return edge_lengths(self.nodes, self.quads)

    def node_set(self, name: str) -> Ints:
        """Return the node ids of a named set; upper or lower case, if that leaves one set.

        Raises
        ------
        MeshError
            With the names that exist.
        """
        return look_up("node", self.node_sets, name)

    def quad_set(self, name: str) -> Ints:
        """Return the quad ids of a named set, as :meth:`node_set`."""
        return look_up("quad", self.quad_sets, name)

    def nodes_where(self, predicate: Callable[[Floats, Floats, Floats], ArrayLike]) -> Ints:
        """Return the ids of the nodes whose position meets a condition, ascending.

        Parameters
        ----------
        predicate : callable
            Called once as ``predicate(x, y, z)`` with arrays of shape (n_node,), [mm]; returns an
            array of bool.

        Examples
        --------
        >>> mesh = Mesh.from_arrays([[0, 0], [1, 0], [1, 1], [0, 1]], [[0, 1, 2, 3]])
        >>> mesh.nodes_where(lambda x, y, z: x > 0.5).tolist()
        [1, 2]
        """
        mask = np.asarray(predicate(*self.nodes.T))
        if mask.shape != (self.n_node,) or mask.dtype != np.bool_:
            raise MeshError(
                f"predicate must return {self.n_node} bools, one per node, got shape {mask.shape} "
                f"of {mask.dtype}; compare the arrays x, y, z it is given, joined by & and |"
            )
        return np.flatnonzero(mask).astype(np.int64)

    @checked
    def with_sets(
        self,
        *,
        node_sets: Mapping[str, ArrayLike] | None = None,
        quad_sets: Mapping[str, ArrayLike] | None = None,
    ) -> Mesh:
        """Return the mesh with further named sets; existing names are refused."""
        problems: list[str] = []
        nodes = cast_sets("node", node_sets, self.n_node, problems)
        quads = cast_sets("quad", quad_sets, self.n_quad, problems)
        for kind, new, old in (("node", nodes, self.node_sets), ("quad", quads, self.quad_sets)):
            problems += [
                f"{kind} set names must be new, got {name!r} again; choose another name"
                for name in new
                if name in old
            ]
        if problems:
            raise error(problems)
        return replace(
            self, node_sets={**self.node_sets, **nodes}, quad_sets={**self.quad_sets, **quads}
        )

    def ordered(self) -> Mesh:
        """Return the mesh with its nodes renumbered so that neighbours are close to each other.

        Quads are processed in their own order (:mod:`shellcut.mitc4.blocks`), but their nodes lie
        in memory in the order of their ids: this saves time in a film of 1e5 quads or more with
        scattered ids, as some meshers leave them. Node sets are renumbered; quads and their sets
        stay; earlier node ids become invalid.
        """
        axes = np.argsort(-np.ptp(self.nodes, axis=0), kind="stable")
        along, across = self.nodes[:, axes[0]], self.nodes[:, axes[1]]
        # Up and down lanes a few quads wide, in the order of the quads.
        breadth = _LANE * float(np.sqrt(np.median(self.quad_areas())))
        order = np.lexsort((across, np.floor((along - along.min()) / breadth)))
        new = np.empty(self.n_node, np.int64)
        new[order] = np.arange(self.n_node)
        return replace(
            self,
            nodes=self.nodes[order],
            directors=self.directors[order],
            quads=new[self.quads],
            node_sets={name: new[ids] for name, ids in self.node_sets.items()},
            origin=new[self.origin[order]],
        )

    @checked
    def cut(self, line_of_nodes: Sequence[int] | Ints) -> Mesh:
        """Return the mesh with a pre-cut (notch) along a line of quad sides.

        The nodes of the line are duplicated wherever its sides separate their quads: nodes within
        the line, and an end on the border or on an earlier cut (the notch is open there). An end
        inside the mesh stays a single node, the crack tip. A closed line (the last node is the
        first again) cuts a patch out. Quads on the left of the line, seen from the side of the
        normals, keep their nodes; duplicates are appended. Each duplicate copies position,
        director, set membership and ``origin`` of its node.

        Parameters
        ----------
        line_of_nodes : sequence of int
            Node ids in order, neighbours joined by a side with quads to the left and right.

        Returns
        -------
        Mesh

        Raises
        ------
        MeshError
            If the line does not follow sides of quads, runs along a border, or would open nothing.
        """
        line = self._line(line_of_nodes)
        cut_edges = {frozenset(pair) for pair in pairwise(line)}
        touched = np.flatnonzero(np.isin(self.quads, line).any(axis=1))
        sides = [(e, self.quads[e].tolist()) for e in touched.tolist()]
        side_of = {(q[a], q[(a + 1) % 4]): e for e, q in sides for a in range(4)}
        self._check_sides(line, side_of)
        # for each node of the line, a quad on the left: its sides contain the leaving one (at the
        # end, the arriving one) in the direction of the line
        left = {line[-1]: side_of[line[-2], line[-1]]} | {
            i: side_of[i, j] for i, j in pairwise(line)
        }

        quads = self.quads.copy()
        parents: list[int] = []
        for node in dict.fromkeys(line):
            around = [e for e in touched.tolist() if node in self.quads[e]]
            for fan in _fans(self.quads, node, around, cut_edges, first=left[node]):
                for e in fan:
                    quads[e, self.quads[e] == node] = self.n_node + len(parents)
                parents.append(node)
        if not parents:
            raise MeshError(
                f"a line of one side between two inner nodes opens nothing, got nodes {line}; add "
                "a side, or start on the border"
            )
        copies = np.array(parents, dtype=np.int64)
        ids = self.n_node + np.arange(len(copies))
        node_sets = {
            name: np.concatenate([members, ids[np.isin(copies, members)]])
            for name, members in self.node_sets.items()
        }
        return Mesh(
            np.concatenate([self.nodes, self.nodes[copies]]),
            quads,
            np.concatenate([self.directors, self.directors[copies]]),
            node_sets,
            self.quad_sets,
            np.concatenate([self.origin, self.origin[copies]]),
        )

    def _line(self, line_of_nodes: Sequence[int] | Ints) -> list[int]:
        ids = np.asarray(line_of_nodes)
        if ids.ndim != 1 or len(ids) < 2 or ids.dtype.kind not in "iu":
            raise MeshError(
                f"line_of_nodes must be two node ids or more in order, got {line_of_nodes!r}"
            )
        line: list[int] = ids.tolist()
        if outside := [n for n in line if not 0 <= n < self.n_node]:
            raise MeshError(
                f"line_of_nodes must lie within 0 to {self.n_node - 1}, got {named(outside)}"
            )
        return line

    def _check_sides(self, line: list[int], side_of: Mapping[tuple[int, int], int]) -> None:
        problems: list[str] = []
        within = line[:-1] if line[0] == line[-1] and len(line) > 3 else line
        if len(set(within)) < len(within):
            twice = sorted({n for n in within if within.count(n) > 1})
            problems.append(
                f"line_of_nodes must pass each node once, got {named(twice)} again; cut in parts"
            )
        for i, j in pairwise(line):
            count = ((i, j) in side_of) + ((j, i) in side_of)
            if count == 0:
                copies = {n: np.flatnonzero(self.origin == self.origin[n]).tolist() for n in (i, j)}
                hint = "".join(
                    f"; node {n} was duplicated by a cut, its copies are {ids}"
                    for n, ids in copies.items()
                    if len(ids) > 1
                )
                problems.append(
                    f"line_of_nodes must follow sides of quads, got {place(i, self.nodes)} to "
                    f"{place(j, self.nodes)} that no side joins; name every node between{hint}"
                )
            elif count == 1:
                problems.append(
                    "line_of_nodes must have quads to its left and right, got "
                    f"{place(i, self.nodes)} to {place(j, self.nodes)} on the border or on a cut; "
                    "leave it out"
                )
        if problems:
            raise error(problems)


# --- the cut -------------------------------------------------------------------------------------


def _fans(
    quads: Ints, node: int, around: list[int], cut_edges: set[frozenset[int]], *, first: int
) -> Iterator[list[int]]:
    # groups into which the cut sides split the quads around a node, without the group of `first`
    spokes: dict[int, list[int]] = {}  # places in `around` by the other end of a side
    for k, e in enumerate(around):
        a = int(np.flatnonzero(quads[e] == node)[0])
        for other in (int(quads[e, (a + 1) % 4]), int(quads[e, (a + 3) % 4])):
            if frozenset((node, other)) not in cut_edges:
                spokes.setdefault(other, []).append(k)
    links = [sharing for sharing in spokes.values() if len(sharing) == 2]
    one, two = np.array(links, np.int64).reshape(-1, 2).T
    part = connected_parts(one, two, len(around)).tolist()
    for group in dict.fromkeys(part):
        if group != part[around.index(first)]:
            yield [e for e, its in zip(around, part, strict=True) if its == group]
