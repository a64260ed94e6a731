"""Find the stretches of a path inside the film, and check that the mesh has room for them.

A path may leave the film across the rim or a hole and come back; every stretch inside is a
*course*. An end of a course is *open* where the path crosses the rim, and *inner* where the path
ends inside the film. An inner end less than three edges from the rim ahead is extended straight to
the rim.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy

from shellcut.arrays import Bools, Floats

from .film_plane import FilmPlane, ImprintError
from .path_curve import PathCurve

# All in units of the local edge length. Measured on gmsh meshes, see docs/theory/imprint.md.
LEAST_RADIUS = 2.0
"""Radius of curvature a chain of edges can follow; on it an edge turns by 29 degrees."""

LEAST_RIM_DISTANCE = 0.9
"""Distance from the rim that leaves room for two rows of quads."""

LEAST_APART = 2.5
"""Distance between two stretches of path: each needs a row of quads, and one between them."""

LEAST_CORNER_DISTANCE = 0.75
"""Distance of a crossing from a corner of the rim, unless it goes right through it."""

LEAD_ON = 3.0
"""An inner end closer than this to the rim, straight ahead, is extended to the rim."""

SHORTEST = 4.0
"""Length of a course."""

LEAST_CROSSING = np.radians(35.0)
"""Angle between path and rim; below it the quads between them are slivers."""

_SAMPLES_AN_EDGE = 8
_MOST_SAMPLES = 40_000
_ON_PATH = 1e-6  # a corner this close to the path (in edge lengths) lies on it


@dataclass(frozen=True, eq=False)
class RimEnd:
    """Crossing of a course and the rim: a point of a piece on which nodes slide, or a corner."""

    piece: int | None
    """Row of ``FilmPlane.pieces``; None at a corner."""
    v: float
    """Parameter on the piece's curve [mm]."""
    corner: int | None
    """The node at the corner."""
    x: Floats
    """Position in the plane, shape (2,)."""


@dataclass(frozen=True, eq=False)
class Course:
    """A stretch of the path inside the film, from u = ``start`` to ``end`` of its curve."""

    curve: PathCurve
    """In the film's plane."""
    start: float
    end: float
    closed: bool
    """Whether the course is a whole closed curve."""
    rim_start: RimEnd | None
    """None for an inner end."""
    rim_end: RimEnd | None

    @property
    def length(self) -> float:
        """Length of the course [mm]."""
        return self.end - self.start

    def as_given(self) -> Course:
        """Return the course without extensions to the rim."""
        if self.curve.closed:
            return self
        return replace(self, start=max(self.start, 0.0), end=min(self.end, self.curve.length))

    def unrolled(self, u: Floats) -> Floats:
        """Return parameters of a closed curve shifted to be centred on the course."""
        if not self.curve.closed:
            return u
        middle = 0.5 * (self.start + self.end)
        turns: Floats = np.round((u - middle) / self.curve.length)
        return u - turns * self.curve.length


def find_courses(film: FilmPlane, curves: Sequence[PathCurve]) -> list[Course]:
    """Return the stretches of the curves inside the film.

    Parameters
    ----------
    film : FilmPlane
    curves : sequence of PathCurve
        In the film's plane.

    Raises
    ------
    ImprintError
        Names the position: a path outside the film, or one that crosses the rim too close to a
        corner or at too small an angle.
    """
    surroundings = Surroundings(film)
    courses = [course for curve in curves for course in surroundings.courses(curve)]
    if not courses:
        raise ImprintError(
            "the path must run through the film, got one that lies outside of it; check its "
            "position, and the units of mesh and path"
        )
    return courses


def check_room(film: FilmPlane, courses: Sequence[Course], beside: Sequence[Course] = ()) -> None:
    """Check that the mesh has room for the courses.

    Parameters
    ----------
    film : FilmPlane
    courses : sequence of Course
        Courses to be imprinted.
    beside : sequence of Course
        Courses along existing lines of edges; others must keep clear of them.

    Raises
    ------
    ImprintError
        Names the position: a path too close to the rim, to a pre-crack, to another path or to
        itself, too tightly curved or too short for the mesh.
    """
    surroundings = Surroundings(film)
    for course in courses:
        surroundings.check_length(course)
        surroundings.check(course)
    surroundings.check_apart(courses, beside)


