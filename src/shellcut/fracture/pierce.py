"""Where a cut begins in film that no crack has reached.

*On its face.* A tooth that comes down in the middle of the sheet presses it by its contact points.
The film parts under a tip, or the lowest place of an arc, once all that presses it there carries
F_p (:mod:`.puncture`) for longer than impacts last (:mod:`.pressing_tips`): points of the tool and
nodes within the bending length L, and of an arc all its points within the width of the contact and
an edge length, between which the mesh shares the force. Where the edge is straight, the film parts
along it once the mean membrane stress across it reaches the strength in the quad under it. Of an
arc so flat that its F_m exceeds F_s the one or the other; one that the contact is wider than is
straight. The force on a tip does not depend on the mesh, which the stress under it does.

*At its rim,* or at the flank of another cut, an edge cuts what it goes through: nothing there holds
the film against it. So it does everywhere if the tool's points do not press.

The quad is cut along the trace of the mid-plane of the blade: a short crack with a closed tip at
either end. Film at a flank is left alone; a blade that crosses an earlier cut begins anew in the
row behind it.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np

from shellcut.arrays import Bools, Floats, Ints, Vec3, norm, product, unit
from shellcut.contact.contact_tables import TOUCHING, ToolPoints
from shellcut.contact.near_nodes import NearNodes, in_box
from shellcut.contact.sheet_contact import PointContact
from shellcut.mitc4.shell import MITC4Shell
from shellcut.numerics.bilinear import shape_functions
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.held_table import Holder
from shellcut.numerics.jit import BoundOnce, inline, kernel
from shellcut.numerics.vec3 import add, combine, cross, dot, load, scale, sub
from shellcut.numerics.vec3 import norm as length
from shellcut.state import State
from shellcut.state.tables import local_edge_length
from shellcut.tool.cutting_edge import (
    BACK,
    NORMAL,
    START,
    VECTOR,
    CuttingEdges,
    segment_part,
)
from shellcut.tool.motion import Motion
from shellcut.tool.pose import Pose, to_body, turn
from shellcut.tool.tool import Tool

from .blade_drive import BladeDrive
from .crack_path import NEAR, CrackPath
from .open_edges import boundary_edges
from .pressing_tips import PressingTips
from .puncture import Puncture, edge_bluntness
from .quad_polygon import (
    AWAY,
    WHOLE,
    Point,
    corner_at,
    onto_boundary,
    side_at,
)
from .ray_ahead import AT_POINT, KIND, PLACE, Aimed, at, through
from .rows_ahead import RowsAhead, table_of
from .tip import Segment, Tip

# A quad is left alone that is nearer to a tip than this, in local edge lengths: the edge drives it.
_NEAR_A_TIP = 2.0

# Sine of the angle to the film up to which an edge lies on it, and enters over no rim.
_FLAT = 0.1

# Cosine of the angle between forces that press the film the same way.
_SAME_WAY = 0.5

# Edge lengths from a tip that faces the film within which an edge has not come over a rim.
_JUST_THERE = 0.1

# Of the parametric square: a ray from there leaves a quad by two sides.
_INNER = 0.75

# Part of its direction that counts in where an edge goes.
_ALONG = 1e-6

# Rows that are looked at, a tooth.
_CANDIDATES = 4


class Begun(NamedTuple):
    """Where a cut begins."""

    row: int
    place: Point
    segment: int
    """Of the cutting edge."""
    measure: float
    """Force or stress over what the film carries on its face, 0 at a rim."""
    force: float = 0.0
    """On the cutting edge, where it presses on the face [N]."""
    delay: float = 0.0
    """Of the mean force on a tip, see :mod:`.pressing_tips`."""


class PlaceLimits(NamedTuple):
    """What the film carries under each point of the tool."""

    force: Floats
    """F_p, inf where the edge is straight, shape (n_of_tool,) [N]."""
    lies: Bools
    """Whether the edge lies on the film over more than L there, shape (n_of_tool,)."""
    width: Floats
    """Of the contact of an arc at F_p, 0 at a tip, shape (n_of_tool,) [mm]."""


class PierceLimits(NamedTuple):
    """What whole film carries."""

    puncture: Puncture
    """Under a tip."""
    strength: float
    """Along an edge [MPa]."""
    own: float | None = None
    """The user's own force of a tip, in place of F_p [N]."""

    def at_points(self, points: ToolPoints, tool: Tool) -> PlaceLimits:
        """Return what it carries under the points of a tool."""
        film, edge_radius = self.puncture, tool.edge_radius
        length = norm(tool.vertices[tool.edges[:, 1]] - tool.vertices[tool.edges[:, 0]])
        longest = np.bincount(tool.edge_chain, length)[tool.edge_chain[points.segment]]
        with np.errstate(invalid="ignore"):
            width = 2.0 * film.slope * points.radius
        tip = (points.segment >= 0) & (width < longest)
        force = np.full(len(width), np.inf)
        lies = ~tip
        for k in np.flatnonzero(tip).tolist():
            rho = edge_bluntness(float(points.radius[k]), edge_radius)
            force[k] = film.force(rho) if self.own is None else self.own
            lies[k] = self.own is None and points.radius[k] > 0.0 and film.blunt * rho > film.sharp
        return PlaceLimits(force, lies, np.where(tip, width, 0.0))


