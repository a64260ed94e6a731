r"""What a run measures: the resistance to its tool, or to the supports that pull its film.

Of a tool it is a torque or force from its wrench.

Signs: all values are exerted by the tool on the film, so a resistance is positive and
resistance x rate is the power of the tool.

==================  ========================  ======================================================
invariant           values                   power
==================  ========================  ======================================================
an axis             torque T, axial force F   T dtheta/dt + F du/dt, u the advance; for a screw of
                                              pitch p du = p/(2 pi) dtheta
a line              force F along it          F ds/dt
none                dW/dq                     (dW/dq) dq/dt, q the coordinate
                                              (:mod:`.run_coordinate`)
==================  ========================  ======================================================

The last one is the generalised force of the coordinate q: with f and m the force and the moment
about a point exerted by the tool, w and v its angular velocity and the velocity of that point,

    dW/dq = (f · v + m · w) / (dq/dt).

Over an angle it is a torque [N·mm], over a path a force [N], and is named so. It equals T or F if
the motion has an invariant axis without sliding along it, or an invariant line. While the
coordinate rests, dW/dq is undefined: the wrench is then projected on the motion at the nearest
instant at which the coordinate moves.

Of a film that its supports move, motion, axis and line are those of the tool as seen from the film
(:mod:`shellcut.loads.film_motion`), and so are forces and works.

The whole wrench is also given in world axes, with its moment about the world's origin.

Of a film without a tool, the way s is that of the support that moves fastest: ds/dt is the largest
speed of any supported node. The force is the work of all supports per mm of it,

    F = Σ R · v / (ds/dt),

with the reactions R and the prescribed velocities v. Where two legs are pulled apart at the same
speed it is the sum of the forces on both.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from shellcut.arrays import Floats, product
from shellcut.formats.errors import point_text
from shellcut.loads.film_motion import FilmMotion
from shellcut.loads.supports import Support
from shellcut.results.steady_window import INTEGRAL, WAY
from shellcut.tool.coordinate import Coordinate
from shellcut.tool.motion import Motion
from shellcut.tool.screw_axis import AT_REST, Axis, Line, instants, kept_axis

from .run_coordinate import coordinate_of

if TYPE_CHECKING:
    from shellcut.simulation.simulation import Simulation

COMPONENTS = [(f"force_{c}", "N") for c in "xyz"] + [(f"moment_{c}", "N*mm") for c in "xyz"]
"""Names and units of the wrench; the moment is about the world's origin."""

# How far an axis may stray in a film that moves, over the film's extent: above what the integration
# of its motion leaves.
_STRAY = 1e-4
_N_SAMPLE = 20_000  # times at which the way is integrated; it then grows linearly

_Triple = Sequence[float]


