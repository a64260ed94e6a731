"""Casting and checks of a mesh given by the user, for :mod:`shellcut.mesh`.

Each check adds its problems to a list and continues, so that one message contains all of them.
X are positions, Q quads, T directors; corners of a quad are numbered as in :mod:`shellcut.mesh`.
"""

from __future__ import annotations

import logging
import os
from collections.abc import Mapping
from difflib import get_close_matches

import numpy as np

from shellcut.arrays import ArrayLike, Bools, Floats, Ints, angles, norm, unit
from shellcut.formats.errors import named, point_text

from .quad_geometry import (
    QuadSides,
    corner_vectors,
    edge_lengths,
    mean_directors,
    quad_vectors,
    scaled_jacobian,
)

MAX_VALENCE = 12
"""Largest number of quads at a node: the split kernels keep a node's fan in an array this long."""

_log = logging.getLogger("shellcut.mesh")

MOST_QUADS = 10_000_000
"""Quads of the largest film allowed: 9 GB, and half a second per step."""

_MANY_QUADS = 1_000_000
"""From so many on a film is announced: the checks of its mesh alone take some 15 s."""

BYTES_A_QUAD = 902.0
"""Memory of a run, measured between 1e5 and 1e6 quads (docs/performance.md)."""

_MIN_RELATIVE_AREA = 1e-12  # quad area over its longest side squared; smaller is round-off
_MIN_RELATIVE_SIDE = 1e-9  # shortest over longest side of a quad; below it two corners coincide
_DIRECTOR_LENGTH = 1e-6  # accepted | |T| - 1 |, then scaled to one: text files have 7 digits
# Thickness is measured along the director: a film whose directors all lean by 5° is 0.4 % too thin
# and up to 1.2 % too soft, by 10° four times that, and the same if they lean in varying directions.
# The mean over a quad of exact normals is the quad's normal; mean normals lean off them by part of
# the fold between quads, at the border by half of it, and across a strip one quad wide no fold
# shows its curvature.
_QUAD_LEAN_DEG = 5.0
_NODE_LEAN_DEG = 10.0
_BORDER_LEAN_DEG = 45.0
_LEAN_OF_FOLD = 0.75


class MeshError(ValueError):
    """The mesh, or a request to one, is invalid; the message lists every problem."""


def checked_arrays(
    nodes: ArrayLike,
    quads: ArrayLike,
    node_sets: Mapping[str, ArrayLike] | None,
    quad_sets: Mapping[str, ArrayLike] | None,
    directors: ArrayLike | None,
    origin: ArrayLike | None,
    max_fold_deg: float,
) -> tuple[Floats, Ints, Floats, dict[str, Ints], dict[str, Ints], Ints]:
    """Return the arguments of :meth:`Mesh.from_arrays`, cast, in the order of the constructor."""
    problems: list[str] = []
    X = _cast_nodes(nodes, problems)
    Q = _cast_quads(quads, problems)
    if X is None or Q is None:
        raise error(problems)
    n_node, n_quad = len(X), len(Q)
    if n_quad >= _MANY_QUADS:
        _log.warning(
            "a film of %s quads takes %.3g GB, and minutes to check and to prepare",
            f"{n_quad:,}",
            n_quad * BYTES_A_QUAD / 1e9,
        )
    named_nodes = cast_sets("node", node_sets, n_node, problems)
    named_quads = cast_sets("quad", quad_sets, n_quad, problems)
    ancestors = _cast_origin(origin, n_node, problems)
    given = _cast_directors(directors, n_node, problems)

    infinite = np.flatnonzero(~np.isfinite(X).all(axis=1))
    if len(infinite):
        problems.append(f"nodes must be finite, got {_places(infinite, X)}; repair or remove them")
    outside = np.flatnonzero((Q.min(axis=1) < 0) | (Q.max(axis=1) >= n_node))
    if len(outside):
        hint = "; ids count from 0" if Q.max() == n_node and Q.min() == 1 else ""
        problems.append(
            f"quads must hold node ids from 0 to {n_node - 1}, got "
            f"{named(outside, lambda e: f'quad {e} of nodes {Q[e].tolist()}')}{hint}; renumber them"
        )
    else:
        sound = _check_corners(X, Q, problems)
        sides = QuadSides(Q, n_node, np.flatnonzero(sound))
        _check_sides(X, Q, sides, problems)
        if not len(infinite):
            sound &= _check_shapes(X, Q, sound, problems)
            _check_folds(X, Q, sides, sound, max_fold_deg, problems)
            if given is not None:
                _check_directors(X, Q, given, sound, problems)
    if given is None and not problems:
        given = mean_directors(X, Q)
        _check_directors(X, Q, given, sound, problems)
    elif given is not None and not problems:
        _check_lean(X, Q, sides, given, problems)
    if given is None or problems:
        raise error(problems)
    T = unit(given)
    return X, Q, T, named_nodes, named_quads, ancestors


