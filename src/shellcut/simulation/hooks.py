"""Hooks: what reads a run. They never change it.

A hook is called after a completed step, when its trigger says so, with the simulation at t_n:
positions, forces, tool pose and energy balance all of that instant. A hook may raise
:class:`StopRun`; the run ends after all hooks of that step have been served.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Protocol, runtime_checkable

if TYPE_CHECKING:
    from .simulation import Simulation


class StopRun(Exception):
    """Raised by a hook that has seen enough; the run ends after this step.

    Examples
    --------
    >>> import shellcut
    >>> class Until:
    ...     def due(self, sim: shellcut.Simulation) -> bool:
    ...         return sim.state.step >= 3
    ...
    ...     def __call__(self, sim: shellcut.Simulation) -> None:
    ...         raise shellcut.StopRun
    ...
    ...     def close(self) -> None:
    ...         pass
    >>> case = shellcut.guillotine(1.0, length=6.0, width=4.0)
    >>> case.simulation.run(case.duration, [Until()])
    >>> case.simulation.state.step
    3
    """


@runtime_checkable
class Hook(Protocol):
    """Reads the simulation now and then; any object with these three methods is a hook.

    Examples
    --------
    >>> import shellcut
    >>> class Pull:
    ...     values = []
    ...
    ...     def due(self, sim: shellcut.Simulation) -> bool:
    ...         return sim.state.step % 10 == 0
    ...
    ...     def __call__(self, sim: shellcut.Simulation) -> None:
    ...         self.values.append(float(sim.tooth_wrenches[:, 2].sum()))
    ...
    ...     def close(self) -> None:
    ...         pass
    >>> isinstance(pull := Pull(), shellcut.Hook)
    True
    >>> case = shellcut.guillotine(1.0, length=6.0, width=4.0)
    >>> case.simulation.run(5e-6, [pull])
    >>> len(pull.values) > 1
    True
    """

    def due(self, sim: Simulation) -> bool:
        """Whether to be called at this step."""
        ...

    def __call__(self, sim: Simulation) -> None:
        """Read the simulation."""
        ...

    def close(self) -> None:
        """Release resources; called when the run ends, however it ends."""
        ...


class StopWhen:
    """End the run between two steps, as soon as a condition holds.

    Parameters
    ----------
    asked : callable
        Called after every step; whether to stop.
    """

    def __init__(self, asked: Callable[[], bool]) -> None:
        self._asked = asked

    def due(self, sim: Simulation) -> bool:
        """Whether the condition holds."""
        return self._asked()

    def __call__(self, sim: Simulation) -> None:
        """Stop."""
        raise StopRun

    def close(self) -> None:
        """Do nothing: there is nothing to release."""


def serve(sim: Simulation, hooks: Sequence[Hook]) -> bool:
    """Call the hooks that are due; return whether the run continues."""
    going = True
    for hook in hooks:
        if hook.due(sim):
            try:
                hook(sim)
            except StopRun:
                going = False
    return going
