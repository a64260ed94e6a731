"""The stable step, safe by bounds.

With stiffness damping lagging half a step, a vector u grows unless, for every u,

    dt² uᵀ(K + K_c)u + 2 dt beta uᵀK u <= 4 uᵀM u,

K being the tangent of the shells (pre-stress counted), K_c that of contact and cables, which are
not damped. With omega_e² the largest eigenvalue of a quad's own stiffness on its share of the mass
and omega_c² the largest K_c / m of its nodes, the sum over quads gives the sufficient condition

    dt <= [-beta omega_e² + sqrt((beta omega_e²)² + 4 omega²)] / omega²,
    omega² = omega_e² + omega_c²,

for the worst quad; without contact it is the known 2/omega (sqrt(1 + xi²) - xi), xi = beta omega/2.
On squares the bound omega_e is some 12 % above the exact frequency of the assembly.

Between full evaluations the quads near the limit are followed at a shorter interval.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ._jit import Floats, Ints
from .cable import CableSet
from .contact import STEEPEST, PenaltyContact
from .shell import MITC4Shell
from .state import State

# Quads whose bound is within this factor of the largest are followed between full evaluations.
_LEADING = 0.8

# A longer step is taken only when the bound has grown by this factor: dt changes seldom.
_HYSTERESIS = 1.08


@dataclass(frozen=True)
class Stepping:
    """How the step is chosen.

    Parameters
    ----------
    safety : float
        Factor on the safe bound; what the state may change until the next evaluation.
    evaluate_every : int
        Steps between evaluations of the leading quads; all quads every tenth time.
    fixed : float, optional
        A step of the user's own [s]; the bound is then ignored.
    """

    safety: float = 0.95
    evaluate_every: int = 500
    fixed: float | None = None

    def __post_init__(self) -> None:
        problems = []
        if not 0 < self.safety <= 1:
            problems.append(f"safety must lie in (0, 1], got {self.safety!r}")
        if not (isinstance(self.evaluate_every, int) and self.evaluate_every > 0):
            problems.append(f"evaluate_every must be a positive count, got {self.evaluate_every!r}")
        if self.fixed is not None and not 0 < self.fixed < math.inf:
            problems.append(f"fixed must be a positive time in s, got {self.fixed!r}")
        if problems:
            raise ValueError("; ".join(problems))


class StableStep:
    """Give the length of the next step."""

    def __init__(
        self,
        stepping: Stepping,
        shell: MITC4Shell,
        cables: CableSet,
        contact: PenaltyContact | None,
    ) -> None:
        self.stepping = stepping
        self._shell, self._cables, self._contact = shell, cables, contact
        self._evaluations = 0
        self._next = 0
        self._revision = -1
        self._dt = 0.0

    def next(self, state: State) -> float:
        """Return dt of the step after t_n [s]."""
        due = state.step >= self._next
        if due and (self.stepping.fixed is None or self._evaluations == 0):
            self._follow(state)
        if self.stepping.fixed is not None:
            return self.stepping.fixed
        if due or state.revision != self._revision:
            self._revision = state.revision
            safe = self.stepping.safety * self.bound(state)
            if safe < self._dt or safe > _HYSTERESIS * self._dt:
                self._dt = safe
        return self._dt

    def forget(self) -> None:
        """Evaluate afresh at the next call: the state has been moved from outside."""
        self._evaluations = self._next = 0
        self._dt = 0.0

    def bound(self, state: State) -> float:
        """Return the safe bound on the step at the last evaluated frequencies [s]."""
        omega_e2 = self._shell.squared_frequency
        omega_c2 = self._node_stiffness(state)[state.quads].max(axis=1)
        damped = self._shell.damping_beta * omega_e2
        total = omega_e2 + omega_c2
        return float(((np.sqrt(damped**2 + 4.0 * total) - damped) / total).min())

    def _follow(self, state: State) -> None:
        if self._evaluations % 10 == 0:
            quads: Ints = np.arange(state.quads.shape[0])
        else:
            known = self._shell.squared_frequency
            quads = np.flatnonzero(known > _LEADING * known.max())
        self._shell.update_frequencies(state, quads)
        self._evaluations += 1
        self._next = state.step + self.stepping.evaluate_every

    def _node_stiffness(self, state: State) -> Floats:
        """Return a bound of contact and cable stiffness over mass at every node [1/s²]."""
        n = state.node
        stiffness = np.zeros(n.count)
        if self._contact is not None:
            near = self._contact.near.ids
            stiffness[near] += STEEPEST * self._contact.parameters.penalty * n.contact_area[near]
        nodes, held = self._cables.stiffness(state)
        np.add.at(stiffness, nodes, held)
        return np.asarray(stiffness / n.mass[: n.count])
