"""What a run measures: the resistance to its tool, or to the supports that pull its film."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias

from .support_pull import SupportPull
from .tool_resistance import Resistance

if TYPE_CHECKING:
    from shellcut.simulation.simulation import Simulation

AnyResistance: TypeAlias = Resistance | SupportPull


def resistance_of(sim: Simulation, until: float) -> AnyResistance:
    """Return the resistance that a run up to ``until`` [s] measures.

    Raises
    ------
    ValueError
        If neither a tool nor a support moves.
    """
    if sim.motion is not None:
        return Resistance(sim.motion, until)
    return SupportPull(sim, until)
