"""The coordinate over which a run gives what its tool has to overcome.

The forces of a cut depend on how its edges move through the film. The angle of a tool that mostly
moves straight, or the path of a body's origin far from the film, says nothing about that. So it is

==========================================  =====================================================
a motion with a coordinate of its own       that coordinate
a motion along a line                       the path along it
edges that turn about a fixed axis          the angle, if the turn is more than noise
edges that make a large turn in step with   the angle, as with measured poses of a cap
their path
all others                                  the path of the edges
==========================================  =====================================================
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from shellcut.arrays import Floats, cross, norm, product
from shellcut.checks.sweep import Sweep
from shellcut.tool.coordinate import Coordinate, HasCoordinate
from shellcut.tool.motion import Motion
from shellcut.tool.pose_of_motion import pose_at
from shellcut.tool.screw_axis import AT_REST, N_INSTANT, Axis, Line

if TYPE_CHECKING:
    from shellcut.simulation.simulation import Simulation

# Turn [rad] below which it is noise: a straight tool whose angle is measured, a film that is
# sheared.
_LEAST = np.radians(1.0)
# Turn [rad] from which on it may be the coordinate of a motion without a fixed axis.
_LARGE = np.pi / 6.0
# Factor by which turn over path may differ from its mean, but for a twentieth at either end.
_IN_STEP, _OUTER = 2.0, 0.05
# Part of the edges' speed about an axis by which they may move in another direction.
_OFF_AXIS = 0.02


def coordinate_of(
    sim: Simulation, motion: Motion, kept: Axis | Line | None, until: float
) -> Coordinate:
    """Return the coordinate of a run.

    motion : of the tool, as seen from the film.  kept : axis or line that it keeps.  until : end of
    the run [s].
    """
    if isinstance(motion, HasCoordinate):
        return Coordinate.own(motion, until)
    if isinstance(kept, Line):
        return Coordinate.path(motion, until)
    edges = _Edges(sim, motion, until)
    if edges.turn_about(kept) or edges.turn_in_step():
        return Coordinate.angle(motion, until)
    return Coordinate.travelled("mm", edges.speed, until, "its edges")


class _Edges:
    """The cutting edges where they pass the film.

    Before an edge enters the film and after it has left it, the place at which it is nearest in
    time counts. Of a tool without edges in the film it is the middle of its vertices.
    """

    def __init__(self, sim: Simulation, motion: Motion, until: float) -> None:
        assert sim.tool is not None
        self._motion, self._until = motion, until
        self._instants = [float(t) for t in (np.arange(N_INSTANT) + 0.5) / N_INSTANT * until]
        self._places = [(np.zeros(1), sim.tool.vertices.mean(axis=0)[None])]
        """Times [s] and places in the body's axes [mm], of each edge."""
        sweep = Sweep.of(sim.mesh, sim.tool, motion, until) if sim.tool.n_edge else None
        if sweep is not None and len(sweep.place):
            self._places = [_in_body(sweep, motion, k) for k in np.unique(sweep.chain).tolist()]

    def turn_about(self, kept: Axis | Line | None) -> bool:
        """Return whether they turn about an axis, if it is fixed, and move along it.

        The axis of a table is known to a share of how far the body's origin is from it.
        """
        if not isinstance(kept, Axis) or any(kept.drift):
            return False
        off = whole = turn = 0.0
        direction = np.array(kept.direction)
        for time in self._instants:
            spin, places, velocity = self._at(time)
            about = cross(spin, places - kept.point)
            rest = velocity - about
            off += float(norm(rest - product(rest, direction)[:, None] * direction).mean())
            whole += float(norm(about).mean())
            turn += float(norm(spin)) * self._until / N_INSTANT
        return turn >= _LEAST and off <= _OFF_AXIS * whole

    def turn_in_step(self) -> bool:
        """Return whether the tool makes a large turn in step with their path."""
        rate = norm(np.array([self._motion.twist(time)[0] for time in self._instants], float))
        speed = np.array([self.speed(time) for time in self._instants])
        if not rate.mean() * self._until >= _LARGE or not speed.any():
            return False
        moves = speed > AT_REST * speed.max()
        over_mean = rate[moves] / speed[moves] * (speed.sum() / rate.sum())
        low, high = np.quantile(over_mean, [_OUTER, 1.0 - _OUTER])
        return bool(low * _IN_STEP >= 1.0 and high <= _IN_STEP)

    def speed(self, time: float) -> float:
        """Return their mean speed at a time [s], in mm/s."""
        return float(norm(self._at(time)[2]).mean())

    def _at(self, time: float) -> tuple[Floats, Floats, Floats]:
        """Return the spin, and places and velocities of the edges in the film, (n_edge, 3) each."""
        spin, velocity = (np.asarray(part, float) for part in self._motion.twist(time))
        at = [[np.interp(time, times, axis) for axis in places.T] for times, places in self._places]
        R, r = pose_at(self._motion, time)
        arms = product(np.array(at), R.T)
        return spin, r + arms, velocity + cross(spin, arms)


def _in_body(sweep: Sweep, motion: Motion, chain: int) -> tuple[Floats, Floats]:
    """Return when and where in the body's axes an edge passes the film: its mean at each time."""
    mine = sweep.chain == chain
    times, which = np.unique(sweep.time[mine], return_inverse=True)
    count = np.bincount(which)[:, None]
    bodies = [
        pose_at(motion, time).to_body(place[None])[0]
        for time, place in zip(sweep.time[mine].tolist(), sweep.place[mine], strict=True)
    ]
    sums = np.zeros((times.size, 3))
    np.add.at(sums, which, np.array(bodies))
    return times, sums / count
