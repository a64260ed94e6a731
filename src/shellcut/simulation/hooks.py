"""Hooks: what reads a run. They never change it.

A hook is called after a completed step, when its trigger says so, with the simulation at t_n:
positions, forces, tool pose and ledger all of that instant. A hook may raise :class:`StopRun`; the
run ends after all hooks of that step have been served.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Protocol, runtime_checkable

from shellcut.numerics.trigger import Trigger

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
    """Reads the simulation now and then; any object with these three methods is one.

    :class:`~shellcut.simulation.hooks.Sampler` is a ready one that keeps what a function returns.

    Examples
    --------
    >>> import shellcut
    >>> from shellcut.simulation.hooks import Sampler
    >>> case = shellcut.guillotine(1.0, length=6.0, width=4.0)
    >>> sim = case.simulation
    >>> pull = Sampler(1e-6, lambda sim: float(sim.tooth_wrenches[:, 2].sum()))
    >>> isinstance(pull, shellcut.Hook)
    True
    >>> sim.run(5e-6, [pull])
    >>> len(pull.values)
    6
    """

    def due(self, sim: Simulation) -> bool:
        """Whether to be called at this step."""
        ...

    def __call__(self, sim: Simulation) -> None:
        """Read the simulation."""
        ...

    def close(self) -> None:
        """Release what is held; called when the run ends, however it ends."""
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


class Sampler:
    """Call a function of the simulation at intervals of time and keep what it returns.

    Parameters
    ----------
    interval : float
        Time between two calls [s].
    read : callable
        Takes the simulation, returns anything; the values are in :attr:`values`.
    """

    def __init__(self, interval: float, read: Callable[[Simulation], object]) -> None:
        self._trigger = Trigger(interval)
        self._read = read
        self.values: list[object] = []

    def due(self, sim: Simulation) -> bool:
        """Whether the interval has passed."""
        return self._trigger(sim.state.time)

    def __call__(self, sim: Simulation) -> None:
        """Keep one value."""
        self.values.append(self._read(sim))

    def close(self) -> None:
        """Do nothing: there is nothing to release."""


def serve(sim: Simulation, hooks: Sequence[Hook]) -> bool:
    """Call the hooks that are due; return whether the run goes on."""
    going = True
    for hook in hooks:
        if hook.due(sim):
            try:
                hook(sim)
            except StopRun:
                going = False
    return going
