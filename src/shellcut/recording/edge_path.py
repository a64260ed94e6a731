"""The path of the cutting edges through the film, the coordinate of a motion that keeps no axis.

The forces of a cut depend on how its edges move through the film. The angle of a tool that mostly
moves straight, or the path of a body's origin far from the film, says nothing about that. The angle
is the coordinate where the edges move by turning: about a fixed axis, or by a large turn in step
with their path, as measured poses of a cap have it. A user's own motion keeps its own coordinate.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from shellcut.arrays import Floats, cross, norm, product
from shellcut.checks.sweep import Sweep
from shellcut.loads.film_motion import SeenFromFilm
from shellcut.tool.motion import Motion
from shellcut.tool.pose_of_motion import pose_at
from shellcut.tool.screw_axis import AT_REST, N_INSTANT, Axis
from shellcut.tool.table_motion import TableMotion
from shellcut.tool.travel import Travel

if TYPE_CHECKING:
    from shellcut.simulation.simulation import Simulation

# Ticks of the run over which the path is summed.
_N_TICK = 1024
# Turn [rad] from which on it may be the coordinate of a motion without a fixed axis.
_LARGE = np.pi / 6.0
# Factor by which turn over path may differ from its mean, but for a twentieth at either end.
_IN_STEP, _OUTER = 2.0, 0.05
# Part of the edges' speed about an axis by which they may move in another direction.
_OFF_AXIS = 0.02


class EdgePath:
    """A motion whose coordinate is the path of the cutting edges where they pass the film [mm].

    Of several edges it is the mean of their paths. Before an edge enters the film and after it has
    left it, the place at which it is nearest in time counts. Of a tool without edges in the film it
    is the path of the middle of its vertices.

    Parameters
    ----------
    sim : Simulation
        With a tool.
    motion : Motion
        Of the tool, as seen from the film.
    until : float
        End of the run [s].
    """

    coordinate_unit = "mm"

    def __init__(self, sim: Simulation, motion: Motion, until: float) -> None:
        assert sim.tool is not None
        self.pose, self.twist = motion.pose, motion.twist
        self._motion = motion
        self._places = [(np.zeros(1), sim.tool.vertices.mean(axis=0)[None])]
        """Times [s] and places in the body's axes [mm], of each edge."""
        sweep = Sweep.of(sim.mesh, sim.tool, motion, until) if sim.tool.n_edge else None
        if sweep is not None and len(sweep.place):
            self._places = [_in_body(sweep, motion, k) for k in np.unique(sweep.chain).tolist()]
        self._travel = Travel(self.speed, until / _N_TICK)

    def coordinate(self, time: float) -> float:
        """Return the path since t = 0 [mm]."""
        return self._travel.at(time)

    def turns_about(self, axis: Axis | None, until: float) -> bool:
        """Return whether the edges move about an axis, if it is fixed, and along it.

        The axis of a table is known to a share of how far the body's origin is from it.

        axis : of the motion, None if it keeps none.  until : end of the run [s].
        """
        if axis is None or any(axis.drift):
            return False
        off = whole = 0.0
        direction = np.array(axis.direction)
        for time in _instants(until):
            spin, places, velocity = self._edges_at(time)
            about = cross(spin, places - axis.point)
            rest = velocity - about
            off += float(norm(rest - product(rest, direction)[:, None] * direction).mean())
            whole += float(norm(about).mean())
        return off <= _OFF_AXIS * whole

    def turns_in_step(self, until: float) -> bool:
        """Return whether the tool makes a large turn in step with the path up to a time [s]."""
        times = _instants(until)
        rate = norm(np.array([self._motion.twist(time)[0] for time in times], float))
        speed = np.array([self.speed(time) for time in times])
        if not rate.mean() * until >= _LARGE or not speed.any():
            return False
        moves = speed > AT_REST * speed.max()
        over_mean = rate[moves] / speed[moves] * (speed.sum() / rate.sum())
        low, high = np.quantile(over_mean, [_OUTER, 1.0 - _OUTER])
        return bool(low * _IN_STEP >= 1.0 and high <= _IN_STEP)

    def speed(self, time: float) -> float:
        """Return the rate of the path [mm/s]."""
        return float(norm(self._edges_at(time)[2]).mean())

    def _edges_at(self, time: float) -> tuple[Floats, Floats, Floats]:
        """Return the spin, and places and velocities of the edges in the film, (n_edge, 3) each."""
        spin, velocity = (np.asarray(part, float) for part in self._motion.twist(time))
        at = [[np.interp(time, times, axis) for axis in places.T] for times, places in self._places]
        R, r = pose_at(self._motion, time)
        arms = product(np.array(at), R.T)
        return spin, r + arms, velocity + cross(spin, arms)


def _instants(until: float) -> list[float]:
    return [float(time) for time in (np.arange(N_INSTANT) + 0.5) / N_INSTANT * until]


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


def has_own_coordinate(motion: Any) -> bool:
    """Return whether the coordinate of a motion is a user's, not one of the library's tables."""
    return type(motion) not in (TableMotion, SeenFromFilm)
