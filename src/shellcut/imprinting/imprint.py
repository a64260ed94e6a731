"""Insert a blade's path into a mesh as a line of edges: see docs/theory/imprint.md."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from shellcut.arrays import Bools, Floats, Ints
from shellcut.material.elastic import Elastic
from shellcut.material.material import Material
from shellcut.mesh.checks import some
from shellcut.mesh.mesh import Mesh
from shellcut.view import draw_path

from .chain import Chain, find_chain
from .course import Course, check_room, find_courses
from .edge_line import IN_THE_MESH, EdgeLine, find_edge_line
from .film_plane import FilmPlane, ImprintError
from .leads import with_room
from .membrane_step import membrane_steps
from .path_curve import PathCurve
from .pillow import Pillowed, pillow, pillowed_mesh
from .smoothing import Sliders, Smoother

REACH = 5.0
"""Nodes within this many edge lengths of the path move."""

ROW_SIZE = 1.25
"""Target size of the quads beside the path over that of the others: a node of the next row must
stay out of reach of the blade-cut rule (0.3 edge lengths)."""

ON_THE_FILM = 0.01
"""Largest deviation of a path from the film's plane, in edge lengths."""

NEAR = 2.0
"""Quality is reported for quads with a node within this many edge lengths of the path."""

N_WORST = 10
"""Number of worst quads listed."""

_FILM = Elastic(young=1678.0, poisson=0.3, density=1.0e-9)  # ShellMaterial.homogeneous


@dataclass(frozen=True, eq=False)
class ImprintResult:
    """A mesh with the path in it, and its quality.

    Examples
    --------
    >>> from shellcut import PathCurve, imprint
    >>> from shellcut.mesh.structured import rectangle
    >>> found = imprint(rectangle(6.0, 4.0, size=0.5), PathCurve.line((0.0, 0.1), (6.0, 0.1)))
    >>> len(found.chains), found.closed
    (1, (False,))
    """

    mesh: Mesh
    """Old nodes and quads keep their ids, new ones are appended; the given mesh itself if the path
    was already in it."""
    chains: tuple[Ints, ...]
    """Node ids along each stretch of path inside the film, in order. A stretch that ends inside the
    film usually ends within an edge; its chain continues to the next node beyond."""
    first: tuple[int, ...]
    """Index in each chain of the last node before the blade's first position: earlier nodes belong
    to the lead behind it. 0 for a path given without leads."""
    closed: tuple[bool, ...]
    """Whether the last node of the chain is joined to the first."""
    there: tuple[bool, ...]
    """Whether a line of edges already lay along the stretch; its nodes did not move."""
    curves: tuple[PathCurve, ...]
    """The given path."""
    moved: Ints
    """Old nodes that were moved."""
    near: Ints
    """Quads near the path."""
    worst: Ints
    """The quads near the path with the smallest scaled Jacobians, worst first, up to ten."""
    jacobian_before: float
    """Smallest scaled Jacobian near the path in the raw mesh."""
    jacobian_after: float
    """The same with the path in it."""
    step_before: float
    """Stable step of the raw mesh's membrane [s], see :mod:`~shellcut.imprinting.membrane_step`."""
    step_after: float
    """The same with the path in it [s]."""
    notes: tuple[str, ...]
    """Notes for the user: ends extended to the rim, moved nodes of named sets."""

    @property
    def changed(self) -> bool:
        """Whether the path was inserted, not already there."""
        return not all(self.there)

    def report(self) -> str:
        """Return the figures in words, in a few lines."""
        n_edge = [len(c) - (not e) for c, e in zip(self.chains, self.closed, strict=True)]
        n_there = sum(n for n, there in zip(n_edge, self.there, strict=True) if there)
        if not self.changed:
            return f"path of {n_there} edges is in the mesh, nothing was moved"
        beside = f" beside {n_there} that were there" if n_there else ""
        lines = [
            f"path of {sum(n_edge) - n_there} edges put into the mesh{beside}, "
            f"{self.mesh.n_quad} quads now, {len(self.moved)} nodes moved",
            f"least scaled Jacobian near the path {self.jacobian_before:.2f} before, "
            f"{self.jacobian_after:.2f} after, worst quads {self.worst.tolist()}",
            f"stable step {self.step_before:.3g} s before, {self.step_after:.3g} s after "
            f"({self.step_after / self.step_before:.2f} of it)",
        ]
        return "\n".join([*lines, *self.notes])

    def picture(self, path: str | os.PathLike[str]) -> None:
        """Draw film, path and worst quads into a file; the suffix sets the format.

        Raises
        ------
        ImportError
            If Matplotlib is not installed.
        """
        film = FilmPlane(self.mesh)
        draw_path(
            film.x,
            self.mesh.quads,
            [
                np.append(c, c[:1]) if e else c
                for c, e in zip(self.chains, self.closed, strict=True)
            ],
            self.worst,
            path,
            title=self.report().splitlines()[0],
            caption="\n".join(self.report().splitlines()[1:3]),
        )