class Surroundings:
    """A film prepared for queries about positions in it.

    Parameters
    ----------
    film : FilmPlane
    """

    def __init__(self, film: FilmPlane) -> None:
        self.film = film
        self.nodes = scipy.spatial.cKDTree(film.x)
        edges = film.mesh.edges()
        self.rim = edges.nodes[edges.n_quad == 1]
        self.spacing = float(np.median(film.edge_length)) / _SAMPLES_AN_EDGE
        a, b = film.x[self.rim[:, 0]], film.x[self.rim[:, 1]]
        t = np.linspace(0.0, 1.0, _SAMPLES_AN_EDGE, endpoint=False)[:, None, None]
        self.rim_points = scipy.spatial.cKDTree((a + t * (b - a)).reshape(-1, 2))

    def size(self, x: Floats) -> Floats:
        """Return the local edge length of the mesh at positions, (n,)."""
        return np.asarray(self.film.edge_length[self.nodes.query(x)[1]])

    def inside(self, x: Floats) -> Bools:
        """Return whether positions lie in the film, (n,)."""
        # even or odd crossings of a ray along the first axis; the flanks of a crack cancel
        odd = np.zeros(len(x), np.bool_)
        for i, j in self.rim.tolist():
            a, b = self.film.x[i], self.film.x[j]
            if a[1] == b[1]:
                continue
            spans = (a[1] > x[:, 1]) != (b[1] > x[:, 1])
            at = a[0] + (x[:, 1] - a[1]) * ((b[0] - a[0]) / (b[1] - a[1]))
            odd ^= spans & (x[:, 0] < at)
        return odd

    def courses(self, curve: PathCurve) -> list[Course]:
        """Return the stretches of one curve inside the film; see :func:`find_courses`."""
        spacing = max(self.spacing, curve.length / _MOST_SAMPLES)
        u, x = curve.samples(spacing)
        inside = self.inside(x)
        if inside.all() and curve.closed:
            return [Course(curve, 0.0, curve.length, True, None, None)]
        if not inside.any():
            return []
        found = []
        for first, last in _runs(inside, closed=curve.closed):
            start, rim_start = self._end(curve, u, inside, first, -1)
            end, rim_end = self._end(curve, u, inside, last, +1)
            if curve.closed and end <= start:
                end += curve.length
            found.append(Course(curve, start, end, False, rim_start, rim_end))
        return found

    def _end(
        self, curve: PathCurve, u: Floats, inside: Bools, k: int, sense: int
    ) -> tuple[float, RimEnd | None]:
        # follow the path from its last sample inside across the rim
        at = float(u[k])
        if curve.closed or 0 <= k + sense < len(u):
            return self._cross(curve, at, at + sense * (u[1] - u[0]))
        h = float(self.size(curve.point(at))[0])
        ahead = at + sense * np.linspace(0.0, LEAD_ON * h, 4 * _SAMPLES_AN_EDGE)
        outside = np.flatnonzero(~self.inside(curve.point(ahead)))
        if not len(outside):
            return at, None
        return self._cross(curve, float(ahead[outside[0] - 1]), float(ahead[outside[0]]))

    def _cross(self, curve: PathCurve, inner: float, outer: float) -> tuple[float, RimEnd]:
        # between the parameters `inner`, inside the film, and `outer` the path crosses the rim
        for _ in range(60):
            middle = 0.5 * (inner + outer)
            if self.inside(curve.point(middle))[0]:
                inner = middle
            else:
                outer = middle
        u = inner
        x = curve.point(u)[0]
        film = self.film
        h = float(self.size(x[None])[0])
        corners = np.flatnonzero(film.corner)
        if len(corners):
            near = corners[np.linalg.norm(film.x[corners] - x, axis=1).argmin()]
            distance = float(np.linalg.norm(film.x[near] - x))
            foot = float(curve.nearest(film.x[near : near + 1])[0])
            off = float(np.linalg.norm(curve.point(foot)[0] - film.x[near]))
            if off <= _ON_PATH * h:
                if curve.closed:
                    foot += curve.length * np.round((u - foot) / curve.length)
                return float(foot), RimEnd(None, 0.0, int(near), film.x[near])
            if distance < LEAST_CORNER_DISTANCE * h:
                raise ImprintError(
                    "a path must cross the rim right through a corner or "
                    f"{LEAST_CORNER_DISTANCE * h:.3g} mm from it, got {distance:.3g} mm at "
                    f"{film.place(x)} (corners are kinks of the rim, ends of named node sets and "
                    "pre-cracks); move the path or the corner"
                )
        piece, v, u = self._on_piece(curve, x, u)
        return u, RimEnd(piece, v, None, curve.point(u)[0])

    def _on_piece(self, curve: PathCurve, x: Floats, u: float) -> tuple[int, float, float]:
        # the crossing with the smooth rim, by Newton steps from that with its chords
        pieces = self.film.pieces
        if not pieces:
            raise ImprintError(
                f"a path must cross the rim where nodes may move, got {self.film.place(x)} where "
                "each is a corner; refine the rim"
            )
        best, v, distance = 0, 0.0, np.inf
        for k, piece in enumerate(pieces):
            at = float(piece.curve.nearest(x[None])[0])
            if not piece.curve.closed:  # straight on from it lies the next piece
                at = min(max(at, 0.0), piece.curve.length)
            d = float(np.linalg.norm(piece.curve.point(at)[0] - x))
            if d < distance:
                best, v, distance = k, at, d
        rim = pieces[best].curve
        for _ in range(8):
            gap = curve.point(u)[0] - rim.point(v)[0]
            slopes = np.stack([-curve.derivative(u)[0], rim.derivative(v)[0]], axis=1)
            step = np.linalg.lstsq(slopes, gap, rcond=None)[0]
            u, v = u + float(step[0]), v + float(step[1])
        cosine = float(curve.tangent(u)[0] @ rim.tangent(v)[0])
        if np.arccos(min(abs(cosine), 1.0)) < LEAST_CROSSING:
            raise ImprintError(
                f"a path must cross the rim at {np.degrees(LEAST_CROSSING):.0f} degrees at least, "
                f"got {np.degrees(np.arccos(min(abs(cosine), 1.0))):.0f} at {self.film.place(x)}; "
                "move it off the rim or across it"
            )
        return best, v, u

    def _samples(self, course: Course) -> Floats:
        n = max(8, int(np.ceil(course.length / self.spacing)))
        return np.linspace(course.start, course.end, min(n, _MOST_SAMPLES))

    def check_length(self, course: Course) -> None:
        """Check that a course is long enough for a chain of edges."""
        x = course.curve.point(self._samples(course))
        least = SHORTEST * float(self.size(x).mean())
        if course.length < least:
            raise ImprintError(
                f"a path must run through the film for {SHORTEST:g} edges at least, here "
                f"{least:.3g} mm, got {course.length:.3g} mm at "
                f"{self.film.place(x[len(x) // 2])}; refine the mesh or lengthen the path"
            )

    def check(self, course: Course) -> None:
        """Check that a course has room beside it, and does not bend too tightly."""
        u = self._samples(course)
        x = course.curve.point(u)
        h = self.size(x)
        film = self.film
        radius = 1.0 / np.maximum(course.curve.curvature(u), 1e-300)
        tight = radius / h
        if tight.min() < LEAST_RADIUS:
            k = int(tight.argmin())
            raise ImprintError(
                f"a path must not bend more tightly than {LEAST_RADIUS:g} edges, here "
                f"{LEAST_RADIUS * h[k]:.3g} mm, got a radius of {radius[k]:.3g} mm at "
                f"{film.place(x[k])}; refine the mesh there or smooth the path"
            )
        # near its own crossings a path may be close to the rim
        inner = np.ones(len(u), np.bool_)
        for end, at in ((course.rim_start, course.start), (course.rim_end, course.end)):
            if end is not None:
                inner &= np.abs(u - at) > 2.0 * h
        distance = self.rim_points.query(x)[0] / h
        distance[~inner] = np.inf
        if distance.min() < LEAST_RIM_DISTANCE:
            k = int(distance.argmin())
            raise ImprintError(
                f"a path must stay {LEAST_RIM_DISTANCE:g} edges off the rim, holes and pre-cracks, "
                f"here {LEAST_RIM_DISTANCE * h[k]:.3g} mm, got {distance[k] * h[k]:.3g} mm at "
                f"{film.place(x[k])}; refine the mesh between them, or cut a notch after the "
                "imprint, along the nodes of its chain"
            )

    def check_apart(self, courses: Sequence[Course], beside: Sequence[Course]) -> None:
        """Check that courses keep apart from each other, themselves and those beside."""
        places, along, which = [], [], []
        every = [*courses, *beside]
        for k, course in enumerate(every):
            n = max(8, int(np.ceil(4.0 * course.length / (self.spacing * _SAMPLES_AN_EDGE))))
            u = np.linspace(course.start, course.end, n + 1)[: n if course.closed else n + 1]
            places.append(course.curve.point(u))
            along.append(u)
            which.append(np.full(len(u), k))
        x, s, owner = (np.concatenate(a) for a in (places, along, which))
        h = self.size(x)
        pairs = scipy.spatial.cKDTree(x).query_pairs(
            LEAST_APART * float(h.max()), output_type="ndarray"
        )
        i, j = pairs[:, 0], pairs[:, 1]
        apart = np.linalg.norm(x[i] - x[j], axis=1) / np.minimum(h[i], h[j])
        gap = np.abs(s[i] - s[j])
        period = np.array([c.length if c.closed else np.inf for c in every])[owner[i]]
        gap = np.minimum(gap, period - gap) / np.minimum(h[i], h[j])
        # on the tightest bend allowed a chord of 2.5 edges spans an arc of 2.7
        clash = (apart < LEAST_APART) & ((owner[i] != owner[j]) | (gap > 1.5 * LEAST_APART))
        clash &= np.minimum(owner[i], owner[j]) < len(courses)
        if clash.any():
            k = int(np.flatnonzero(clash)[apart[clash].argmin()])
            a, b = (self.film.place(x[m]) for m in (i[k], j[k]))
            raise ImprintError(
                f"paths must keep {LEAST_APART:g} edges apart from each other and from "
                f"themselves and must not cross, got {a} and {b}; imprint one of them, or refine"
            )


def _runs(inside: Bools, *, closed: bool) -> list[tuple[int, int]]:
    # first and last sample of each stretch inside; on a closed curve one may pass the start
    n = len(inside)
    before = np.roll(inside, 1)
    after = np.roll(inside, -1)
    if not closed:
        before[0] = after[-1] = False
    first = np.flatnonzero(inside & ~before)
    last = np.flatnonzero(inside & ~after)
    if closed and last[0] < first[0]:
        last = np.roll(last, -1)
    assert len(first) == len(last) <= n
    return list(zip(first.tolist(), last.tolist(), strict=True))
