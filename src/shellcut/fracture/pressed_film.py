"""Where a tip or an edge loads the face of whole film up to what it carries.

A tooth that comes down in the middle of the sheet presses it by its contact points. The film parts
under a tip, or the lowest place of an arc, once all that presses it there carries F_p
(:mod:`.puncture`) for longer than impacts last (:mod:`.pressing_tips`). Where the film is in
tension (:mod:`.film_tension`), F_p is smaller. On a tip press points of the tool and nodes within
the bending length L, and of an arc all its points within the width of the contact and an edge
length, between which the mesh shares the force; each on the film that it presses
(:mod:`.film_around`): of two layers each carries F_p. Where the edge is straight, the film parts
along it once the mean membrane stress across it reaches the strength in the quad under it. Of an
arc so flat that its F_m exceeds F_s the one or the other; one that the contact is wider than is
straight. The force on a tip does not depend on the mesh, which the stress under it does.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from shellcut.arrays import Floats, Ints, norm, product, unit
from shellcut.contact.press_term import TOUCHING
from shellcut.contact.sheet_contact import PointContact
from shellcut.mitc4.shell import MITC4Shell
from shellcut.numerics.kept import Kept
from shellcut.state import State
from shellcut.state.tables import local_edge_length
from shellcut.tool.cutting_edge import NORMAL, CuttingEdges
from shellcut.tool.motion import Motion
from shellcut.tool.pose import Pose
from shellcut.tool.tool import Tool

from .cut_film import CutFilm
from .film_tension import tension_around
from .own_cuts import OwnCuts
from .pressing_tips import Load, PressingTips
from .puncture import PierceLimits, PlaceLimits
from .tip import Begun, DrivenTips, Pierced

# Cosine of the angle between forces that press the film in the same direction.
_SAME_DIRECTION = 0.5

# L from the contact of a tip beyond which its own tension is that of a membrane.
_RING = 4.0

# Edge lengths from a tip that faces the film within which an edge has not crossed a border.
_JUST_THERE = 0.1


class PressedFilm(Kept):
    """Finds whole rows that a tool pierces on their face.

    Parameters
    ----------
    film : CutFilm
        How it is cut.
    shell : MITC4Shell
        Its stresses.
    edges : CuttingEdges
        Of the tool.
    limits : PierceLimits
        What the film carries on its face.
    points : PointContact
        By which the tool presses on the film.
    tool, motion : Tool, Motion
        Whose cutting edges these are, and how they move.
    own : OwnCuts
        Which edges are one blade.
    """

    kept_names = ("_means",)

    def __init__(
        self,
        film: CutFilm,
        shell: MITC4Shell,
        edges: CuttingEdges,
        limits: PierceLimits,
        points: PointContact,
        tool: Tool,
        motion: Motion,
        own: OwnCuts,
    ) -> None:
        self._own = own
        self._film, self._shell, self._edges, self._points = film, shell, edges, points
        self._chain, self._limits = tool.edge_chain, limits
        self._places: PlaceLimits = limits.at_points(points.points, tool)
        self._means = PressingTips(
            points, motion, film, self._places.force, limits.puncture.impedance
        )

    def flat_pressure(self) -> float:
        """Return the pressure up to which the film counts as flat at all tips [MPa].

        It is inf without tips, and where the user gives their force.
        """
        force = self._places.force[np.isfinite(self._places.force)]
        if not force.size or self._limits.own is not None:
            return np.inf
        return self._limits.puncture.pressure(float(force.max()))

    def pierced_rows(self, state: State, pose: Pose, tips: DrivenTips) -> list[Begun]:
        """Return where a tip or an edge on the face of the film has reached what this carries.

        tips : where the cracks end that an edge drives.
        """
        points, loads = self._points, dict[int, Load]()
        if touches := points.touch.sums[TOUCHING] > 0.0:
            loads = self._loads_on_tips(state, pose)
        self._means.follow(state, pose, loads)
        if not touches:
            return []
        on, force, point = points.points, points.carriers.pressure, points.point_of_sheet()
        pressing = np.flatnonzero((force > 0.0) & (on.segment[point] >= 0))
        chain = self._chain[on.segment[point[pressing]]]
        found = []
        for i, edge in zip(pressing.tolist(), chain.tolist(), strict=True):
            of_edge = float(force[pressing[chain == edge]].sum())
            begun = self._begun(state, pose, tips, i, of_edge, loads.get(i))
            if begun is not None:
                found.append(begun)
        return found

    def _begun(
        self, state: State, pose: Pose, tips: DrivenTips, i: int, of_edge: float, load: Load | None
    ) -> Begun | None:
        """Return where contact point i pierces whole film away from its tips, if it does.

        of_edge : force on the whole edge [N].  load : of a tip.
        """
        contact_points, k = self._points.carriers, int(self._points.point_of_sheet()[i])
        nodes, weights = contact_points.node[i], contact_points.weight[i]
        row, segment = _row_of(state, nodes), int(self._points.points.segment[k])
        if row < 0:
            return None
        here = product(weights, state.node.x[nodes])
        if self._own.at_own_tip(state, row, here, segment, tips):
            return None
        measure = delay = impact = 0.0
        if load is not None:
            mean = self._means.mean(i)
            measure, delay = mean / self._carried(state, row, here, i, mean), self._means.delay(i)
            impact = load.force - mean
        if self._places.lies[k]:
            across = self._across(state, pose, row, segment) / self._limits.strength
            if across > measure:
                measure, delay, impact = across, 0.0, 0.0
        if measure < 1.0:
            return None
        _, w1, w2, w3 = weights.tolist()
        place = 2.0 * (w1 + w2) - 1.0, 2.0 * (w2 + w3) - 1.0
        depth = self._film.depth_at(state, row, place)
        return Begun(row, place, segment, Pierced(float(measure), of_edge - impact, delay, depth))

    def largest_loads(self) -> Floats:
        """Return the largest force on tips and arcs of each cutting edge so far, over F_p."""
        of_edge = np.zeros(int(self._chain.max()) + 1)
        has_edge = self._points.points.segment >= 0
        chain = self._chain[self._points.points.segment[has_edge]]
        np.maximum.at(of_edge, chain, self._means.largest()[has_edge])
        return of_edge

    def not_on_face(self, state: State, pose: Pose, begun: Sequence[Begun]) -> list[Begun]:
        """Return those of some places near which no tip of their edge is still on the face.

        Within an edge length if it presses. Else it is there if it has just reached the face: a tip
        in the film's plane is above or below it by round-off, or by what it moves in a step.
        """
        if not begun:
            return []
        on, point = self._points.points, self._points.point_of_sheet()
        is_tip, tables = np.isfinite(self._places.force[point]), self._points.tables
        presses = self._points.carriers.pressure > 0.0
        tips = np.flatnonzero(is_tip & (presses | self._points.knows_side()))
        at, chain = pose.to_space(on.place[point[tips]]), self._chain[on.segment[point[tips]]]
        near = np.where(presses[tips], 1.0, _JUST_THERE)
        clear = []
        for start in begun:
            gap = norm(at - self._film.place_in(state, start.row, start.place).x)
            of_edge, size = chain == self._chain[start.segment], self._film.size(start.row)
            of_sheet = np.isin(tables.pairs.sheet_of_pair, tips[of_edge & (gap < near * size)])
            rows = tables.pairs.row[of_sheet]  # known also of a tip that does not press
            if not np.isin(rows, self._film.around(state, start.row, size)).any():
                clear.append(start)
        return clear

    def _loads_on_tips(self, state: State, pose: Pose) -> dict[int, Load]:
        """Return the load of each place of a tip or an arc, by its row of contact points.

        All that presses its film there in the same direction: points of the tool and nodes within
        the length L of the film, and points of its own arc within the width of the contact and an
        edge length.
        """
        points, limits, length = self._points, self._places, self._limits.puncture.length
        on, at_nodes, of = points.carriers, points.nodes.carriers, points.points
        sheets = np.flatnonzero(on.pressure > 0.0)
        point = points.point_of_sheet()[sheets]
        is_tip = np.isfinite(limits.force[point])
        if not is_tip.any():
            return {}
        pressed = np.flatnonzero(at_nodes.pressure > 0.0)
        node = at_nodes.node[pressed, 0]
        place = np.concatenate([of.place[point], pose.to_body(state.node.x[node])])
        normal = np.concatenate([on.normal[sheets], at_nodes.normal[pressed]])
        arc = np.concatenate([of.arc[point], np.full(len(pressed), -1)])
        force = np.concatenate([on.pressure[sheets], at_nodes.pressure[pressed]])
        carried_by = np.concatenate([on.node[sheets], np.repeat(node[:, None], 4, axis=1)])
        found = {}
        for i in np.flatnonzero(is_tip).tolist():
            sheet, k = int(sheets[i]), int(point[i])
            row = _row_of(state, on.node[sheet])
            if row < 0:
                continue
            area = state.node.contact_area[on.node[sheet]].mean()
            wide = limits.width[k] + local_edge_length(float(area)) if of.radius[k] > 0.0 else 0.0
            around = state.quads[self._film.around(state, row, max(length, float(wide)))]
            gap = norm(place - place[i])
            of_arc = (arc >= 0) & (arc == arc[i]) & (gap <= wide)
            alike = product(normal, normal[i]) > _SAME_DIRECTION
            alike &= np.isin(carried_by, around).all(axis=1)
            found[sheet] = Load(row, float(force[alike & ((gap <= length) | of_arc)].sum()))
        return found

    def _carried(self, state: State, row: int, here: Floats, i: int, mean: float) -> float:
        """Return the force that pierces a row under contact point i [N].

        here : place of the point, shape (3,) [mm].  mean : force on it [N]; one that pierces at no
        tension asks for none.
        """
        k, limits = int(self._points.point_of_sheet()[i]), self._limits
        force = float(self._places.force[k])
        least_force = limits.puncture.force_left(force, 1.0, 0.0)
        if limits.own is not None or mean < least_force or not self._means.is_due(i):
            return force
        ring = _RING * limits.puncture.length + float(self._places.width[k])
        most, least = tension_around(self._shell, state, row, here, ring)
        return limits.puncture.force_left(force, most / limits.strength, least / limits.strength)

    def _across(self, state: State, pose: Pose, row: int, segment: int) -> float:
        """Return the mean membrane stress across an edge in a row [MPa]."""
        nodes = state.quads[row]
        t = unit(state.node.t[nodes].sum(axis=0))
        normal = product(pose.rotation, self._edges.segments[segment, NORMAL])
        across = unit(normal - product(normal, t) * t)
        stress = self._shell.stress(state, np.array([row]), place="nominal")[0]
        return float(product(product(stress, across), across))


def _row_of(state: State, nodes: Ints) -> int:
    """Return the row with some corners, shape (4,); -1 if it has been cut since it was pressed."""
    there = state.node.quads[nodes[0], : state.node.n_quad_at[nodes[0]]]
    rows = there[(state.quads[there] == nodes).all(axis=1)].tolist()
    return rows[0] if rows else -1