def check_quads(X: Floats, Q: Ints) -> None:
    """Refuse quads that are wrong by themselves: twice there, or without four corners in order."""
    problems: list[str] = []
    _check_shapes(X, Q, _check_corners(X, Q, problems), problems)
    if problems:
        raise error(problems)


# --- casting and checks: each adds its problems to the list --------------------------------------


def error(problems: list[str]) -> MeshError:
    """Return one error that lists the problems."""
    if len(problems) == 1:
        return MeshError(problems[0])
    return MeshError(f"{len(problems)} problems:\n- " + "\n- ".join(problems))


def place(node: int, X: Floats) -> str:
    """Name a node and where it is."""
    return f"node {node} at {point_text(X[node])}"


def _places(nodes: Ints, X: Floats) -> str:
    return named(nodes, lambda n: place(n, X))


def _quad_places(quads: Ints, X: Floats, Q: Ints) -> str:
    return named(quads, lambda e: f"quad {e} at {point_text(X[Q[e]].mean(axis=0))}")


def _quad_pairs(first: Ints, second: Ints, X: Floats, Q: Ints) -> str:
    pairs = np.sort(np.stack([first, second], axis=1), axis=1)
    return named(pairs, lambda p: " and ".join(_quad_places(p[i : i + 1], X, Q) for i in (0, 1)))


def _cast_nodes(nodes: ArrayLike, problems: list[str]) -> Floats | None:
    X = np.array(nodes, dtype=np.float64, order="C")
    if X.ndim != 2 or X.shape[1] not in (2, 3) or len(X) == 0:
        problems.append(
            f"nodes must have shape (n_node, 3) or (n_node, 2), got {X.shape}; one row per node"
        )
        return None
    if X.shape[1] == 2:
        X = np.concatenate([X, np.zeros((len(X), 1))], axis=1)
    return X


def _cast_quads(quads: ArrayLike, problems: list[str]) -> Ints | None:
    Q = np.array(quads, order="C")
    if Q.ndim != 2 or Q.shape[1] != 4 or len(Q) == 0:
        problems.append(
            f"quads must have shape (n_quad, 4), got {Q.shape}; one row of four node ids per quad, "
            "triangles are not supported"
        )
        return None
    if Q.dtype.kind not in "iu":
        problems.append(f"quads must be whole numbers, got {Q.dtype}; cast the node ids to int")
        return None
    return Q.astype(np.int64)


def _cast_ids(
    what: str, ids: ArrayLike, n: int, problems: list[str], *, unique: bool = True
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
        problems.append(f"{what} must hold ids from 0 to {n - 1}, got {named(outside.tolist())}")
        return none
    values, counts = np.unique(members, return_counts=True)
    if unique and (counts > 1).any():
        problems.append(
            f"{what} must hold each id once, got {named(values[counts > 1].tolist())} again; "
            "pass it through numpy.unique"
        )
    return members.astype(np.int64)


def cast_sets(
    kind: str, sets: Mapping[str, ArrayLike] | None, n: int, problems: list[str]
) -> dict[str, Ints]:
    """Return the named sets of ``kind`` ids below ``n``; an invalid one is left empty."""
    return {
        name: _cast_ids(f"{kind} set {name!r}", ids, n, problems)
        for name, ids in (sets or {}).items()
    }


def _cast_origin(origin: ArrayLike | None, n_node: int, problems: list[str]) -> Ints:
    if origin is None:
        return np.arange(n_node, dtype=np.int64)
    ancestors = _cast_ids("origin", origin, n_node, problems, unique=False)
    if ancestors.shape != (n_node,):
        shape = ancestors.shape
        problems.append(f"origin must have shape ({n_node},), one id per node, got {shape}")
    elif (ancestors[ancestors] != ancestors).any():
        wrong = np.flatnonzero(ancestors[ancestors] != ancestors)
        problems.append(
            f"origin must point to nodes that are their own origin, got nodes "
            f"{named(wrong.tolist())} that point to a duplicate"
        )
    return ancestors


def _cast_directors(directors: ArrayLike | None, n_node: int, problems: list[str]) -> Floats | None:
    if directors is None:
        return None
    T = np.array(directors, dtype=np.float64, order="C")
    if T.shape != (n_node, 3) or not np.isfinite(T).all():
        state = f"shape {T.shape}" if T.shape != (n_node, 3) else "nan or inf"
        problems.append(
            f"directors must be finite numbers of shape ({n_node}, 3), got {state}; "
            "leave them out for the mean normals"
        )
        return None
    return T


def _check_corners(X: Floats, Q: Ints, problems: list[str]) -> Bools:
    # returns the quads that get the further checks
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
            f"{named(valence[crowded])}; remesh around them"
        )
    return sound