class Pierce:
    """Finds whole quads in which a cutting edge begins a cut.

    Parameters
    ----------
    state : State
        At the start.
    path, drive : CrackPath, BladeDrive
        Where cracks go, and where edges do.
    shell : MITC4Shell
        The film.
    limits : PierceLimits
        What the film carries on its face.
    points : PointContact, optional
        By which the tool presses on the film.
    tool, motion : Tool, Motion
        Whose cutting edges these are, and how they move.
    """

    def __init__(
        self,
        state: State,
        path: CrackPath,
        drive: BladeDrive,
        shell: MITC4Shell,
        limits: PierceLimits,
        points: PointContact | None,
        tool: Tool,
        motion: Motion,
    ) -> None:
        self._path, self._drive, self._shell, self._points = path, drive, shell, points
        self._chain = chain = tool.edge_chain
        self._limits = limits
        self._places: PlaceLimits | None = None
        self._tips: PressingTips | None = None
        if points is not None:
            self._places = limits.at_points(points.points, tool)
            self._tips = PressingTips(points, motion, self._places.force, limits.puncture.impedance)
        size = float(np.sqrt(shell.area.max()))
        self._at_rim, self._open = np.unique(boundary_edges(state)), np.zeros(0, np.bool_)
        self._edges = edges = drive.edges
        quad = table_of(state, path, [(0, (0.0, 0.0))], [()])  # of any whole quad
        start = edges.segments[:, START]
        both = np.stack([start, start + edges.segments[:, VECTOR]], axis=1)
        ends = [both[chain == c] for c in range(int(chain.max()) + 1)]
        self._low = np.array([one.min(axis=(0, 1)) - size for one in ends])
        self._high = np.array([one.max(axis=(0, 1)) + size for one in ends])
        n_most = len(ends) * _CANDIDATES
        self._row, self._segment = np.full(n_most, -1), np.full(n_most, -1)
        self._place = np.zeros((n_most, 2))
        self._rows = self._first = np.zeros(0, np.int64)
        self._near = NearNodes(self._low, self._high, size)
        self._held = Holder()(edges), Holder()(quad), Holder()(Aimed.of(2))
        self._find = BoundOnce(_pierced)

    def found(self, state: State, pose: Pose, tips: Floats) -> list[Begun]:
        """Return where cuts begin, in whole rows.

        Parameters
        ----------
        state : State
            Present positions.
        pose : Pose
            Of the tool.
        tips : ndarray, shape (n, 3)
            Where the cracks end that an edge drives [mm].
        """
        entered = self._entered(state, pose, tips)
        if entered and (on := self._tips_on_face(pose)):
            entered = [one for one in entered if not self._lies_on(state, one, on)]
        return [*self._pressed(state, pose, tips), *entered]

    def _tips_on_face(self, pose: Pose) -> list[tuple[int, Floats, bool]]:
        """Return tips of the cutting edges that are on the face of the film.

        The chain of each, where it is, and whether it presses.
        """
        if self._points is None or self._places is None:
            return []
        on, point = self._points.points, self._points.point_of_sheet()
        is_tip = np.isfinite(self._places.force[point])
        pressing = self._points.carriers.pressure > 0.0
        sheets = np.flatnonzero(is_tip & (pressing | self._points.knows_side()))
        chains = self._chain[on.segment[point[sheets]]].tolist()
        places = pose.to_space(on.place[point[sheets]])
        return list(zip(chains, places, pressing[sheets].tolist(), strict=True))

    def _lies_on(self, state: State, begun: Begun, on: list[tuple[int, Floats, bool]]) -> bool:
        """Return whether a tip of an edge is still on the face near a place.

        Within an edge length if it presses. Else it is there if it has just come to the face: a tip
        in the film's plane is above or below it by round-off, or by what it moves in a step.
        """
        here = self._path.place_in(state, begun.row, begun.place).x
        near, chain = math.sqrt(self._shell.area[begun.row]), self._chain[begun.segment]
        return any(
            c == chain and norm(at - here) < (near if pressing else _JUST_THERE * near)
            for c, at, pressing in on
        )

    def _pressed(self, state: State, pose: Pose, tips: Floats) -> Iterator[Begun]:
        """Yield where a tip or an edge on the face of the film has reached what this carries."""
        points, limits, means = self._points, self._places, self._tips
        if points is None or limits is None or means is None:
            return
        loads = _Loads.on_tips(points, limits, self._limits.puncture.length, state, pose)
        means.follow(state, pose, loads)
        if not points.touch.sums[TOUCHING]:
            return
        on, (node, weight, _, _, force, _) = points.points, points.carriers
        point = points.point_of_sheet()
        pressing = np.flatnonzero((force > 0.0) & (on.segment[point] >= 0))
        chain = self._chain[on.segment[point[pressing]]]
        for i, edge in zip(pressing.tolist(), chain.tolist(), strict=True):
            k = int(point[i])
            there = state.node.quads[node[i, 0], : state.node.n_quad_at[node[i, 0]]]
            rows = there[(state.quads[there] == node[i]).all(axis=1)].tolist()
            if not rows:  # it has been cut since it was pressed
                continue
            row, segment = rows[0], int(on.segment[k])
            measure = delay = impact = 0.0
            here = product(weight[i], state.node.x[node[i]])
            size = math.sqrt(self._shell.area[row])
            if (norm(tips - here) < _NEAR_A_TIP * size).any():
                continue
            if limits.force[k] < np.inf:
                measure, delay = means.mean(k) / limits.force[k], means.delay(k)
                impact = loads.get(i, 0.0) - means.mean(k)
            if limits.lies[k]:
                across = self._across(state, pose, row, segment) / self._limits.strength
                if across > measure:
                    measure, delay, impact = across, 0.0, 0.0
            if measure >= 1.0:
                w = weight[i]
                place = 2.0 * float(w[1] + w[2]) - 1.0, 2.0 * float(w[2] + w[3]) - 1.0
                carried = float(force[pressing[chain == edge]].sum() - impact)
                yield Begun(row, place, segment, float(measure), carried, delay)

    def _across(self, state: State, pose: Pose, row: int, segment: int) -> float:
        """Return the mean membrane stress across an edge in a row [MPa]."""
        nodes = state.quads[row]
        t = unit(state.node.t[nodes].sum(axis=0))
        normal = product(pose.rotation, self._edges.segments[segment, NORMAL])
        way = unit(normal - product(normal, t) * t)
        stress = self._shell.stress(state, np.array([row]), place="nominal")[0]
        return float(product(product(stress, way), way))

    def _entered(self, state: State, pose: Pose, tips: Floats) -> list[Begun]:
        """Return where an edge goes through film that nothing holds against it.

        The edge runs between the flanks of its own cut: rows at a flank are left out, and those
        that its mid-plane would not part.
        """
        if self._near.renew(state, pose):
            self._list(state)
        row, segment, place = self._row, self._segment, self._place
        edges, quad, chord = self._held
        n_found = self._find(
            state.node.x,
            state.node.t,
            state.quads,
            self._rows,
            self._first,
            self._shell.area,
            tips,
            pose,
            edges,
            self._chain,
            self._low,
            self._high,
            quad,
            chord,
            row,
            segment,
            place,
        )
        return [
            Begun(int(row[k]), (float(place[k, 0]), float(place[k, 1])), int(segment[k]), 0.0)
            for k in range(n_found)
        ]

    def ways(
        self, state: State, begun: Begun, tips: Sequence[Tip]
    ) -> Iterator[tuple[Segment, Segment]]:
        """Yield segments from a place in a row to where an edge was and to where it will be.

        First those that lead to where an oncoming crack ends, if there are any. From a place on the
        boundary of rows one of the segments is that place itself, where the cut ends. Cracks along
        sides only, and those begun so near a side that both ways lead to it, follow the nearest
        one.

        tips : of all cracks.
        """
        row, place, edge, measure, *_ = begun
        way, sides_only = self._way(state, row, place, edge), self._path.sides_only
        if not sides_only:
            ends = (self._towards(state, row, place, edge, tips, end) for end in (-1.0, 1.0))
            for back, ahead in itertools.product(*ends):
                if measure or self._leads_out(state, back):
                    yield back, ahead
        around = self._around(state, row, place) if measure else []
        if not sides_only:
            for at in around:
                start = Segment(*at, at[1], side_at(at[1]), corner_at(at[1]))
                for ahead in self._towards(state, *at, edge, tips, 1.0):
                    yield start, ahead
                for back in self._towards(state, *at, edge, tips, -1.0):
                    yield back, start
        if measure or sides_only:
            within = np.inf if measure and sides_only else NEAR
            for at in [(row, place), *around]:
                side = self._path.side_near(state, *at, *way, within)
                if side is not None and (measure or self._leads_out(state, side.reversed())):
                    yield side.reversed(), side
        if measure and not sides_only:  # beside a side that cannot be broken, at the rim
            for at_row, (xi, eta) in [(row, place), *around]:
                inner = min(max(xi, -_INNER), _INNER), min(max(eta, -_INNER), _INNER)
                both = (self._towards(state, at_row, inner, edge, tips, end) for end in (-1.0, 1.0))
                yield from itertools.product(*both)

    def _around(self, state: State, row: int, place: Point) -> list[tuple[int, Point]]:
        """Return the whole rows that touch a place on the boundary of one, and where it is in each.

        A ray from there leads through one of them and the opposite one through another.
        """
        on = self._path.rows_at(self._path.topology.parent(row), onto_boundary(place))
        return [
            at
            for at in on
            if self._path.topology.polygon(at[0]) == WHOLE
            and not state.node.halved[state.quads[at[0]]].any()
        ]

    def _leads_out(self, state: State, back: Segment) -> bool:
        """Return whether an edge has come into a row over the rim, or over a flank next to it."""
        side = (back.side, (back.side + 1) % 4) if back.corner < 0 else (back.corner,)
        return bool(self._open[state.quads[back.row, list(side)]].all())

    def _towards(
        self,
        state: State,
        row: int,
        place: Point,
        edge: int,
        tips: Sequence[Tip],
        reach: float,
    ) -> list[Segment]:
        way, lean = self._way(state, row, place, edge, reach)
        segment = self._path.segment(state, row, place, way, lean)
        if segment is None:
            return []
        gap = np.array(shape_functions(*segment.exit)) - np.array(shape_functions(*place))
        heading = product(gap, state.node.X[state.quads[row]])
        ends = self._path.oncoming(row, place, unit(heading), tips)
        joined = self._path.segment(state, row, place, way, lean, ends) if ends else None
        return [segment] if joined is None else [joined, segment]

    def _way(
        self, state: State, row: int, place: Point, edge: int, reach: float = 1.0
    ) -> tuple[Floats, Floats]:
        """Return the direction to where an edge will be from a place, or was, and its lean, (3,).

        reach : as of :meth:`.BladeDrive.find`.
        """
        at, size = self._path.place_in(state, row, place), np.array([self._path.size(row)])
        then = self._drive.find(at.x[None], size, state.time, edge, reach)
        # Of an edge that lies on the film, whose back is upright, its direction decides.
        back = self._edges.segments[edge, BACK] + _ALONG * unit(self._edges.segments[edge, VECTOR])
        heading = product(then.rotation[0], back) * -reach
        self._drive.direct(at.t[None], heading[None], at.T[None], size)
        return then.ways[0, 0], then.lean[0]

    def saved(self) -> dict[str, Any]:
        """Return the list of nodes near the edges, and the forces on tips."""
        tips = {} if self._tips is None else self._tips.saved()
        return {"near": self._near.saved(), "tips": tips}

    def restore(self, state: State, saved: dict[str, Any]) -> None:
        """Take over :meth:`saved`, a list of the nodes of ``state``."""
        self._near.restore(state, saved["near"])
        if self._tips is not None:
            self._tips.restore(saved["tips"])
        self._list(state)

    def _list(self, state: State) -> None:
        """List the whole rows near the tool without a node at a flank, by their first nodes.

        Those at the rim and next to rows at a flank; all of them if the tool's points do not press.
        """
        quads, near = state.quads, np.zeros(state.n_node, np.bool_)
        near[self._near.ids] = True
        at_flank = state.node.halved[quads].any(axis=1)
        may = near[quads[:, 0]] & (state.quad.share[: state.n_quad] >= 1.0) & ~at_flank
        self._open = np.full(state.n_node, self._points is None)
        self._open[self._at_rim] = self._open[quads[at_flank]] = True
        may &= self._open[quads].any(axis=1)
        self._rows = np.flatnonzero(may)
        self._first = quads[self._rows, 0].astype(np.int64)


