"""The motion of a film that its supports move, and the tool's motion as seen from it.

A cut knows only how tool and film move to each other. So whatever is per length, per angle or along
the motion uses :class:`SeenFromFilm`: it is the tool's motion in a frame in which the film rests
where its mesh lies. Where no support moves the film, the tool's own motion serves as it is.

The film moves as the rigid body that is nearest to its supported nodes: each supported axis of a
node counts once, so a clamp with more nodes counts more, and what the supported axes leave open
rests. With Q and q its pose, x = Q X + q, the least squares of the prescribed velocities at the
places Q X + q give its twist at any time, and this twist moves the pose on. It is integrated in
ticks of many steps by the midpoint rule, each tick with a twist of its own: exact for a constant
twist.

With R, r, w, v pose and twist of the tool and w_f, v_f the twist of the film, v_f that of q,

    R' = Q^T R,  r' = Q^T (r - q),  w' = Q^T (w - w_f),  v' = Q^T (v - v_f - w_f x (r - q)).
"""

from __future__ import annotations

from collections.abc import Sequence
from math import sin
from typing import Any, NamedTuple

import numpy as np

from shellcut.arrays import Floats, Ints, norm, product
from shellcut.arrays import cross as row_cross
from shellcut.numerics.jit import BoundOnce, kernel
from shellcut.numerics.small_matrices import symmetric_eigen
from shellcut.numerics.vec3 import add, add_scaled, combine, cross, scale, store
from shellcut.numerics.vec3 import norm as norm_of
from shellcut.state import State
from shellcut.tool.motion import Motion
from shellcut.tool.pose import Pose
from shellcut.tool.pose_of_motion import pose_at

from .supports import Rate, SupportSet

# Of the largest prescribed velocity.
_ROUND_OFF = 1e-12
# Of the largest eigenvalue: below it the supported axes leave a motion open.
_DETERMINED = 1e-9
# Steps of the run at its start in a tick.
_STEPS = 32
# Below this [rad] a turn uses series, whose next term is below 1e-17.
_SMALL_ANGLE = 1e-4
# Parts of the largest prescribed velocity that supported nodes may differ by from those of a rigid
# film: far above what a tick leaves, far below any stretch that moves a film to a tool.
_RIGID = 1e-3
# Instants at which that is tested.
_N_INSTANT = 64