def imprint(
    mesh: Mesh, curve: PathCurve | Sequence[PathCurve], *, material: Material | None = None
) -> ImprintResult:
    """Insert a path into a flat mesh as an exact line of edges.

    The function finds a chain of edges near the path, inserts a layer of quads on both sides of it,
    moves the chain onto the path, and smooths the quads around it. Nothing changes more than five
    edge lengths from the path. Rim, corners, named sets and pre-cracks stay: nodes of the rim slide
    on it, nodes that mark a set or a pre-crack do not move. If a line of edges already lies along a
    stretch of the path, its nodes stay; if that holds for every stretch, the film is unchanged.

    Parameters
    ----------
    mesh : Mesh
        Flat, in any plane.
    curve : PathCurve or sequence of PathCurve
        The path, in the film's plane; curves in two coordinates lie in z = 0. It may leave the film
        and come back. See :func:`shellcut.imprinting.blade_path` for the path of a tool.
    material : Material, optional
        For the stable steps reported; by default the paper's film.

    Returns
    -------
    ImprintResult

    Raises
    ------
    ImprintError
        If the film is not flat, or the path does not lie in it, is too tightly curved or too near
        to the rim, to a pre-crack or to itself for this mesh, or no good quads are found.

    Examples
    --------
    >>> from shellcut.mesh.structured import rectangle
    >>> mesh = rectangle(6.0, 3.0, size=0.5)
    >>> result = imprint(mesh, PathCurve.line((0.0, 0.2), (6.0, 0.2)))
    >>> bool(abs(result.mesh.nodes[result.chains[0], 1] - 0.2).max() < 1e-12)
    True
    """
    curves = (curve,) if isinstance(curve, PathCurve) else tuple(curve)
    film = FilmPlane(mesh)
    fitted, lead_notes = with_room(film, [_flattened(film, c) for c in curves])
    ways, notes = _ways(film, find_courses(film, fitted))
    notes = lead_notes + notes
    new = [way for way in ways if isinstance(way, Chain)]
    settled = [way for way in ways if isinstance(way, EdgeLine)]
    courses = [way.course for way in ways]
    elastic = material or _FILM
    step = float(membrane_steps(film.x, mesh.quads, elastic).min())
    near = _near(film.x, mesh.quads, film.edge_length, courses)
    jacobian = mesh.scaled_jacobian()
    before = float(jacobian[near].min())
    result, moved = mesh, np.zeros(0, np.int64)
    if new:
        layers = pillow(film, new)
        x = _smoothed(film, layers, new, settled)
        _check(film, layers, x)
        moved = np.flatnonzero((x[: mesh.n_node] != film.x).any(axis=1))
        result = pillowed_mesh(film, layers, x, moved)
        notes += _set_notes(film, moved)
        jacobian = result.scaled_jacobian()
        near = _near(x, result.quads, film.edge_length[layers.parent], courses)
        after = float(membrane_steps(x, result.quads, elastic).min())
    chains = tuple(w.nodes[w.on_path] if isinstance(w, Chain) else w.nodes for w in ways)
    done = film if result is mesh else FilmPlane(result)
    return ImprintResult(
        mesh=result,
        chains=chains,
        first=tuple(_first(done, *one) for one in zip(chains, courses, strict=True)),
        closed=tuple(course.closed for course in courses),
        there=tuple(isinstance(way, EdgeLine) for way in ways),
        curves=curves,
        moved=moved,
        near=near,
        worst=near[np.argsort(jacobian[near], kind="stable")[:N_WORST]],
        jacobian_before=before,
        jacobian_after=float(jacobian[near].min()),
        step_before=step,
        step_after=after if new else step,
        notes=tuple(notes),
    )