class _Loads(NamedTuple):
    """All that presses on the film at its points, and at its nodes."""

    sheet: Ints
    """Row among the carriers of points, -1 of a node, shape (n_load,)."""
    place: Floats
    """In the body frame, shape (n_load, 3) [mm]."""
    normal: Floats
    """Direction on the film, likewise, shape (n_load, 3)."""
    arc: Ints
    """Of a cutting edge, -1 for none, shape (n_load,)."""
    force: Floats
    """Shape (n_load,) [N]."""

    @classmethod
    def of(cls, points: PointContact, state: State, pose: Pose) -> _Loads:
        """Return those of the last evaluation."""
        on, nodes = points.carriers, points.nodes.carriers
        sheets, pressed = np.flatnonzero(on.pressure > 0.0), np.flatnonzero(nodes.pressure > 0.0)
        point = points.point_of_sheet()[sheets]
        at_nodes = pose.to_body(state.node.x[nodes.node[pressed, 0]])
        none = np.full(len(pressed), -1)
        return cls(
            np.concatenate([sheets, none]),
            np.concatenate([points.points.place[point], at_nodes]),
            np.concatenate([on.normal[sheets], nodes.normal[pressed]]),
            np.concatenate([points.points.arc[point], none]),
            np.concatenate([on.pressure[sheets], nodes.pressure[pressed]]),
        )

    @classmethod
    def on_tips(
        cls, points: PointContact, limits: PlaceLimits, length: float, state: State, pose: Pose
    ) -> dict[int, float]:
        """Return what presses on each place of a tip or an arc [N], by its row among the carriers.

        length : L of the film [mm].
        """
        on, point = points.points, points.point_of_sheet()
        is_tip = np.isfinite(limits.force[point])
        sheets = np.flatnonzero(is_tip & (points.carriers.pressure > 0.0)).tolist()
        if not sheets:
            return {}
        loads, found = cls.of(points, state, pose), {}
        for sheet in sheets:
            k = int(point[sheet])
            area = state.node.contact_area[points.carriers.node[sheet]].mean()
            wide = limits.width[k] + local_edge_length(float(area)) if on.radius[k] > 0.0 else 0.0
            found[sheet] = loads.near(sheet, length, wide)
        return found

    def near(self, sheet: int, length: float, wide: float) -> float:
        """Return what presses the film the same way within a length of a point [N].

        Of the points of its own arc within ``wide``, too [mm].
        """
        own = int(np.flatnonzero(self.sheet == sheet)[0])
        gap = norm(self.place - self.place[own])
        of_arc = (self.arc >= 0) & (self.arc == self.arc[own]) & (gap <= wide)
        alike = product(self.normal, self.normal[own]) > _SAME_WAY
        return float(self.force[alike & ((gap <= length) | of_arc)].sum())