class FilmMotion:
    """The rigid motion of a film by its supports, from the start of a run on.

    Parameters
    ----------
    supports : SupportSet
        Some of which move positions.
    state : State
        After :meth:`SupportSet.initialise`.
    """

    def __init__(self, supports: SupportSet, state: State) -> None:
        self._rates: Sequence[tuple[Ints, int, Rate]] = supports.moved
        n = len(supports.directors)
        self._nodes, axes = np.nonzero(state.node.support[:n, :3])
        self._along, self._axes = np.eye(3)[axes], axes
        self._prescribed = np.zeros((n, 3))
        self._solved: tuple[Floats, _LeastSquares] | None = None
        self._move = BoundOnce(move)
        self._start(state.node.x[:n][self._nodes], 1.0)

    @classmethod
    def of(cls, supports: SupportSet, state: State) -> FilmMotion | None:
        """Return the motion of a film, None where no support moves positions."""
        return cls(supports, state) if supports.moved else None

    def begin(self, state: State, dt: float) -> None:
        """Start from where the supported nodes are; ``dt`` [s] is the length of the first step."""
        self._start(state.node.x[self._nodes].copy(), _STEPS * dt)

    def _start(self, places: Floats, tick: float) -> None:
        self._X, self.tick = places, tick
        self._solved = None
        self._poses = [Pose(np.eye(3), np.zeros(3))]
        self._twists: list[tuple[Floats, Floats]] = []

    def saved(self) -> dict[str, Any]:
        """Return where the supported nodes were at the start [mm], and the tick [s]."""
        return {"places": self._X, "tick": self.tick}

    def restore(self, saved: dict[str, Any]) -> None:
        """Take over :meth:`saved`."""
        self._start(np.array(saved["places"]), float(saved["tick"]))

    @property
    def extent(self) -> float:
        """Of the supported nodes at the start [mm]."""
        return float(norm(np.ptp(self._X, axis=0)))

    def pose(self, time: float) -> Pose:
        """Return Q and q [mm] at a time [s]: x = Q X + q."""
        k = max(int(time / self.tick), 0)
        while len(self._twists) <= k:
            pose, at = self._poses[-1], len(self._twists) * self.tick
            half = 0.5 * self.tick
            middle = self._moved(pose, *self._fit(at, pose)[:2], half)
            spin, velocity, _ = self._fit(at + half, middle)
            velocity = velocity + row_cross(spin, pose.translation - middle.translation)
            self._twists.append((spin, velocity))
            self._poses.append(self._moved(pose, spin, velocity, self.tick))
        return self._moved(self._poses[k], *self._twists[k], time - k * self.tick)

    def _moved(self, pose: Pose, spin: Floats, velocity: Floats, time: float) -> Pose:
        """Return a pose moved on by a constant twist."""
        after = np.empty((4, 3))
        self._move.code(pose, spin, velocity, time, after)
        return Pose(after[:3], after[3])

    def twist(self, time: float) -> tuple[Floats, Floats]:
        """Return the angular velocity [rad/s] and that of q [mm/s] at a time [s], (3,) each."""
        return self._fit(time, self.pose(time))[:2]

    def misfit(self, until: float) -> tuple[float, float]:
        """Return by how much supported nodes move otherwise than this motion, and how they move.

        The largest of each until then [s], in mm/s.
        """
        times = (np.arange(_N_INSTANT) + 0.5) / _N_INSTANT * until
        found = [self._fit(t, self.pose(t))[2] for t in times.tolist()]
        off, most = np.array(found).max(axis=0).tolist()
        return off, most

    def is_rigid(self, until: float) -> bool:
        """Whether the supports move the film as a whole until then [s]."""
        off, most = self.misfit(until)
        return off <= _RIGID * most

    def velocity_at(self, x: Floats, time: float) -> Floats:
        """Return the velocity of the film, were it rigid, at places (n, 3), shape (n, 3) [mm/s]."""
        spin, velocity = self.twist(time)
        return np.asarray(velocity + row_cross(spin, x - self.pose(time).translation))

    def kinetic(self, state: State, kinetic: float) -> float:
        """Return the kinetic energy as seen from the film [N·mm].

        kinetic : that in space, of translation and rotation [N·mm].
        """
        n, count = state.node, state.node.count
        spin = state.pace * self.twist(state.time)[0]
        u = state.pace * self.velocity_at(n.x[:count], state.time)
        t, mass = n.t[:count], n.mass[:count]
        turning = spin - product(t, spin)[:, None] * t  # a director has no spin about itself
        moved = np.einsum("ic,ic->i", u, 0.5 * u - n.velocity_half[:count])
        turned = np.einsum("ic,ic->i", turning, 0.5 * turning - n.spin_half[:count])
        return kinetic + float(product(mass, moved) + product(n.inertia[:count], turned))

    def _fit(self, time: float, pose: Pose) -> tuple[Floats, Floats, tuple[float, float]]:
        """Return spin, velocity of q, and the largest misfit and largest prescribed velocity."""
        rates = self._prescribed
        for ids, c, rate in self._rates:
            rates[ids, c] = rate(time)
        wanted = rates[self._nodes, self._axes]
        solved = self._least_squares(pose.rotation)
        found = product(solved.inverse, wanted)
        off = float(np.abs(product(solved.share, found) - wanted).max())
        # A spin of round-off is none: a film that does not turn keeps its least squares.
        turns = float(np.abs(found[3:]).max()) > _ROUND_OFF * float(np.abs(wanted).max())
        spin = found[3:] / solved.size if turns else np.zeros(3)
        place = product(pose.rotation, self._X.mean(axis=0)) + pose.translation
        velocity = found[:3] + row_cross(spin, pose.translation - place)
        return spin, velocity, (off, float(np.abs(wanted).max()))

    def _least_squares(self, rotation: Floats) -> _LeastSquares:
        """Return the least squares of the supported axes of a turned film; the last one is kept."""
        if self._solved is None or not np.array_equal(self._solved[0], rotation):
            arm = product(self._X - self._X.mean(axis=0), rotation.T)
            size = max(float(np.abs(arm).max()), np.finfo(float).tiny)
            # By axis: along . (velocity + spin x arm) = rate, the spin times the size.
            share = np.hstack([self._along, row_cross(arm / size, self._along)])
            squares, modes = symmetric_eigen(product(share.T, share))
            determined = squares > _DETERMINED * squares[-1]
            inverse = product(
                modes[:, determined] / squares[determined], product(modes[:, determined].T, share.T)
            )
            self._solved = rotation.copy(), _LeastSquares(share, inverse, size)
        return self._solved[1]