class Resistance:
    """Compute the resistance from the wrench on the tool.

    Parameters
    ----------
    motion : Motion
        Of the tool, as seen from the film.
    kept : Axis or Line, optional
        What the motion keeps.
    coordinate : Coordinate
        Of the run.
    until : float
        End of the run [s].
    film : FilmMotion, optional
        That of a film which its supports move.
    """

    def __init__(
        self,
        motion: Motion,
        kept: Axis | Line | None,
        coordinate: Coordinate,
        until: float,
        film: FilmMotion | None = None,
    ) -> None:
        self._coordinate, self._film = coordinate, film
        turns = coordinate.unit == "rad"
        self.coordinate_name, self.coordinate_unit = ("angle", "deg") if turns else ("path", "mm")
        """Abscissa of the values, in the unit shown to users."""
        self.coordinate_scale = float(np.degrees(1.0)) if turns else 1.0
        """Factor from the coordinate to that unit."""
        self._reading: _AboutAxis | _AlongLine | _OfCoordinate
        if isinstance(kept, Axis) and turns:
            self._reading = _AboutAxis(kept, coordinate)
        elif isinstance(kept, Line):
            self._reading = _AlongLine(kept)
        else:
            self._reading = _OfCoordinate(motion, coordinate, until)
        self.columns, self.meaning = self._reading.columns, self._reading.meaning
        """Names and units of the values, and what the first is, which does the work."""
        if film is not None:
            self.meaning += ", as seen from the film, which its supports move"

    def coordinate(self, time: float) -> float:
        """Return the coordinate at a time in the unit shown to users."""
        return self._coordinate.at(time) * self.coordinate_scale

    def of(self, wrench: Floats, origin: Floats, time: float) -> list[float]:
        """Return the values for one wrench on the tool at a time [s], in the order of ``columns``.

        The wrench is force [N] and moment [N·mm] about the present position of the body's origin
        [mm].
        """
        # Plain floats: NumPy takes ten times as long for six numbers.
        *force, mx, my, mz = wrench.tolist()
        return self._reading.of(force, (mx, my, mz), origin.tolist(), time)

    def felt(self, sim: Simulation) -> list[float]:
        """Return the values from contact and joints of all teeth together."""
        return self._now(sim, sim.tooth_wrenches.sum(axis=0))

    def _now(self, sim: Simulation, wrench: Floats) -> list[float]:
        """Return the values at t_n for one wrench on the tool, in the world's axes."""
        time, origin = sim.state.time, sim.pose.translation
        if self._film is not None:
            Q, q = self._film.pose(time)
            wrench, origin = product(wrench.reshape(2, 3), Q).ravel(), product(origin - q, Q)
        return self.of(wrench, origin, time)

    def row(self, sim: Simulation) -> Iterator[tuple[str, str, float]]:
        """Yield name, unit and value of its columns of the history."""
        of_terms = [
            (term.name, self._now(sim, term.touch.wrench.sum(axis=0))) for term in sim.terms.on_tool
        ]
        for k, (figure, unit) in enumerate(self.columns):
            yield figure, unit, float(np.add.reduce([values[k] for _, values in of_terms]))
            yield from ((f"{figure}_{name}", unit, values[k]) for name, values in of_terms)
        if isinstance(self._reading, _AboutAxis):
            sums = self._reading.integrals(sim.terms.wrench_over_turn, sim.work_in_film)
            for (figure, unit), value in zip(self.columns, sums, strict=True):
                yield figure + INTEGRAL, unit, value
        elif self._film is not None:
            yield self.columns[0][0] + INTEGRAL, "N*mm", sim.work_in_film
        first, unit = self.columns[0]
        for tooth, wrench in enumerate(sim.tooth_wrenches, start=1):
            yield f"{first}_tooth_{tooth}", unit, self._now(sim, wrench)[0]
        whole = sum(term.touch.wrench.sum(axis=0) for term in sim.terms.on_tool)
        about_world = self.components(whole, sim.pose.translation)
        yield from ((*named, value) for named, value in zip(COMPONENTS, about_world, strict=True))

    def components(self, wrench: Floats, origin: Floats) -> list[float]:
        """Return the wrench exerted by the tool, in the order of :data:`COMPONENTS`.

        ``wrench`` and ``origin`` as in :meth:`of`; the moment is about the world's origin.
        """
        *force, mx, my, mz = wrench.tolist()
        moment = _moment_about((0.0, 0.0, 0.0), force, (mx, my, mz), origin.tolist())
        # 0.0 - c instead of -c, so that zero never prints as -0.
        return [0.0 - c for c in (*force, *moment)]


class SupportPull:
    """Path of the supports of a film without a tool, and the force that moves them.

    Its attributes are those of :class:`Resistance`; ValueError if no support moves.
    """

    def __init__(self, sim: Simulation, until: float) -> None:
        supports: tuple[Support, ...] = sim.inputs["supports"]  # type: ignore[assignment]
        rates = [list(one.velocity.values()) for one in supports if one.velocity]
        if not rates:
            raise ValueError(
                "a Recorder needs a simulation with a tool and its motion, or with a support that "
                "moves"
            )
        self.coordinate_name, self.coordinate_unit = WAY, "mm"
        self.columns = [("force", "N")]
        self.meaning = (
            "sum of the forces on the supports that move, each times its speed over that of the "
            "fastest"
        )
        self._time = np.linspace(0.0, until, _N_SAMPLE + 1)
        times = self._time.tolist()
        fastest = [max(np.add.reduce([r(t) ** 2 for r in one]) for one in rates) for t in times]
        speed = np.sqrt(np.array(fastest))
        mean = 0.5 * (speed[1:] + speed[:-1])
        self._way = np.concatenate([[0.0], np.cumsum(mean * np.diff(self._time))])
        self._last_speed = float(speed[-1])

    def coordinate(self, time: float) -> float:
        """Return the path at a time [mm]."""
        beyond = max(time - float(self._time[-1]), 0.0)  # the last step is not shortened
        return float(np.interp(time, self._time, self._way)) + beyond * self._last_speed

    def felt(self, sim: Simulation) -> list[float]:
        """Return the force now [N], zero while nothing moves."""
        n = sim.state.node
        rate = n.support_rate[: n.count]
        moved = np.flatnonzero(rate.any(axis=1))
        if not moved.size:
            return [0.0]
        speed = np.linalg.norm(rate[moved, :3], axis=1).max()
        power = float(np.einsum("ij,ij->", n.reaction[moved], rate[moved]))
        return [power / float(speed) if speed > 0.0 else 0.0]

    def row(self, sim: Simulation) -> Iterator[tuple[str, str, float]]:
        """Yield name, unit and value of its columns of the history."""
        yield "force", "N", self.felt(sim)[0]