def lies_in(mesh: Mesh, curve: PathCurve | Sequence[PathCurve]) -> bool:
    """Return whether lines of edges lie under a whole path, so that an imprint changes nothing.

    Parameters
    ----------
    mesh : Mesh
        Flat, in any plane.
    curve : PathCurve or sequence of PathCurve
        As in :func:`imprint`.

    Raises
    ------
    ImprintError
        If the film is not flat, or the path does not lie in it.
    """
    curves = (curve,) if isinstance(curve, PathCurve) else tuple(curve)
    film = FilmPlane(mesh)
    fitted, _ = with_room(film, [_flattened(film, c) for c in curves])
    return all(find_edge_line(film, course) is not None for course in find_courses(film, fitted))


def _flattened(film: FilmPlane, curve: PathCurve) -> PathCurve:
    def to_plane(points: Floats) -> Floats:
        if points.shape[1] == 2:
            points = np.column_stack([points, np.zeros(len(points))])
        off = np.abs(film.off_plane(points))
        limit = ON_THE_FILM * float(np.median(film.edge_length))
        if off.max() > limit:
            raise ImprintError(
                f"a path must lie in the film's plane to {limit:.2g} mm, got a point "
                f"{off.max():.3g} mm off it; project the path on the film"
            )
        return film.flatten(points)

    return curve.mapped(to_plane)


def _ways(film: FilmPlane, courses: Sequence[Course]) -> tuple[list[Chain | EdgeLine], list[str]]:
    # existing lines of edges come first, chains keep clear of them
    lines = [find_edge_line(film, course) for course in courses]
    there = [line for line in lines if line is not None]
    new = [course for course, line in zip(courses, lines, strict=True) if line is None]
    if new:
        check_room(film, new, [line.course for line in there])
    quads = film.mesh.quads
    taken = np.zeros(film.mesh.n_node, np.bool_)
    for line in there:
        taken[quads[np.isin(quads, line.nodes).any(axis=1)]] = True
    ways: list[Chain | EdgeLine] = []
    notes: list[str] = []
    for course, known in zip(courses, lines, strict=True):
        if known is not None:
            ways.append(known)
            continue
        chain = find_chain(film, course, taken)
        ways.append(chain)
        taken[quads[np.isin(quads, chain.nodes).any(axis=1)]] = True
        for end, at in ((course.rim_start, course.start), (course.rim_end, course.end)):
            beyond = not course.curve.closed and not 0.0 <= at <= course.curve.length
            if end is not None and beyond:
                notes.append(f"the end of the path near {film.place(end.x)} is extended to the rim")
    return ways, notes


def _first(film: FilmPlane, chain: Ints, course: Course) -> int:
    # index of the last node of a chain that is not beyond the end of the lead behind the blade
    if course.closed:
        return 0
    slack = IN_THE_MESH * film.edge_length[chain]
    before = course.curve.nearest(film.x[chain]) <= course.curve.leads[0] + slack
    return max(int(before.sum()) - 1, 0)


def _distance(x: Floats, course: Course) -> Floats:
    # distance to the course, whose curve may continue beyond it
    u = course.unrolled(course.curve.nearest(x))
    if not course.closed:
        u = np.clip(u, course.start, course.end)
    return np.asarray(np.linalg.norm(course.curve.point(u) - x, axis=1))


def _near(x: Floats, quads: Ints, h: Floats, courses: Sequence[Course]) -> Ints:
    near = np.zeros(len(x), np.bool_)
    for course in courses:
        near |= _distance(x, course) < NEAR * h
    return np.flatnonzero(near[quads].any(axis=1))


