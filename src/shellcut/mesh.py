"""The mesh: reference nodes, quads, directors and named sets, checked once and then frozen.

All casting and all checks of what the user hands in happen in :meth:`Mesh.from_arrays`; the rest
of the library relies on them. What must hold is what five-parameter shell nodes and cutting need:
one smooth, consistently oriented sheet (or several), every node with a single fan of quads.

Corners of a quad are numbered 0 to 3 counter-clockwise about its normal. At corner ``a`` the edge
vectors are ``p`` (to corner a+1) and ``q`` (to corner a-1), and ``p × q`` is the corner's area
vector, along the normal.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from difflib import get_close_matches
from functools import cached_property
from itertools import pairwise
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from ._jit import Bools, Floats, Ints

MAX_VALENCE = 12
"""Most quads one node may join: the split kernels keep a node's fan in an array of this length."""

_NAMED = 5  # offenders named in a message; a thousand bad quads need no thousand lines
_MIN_RELATIVE_AREA = 1e-12  # quad area over its longest edge squared; below it round-off decides
_MIN_RELATIVE_EDGE = 1e-9  # shortest over longest edge of a quad; below it two corners coincide
_DIRECTOR_LENGTH = 1e-6  # | |T| - 1 | let through, then scaled to one: text files carry 7 digits
_FLAT = 1e-12  # directors this near to their mean are the mean: round-off of a plane mesh


class MeshError(ValueError):
    """A mesh, or a question to one, that cannot be right; the message lists every problem."""


class Edges(NamedTuple):
    """The edges of a mesh, each once."""

    nodes: Ints
    """Ends, shape (n_edge, 2), lower id first, rows in lexicographic order."""
    quads: Ints
    """Quads on the edge, shape (n_edge, 2); where there is one only, it stands twice."""
    n_quad: Ints
    """Number of quads on the edge, shape (n_edge,): 1 on the boundary, 2 inside."""


