"""Coulomb friction where corners and edges of the tool press on quads of the film.

A point k of the tool that presses with N at its foot on a quad (:mod:`.point_contact`) is held
there by a spring across the pressure, as the nodes are on the tool's faces
(:mod:`.coulomb_friction`): u is its elongation in the tool's frame, d what the film at the foot has
moved against the tool in the step, P = 1 - n n^T,

    u* = P (u + d),    u' = u* min(1, mu N / (k_t |u*|)),    force on the film -k_t u',

handed to the quad's nodes by their shape functions at the foot, and minus that at the foot on the
tool. k_t is ``TANGENTIAL`` times the point's k_p. The spring follows the point: u is kept when the
foot slides from quad to quad.

*Works.* As the foot slides, shape functions and k_t change from step to step. The force f of
t_{n-1} has acted on the film at its own foot, which has moved by d_f, so

    dissipated = - ½ (f · d_f + f' · d) - (stored' - stored),

which is the mean force times the slip where the foot stays with the same film.
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

import numpy as np

from shellcut.arrays import Floats, Ints, Vec3
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.held_table import Holder
from shellcut.numerics.jit import BoundOnce, inline, kernel
from shellcut.numerics.vec3 import add, combine, cross, dot, load, norm, scale, store, sub
from shellcut.state import State
from shellcut.tool.pose import Pose, to_body, turn, turn_back
from shellcut.tool.touch import Touch

from .friction_term import TANGENTIAL, ToolFriction
from .point_contact import PointContact
from .point_tables import PointFilm, PointTables
from .settings import node_stiffness


class _Springs(NamedTuple):
    """Springs of the points; the kernel writes."""

    spring: Annotated[Floats, "(n_point, 3)"]
    """Elongation u in the tool's frame [mm]."""
    pull: Annotated[Floats, "(n_point, 3)"]
    """Force on the film in the tool's frame [N]."""
    force: Annotated[Floats, "(n_point, 3)"]
    """The same in space."""
    stored: Annotated[Floats, "(n_point,)"]
    """Energy [N·mm]."""
    node: Annotated[Ints, "(n_point, 4)"]
    """Nodes that the force acts on."""
    weight: Annotated[Floats, "(n_point, 4)"]
    """Their shape functions."""

    @classmethod
    def at_rest(cls, n: int) -> _Springs:
        return cls(
            spring=np.zeros((n, 3)),
            pull=np.zeros((n, 3)),
            force=np.zeros((n, 3)),
            stored=np.zeros(n),
            node=np.zeros((n, 4), np.int64),
            weight=np.zeros((n, 4)),
        )


class PointFriction(ToolFriction):
    """Friction of the tool's points, a :class:`shellcut.simulation.tool_terms.ToolTerm`.

    Parameters
    ----------
    points : PointContact
        Presses the points on the film; evaluated before this in every step.
    coefficient : float
        mu.
    """

    def __init__(self, points: PointContact, coefficient: float) -> None:
        super().__init__("point_friction", points, coefficient)
        self._points = points
        self._take(_Springs.at_rest(len(points.points.place)))
        self._pose: Pose | None = None
        self._call = BoundOnce(_add_point_friction)

    def add_forces(self, state: State, pose: Pose) -> None:
        """Add the friction at t_n to the nodal forces, with the tool at the given pose."""
        before, self._pose = self._pose or pose, pose
        quiet = self._is_quiet()
        if quiet and self._rests:
            return
        self._call.code(
            pose, before, state.dt, self.coefficient, self._points.tables, self._held, self._touch
        )
        self._rests = quiet

    def saved(self) -> dict[str, Any]:
        """Return the springs and the last forces."""
        return {"springs": self._springs._asdict(), "touch": self.touch._asdict()}

    def restore(self, _state: State, pose: Pose, saved: dict[str, Any]) -> None:
        """Take over :meth:`saved`, with the tool at its present pose; after the points'."""
        self._pose = pose
        self._take(_Springs(**{name: rows.copy() for name, rows in saved["springs"].items()}))
        self.touch.take(saved["touch"])
        self._rests = False

    def _take(self, springs: _Springs) -> None:
        self._springs, self._held = springs, Holder()(springs)


@inline
def _way_of_foot(
    k: int, node: Ints, weight: Floats, film: PointFilm, dt: float, pose: Pose, before: Pose
) -> tuple[Vec3, Vec3, Vec3]:
    """Return where a foot is, its velocity, and its way against the tool in the tool's frame."""
    s, moves = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for c in range(4):
        n, share = node[k, c], weight[k, c]
        s = combine(1.0, s, share, load(film.x, n))
        moves = combine(1.0, moves, share, load(film.velocity_half, n))
    return s, moves, sub(to_body(s, pose), to_body(combine(1.0, s, -dt, moves), before))


@kernel
def _add_point_friction(
    pose: Pose,
    before: Pose,
    dt: float,
    coefficient: float,
    tables: PointTables,
    springs: _Springs,
    touch: Touch,
) -> None:
    """Add the friction of the points to the forces of their nodes.

    Writes the springs and touch, see :class:`.friction_term.FrictionForces`.
    """
    pose, before, tables = borrowed(pose), borrowed(before), borrowed(tables)
    springs = borrowed(springs)
    wrench, sums = borrowed(touch)
    wrench[:] = 0.0
    points, presses, film, origin = tables.points, tables.springs, tables.film, pose.translation
    work = stored = dissipated = 0.0
    n_slipping = 0
    for k in range(springs.stored.shape[0]):
        pressed, old = load(presses.force, k), load(springs.force, k)
        pressure = norm(pressed)
        held = dot(old, old) > 0.0
        if pressure == 0.0 and not held:
            continue
        if held:
            _, moves, d = _way_of_foot(k, springs.node, springs.weight, film, dt, pose, before)
            work += 0.5 * dt * dot(old, moves)
            dissipated -= 0.5 * dot(load(springs.pull, k), d)
        dissipated += springs.stored[k]
        springs.stored[k] = 0.0
        new, pull, f = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        if pressure > 0.0:
            area = 0.0
            for c in range(4):
                springs.node[k, c], springs.weight[k, c] = presses.node[k, c], presses.weight[k, c]
                area += 0.25 * film.contact_area[presses.node[k, c]]
            s, moves, d = _way_of_foot(k, springs.node, springs.weight, film, dt, pose, before)
            stiffness = TANGENTIAL * points.share[k] * node_stiffness(area, tables.law)
            pulled = add(load(springs.spring, k), d)
            normal = turn_back(scale(1.0 / pressure, pressed), pose)
            new = combine(1.0, pulled, -dot(pulled, normal), normal)
            most, trial = coefficient * pressure, stiffness * norm(new)
            if trial > most:
                new = scale(most / trial, new)
                n_slipping += 1
            pull = scale(-stiffness, new)
            f = turn(pull, pose)
            springs.stored[k] = 0.5 * stiffness * dot(new, new)
            stored += springs.stored[k]
            work += 0.5 * dt * dot(f, moves)
            dissipated -= 0.5 * dot(pull, d) + springs.stored[k]
            body = points.body[k]
            moment = cross((s[0] - origin[0], s[1] - origin[1], s[2] - origin[2]), f)
            for c in range(3):
                for corner in range(4):
                    film.force[springs.node[k, corner], c] += springs.weight[k, corner] * f[c]
                wrench[body, c] -= f[c]
                wrench[body, 3 + c] -= moment[c]
        store(springs.spring, k, new)
        store(springs.pull, k, pull)
        store(springs.force, k, f)
    sums[0], sums[1], sums[2], sums[3] = work, dissipated, stored, n_slipping