def _smoothed(
    film: FilmPlane, layers: Pillowed, chains: Sequence[Chain], settled: Sequence[EdgeLine]
) -> Floats:
    # positions of all nodes after smoothing around the chains; nodes of existing lines stay
    mesh = film.mesh
    n_old, n = mesh.n_node, len(layers.x)
    x = layers.x.copy()
    near = np.zeros(n, np.bool_)
    for chain in chains:
        near |= _distance(layers.x, chain.course) < REACH * film.edge_length[layers.parent]
    near[n_old:] = True
    near[:n_old] &= ~film.pinned
    for line in settled:
        near[line.nodes] = False
    rim = np.concatenate([film.boundary, np.zeros(n - n_old, np.bool_)])
    rim[list(layers.rim_neighbour)] = True
    free = near & ~rim
    straight = _straight_corners(film, layers, rim)

    slides = near[:n_old] & film.boundary & ~film.corner
    slides[mesh.quads[straight[: mesh.n_quad].any(axis=1)]] = False
    sliders = []
    for chain in chains:
        on = chain.on_path
        nodes, u = chain.nodes[on], chain.u[on]
        free[nodes] = False
        slides[nodes] = False
        held = np.zeros(len(nodes), np.bool_)
        if not chain.closed:
            held[[0, -1]] = True
        for end, k in ((chain.course.rim_start, 0), (chain.course.rim_end, -1)):
            if end is not None:
                x[nodes[k]] = end.x
        sliders.append(Sliders(nodes[~held], chain.course.curve, u[~held]))
    sliders += _rim_sliders(film, layers, slides, x)

    area = mesh.quad_areas()
    new = [ROW_SIZE**2 * float(np.mean(area[list(old)])) for old in layers.beside]
    weight = np.where(straight, 0.0, 1.0)
    return Smoother(
        x, layers.quads, np.sqrt(np.concatenate([area, new])), free, sliders, weight
    ).run()


def _straight_corners(film: FilmPlane, layers: Pillowed, rim: Bools) -> Bools:
    # corners between two edges of a smooth rim are always straight, (n_quad, 4)
    single = (np.bincount(layers.quads.ravel(), minlength=len(rim)) == 1) & rim
    single[: film.mesh.n_node] &= ~film.corner
    return np.asarray(single[layers.quads])


def _rim_sliders(film: FilmPlane, layers: Pillowed, slides: Bools, x: Floats) -> list[Sliders]:
    sliders = []
    for piece in film.pieces:
        ids = piece.nodes
        knots = piece.curve.knots[: len(ids)]
        old = slides[ids]
        sides = set(zip(ids.tolist(), np.roll(ids, -1).tolist(), strict=True))
        new = [
            copy
            for copy, neighbour in layers.rim_neighbour.items()
            if {(int(layers.parent[copy]), neighbour), (neighbour, int(layers.parent[copy]))}
            & sides
        ]
        nodes = np.concatenate([ids[old], np.array(new, dtype=np.int64)])
        u = np.concatenate([knots[old], piece.curve.nearest(x[new])]) if new else knots[old]
        if len(nodes):
            sliders.append(Sliders(nodes, piece.curve, u))
    return sliders


def _check(film: FilmPlane, layers: Pillowed, x: Floats) -> None:
    at = x[layers.quads]
    p, q = np.roll(at, -1, axis=1) - at, np.roll(at, 1, axis=1) - at
    inverted = ((p[..., 0] * q[..., 1] - p[..., 1] * q[..., 0]) <= 0.0).any(axis=1)
    if inverted.any():
        e = int(np.flatnonzero(inverted)[0])
        raise ImprintError(
            f"quads around the path must become convex, got {int(inverted.sum())} that did not, "
            f"the first at {film.place(at[e].mean(axis=0))}; refine the mesh there, or move named "
            "sets, corners and pre-cracks away from the path"
        )


def _set_notes(film: FilmPlane, moved: Ints) -> list[str]:
    notes = []
    pinned = moved[film.pinned[moved]]
    for name, members in film.mesh.node_sets.items():
        hit = np.intersect1d(pinned, members)
        if len(hit):
            notes.append(f"node set {name!r}: nodes {some(hit.tolist())} were moved onto the path")
    return notes
