"""Resistance of a film without a tool that is pulled by its supports.

The way s is that of the support that moves fastest: ds/dt is the largest speed of any supported
node. The force is the work of all supports per mm of it,

    F = Σ R · v / (ds/dt),

with the reactions R and the prescribed velocities v. Where two legs are pulled apart at the same
speed it is the sum of the forces on both.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from shellcut.loads.supports import Support

if TYPE_CHECKING:
    from shellcut.simulation.simulation import Simulation

_N_SAMPLE = 20_000  # times at which the way is integrated; it then grows linearly


class SupportPull:
    """Way of the supports, and the force that moves them.

    Parameters
    ----------
    sim : Simulation
        Without a tool, with a support that moves.
    until : float
        End of the run [s].

    Attributes
    ----------
    columns, meaning, coordinate_name, coordinate_unit
        As in :class:`~shellcut.recording.tool_resistance.Resistance`.

    Raises
    ------
    ValueError
        If no support moves.
    """

    def __init__(self, sim: Simulation, until: float) -> None:
        supports: tuple[Support, ...] = sim.inputs["supports"]  # type: ignore[assignment]
        rates = [list(one.velocity.values()) for one in supports if one.velocity]
        if not rates:
            raise ValueError(
                "a Recorder needs a simulation with a tool and its motion, or with a support that "
                "moves"
            )
        self.coordinate_name, self.coordinate_unit = "way", "mm"
        self.columns = [("force", "N")]
        self.meaning = (
            "work of the supports per mm of the way of the fastest of them: the sum of the forces "
            "on those that move at its speed"
        )
        self._time = np.linspace(0.0, until, _N_SAMPLE + 1)
        times = self._time.tolist()
        fastest = [max(np.add.reduce([r(t) ** 2 for r in one]) for one in rates) for t in times]
        speed = np.sqrt(np.array(fastest))
        mean = 0.5 * (speed[1:] + speed[:-1])
        self._way = np.concatenate([[0.0], np.cumsum(mean * np.diff(self._time))])

    def coordinate(self, time: float) -> float:
        """Return the way at a time [mm]."""
        return float(np.interp(time, self._time, self._way))

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