@inline
def _weights(start: Vec3, end: Vec3, a: Vec3, b: Vec3, c: Vec3) -> tuple[bool, float, float]:
    """Return whether a segment goes through a triangle, and the weights of b and c there."""
    normal, vector = cross(sub(b, a), sub(c, a)), sub(end, start)
    d0, d1 = dot(sub(start, a), normal), dot(sub(end, a), normal)
    area, rise = dot(normal, normal), d0 - d1
    if d0 * d1 >= 0.0 or rise * rise < _FLAT * _FLAT * area * dot(vector, vector):
        return False, 0.0, 0.0
    p = combine(1.0, start, d0 / rise, vector)
    w_b = dot(cross(sub(a, c), sub(p, c)), normal) / area
    w_c = dot(cross(sub(b, a), sub(p, a)), normal) / area
    return w_b >= 0.0 and w_c >= 0.0 and w_b + w_c <= 1.0, w_b, w_c


@inline
def parts_quad(
    quad: RowsAhead,
    chord: Aimed,
    x: Floats,
    t: Floats,
    quads: Ints,
    e: int,
    xi: float,
    eta: float,
    normal: Vec3,
    size: float,
) -> bool:
    """Return whether the trace of a plane at a place of quad e leaves it by two sides.

    Or by both corners of one side, which is broken then.

    quad, chord : tables of one row and two rays, written.  x, t : (n_node, 3).  quads :
    (n_quad, 4).  normal : of the plane.  size : edge length [mm].
    """
    if quad.sides_only or abs(xi) > 1.0 - 2.0 * AWAY or abs(eta) > 1.0 - 2.0 * AWAY:
        return True  # on a side to within round-off: the rules themselves decide
    quad.size[0], quad.entry[0, 0], quad.entry[0, 1] = size, xi, eta
    for a in range(4):
        quad.nodes[0, a] = quads[e, a]
    upright = (0.0, 0.0, 0.0)
    trace = cross(at(quad, 0, xi, eta, t), normal)
    trace = scale(1.0 / length(trace), trace)
    for i in range(2):
        way = scale(2.0 * i - 1.0, trace)
        if not through(quad, 0, i, x, t, way, upright, False, chord):
            return False
    together = False
    for side in range(4):
        together = together or (_is_on(chord, 0, side) and _is_on(chord, 1, side))
    at_corners = chord.way[0, KIND] == AT_POINT and chord.way[1, KIND] == AT_POINT
    return not together or (at_corners and chord.way[0, PLACE] != chord.way[1, PLACE])