AnyResistance: TypeAlias = Resistance | SupportPull


def resistance_of(sim: Simulation, until: float) -> AnyResistance:
    """Return the resistance that a run up to ``until`` [s] measures; something must move."""
    motion, film = sim.motion_in_film, sim.film_motion
    if motion is None:
        return SupportPull(sim, until)
    kept = kept_axis(motion, until, 0.0 if film is None else _STRAY * film.extent)
    coordinate = coordinate_of(sim, motion, kept, until)
    return Resistance(motion, kept, coordinate, until, film)


class _AboutAxis:
    """Torque about the axis, force along the advance."""

    def __init__(self, kept: Axis, coordinate: Coordinate) -> None:
        self.columns = [("torque", "N*mm"), ("axial_force", "N")]
        self._axis, self._advance, self._point = kept.direction, kept.advance, kept.point
        self._drift, self._angle = kept.drift, coordinate.at
        self._moves = any(kept.drift)
        moving = ", which moves, at the start" if self._moves else ""
        self.meaning = (
            f"torque about the axis {point_text(kept.direction, 4)}{moving} through "
            f"{point_text(kept.point, 4)} mm"
        )

    def of(self, force: _Triple, moment: _Triple, origin: _Triple, time: float) -> list[float]:
        point = self._point
        if self._moves:
            q = self._angle(time)
            (px, py, pz), (dx, dy, dz) = point, self._drift
            point = (px + q * dx, py + q * dy, pz + q * dz)
        about = _moment_about(point, force, moment, origin)
        return [0.0 - _dot(self._axis, about), 0.0 - _dot(self._advance, force)]

    def integrals(self, over_turn: Floats, work: float) -> list[float]:
        """Return those of the values over the angle [rad], from the wrench's and the work."""
        *force, mx, my, mz = over_turn.tolist()
        torque, along = self.of(force, (mx, my, mz), (0.0, 0.0, 0.0), 0.0)
        if self._moves:  # then the moments are about other points from step to step
            aside = 1.0 - _dot(self._axis, self._advance) ** 2
            torque = work - _dot(self._drift, self._advance) / aside * along
        return [torque, along]


class _AlongLine:
    """Force along the line."""

    def __init__(self, kept: Line) -> None:
        self.columns = [("force", "N")]
        self._direction = kept.direction
        self.meaning = f"force along {point_text(kept.direction, 4)}"

    def of(self, force: _Triple, _moment: _Triple, _origin: _Triple, _time: float) -> list[float]:
        return [0.0 - _dot(self._direction, force)]


class _OfCoordinate:
    """Generalised force of the coordinate."""

    def __init__(self, motion: Motion, coordinate: Coordinate, until: float) -> None:
        self._motion, self._rate = motion, coordinate.rate
        self._seen = instants(motion, coordinate, until)
        if coordinate.unit == "rad":
            self.columns = [("torque", "N*mm")]
            self.meaning = "generalised torque: work of the tool per radian; it keeps no axis"
        else:
            self.columns = [("force", "N")]
            along = f" of the path of {coordinate.of}" if coordinate.of else ""
            self.meaning = (
                f"generalised force: work of the tool per mm{along}; it keeps no direction"
            )
        rates = [abs(self._rate(time)) for time in self._seen.time.tolist()]
        self._slowest = AT_REST * max(rates, default=0.0)

    def of(self, force: _Triple, moment: _Triple, origin: _Triple, time: float) -> list[float]:
        rate = self._rate(time)
        if abs(rate) > self._slowest:
            spin, velocity = (np.asarray(part, float).tolist() for part in self._motion.twist(time))
            power = _dot(force, velocity) + _dot(moment, spin)
            return [0.0 - power / rate]
        if not self._seen.time.size:
            return [0.0]
        k = int(np.abs(self._seen.time - time).argmin())
        spin, shift = self._seen.spin[k], self._seen.shift[k]
        return [0.0 - _dot(force, shift.tolist()) - _dot(moment, spin.tolist())]


def _moment_about(
    point: _Triple, force: _Triple, moment: _Triple, origin: _Triple
) -> tuple[float, float, float]:
    """Return the moment about ``point``, given the moment about ``origin``."""
    (px, py, pz), (fx, fy, fz), (x, y, z) = point, force, origin
    x, y, z = x - px, y - py, z - pz
    mx, my, mz = moment
    return mx + y * fz - z * fy, my + z * fx - x * fz, mz + x * fy - y * fx


def _dot(a: _Triple, b: _Triple) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