class _LeastSquares(NamedTuple):
    """Of the rates of supported axes, by the velocity of their middle and the spin times a size."""

    share: Floats
    """Of both in each rate, shape (n_axis, 6)."""
    inverse: Floats
    """Which gives them, what the axes leave open being zero, shape (6, n_axis)."""
    size: float
    """[mm]"""


class SeenFromFilm:
    """The motion of a tool as seen from a film that its supports move, a :class:`.Motion`.

    Parameters
    ----------
    film : FilmMotion
        Of the film.
    motion : Motion
        Of the tool in space.
    """

    def __init__(self, film: FilmMotion, motion: Motion) -> None:
        self._film, self._motion = film, motion

    def pose(self, time: float) -> Pose:
        """Return R' and r' [mm], with x' = R' X + r'."""
        (R, r), (Q, q) = pose_at(self._motion, time), self._film.pose(time)
        return Pose(product(Q.T, R), product(Q.T, r - q))

    def twist(self, time: float) -> tuple[Floats, Floats]:
        """Return the angular velocity [rad/s] and that of the body's origin [mm/s], (3,) each."""
        spin, velocity = (np.asarray(part, float) for part in self._motion.twist(time))
        arm = pose_at(self._motion, time).translation - self._film.pose(time).translation
        of_film, moving = self._film.twist(time)
        back = self._film.pose(time).rotation.T
        rate = velocity - moving - row_cross(of_film, arm)
        return product(back, spin - of_film), product(back, rate)


def in_film(film: FilmMotion | None, motion: Motion) -> Motion:
    """Return the motion of a tool as seen from a film.

    It is the tool's own where no support moves the film.
    """
    return motion if film is None else SeenFromFilm(film, motion)


@kernel
def move(before: Pose, spin: Floats, velocity: Floats, time: float, after: Floats) -> None:
    """Write a pose moved on by a constant twist: spin and velocity at its translation, (3,) each.

    after : (4, 3), rows of the rotation, then the translation.
    """
    a = scale(time, (spin[0], spin[1], spin[2]))
    angle = norm_of(a)
    if angle < _SMALL_ANGLE:
        s, k = 1.0 - angle * angle / 6.0, 0.5 - angle * angle / 24.0
        third = 1.0 / 6.0 - angle * angle / 120.0
    else:
        half = sin(0.5 * angle) / angle
        s, k = sin(angle) / angle, 2.0 * half * half
        third = (1.0 - s) / (angle * angle)
    R, r = before
    # Each axis b turns to exp(ã) b = b + s a x b + k a x (a x b). The shift is the integral of
    # exp(ã) velocity over the time.
    for c in range(3):
        b = R[0, c], R[1, c], R[2, c]
        across = cross(a, b)
        turned = add(b, combine(s, across, k, cross(a, across)))
        after[0, c], after[1, c], after[2, c] = turned
    v = velocity[0], velocity[1], velocity[2]
    across = cross(a, v)
    shift = add(v, combine(k, across, third, cross(a, across)))
    store(after, 3, add_scaled((r[0], r[1], r[2]), time, shift))
