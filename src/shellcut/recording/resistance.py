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

Of a film without a tool, the way s is that by which its supports part. ds/dt is the largest
difference between the prescribed velocities v of two supported nodes, along axes that both
support; nodes held at rest count with v = 0. The force is the power of all supports over it, as
seen from a frame that moves with the middle w of the largest and the smallest v along each axis,

    F = (Σ R · (v - w) + Σ M · spin) / (ds/dt),

with the reactions R and moments M. So neither depends on which grip of a machine moves, or on a
velocity that is common to all: F is what a load cell reads over the travel of the crosshead, and
the mean of both cells where inertia or loads make them differ. If two legs are pulled apart, it is
the force on one of them. Turns are those in space. Where the film is tied to something else at
rest, such as glue to its base, this counts as a support with v = 0, and w = 0 as its forces are not
among R. So it is, too, if the supports never part.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from shellcut.arrays import Floats, product
from shellcut.formats.errors import point_text
from shellcut.loads.film_motion import FilmMotion
from shellcut.results.energy_account import KINETIC_IN_FILM
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
    """Path by which the supports of a film without a tool part, and the force that parts them.

    Its attributes are those of :class:`Resistance`; ValueError if no support moves.
    """

    def __init__(self, sim: Simulation, until: float) -> None:
        moved = sim.supports.moved
        if not moved:
            raise ValueError(
                "a Recorder needs a simulation with a tool and its motion, or with a support that "
                "moves"
            )
        self.coordinate_name, self.coordinate_unit = WAY, "mm"
        self.columns = [("force", "N")]
        # Nodes with the same motion count once: that of each axis, 0 for rest, -1 for no support.
        held = sim.state.node.support[: sim.mesh.n_node, :3]
        motion = np.where(held, 0, -1)
        for k, (ids, c, _) in enumerate(moved, start=1):
            motion[ids, c] = k
        kinds, self._nodes = np.unique(motion, axis=0, return_index=True)
        self._held = kinds >= 0
        self._time = np.linspace(0.0, until, _N_SAMPLE + 1)
        times = self._time.tolist()
        rates = np.zeros((len(moved) + 1, len(times)))
        for k, (_, _, rate) in enumerate(moved, start=1):
            rates[k] = [rate(time) for time in times]
        # Shape (n_kind, 3, n_time).
        velocity = np.where(self._held[..., None], rates[kinds], 0.0)
        self._tied = bool(sim.inputs["terms"])
        self._at_rest = self._tied or not self._parting(velocity, at_rest=False).any()
        speed = self._parting(velocity, at_rest=self._at_rest)
        self.meaning = (
            "power of the supports over the speed of the fastest"
            if self._at_rest
            else "force that parts the supports: their power over the speed at which they part"
        )
        mean = 0.5 * (speed[1:] + speed[:-1])
        self._way = np.concatenate([[0.0], np.cumsum(mean * np.diff(self._time))])
        self._last_speed = float(speed[-1])

    def _parting(self, velocity: Floats, *, at_rest: bool) -> Floats:
        """Return the largest difference of velocities (n_kind, 3, ...), of shape (...) [mm/s].

        at_rest : whether something counts that is held at rest along all axes.
        """
        squared = np.zeros(velocity.shape[2:])
        for i, (own, held) in enumerate(zip(velocity, self._held, strict=True)):
            for other, also in zip(velocity[:i], self._held[:i], strict=True):
                apart = (own - other)[held & also]
                np.maximum(squared, np.add.reduce(apart * apart), out=squared)
            if at_rest:
                np.maximum(squared, np.add.reduce(own * own), out=squared)
        return np.sqrt(squared)

    def _common(self, velocity: Floats) -> Floats:
        """Return the middle of the velocities (n_kind, 3) along each axis, shape (3,) [mm/s]."""
        if self._at_rest:
            return np.zeros(3)
        low = np.where(self._held, velocity, np.inf).min(axis=0)
        high = np.where(self._held, velocity, -np.inf).max(axis=0)
        return np.where(self._held.any(axis=0), 0.5 * (low + high), 0.0)

    def coordinate(self, time: float) -> float:
        """Return that path at a time [mm]."""
        beyond = max(time - float(self._time[-1]), 0.0)  # the last step is not shortened
        return float(np.interp(time, self._time, self._way)) + beyond * self._last_speed

    def felt(self, sim: Simulation) -> list[float]:
        """Return the force now [N], zero while nothing parts."""
        n = sim.state.node
        velocity = n.support_rate[self._nodes, :3]
        speed = float(self._parting(velocity, at_rest=self._at_rest))
        if speed == 0.0:
            return [0.0]
        supported = np.flatnonzero(n.supported[: n.count])
        rate = n.support_rate[supported]
        rate[:, :3] -= self._common(velocity)
        rate[~n.support[supported]] = 0.0
        return [float(np.einsum("ij,ij->", n.reaction[supported], rate)) / speed]

    def row(self, sim: Simulation) -> Iterator[tuple[str, str, float]]:
        """Yield name, unit and value of its columns of the history."""
        yield "force", "N", self.felt(sim)[0]
        if not self._tied:
            yield KINETIC_IN_FILM, "N*mm", _about_its_mean(sim)


def _about_its_mean(sim: Simulation) -> float:
    """Return the kinetic energy as seen from the centre of mass [N·mm].

    K - p²/(2 m), with momentum p and mass m: a velocity of all strains nothing.
    """
    n = sim.state.node
    mass = n.mass[: n.count]
    momentum = product(mass, n.velocity_half[: n.count])
    return sim.ledger.kinetic - float(product(momentum, momentum)) / (2.0 * float(mass.sum()))


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