@dataclass(frozen=True, eq=False)
class Mesh:
    """Reference mid-surface of a shell as four-node quads.

    Build it by :meth:`from_arrays`, which checks; the plain constructor takes arrays on trust and
    makes them read-only.

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
    """Node of the uncut mesh that a node was duplicated from, itself otherwise; (n_node,)."""

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
        # a mapping proxy cannot be pickled: workers of a sweep get plain dicts, then proxies again
        sets = dict(self.node_sets), dict(self.quad_sets)
        return Mesh, (self.nodes, self.quads, self.directors, *sets, self.origin)

    def __repr__(self) -> str:
        return (
            f"Mesh({self.n_node} nodes, {self.n_quad} quads, node_sets={sorted(self.node_sets)}, "
            f"quad_sets={sorted(self.quad_sets)})"
        )

    @classmethod
    def from_arrays(
        cls,
        nodes: npt.ArrayLike,
        quads: npt.ArrayLike,
        *,
        node_sets: Mapping[str, npt.ArrayLike] | None = None,
        quad_sets: Mapping[str, npt.ArrayLike] | None = None,
        directors: npt.ArrayLike | None = None,
        origin: npt.ArrayLike | None = None,
        max_fold_deg: float = 60.0,
    ) -> Mesh:
        """Cast, check and freeze a mesh.

        Parameters
        ----------
        nodes : array_like, shape (n_node, 3) or (n_node, 2), [mm]
            Reference mid-surface; two columns mean z = 0.
        quads : array_like of int, shape (n_quad, 4)
            Corner node ids, all quads turning the same way seen from one side.
        node_sets, quad_sets : mapping of str to array_like of int, optional
            Named ids, no id twice in a set.
        directors : array_like, shape (n_node, 3), optional
            Unit directors on the side of the normals; scaled to exact unit length. By default the
            area-weighted mean of the corner normals at each node.
        origin : array_like of int, shape (n_node,), optional
            For a mesh that was cut before: the node each node was duplicated from.
        max_fold_deg : float
            Largest angle [degrees] between the normals of two neighbouring quads.

        Returns
        -------
        Mesh

        Raises
        ------
        MeshError
            With all problems found, one a line.
        """
        problems: list[str] = []
        X = _cast_nodes(nodes, problems)
        Q = _cast_quads(quads, problems)
        if X is None or Q is None:
            raise _error(problems)
        n_node, n_quad = len(X), len(Q)
        named_nodes = _cast_sets("node", node_sets, n_node, problems)
        named_quads = _cast_sets("quad", quad_sets, n_quad, problems)
        ancestors = _cast_origin(origin, n_node, problems)
        given = _cast_directors(directors, n_node, problems)

        finite = _check_finite(X, problems)
        if _check_ids(Q, n_node, problems):
            sound = _check_corners(X, Q, problems)
            edges = _QuadSides(Q, n_node, np.flatnonzero(sound))
            _check_edges(X, Q, edges, problems)
            if finite:
                sound &= _check_shapes(X, Q, sound, problems)
                _check_folds(X, Q, edges, sound, max_fold_deg, problems)
                if given is not None:
                    _check_directors(X, Q, given, sound, problems)
        if given is None and not problems:
            given = _mean_directors(X, Q)
            _check_directors(X, Q, given, sound, problems)
        if given is None or problems:
            raise _error(problems)
        T = _unit(given)
        return cls(X, Q, T, named_nodes, named_quads, ancestors)

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
        edges = _QuadSides(self.quads, self.n_node, np.arange(self.n_quad))
        ends = edges.start, edges.start + edges.n_quad - 1
        table = Edges(edges.nodes, np.stack([edges.quads[k] for k in ends], axis=1), edges.n_quad)
        for array in table:
            array.flags.writeable = False
        return table

    def edges(self) -> Edges:
        """Return the edges, each once, with the quads on them; built on first use.

        Returns
        -------
        Edges
            ``nodes`` (n_edge, 2), ``quads`` (n_edge, 2) and ``n_quad`` (n_edge,), read-only.
        """
        return self._edges

    def boundary_nodes(self) -> Ints:
        """Return the ids of the nodes on edges with one quad, ascending; notches included."""
        return np.unique(self._edges.nodes[self._edges.n_quad == 1])

    def quad_areas(self) -> Floats:
        """Return the area of every quad, shape (n_quad,), [mm²].

        The area of the bilinear surface by 2x2 Gauss points: exact for a plane quad. The area
        vector is linear over the quad, as the mixed term drops out of the cross product.
        """
        corners = [_corner_vectors(self.nodes, self.quads, a) for a in range(4)]
        vectors = [np.cross(p, q) for p, q in corners]
        areas = np.zeros(self.n_quad)
        near, far = 0.5 * (1.0 + 1.0 / np.sqrt(3.0)), 0.5 * (1.0 - 1.0 / np.sqrt(3.0))
        for a in range(4):
            weights = near * near, near * far, far * far, near * far
            terms = (w * vectors[(a + b) % 4] for b, w in enumerate(weights))
            areas += 0.25 * _norm(sum(terms, start=np.zeros(3)))
        return areas

    def scaled_jacobian(self) -> Floats:
        """Return the least scaled Jacobian over the corners of every quad, shape (n_quad,).

        (p × q)·n / (|p| |q|) with the mean normal n: the sine of the corner angle, 1 for a
        rectangle, 0 or less where a corner is straight or re-entrant.
        """
        return _scaled_jacobian(self.nodes, self.quads)

    def edge_lengths(self) -> Floats:
        """Return the edge lengths of every quad, shape (n_quad, 4), [mm], from corner a to a+1."""
        return _edge_lengths(self.nodes, self.quads)

    def node_set(self, name: str) -> Ints:
        """Return the node ids of a named set; a wrong name is answered with the names there are."""
        return _look_up("node", self.node_sets, name)

    def quad_set(self, name: str) -> Ints:
        """Return the quad ids of a named set; a wrong name is answered with the names there are."""
        return _look_up("quad", self.quad_sets, name)

    def nodes_where(self, predicate: Callable[[Floats, Floats, Floats], npt.ArrayLike]) -> Ints:
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
                f"predicate must return {self.n_node} bools, one a node, got shape {mask.shape} "
                f"of {mask.dtype}; compare the arrays x, y, z it is given, joined by & and |"
            )
        return np.flatnonzero(mask).astype(np.int64)

    def with_sets(
        self,
        *,
        node_sets: Mapping[str, npt.ArrayLike] | None = None,
        quad_sets: Mapping[str, npt.ArrayLike] | None = None,
    ) -> Mesh:
        """Return the mesh with further named sets; a name already taken is refused."""
        problems: list[str] = []
        nodes = _cast_sets("node", node_sets, self.n_node, problems)
        quads = _cast_sets("quad", quad_sets, self.n_quad, problems)
        for kind, new, old in (("node", nodes, self.node_sets), ("quad", quads, self.quad_sets)):
            problems += [
                f"{kind} set names must be new, got {name!r} again; choose another name"
                for name in new
                if name in old
            ]
        if problems:
            raise _error(problems)
        return replace(
            self, node_sets={**self.node_sets, **nodes}, quad_sets={**self.quad_sets, **quads}
        )

    def cut(self, line_of_nodes: Sequence[int] | npt.NDArray[np.integer[Any]]) -> Mesh:
        """Return the mesh with a pre-cut (notch) along a line of mesh edges.

        The nodes of the line are duplicated wherever its edges part their quads: nodes within the
        line, and an end that lies on the boundary or on an earlier cut (the notch is open there).
        An end inside the mesh stays a single node, the crack tip. A closed line (last node the
        first again) cuts a patch out. Quads on the left of the line, seen from the side the normals
        point to, keep their nodes; duplicates are appended. Each takes over position, director,
        set membership and ``origin`` of its node.

        Parameters
        ----------
        line_of_nodes : sequence of int
            Node ids in order, neighbours joined by an edge that has quads on both sides.

        Returns
        -------
        Mesh

        Raises
        ------
        MeshError
            If the line does not follow the edges, runs along a boundary, or would open nothing.
        """
        line = self._check_line(line_of_nodes)
        cut_edges = {frozenset(pair) for pair in pairwise(line)}
        touched = np.flatnonzero(np.isin(self.quads, line).any(axis=1))
        left = _left_quads(self.quads, touched, line)

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
                f"a line of one edge between two inner nodes opens nothing, got nodes {line}; "
                "add an edge, or start on the boundary"
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

    def _check_line(self, line_of_nodes: Sequence[int] | npt.NDArray[np.integer[Any]]) -> list[int]:
        ids = np.asarray(line_of_nodes)
        if ids.ndim != 1 or len(ids) < 2 or ids.dtype.kind not in "iu":
            raise MeshError(
                f"line_of_nodes must be two node ids or more in order, got {line_of_nodes!r}"
            )
        line: list[int] = ids.tolist()
        problems: list[str] = []
        if outside := [n for n in line if not 0 <= n < self.n_node]:
            raise MeshError(
                f"line_of_nodes must lie within 0 to {self.n_node - 1}, got {_some(outside)}"
            )
        within = line[:-1] if line[0] == line[-1] and len(line) > 3 else line
        if len(set(within)) < len(within):
            twice = sorted({n for n in within if within.count(n) > 1})
            problems.append(
                f"line_of_nodes must pass each node once, got {_some(twice)} again; cut in parts"
            )
        for i, j in pairwise(line):
            count = self._edge_count(i, j)
            if count == 0:
                twins = {n: np.flatnonzero(self.origin == self.origin[n]).tolist() for n in (i, j)}
                hint = "".join(
                    f"; node {n} was duplicated by a cut, its copies are {ids}"
                    for n, ids in twins.items()
                    if len(ids) > 1
                )
                problems.append(
                    f"line_of_nodes must follow mesh edges, got {_place(i, self.nodes)} to "
                    f"{_place(j, self.nodes)} that no edge joins; name every node between{hint}"
                )
            elif count == 1:
                problems.append(
                    f"edges to cut must have quads on both sides, got {_place(i, self.nodes)} to "
                    f"{_place(j, self.nodes)} on the boundary or cut before; leave it out"
                )
        if problems:
            raise _error(problems)
        return line

    def _edge_count(self, i: int, j: int) -> int:
        # rows are in lexicographic order: find the row (low, high), 0 if there is none
        low, high = min(i, j), max(i, j)
        start, stop = np.searchsorted(self._edges.nodes[:, 0], [low, low + 1])
        row = np.flatnonzero(self._edges.nodes[start:stop, 1] == high)
        return int(self._edges.n_quad[start + row[0]]) if len(row) else 0


class _QuadSides:
    # The sides of some quads grouped by edge. The sides on edge k, whose ends are nodes[k], belong
    # to quads[start[k] : start[k] + n_quad[k]].

    def __init__(self, quads: Ints, n_node: int, ids: Ints) -> None:
        tail = quads[ids]
        head = np.roll(tail, -1, axis=1)
        keys = (np.minimum(tail, head) * n_node + np.maximum(tail, head)).ravel()
        order = np.argsort(keys, kind="stable")
        keys = keys[order]
        self.quads = ids[order // 4]
        self.start = np.flatnonzero(np.concatenate([[True], keys[1:] != keys[:-1]]))[: len(keys)]
        self.n_quad = np.diff(np.append(self.start, len(keys))).astype(np.int64)
        keys = keys[self.start]
        self.nodes = np.stack([keys // n_node, keys % n_node], axis=1)
        self._forward = (tail < head).ravel()[order]  # the side runs from lower to higher id

    def neighbours(self) -> tuple[Ints, Ints, Bools]:
        # the two quads of every inner edge, and whether they turn the same way
        start = self.start[self.n_quad == 2]
        turning_alike = self._forward[start] != self._forward[start + 1]
        return self.quads[start], self.quads[start + 1], turning_alike


# --- the cut -------------------------------------------------------------------------------------


def _left_quads(quads: Ints, touched: Ints, line: list[int]) -> dict[int, int]:
    # for every node of the line a quad that has the leaving (at the end: arriving) edge on its rim
    # in the line's own sense, that is, a quad on the left
    side_of = {
        (int(quads[e, a]), int(quads[e, (a + 1) % 4])): e
        for e in touched.tolist()
        for a in range(4)
    }
    left: dict[int, int] = {}
    for i, j in pairwise(line):
        left[i] = side_of[i, j]
        left.setdefault(j, side_of[i, j])
    return left


def _fans(
    quads: Ints, node: int, around: list[int], cut_edges: set[frozenset[int]], *, first: int
) -> Iterator[list[int]]:
    # the groups into which the cut edges part the quads around a node, without the group of `first`
    spokes: dict[int, list[int]] = {}
    for e in around:
        a = int(np.flatnonzero(quads[e] == node)[0])
        for other in (int(quads[e, (a + 1) % 4]), int(quads[e, (a + 3) % 4])):
            if frozenset((node, other)) not in cut_edges:
                spokes.setdefault(other, []).append(e)
    left = dict.fromkeys([first, *around])
    while left:
        fan = [next(iter(left))]
        left.pop(fan[0])
        for e in fan:  # grows while it is read
            for sharing in spokes.values():
                if e in sharing:
                    fan += [f for f in sharing if f in left]
                    for f in sharing:
                        left.pop(f, None)
        if first not in fan:
            yield fan


# --- geometry ------------------------------------------------------------------------------------


def _norm(vectors: Floats) -> Floats:
    length: Floats = np.sqrt(np.einsum("ij,ij->i", vectors, vectors))
    return length


def _corner_vectors(X: Floats, quads: Ints, a: int) -> tuple[Floats, Floats]:
    at = X[quads[:, a]]
    return X[quads[:, (a + 1) % 4]] - at, X[quads[:, (a + 3) % 4]] - at


def _quad_vectors(X: Floats, quads: Ints) -> Floats:
    # vector areas [mm²], half the cross product of the diagonals, along the mean normals
    diagonals = X[quads[:, 2]] - X[quads[:, 0]], X[quads[:, 3]] - X[quads[:, 1]]
    vectors: Floats = 0.5 * np.cross(*diagonals)
    return vectors


def _edge_lengths(X: Floats, quads: Ints) -> Floats:
    sides = (X[quads[:, (a + 1) % 4]] - X[quads[:, a]] for a in range(4))
    return np.stack([_norm(side) for side in sides], axis=1)


def _unit(vectors: Floats) -> Floats:
    # rows of length zero stay zero; they are reported as degenerate
    length = _norm(vectors)[:, None]
    unit: Floats = np.divide(vectors, length, out=np.zeros_like(vectors), where=length > 0.0)
    return unit


def _scaled_jacobian(X: Floats, quads: Ints) -> Floats:
    normals = _unit(_quad_vectors(X, quads))
    least = np.ones(len(quads))
    for a in range(4):
        p, q = _corner_vectors(X, quads, a)
        jacobian = np.einsum("ij,ij->i", np.cross(p, q), normals)
        lengths = _norm(p) * _norm(q)
        scaled = np.divide(jacobian, lengths, out=np.zeros(len(quads)), where=lengths > 0.0)
        np.minimum(least, scaled, out=least)
    return least


def _mean_directors(X: Floats, quads: Ints) -> Floats:
    # |p × q| is twice the area of the corner's triangle: the plain sum is area-weighted
    sums = np.zeros_like(X)
    for a in range(4):
        vectors = np.cross(*_corner_vectors(X, quads, a))
        for i in range(3):
            sums[:, i] += np.bincount(quads[:, a], weights=vectors[:, i], minlength=len(X))
    T = _unit(sums)
    mean = _unit(T.mean(axis=0, keepdims=True))
    if np.abs(T - mean).max() < _FLAT:
        T[:] = _unit(np.where(np.abs(mean) < _FLAT, 0.0, mean))
    T += 0.0  # no negative zeros
    return T


# --- casting and checks: each adds its problems to the list --------------------------------------


def _error(problems: list[str]) -> MeshError:
    if len(problems) == 1:
        return MeshError(problems[0])
    return MeshError(f"{len(problems)} problems:\n- " + "\n- ".join(problems))


def _some(items: Iterable[Any], describe: Callable[[Any], str] = str) -> str:
    listed = list(items)
    more = f" and {len(listed) - _NAMED} more" if len(listed) > _NAMED else ""
    return ", ".join(describe(item) for item in listed[:_NAMED]) + more


def _point(x: Floats) -> str:
    return "(" + ", ".join(f"{c:.6g}" for c in x) + ")"


def _place(node: int, X: Floats) -> str:
    return f"node {node} at {_point(X[node])}"


def _places(nodes: Ints, X: Floats) -> str:
    return _some(nodes, lambda n: _place(n, X))


def _quad_places(quads: Ints, X: Floats, Q: Ints) -> str:
    return _some(quads, lambda e: f"quad {e} at {_point(X[Q[e]].mean(axis=0))}")


def _quad_pairs(one: Ints, two: Ints, X: Floats, Q: Ints) -> str:
    pairs = np.sort(np.stack([one, two], axis=1), axis=1)
    return _some(pairs, lambda p: " and ".join(_quad_places(p[i : i + 1], X, Q) for i in (0, 1)))


def _cast_nodes(nodes: npt.ArrayLike, problems: list[str]) -> Floats | None:
    try:
        X = np.array(nodes, dtype=np.float64, order="C")
    except (TypeError, ValueError):
        problems.append("nodes must be an array of numbers of shape (n_node, 3) or (n_node, 2)")
        return None
    if X.ndim != 2 or X.shape[1] not in (2, 3) or len(X) == 0:
        problems.append(
            f"nodes must have shape (n_node, 3) or (n_node, 2), got {X.shape}; one row a node"
        )
        return None
    if X.shape[1] == 2:
        X = np.concatenate([X, np.zeros((len(X), 1))], axis=1)
    return X


def _cast_quads(quads: npt.ArrayLike, problems: list[str]) -> Ints | None:
    try:
        Q = np.array(quads, order="C")
    except ValueError:
        Q = np.empty(0)  # rows of different lengths
    if Q.ndim != 2 or Q.shape[1] != 4 or len(Q) == 0:
        problems.append(
            f"quads must have shape (n_quad, 4), got {Q.shape}; one row of four node ids a quad, "
            "triangles are not supported"
        )
        return None
    if Q.dtype.kind not in "iu":
        problems.append(f"quads must be whole numbers, got {Q.dtype}; cast the node ids to int")
        return None
    return Q.astype(np.int64)


def _cast_ids(
    what: str, ids: npt.ArrayLike, n: int, problems: list[str], *, unique: bool = True
) -> Ints:
    members = np.array(ids)
    none = np.empty(0, dtype=np.int64)
    if members.size == 0:
        return none
    if members.ndim != 1 or members.dtype.kind not in "iu":
        problems.append(
            f"{what} must be one row of whole numbers, got shape {members.shape} of "
            f"{members.dtype}; give ids, not a mask or coordinates"
        )
        return none
    outside = members[(members < 0) | (members >= n)]
    if len(outside):
        problems.append(f"{what} must hold ids from 0 to {n - 1}, got {_some(outside.tolist())}")
        return none
    values, counts = np.unique(members, return_counts=True)
    if unique and (counts > 1).any():
        problems.append(
            f"{what} must hold each id once, got {_some(values[counts > 1].tolist())} again; "
            "pass it through numpy.unique"
        )
    return members.astype(np.int64)


def _cast_sets(
    kind: str, sets: Mapping[str, npt.ArrayLike] | None, n: int, problems: list[str]
) -> dict[str, Ints]:
    return {
        name: _cast_ids(f"{kind} set {name!r}", ids, n, problems)
        for name, ids in (sets or {}).items()
    }


def _cast_origin(origin: npt.ArrayLike | None, n_node: int, problems: list[str]) -> Ints:
    if origin is None:
        return np.arange(n_node, dtype=np.int64)
    ancestors = _cast_ids("origin", origin, n_node, problems, unique=False)
    if ancestors.shape != (n_node,):
        problems.append(f"origin must have shape ({n_node},), one id a node, got {ancestors.shape}")
    elif (ancestors[ancestors] != ancestors).any():
        wrong = np.flatnonzero(ancestors[ancestors] != ancestors)
        problems.append(
            f"origin must point to nodes that are their own origin, got nodes "
            f"{_some(wrong.tolist())} that point to a duplicate"
        )
    return ancestors


def _cast_directors(
    directors: npt.ArrayLike | None, n_node: int, problems: list[str]
) -> Floats | None:
    if directors is None:
        return None
    try:
        T = np.array(directors, dtype=np.float64, order="C")
    except (TypeError, ValueError):
        T = np.empty(0)
    if T.shape != (n_node, 3) or not np.isfinite(T).all():
        state = f"shape {T.shape}" if T.shape != (n_node, 3) else "nan or inf"
        problems.append(
            f"directors must be finite numbers of shape ({n_node}, 3), got {state}; "
            "leave them out for the mean normals"
        )
        return None
    return T


def _check_finite(X: Floats, problems: list[str]) -> bool:
    bad = np.flatnonzero(~np.isfinite(X).all(axis=1))
    if len(bad):
        problems.append(f"nodes must be finite, got {_places(bad, X)}; repair or remove them")
    return not len(bad)


def _check_ids(Q: Ints, n_node: int, problems: list[str]) -> bool:
    bad = np.flatnonzero((Q.min(axis=1) < 0) | (Q.max(axis=1) >= n_node))
    if len(bad):
        hint = "; ids count from 0" if Q.max() == n_node and Q.min() == 1 else ""
        problems.append(
            f"quads must hold node ids from 0 to {n_node - 1}, got "
            f"{_some(bad, lambda e: f'quad {e} of nodes {Q[e].tolist()}')}{hint}; renumber them"
        )
    return not len(bad)


def _check_corners(X: Floats, Q: Ints, problems: list[str]) -> Bools:
    # returns the quads that go on to the further checks
    ordered = np.sort(Q, axis=1)
    sound: Bools = (ordered[:, 1:] != ordered[:, :-1]).all(axis=1)
    if not sound.all():
        problems.append(
            "quads must have four different nodes, got "
            f"{_quad_places(np.flatnonzero(~sound), X, Q)}; triangles are not supported, "
            "mesh with quads only"
        )
    order = np.lexsort(ordered.T)
    same = (ordered[order[1:]] == ordered[order[:-1]]).all(axis=1)
    if same.any():
        problems.append(
            "quads must differ, got the same four nodes in "
            f"{_quad_pairs(order[:-1][same], order[1:][same], X, Q)}; remove the duplicates"
        )
        sound[order[1:][same]] = False
    valence = np.bincount(Q.ravel(), minlength=len(X))
    if len(loose := np.flatnonzero(valence == 0)):
        problems.append(
            f"nodes must belong to a quad, got {_places(loose, X)}; remove them and renumber"
        )
    if len(crowded := np.flatnonzero(valence > MAX_VALENCE)):
        problems.append(
            f"nodes must join {MAX_VALENCE} quads at most, got {_places(crowded, X)} joining "
            f"{_some(valence[crowded])}; remesh around them"
        )
    return sound


def _check_edges(X: Floats, Q: Ints, edges: _QuadSides, problems: list[str]) -> None:
    crowded = np.flatnonzero(edges.n_quad > 2)
    if len(crowded):
        ends = edges.nodes
        named = _some(
            crowded,
            lambda k: f"{_place(ends[k, 0], X)} to {_place(ends[k, 1], X)} with {edges.n_quad[k]}",
        )
        problems.append(
            f"edges must have one or two quads, got {named}; a T-joint has no single director, "
            "five-parameter nodes are for smooth shells only: model one sheet"
        )
    one, two, alike = edges.neighbours()
    if not alike.all():
        problems.append(
            "neighbouring quads must turn the same way, got opposite orientation in "
            f"{_quad_pairs(one[~alike], two[~alike], X, Q)}; reverse the node order of one side"
        )
    # one open fan has two rim spokes; more mean that the node joins quads like a hinge
    spokes = np.bincount(edges.nodes[edges.n_quad == 1].ravel(), minlength=len(X))
    pinched = np.flatnonzero(spokes > 2)
    if len(pinched) and not len(crowded) and len(edges.quads) == Q.size:
        problems.append(
            f"the quads of a node must form one fan, got {_places(pinched, X)} joining parts that "
            "share no edge; duplicate the node or add quads between"
        )


def _check_shapes(X: Floats, Q: Ints, among: Bools, problems: list[str]) -> Bools:
    lengths = _edge_lengths(X, Q)
    longest = lengths.max(axis=1)
    flat = _norm(_quad_vectors(X, Q)) <= _MIN_RELATIVE_AREA * longest**2
    flat |= lengths.min(axis=1) <= _MIN_RELATIVE_EDGE * longest
    flat &= among
    if flat.any():
        problems.append(
            "quads must have an area and four edges, got "
            f"{_quad_places(np.flatnonzero(flat), X, Q)} degenerate or a bow-tie; merge nodes at "
            "one place, put the four corners in order around the quad"
        )
    least = _scaled_jacobian(X, Q)
    bad = (least <= 0.0) & among & ~flat
    if bad.any():
        problems.append(
            "quads must be convex with corners in order (Jacobian above 0 at each corner), got "
            f"{_quad_places(np.flatnonzero(bad), X, Q)} inverted or folded onto itself, scaled "
            f"Jacobian {_some(least[bad], '{:.3g}'.format)}; reorder the corners or move the nodes"
        )
    sound: Bools = ~(flat | bad)
    return sound


def _check_folds(
    X: Floats, Q: Ints, edges: _QuadSides, sound: Bools, limit_deg: float, problems: list[str]
) -> None:
    one, two, alike = edges.neighbours()
    alike &= sound[one] & sound[two]
    one, two = one[alike], two[alike]
    normals = _unit(_quad_vectors(X, Q))
    # the arc tangent keeps small angles, which an arc cosine rounds away
    sine = _norm(np.cross(normals[one], normals[two]))
    cosine = np.einsum("ij,ij->i", normals[one], normals[two])
    angle = np.degrees(np.arctan2(sine, cosine))
    folded = angle > limit_deg
    if folded.any():
        problems.append(
            f"normals of neighbouring quads must differ by {limit_deg:g} degrees at most, got "
            f"{_some(angle[folded], '{:.1f}'.format)} between "
            f"{_quad_pairs(one[folded], two[folded], X, Q)}; five-parameter nodes are for smooth "
            "shells only: refine a curved sheet, round a fold, or raise max_fold_deg"
        )


def _check_directors(X: Floats, Q: Ints, given: Floats, sound: Bools, problems: list[str]) -> None:
    length = _norm(given)
    wrong = np.abs(length - 1.0) > _DIRECTOR_LENGTH
    if wrong.any():
        problems.append(
            f"directors must have unit length, got {_places(np.flatnonzero(wrong), X)} of length "
            f"{_some(length[wrong], '{:.6g}'.format)}; divide them by their norm"
        )
    below = np.zeros(len(X), dtype=np.bool_)
    for a in range(4):
        p, q = _corner_vectors(X, Q, a)
        against = np.einsum("ij,ij->i", np.cross(p, q), given[Q[:, a]]) <= 0.0
        below[Q[against & sound, a]] = True
    below &= ~wrong
    if below.any():
        problems.append(
            "directors must point to the side of the normals, got "
            f"{_places(np.flatnonzero(below), X)} pointing along or against the sheet; reverse "
            "the directors or the node order of the quads"
        )


def _look_up(kind: str, sets: Mapping[str, Ints], name: str) -> Ints:
    try:
        return sets[name]
    except KeyError:
        near = get_close_matches(name, sets, n=1, cutoff=0.0)
        names = ", ".join(sorted(sets)) or "none"
        hint = f"; did you mean {near[0]!r}" if near else f"; add it by with_sets({kind}_sets=...)"
        raise MeshError(
            f"{kind} set must be one of those present ({names}), got {name!r}{hint}"
        ) from None