@inline
def _is_on(chord: Aimed, i: int, side: int) -> bool:
    """Return whether a ray ends on a side of a whole quad."""
    end: int = chord.way[i, PLACE]
    return end == side or (bool(chord.way[i, KIND] == AT_POINT) and end == (side + 1) % 4)


@kernel
def _pierced(
    x: Floats,
    t: Floats,
    quads: Ints,
    whole: Ints,
    first: Ints,
    area: Floats,
    tips: Floats,
    pose: Pose,
    edges: CuttingEdges,
    chain: Ints,
    low: Floats,
    high: Floats,
    quad: RowsAhead,
    chord: Aimed,
    row: Ints,
    segment: Ints,
    place: Floats,
) -> int:
    """Write the rows that edges go through, their segments and the places in them; return how many.

    whole, first : (n,), rows and their first nodes.  chain : (n_edge,), of each segment.  low,
    high : (n_chain, 3), boxes around the chains.  quad, chord : tables of one row and two rays,
    written.  row, segment : (n_most,).  place : (n_most, 2), xi and eta.
    """
    pose, edges = borrowed(pose), borrowed(edges)
    quad, chord = borrowed(quad), borrowed(chord)
    segments = edges.segments
    n_found = 0
    for i in range(whole.shape[0]):
        e, here, far = whole[i], load(x, first[i]), True
        for tip in range(tips.shape[0]):
            gap = sub(load(tips, tip), here)
            far = far and dot(gap, gap) > _NEAR_A_TIP**2 * area[e]
        if not far:
            continue
        corner = to_body(here, pose)
        for c in range(low.shape[0]):
            if not in_box(corner, low, high, c):
                continue
            second = to_body(load(x, quads[e, 1]), pose)
            third = to_body(load(x, quads[e, 2]), pose)
            fourth = to_body(load(x, quads[e, 3]), pose)
            for k in range(segments.shape[0]):
                if chain[k] != c or n_found == row.shape[0]:
                    continue
                start = segment_part(segments, k, START)
                end = add(start, segment_part(segments, k, VECTOR))
                hit, w1, w2 = _weights(start, end, corner, second, third)
                xi, eta = 2.0 * (w1 + w2) - 1.0, 2.0 * w2 - 1.0
                if not hit:
                    hit, w1, w2 = _weights(start, end, corner, third, fourth)
                    xi, eta = 2.0 * w1 - 1.0, 2.0 * (w1 + w2) - 1.0
                if not hit:
                    continue
                plane = turn(segment_part(segments, k, NORMAL), pose)
                if parts_quad(quad, chord, x, t, quads, e, xi, eta, plane, math.sqrt(area[e])):
                    row[n_found], segment[n_found] = e, k
                    place[n_found, 0], place[n_found, 1] = xi, eta
                    n_found += 1
    return n_found
