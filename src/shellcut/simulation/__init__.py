"""The explicit simulation: the order of a step, its length, the energy ledger, relaxation, hooks.

May import the physics (``fracture`` and rows below). ``simulation.Simulation.run`` is the step on
one screen.
"""

from .hooks import Hook, StopRun, StopWhen
from .instability import UnstableStep
from .simulation import Simulation
from .stable_step import Stepping

__all__ = ["Hook", "Simulation", "Stepping", "StopRun", "StopWhen", "UnstableStep"]