def _check_sides(X: Floats, Q: Ints, sides: QuadSides, problems: list[str]) -> None:
    crowded = np.flatnonzero(sides.n_quad > 2)
    if len(crowded):
        ends = sides.nodes
        found = named(
            crowded,
            lambda k: f"{place(ends[k, 0], X)} to {place(ends[k, 1], X)} with {sides.n_quad[k]}",
        )
        problems.append(
            f"a side must belong to one or two quads, got {found}; a T-joint has no single "
            "director, five-parameter nodes are for smooth shells only: model one sheet"
        )
    first, second, alike = sides.neighbours()
    if not alike.all():
        problems.append(
            "neighbouring quads must have the same orientation, got opposite orientation in "
            f"{_quad_pairs(first[~alike], second[~alike], X, Q)}; reverse the node order of the "
            "quads on one side"
        )
    # an open fan has two sides on the border; with more the node connects quads like a hinge
    spokes = np.bincount(sides.nodes[sides.n_quad == 1].ravel(), minlength=len(X))
    pinched = np.flatnonzero(spokes > 2)
    if len(pinched) and not len(crowded) and len(sides.quads) == Q.size:
        problems.append(
            f"the quads of a node must form one fan, got {_places(pinched, X)} joining parts that "
            "share no side; duplicate the node or add quads between"
        )


def _check_shapes(X: Floats, Q: Ints, among: Bools, problems: list[str]) -> Bools:
    lengths = edge_lengths(X, Q)
    longest = lengths.max(axis=1)
    flat = norm(quad_vectors(X, Q)) <= _MIN_RELATIVE_AREA * longest**2
    flat |= lengths.min(axis=1) <= _MIN_RELATIVE_SIDE * longest
    flat &= among
    if flat.any():
        problems.append(
            "quads must have an area and four sides, got "
            f"{_quad_places(np.flatnonzero(flat), X, Q)} degenerate or a bow-tie; merge nodes at "
            "one place, put the four corners in order around the quad"
        )
    least = scaled_jacobian(X, Q)
    bad = (least <= 0.0) & among & ~flat
    if bad.any():
        problems.append(
            "quads must be convex with corners in order (Jacobian above 0 at each corner), got "
            f"{_quad_places(np.flatnonzero(bad), X, Q)} inverted or folded onto itself, scaled "
            f"Jacobian {named(least[bad], '{:.3g}'.format)}; reorder the corners or move the nodes"
        )
    return np.asarray(~(flat | bad))


def _check_folds(
    X: Floats, Q: Ints, sides: QuadSides, sound: Bools, limit_deg: float, problems: list[str]
) -> None:
    first, second, alike = sides.neighbours()
    alike &= sound[first] & sound[second]
    first, second = first[alike], second[alike]
    normals = quad_vectors(X, Q)
    angle = np.degrees(angles(normals[first], normals[second]))
    folded = angle > limit_deg
    if folded.any():
        problems.append(
            f"normals of neighbouring quads must differ by {limit_deg:g} degrees at most, got "
            f"{named(angle[folded], '{:.1f}'.format)} between "
            f"{_quad_pairs(first[folded], second[folded], X, Q)}; five-parameter nodes are for "
            "smooth shells only: refine a curved sheet, round a fold by several quads across it; a "
            "sharp fold cannot be modelled"
        )


def _check_directors(X: Floats, Q: Ints, given: Floats, sound: Bools, problems: list[str]) -> None:
    length = norm(given)
    wrong = np.abs(length - 1.0) > _DIRECTOR_LENGTH
    if wrong.any():
        problems.append(
            f"directors must have unit length, got {_places(np.flatnonzero(wrong), X)} of length "
            f"{named(length[wrong], '{:.6g}'.format)}; divide them by their norm"
        )
    below = np.zeros(len(X), dtype=np.bool_)
    for a in range(4):
        p, q = corner_vectors(X, Q, a)
        against = np.einsum("ij,ij->i", np.cross(p, q), given[Q[:, a]]) <= 0.0
        below[Q[against & sound, a]] = True
    below &= ~wrong
    if below.any():
        problems.append(
            "directors must point to the side of the normals, got "
            f"{_places(np.flatnonzero(below), X)} pointing along or against the sheet; reverse "
            "the directors or the node order of the quads"
        )


