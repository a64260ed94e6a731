"""A film meshed from its outline by Gmsh: :func:`mesh_from_outline`.

Gmsh is an optional extra (``pip install 'shellcut[mesh]'``, GPL) and imported only by this call.
The boundary is divided here, into an even number of edges per loop: with an odd number no mesh of
quads only exists. Inside, Blossom pairs Gmsh's frontal-Delaunay triangles to quads; on discs the
smallest scaled Jacobian was 0.71, with other settings 0.03 to 0.68.
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from math import atan2
from typing import Annotated, Any, TypeAlias

import numpy as np
import numpy.typing as npt

from shellcut.arguments import Option, checked
from shellcut.arrays import Floats, Ints, each

from .film_size import check_film_size
from .loops import area_of, levels, meetings
from .mesh import Mesh, MeshError

CORNER_DEG = 30.0
"""A vertex at which the outline turns by more is a corner and becomes a node [deg]."""

_MOST_EDGES = 50_000
"""Limit along outline and holes."""

_ALGORITHMS = (6, 5, 8)  # frontal-Delaunay, Delaunay, frontal for quads: tried if triangles remain
_OPTIONS = {
    "General.Terminal": 0,
    "General.NumThreads": 1,
    "Mesh.RecombineAll": 1,
    "Mesh.RecombinationAlgorithm": 1,  # Blossom
    "Mesh.MeshSizeExtendFromBoundary": 1,
    "Mesh.MeshSizeFromPoints": 1,
    "Mesh.ElementOrder": 1,
    "Mesh.RandomSeed": 1,
}


QuadSize: TypeAlias = Annotated[float, Option("mm", "edge length of the quads, about", above=0)]


@checked
def mesh_from_outline(
    outline: Annotated[
        npt.ArrayLike, Option("mm", "vertices in order, without the first again", form="polygon")
    ],
    *,
    size: QuadSize,
    holes: Annotated[
        Sequence[npt.ArrayLike], Option("mm", "polygons inside", form="polygons")
    ] = (),
) -> Mesh:
    """Return a plane mesh of quads within a polygon, with Gmsh.

    Between corners (:data:`CORNER_DEG`) the polygon stands for a smooth curve: nodes lie on it, but
    not on its vertices.

    Returns
    -------
    Mesh
        Node sets "outline", "hole_1", "hole_2", ... in order along each loop.

    Raises
    ------
    MeshError
        If a polygon is invalid, or Gmsh leaves triangles.
    ImportError
        If Gmsh is missing or cannot be loaded.

    Examples
    --------
    >>> mesh = mesh_from_outline([(0, 0), (10, 0), (10, 6), (0, 6)], size=1.0)  # doctest: +SKIP
    """
    names = ["outline", *(f"hole_{k}" for k in range(1, len(holes) + 1))]
    polygons = [
        _polygon(vertices, name) for vertices, name in zip((outline, *holes), names, strict=True)
    ]
    _check_apart(polygons, names)
    _check_count(polygons, size)
    loops = [_divided(polygon, size) for polygon in polygons]
    _check_apart(loops, names)  # the division may have bridged parts narrower than an edge
    with _gmsh() as gmsh:
        left = 0
        for algorithm in _ALGORITHMS:
            nodes, quads, left, rims = _meshed(gmsh, loops, size, algorithm)
            if not left:
                return Mesh.from_arrays(nodes, quads, node_sets=dict(zip(names, rims, strict=True)))
    raise MeshError(
        f"Gmsh must find a mesh of quads only, but leaves {left} triangles; change size a little, "
        "or check narrow parts of the outline"
    )


def _check_count(polygons: list[Floats], size: float) -> None:
    # check the number of quads by area, and of edges along the outlines, which are passed to Gmsh
    area = area_of(polygons[0]) - sum(area_of(hole) for hole in polygons[1:])
    check_film_size(area / size / size, "enlarge size, or shrink the outline")
    around = sum(float(np.hypot(*(np.roll(p, -1, axis=0) - p).T).sum()) for p in polygons)
    if not around / size <= _MOST_EDGES:
        raise MeshError(
            f"outline and holes must be {_MOST_EDGES:,} edges of a size around at most, got "
            f"{around:.4g} mm at size {size:g} mm, {around / size:,.0f} edges: enlarge size"
        )


def _polygon(vertices: npt.ArrayLike, name: str) -> Floats:
    try:
        points = np.array(vertices, dtype=np.float64)
    except (TypeError, ValueError):
        points = np.empty(0)
    if points.ndim != 2 or points.shape[1] != 2 or len(points) < 3:
        raise MeshError(f"{name} must be three points or more of shape (n, 2), got {points.shape}")
    if not np.isfinite(points).all():
        raise MeshError(f"{name} must be finite")
    sides = np.roll(points, -1, axis=0) - points
    if (np.hypot(*sides.T) == 0.0).any():
        at = int(np.flatnonzero(np.hypot(*sides.T) == 0.0)[0])
        raise MeshError(f"{name} must have different vertices, {at} is where the next one is")
    return points


def _check_apart(loops: list[Floats], names: list[str]) -> None:
    # Gmsh hangs on crossing outlines: sides must not cross or touch, and holes must lie inside
    for found in meetings(loops):
        other = "itself" if found.one == found.other else names[found.other]
        raise MeshError(
            f"the outline and its holes must not cross or touch, {names[found.one]} "
            f"{'crosses' if found.crosses else 'touches'} {other} near ({found.place[0]:.4g}, "
            f"{found.place[1]:.4g})"
        )
    for name, level in zip(names[1:], levels(loops)[1:], strict=True):
        if level == 0:
            raise MeshError(f"{name} must lie inside the outline")
        if level > 1:
            raise MeshError(f"holes must lie apart, {name} lies in another")


def _divided(points: Floats, size: float) -> Floats:
    # nodes along the polygon: all corners, evenly spaced by arc length between them
    sides = np.roll(points, -1, axis=0) - points
    length = np.hypot(*sides.T)
    before = np.roll(sides, 1, axis=0)
    cross = before[:, 0] * sides[:, 1] - before[:, 1] * sides[:, 0]
    turn = each(atan2, np.abs(cross), (before * sides).sum(axis=1))
    corners = np.flatnonzero(np.degrees(turn) > CORNER_DEG)
    start = corners if len(corners) else np.array([0])
    arc = np.concatenate([[0.0], np.cumsum(length)])
    total = arc[-1]
    ends = np.append(arc[start], arc[start[0]] + total)
    pieces = np.diff(ends)
    counts = np.maximum(1, np.round(pieces / size)).astype(int)
    counts[int(np.argmax(pieces / counts))] += int(counts.sum() % 2)
    while counts.sum() < 4:
        counts[int(np.argmax(pieces / counts))] += 2
    at = np.concatenate(
        [
            first + piece * np.arange(n) / n
            for first, piece, n in zip(ends[:-1], pieces, counts, strict=True)
        ]
    )
    closed = np.concatenate([points, points[:1]])
    twice = np.concatenate([arc, total + arc[1:]])
    xy = [np.interp(at, twice, np.concatenate([c, c[1:]])) for c in closed.T]
    return np.stack(xy, axis=1)


@contextmanager
def _gmsh() -> Iterator[Any]:
    # Gmsh with these options and an empty model; the user's state is restored
    try:
        import gmsh
    except ImportError:
        raise ImportError(
            "meshing an outline needs Gmsh, an optional extra under the GPL: "
            "pip install 'shellcut[mesh]'"
        ) from None
    except OSError as reason:  # a system library missing from its wheel
        raise ImportError(
            f"Gmsh is installed but cannot be loaded: {reason}; on Debian and Ubuntu: "
            "apt install libglu1-mesa libxcursor1 libxft2 libxinerama1"
        ) from None
    was_running = bool(gmsh.isInitialized())
    if not was_running:
        gmsh.initialize(readConfigFiles=False, interruptible=False)
        _keep_closed_pipes_harmless()
    kept = {name: gmsh.option.getNumber(name) for name in [*_OPTIONS, "Mesh.Algorithm"]}
    current = gmsh.model.getCurrent() if was_running else None
    try:
        for name, value in _OPTIONS.items():
            gmsh.option.setNumber(name, value)
        yield gmsh
    finally:
        if was_running:
            for name, value in kept.items():
                gmsh.option.setNumber(name, value)
            gmsh.model.setCurrent(current)
        else:
            gmsh.finalize()


def _keep_closed_pipes_harmless() -> None:
    """Put back what Python does with SIGPIPE: Gmsh lets a closed pipe end the process silently.

    ``shellcut run ... | head`` would then lose its run. Only the main thread may do so.
    """
    if hasattr(signal, "SIGPIPE") and threading.current_thread() is threading.main_thread():
        handler = signal.getsignal(signal.SIGPIPE)
        if handler is not None:
            signal.signal(signal.SIGPIPE, handler)


def _meshed(
    gmsh: Any, loops: list[Floats], size: float, algorithm: int
) -> tuple[Floats, Ints, int, list[Ints]]:
    # returns nodes (n, 2), quads, the number of triangles left, and the nodes of each loop in order
    gmsh.model.add("shellcut outline")
    try:
        gmsh.option.setNumber("Mesh.Algorithm", algorithm)
        geo = gmsh.model.geo
        curve_loops, point_tags = [], []
        for loop in loops:
            points = [geo.addPoint(x, y, 0.0, size) for x, y in loop.tolist()]
            lines = [
                geo.addLine(p, q) for p, q in zip(points, points[1:] + points[:1], strict=True)
            ]
            for line in lines:
                geo.mesh.setTransfiniteCurve(line, 2)
            curve_loops.append(geo.addCurveLoop(lines))
            point_tags.append(points)
        geo.addPlaneSurface(curve_loops)
        geo.synchronize()
        try:
            gmsh.model.mesh.generate(2)
        except Exception as reason:  # gmsh raises plain Exception
            raise MeshError(
                f"Gmsh cannot mesh this outline: {reason}; do its holes lie inside, apart?"
            ) from None
        tags, xyz, _ = gmsh.model.mesh.getNodes()
        row = np.zeros(int(tags.max()) + 1, dtype=np.int64)
        row[tags.astype(np.int64)] = np.arange(len(tags))
        corners = {3: np.empty((0, 4), np.int64), 2: np.empty((0, 3), np.int64)}
        kinds, _, node_tags = gmsh.model.mesh.getElements(2)
        for kind, members in zip(kinds, node_tags, strict=True):
            corners[int(kind)] = row[members.astype(np.int64)].reshape(-1, 4 if kind == 3 else 3)
        rims = [
            np.array([row[int(gmsh.model.mesh.getNodes(0, p)[0][0])] for p in points])
            for points in point_tags
        ]
        return xyz.reshape(-1, 3)[:, :2], corners[3], len(corners[2]), rims
    finally:
        gmsh.model.remove()
