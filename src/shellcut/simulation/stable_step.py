"""The choice of the step: safe by a bound, and steady.

:class:`.step_bound.StepBound` gives the largest safe step, and this much of it is used:

    safe = safety · bound.                                                                      (1)

All quads are evaluated every ``evaluate_every`` steps, and sooner in a film that is stretched fast;
quads at contact and cables when these have changed. The step chosen follows a safe step down at
once, and up with delay, as each change of dt costs energy:

    dt <- safe    if safe < dt, or safe > 1.08 dt;                                              (2)
    dt <- least   at the end of an interval of evaluations, if least > 1.01 dt;                 (3)

with the least safe step of all evaluations in the interval. The step taken grows towards it:

    dt_n = min(dt, 1.002 dt_{n-1}).                                                             (4)
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np

from shellcut.arguments import Option, checked
from shellcut.mitc4.shell import MITC4Shell
from shellcut.numerics.kept import Kept
from shellcut.state import State
from shellcut.tool.force_term import ForceTerm

from .step_bound import StepBound

# (2) and (3): dt changes seldom, and does not stay short for the rest of a run after one moment in
# which it had to be.
_CLEARLY_LONGER, _LONGER_THROUGHOUT = 1.08, 1.01

# (4): a change of the step costs ¼ (dt_n - dt_{n-1}) dt f² / m of energy for every force f out of
# balance, and at a cut, where the step may grow, such forces are large. They have died down before
# a growth by a tenth is complete.
_GROWTH = 1.002

# Steps between two checks whether stretch has used up what safety leaves: often enough for a strip
# drawn out by a fifth in between.
_STRETCH_EVERY = 100

# Damping over the critical one beyond which the root in the bound on the step is lost to round-off:
# its relative error is 2 eps xi², 4e-8 at this.
_MOST_DAMPING = 1e4


@checked
@dataclass(frozen=True)
class Stepping:
    """How the step is chosen.

    Examples
    --------
    >>> Stepping(safety=0.9).fixed is None
    True
    """

    safety: Annotated[
        float,
        Option(
            "", "factor on the stable step, a margin until the next evaluation", above=0, most=1
        ),
    ] = 0.95
    evaluate_every: Annotated[
        int, Option("", "steps between two evaluations of all quads", least=1)
    ] = 500
    fixed: Annotated[
        float | None, Option("s", "a constant step", above=0, unset="the safe step")
    ] = None


class StableStep(Kept):
    """Give the length of the next step."""

    kept_names = "_next", "_dt", "_least"

    def __init__(
        self,
        stepping: Stepping | None,
        shell: MITC4Shell,
        terms: Sequence[ForceTerm],
    ) -> None:
        self.stepping = stepping or Stepping()
        self._bound = StepBound(shell, terms)
        self.forget()

    def forget(self) -> None:
        """Evaluate all quads at the next call: the state has been moved from outside."""
        self._next = 0  # number of the step at which the interval of evaluations ends
        self._dt = 0.0  # chosen, towards which the step grows [s]
        self._least = math.inf  # of the safe steps in the interval [s]

    def next(self, state: State) -> float:
        """Return dt of the step after t_n [s]; ``state.dt`` is that of the step before."""
        if self.stepping.fixed is not None:
            return self.stepping.fixed
        step, bound, safety = state.step, self._bound, self.stepping.safety
        if step >= self._next or (
            step % _STRETCH_EVERY == 0 and bound.is_exceeded_by_stretch(state, self._dt)
        ):
            safe = safety * bound.of_all(state)  # (1)
            self._choose(safe, min(safe, self._least))
            self._next, self._least = step + self.stepping.evaluate_every, safe
        elif bound.is_outdated(state):
            safe = safety * bound.of_changed(state)
            self._choose(safe, 0.0)
            self._least = min(safe, self._least)
        # The first step has the length chosen.
        return min(self._dt, _GROWTH * state.dt or self._dt)  # (4)

    def _choose(self, safe: float, throughout: float) -> None:
        """Choose dt; ``throughout`` is the least safe step of an interval that ends, else 0."""
        if not safe >= self._dt or safe > _CLEARLY_LONGER * self._dt:
            self._dt = safe  # (2), also one that is NaN: the run stops by it
        elif throughout > _LONGER_THROUGHOUT * self._dt:
            self._dt = throughout  # (3)

    def check(self, dt: float) -> None:
        """Refuse a step that is not a finite time above 0, and damping too large for any bound.

        Raises
        ------
        ValueError
            Saying what makes the step so short.
        """
        shell = self._bound.shell
        with np.errstate(all="ignore"):
            damped = float(shell.frequencies.damped.max())
            ratio = 0.5 * shell.damping_beta * math.sqrt(damped)
        if not ratio <= _MOST_DAMPING:
            raise ValueError(
                f"damping_beta must damp the stiffest quad {_MOST_DAMPING:,.0f} times critically "
                f"at most, {shell.damping_beta:g} s does {ratio:.2g} times: is it in s?"
            )
        if not 0.0 < dt < math.inf:
            raise ValueError(
                f"the stable step must be a time above 0, got {dt:.4g} s: {self.reason()}"
            )

    def reason(self) -> str:
        """Return what sets the step, in words with numbers: a model's nonsense shows in them."""
        if self.stepping.fixed is not None:
            return f"time.fixed is {self.stepping.fixed:.4g} s"
        shell = self._bound.shell
        stiffest = int(shell.frequencies.squared.argmax())
        with np.errstate(all="ignore"):
            undamped = 2.0 / np.sqrt(shell.frequencies.squared[stiffest])
            damped = self._bound.of_quad_alone(stiffest)
        said = (
            f"the stiffest quad alone needs {undamped:.4g} s (side length, thickness, modulus and "
            "density set it)"
        )
        if shell.damping_beta > 0.0:
            said += f", with damping_beta = {shell.damping_beta:.4g} s for {damped:.4g} s"
        return said + "; is one of them in another unit?"

    def bound(self, state: State) -> float:
        """Return the safe bound on the step at the last known frequencies [s]."""
        return self._bound.of_present(state)

    def largest_safe(self, state: State) -> float:
        """Return the safe step without the safety factor [s]; nothing of this is kept."""
        return self._bound.of_all_once(state)

    def saved(self) -> dict[str, Any]:
        """Return the step, when all quads were evaluated last, and what was found."""
        return super().saved() | self._bound.saved()

    def restore(self, saved: Mapping[str, Any]) -> None:
        """Take over :meth:`saved`."""
        super().restore(saved)
        self._bound.restore(saved)