def _check_lean(X: Floats, Q: Ints, sides: QuadSides, given: Floats, problems: list[str]) -> None:
    normals = quad_vectors(X, Q)
    first, second, _ = sides.neighbours()
    fold = np.zeros(len(Q))
    for side in (first, second):
        np.maximum.at(fold, side, np.degrees(angles(normals[first], normals[second])))
    lean = np.degrees(angles(given[Q].sum(axis=1), normals))
    limit = _QUAD_LEAN_DEG + _LEAN_OF_FOLD * fold
    if len(bad := np.flatnonzero(lean > limit)):
        problems.append(
            "directors must be normal to the film: their mean over a quad within "
            f"{_QUAD_LEAN_DEG:g} degrees of the quad's normal where the film is flat, got "
            f"{_quad_places(bad, X, Q)} with directors that lean by "
            f"{named(lean[bad], '{:.3g}'.format)} degrees; give normals of the surface, or leave "
            "them out for the mean normals"
        )
    lean = np.degrees(angles(given, mean_directors(X, Q)))
    limit = np.full(len(X), _NODE_LEAN_DEG)
    limit[sides.nodes[sides.n_quad == 1]] = _BORDER_LEAN_DEG
    sharpest = np.zeros(len(X))
    np.maximum.at(sharpest, Q, fold[:, None])
    if len(bad := np.flatnonzero(lean > limit + _LEAN_OF_FOLD * sharpest)):
        problems.append(
            f"directors must lie within {_NODE_LEAN_DEG:g} degrees of the mean normal of their "
            f"quads, at the border within {_BORDER_LEAN_DEG:g}, where the film is flat, got "
            f"{_places(bad, X)} that lean by {named(lean[bad], '{:.3g}'.format)} degrees; give "
            "normals of the surface, or leave them out for the mean normals"
        )


def look_up(kind: str, sets: Mapping[str, Ints], name: str) -> Ints:
    """Return a named set; an unknown name raises an error with the existing names.

    Letters may have any case where that leaves one set, as Abaqus and LS-DYNA compare names.
    """
    if name in sets:
        return sets[name]
    folded = [known for known in sorted(sets) if known.casefold() == name.casefold()]
    if len(folded) == 1:
        return sets[folded[0]]
    by_letters = {known.casefold(): known for known in sorted(sets)}
    close = get_close_matches(name.casefold(), by_letters, n=len(sets) or 1, cutoff=0.0)
    near = folded or [by_letters[known] for known in close]
    names = ", ".join(dict.fromkeys([*near, *sorted(sets)])) or "none"
    add = f"with_sets({kind}_sets=...) in Python, or as a group of {kind}s in the file of a film"
    hint = f"; did you mean {near[0]!r}" if near else f"; add it by {add}"
    raise MeshError(f"{kind} set must be one of those present ({names}), got {name!r}{hint}")


def check_film_size(n_quad: float, remedy: str) -> None:
    """Refuse a film of too many quads, about, for the library or for this machine's memory.

    The number may be infinite.

    Examples
    --------
    >>> check_film_size(75e6, "enlarge size")
    Traceback (most recent call last):
    ...
    shellcut.mesh.checks.MeshError: the film must have 10,000,000 quads at most, it would have ...
    """
    needed = n_quad * BYTES_A_QUAD
    shown = f"{n_quad:,.0f}" if n_quad < 1e12 else f"{n_quad:.3g}"
    takes = f"it would have about {shown}, which take {needed / 1e9:,.3g} GB"
    if not n_quad <= MOST_QUADS:
        raise MeshError(f"the film must have {MOST_QUADS:,} quads at most, {takes}: {remedy}")
    there = _memory()
    if there is not None and needed > there:
        raise MeshError(
            f"the film must fit into this machine's memory of {there / 1e9:.3g} GB, {takes}: "
            f"{remedy}"
        )


def _memory() -> float | None:
    """Return this machine's memory in bytes, None if unknown."""
    try:
        return float(os.sysconf("SC_PHYS_PAGES")) * float(os.sysconf("SC_PAGE_SIZE"))
    except (AttributeError, ValueError, OSError):
        return None
