"""The stable step, safe by bounds.

With stiffness damping lagging half a step, a vector u grows unless, for every u,

    dt² uᵀ(K + K_c)u + 2 dt beta uᵀK_d u <= 4 uᵀM u,

K being the tangent of the shells (pre-stress counted), K_c that of contact and cables, which are
not damped, and K_d the stiffness that is: that of the elastic moduli. With omega_e² and omega_d²
the largest eigenvalues of a quad's own K and K_d on its share of the mass and omega_c² the largest
K_c / m of its nodes, the sum over quads gives the sufficient condition

    dt <= [-beta omega_d² + sqrt((beta omega_d²)² + 4 omega²)] / omega²,
    omega² = omega_e² + omega_c²,

for the worst quad. A linear film's omega_d is omega_e; then, without contact, it is the known
2/omega (sqrt(1 + xi²) - xi), xi = beta omega/2.
On squares the bound omega_e is some 12 % above the exact frequency of the assembly.

omega_e is a bound that grows with the change of shape since a quad was last evaluated
(:mod:`shellcut.mitc4.frequency`). At intervals the bounds of all quads are brought up to date, and
the quads that limit the step are evaluated: worst first, until no other could shorten it by more
than 1 %. What contact and cables add is looked at again in the same way at a split, and when a
contact has searched for what is near the tool: a tool that moves far between two evaluations comes
to nodes that were not near at the last one. Until then the stiffness of a term that searches is
good. A film that is stretched fast is looked at sooner (:mod:`shellcut.mitc4.stretch_since`).
"""

from __future__ import annotations

import copy
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from operator import attrgetter
from typing import Annotated, Any

import numpy as np

from shellcut.arguments import Option, checked
from shellcut.arrays import Bools, Floats, Ints, NodeStiffness, SmallIds, StiffnessBy
from shellcut.fracture.flank_points import hand_on_stiffness
from shellcut.mitc4.shell import MITC4Shell
from shellcut.mitc4.stretch_since import StretchSince
from shellcut.numerics.jit import BoundOnce, kernel
from shellcut.numerics.kept import Kept
from shellcut.state import KnownTopology, State
from shellcut.tool.force_term import ForceTerm

# Quads are evaluated until the bounds of the others shorten the step by no more than this factor.
_TIGHT = 0.99

# A longer step is taken as soon as the bound has grown by the first factor, and by the second only
# if it has been so long at every look of a whole interval: dt changes seldom, and does not stay
# short for the rest of a run after one moment in which it had to be.
_AT_ONCE, _AFTER_ALL = 1.08, 1.01

# Largest factor between two steps: a change of the step costs ¼ (dt_n - dt_{n-1}) dt f² / m of
# energy for every force f out of balance, and at a cut, where the step may grow, such forces are
# large. They have died down before a growth by a tenth is complete.
_GROWTH = 1.002

# Steps after which it is asked whether stretch has taken up what safety leaves: often enough for a
# strip drawn out by a fifth in between. A growth of omega² below the second factor is not worth a
# look, whatever the safety.
_STRETCH_EVERY, _LEAST_GROWTH = 100, 1.01

# Damping over the critical one beyond which the root in the bound on the step is lost to round-off:
# its relative error is 2 eps xi², 4e-8 at this.
_MOST_DAMPING = 1e4

_n_search = attrgetter("n_search")

# Quads evaluated at a time: after the worst few, few others are left to ask.
_BATCH = 32


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
        Option("", "factor on the safe step, until it is computed again", above=0, most=1),
    ] = 0.95
    evaluate_every: Annotated[
        int, Option("", "steps until it is computed again; each split does so, too", least=1)
    ] = 500
    fixed: Annotated[
        float | None, Option("s", "a step of your own", above=0, unset="the safe step")
    ] = None


class StableStep(Kept):
    """Give the length of the next step."""

    kept_names = "_next", "_topology", "_dt", "_step", "_free", "_least", "_known", "_stretch"

    def __init__(
        self,
        stepping: Stepping | None,
        shell: MITC4Shell,
        terms: Sequence[ForceTerm],
    ) -> None:
        self.stepping = stepping or Stepping()
        self._shell = shell
        self._terms = tuple(terms)
        self._stiffest_nodes, self._safe_steps = BoundOnce(stiffest_nodes), BoundOnce(safe_steps)
        self._stretch = StretchSince(shell.frequencies.by_stretch)
        # How often each term had searched at the last look, and its stiffness then.
        self._searched = [0 for _ in self._terms]
        nothing = np.zeros(0, np.int64), np.zeros(0)
        self._stiffness: dict[str, NodeStiffness] = {term.name: nothing for term in self._terms}
        self._next = 0
        self._topology = KnownTopology()
        self._dt = self._step = 0.0
        # Bound of the quads alone at the last look at all, and the least safe step since then.
        self._free, self._least = math.inf, math.inf
        # Quads evaluated since the last look at all.
        self._known = np.zeros(shell.frequencies.squared.size, np.bool_)

    def next(self, state: State) -> float:
        """Return dt of the step after t_n [s]."""
        if self.stepping.fixed is not None:
            return self.stepping.fixed
        step = state.step
        due = step >= self._next or (step % _STRETCH_EVERY == 0 and self._is_stretched(state))
        searched = list(map(_n_search, self._terms))
        if due or searched != self._searched or not self._topology.is_of(state):
            bound = self._look_at_all(state) if due else self._look_at_stiffness(state)
            self._take(self.stepping.safety * bound, due)
        self._step = min(self._dt, _GROWTH * self._step or self._dt)
        return self._step

    def _is_stretched(self, state: State) -> bool:
        """Whether the bound, grown by stretch since the last look at all quads, is exceeded.

        The growth is estimated high: what a step really takes up by then lies below.
        """
        growth, dt, beta = self._stretch.growth(state), self._dt, self._shell.damping_beta
        damped = float(self._shell.frequencies.damped.max())
        used_up = 0.25 * growth * (dt * dt * self._stretch.largest + 2.0 * dt * beta * damped)
        return used_up > 1.0 and growth > _LEAST_GROWTH

    def _take(self, safe: float, due: bool) -> None:
        """Choose the step after a look, at all quads when that was due."""
        longest = min(safe, self._least)  # of all looks since the last one at all quads
        if not safe >= self._dt or safe > _AT_ONCE * self._dt:
            self._dt = safe  # also one that is no number: the run stops by it
        elif due and longest > _AFTER_ALL * self._dt:
            self._dt = longest
        self._least = safe if due else min(safe, self._least)

    def check(self, dt: float) -> None:
        """Refuse a step that is no time, and damping by which none can be told.

        Raises
        ------
        ValueError
            Saying what makes the step so short.
        """
        with np.errstate(all="ignore"):
            damped = float(self._shell.frequencies.damped.max())
            ratio = 0.5 * self._shell.damping_beta * math.sqrt(damped)
        if not ratio <= _MOST_DAMPING:
            raise ValueError(
                f"damping_beta must damp the stiffest quad {_MOST_DAMPING:,.0f} times critically "
                f"at most, {self._shell.damping_beta:g} s does {ratio:.2g} times: is it in s?"
            )
        if not 0.0 < dt < math.inf:
            raise ValueError(
                f"the stable step must be a time above 0, got {dt:.4g} s: {self.reason()}"
            )

    def reason(self) -> str:
        """Return what sets the step, in words with numbers: a model's nonsense shows in them."""
        if self.stepping.fixed is not None:
            return f"time.fixed is {self.stepping.fixed:.4g} s"
        stiffest = [int(self._shell.frequencies.squared.argmax())]
        with np.errstate(all="ignore"):
            undamped = 2.0 / np.sqrt(self._shell.frequencies.squared[stiffest])[0]
            damped = min(self._steps(np.array(stiffest), np.zeros(1), np.empty(1)))
        said = (
            f"the stiffest quad alone asks for {undamped:.4g} s (edge length, thickness, modulus "
            "and density set it)"
        )
        if self._shell.damping_beta > 0.0:
            said += f", with damping_beta = {self._shell.damping_beta:.4g} s for {damped:.4g} s"
        return said + "; is one of them in another unit?"

    def largest_safe(self, state: State) -> float:
        """Return the safe step without the safety factor [s]; nothing of this look is kept."""
        frequencies = self._shell.frequencies
        before = copy.deepcopy(frequencies.saved())
        whole = StableStep(Stepping(safety=1.0), self._shell, self._terms)
        safe = whole.next(state)
        frequencies.restore(before)
        return safe

    def forget(self) -> None:
        """Look afresh at the next call: the state has been moved from outside."""
        self._next = 0
        self._dt, self._step, self._least = 0.0, 0.0, math.inf

    def saved(self) -> dict[str, Any]:
        """Return when it looked last and what it found; the frequencies are the shell's."""
        return super().saved() | {
            "searched": np.array(self._searched, np.int64),
            "terms": {
                name: {"node": node, "stiffness": stiffness}
                for name, (node, stiffness) in self._stiffness.items()
            },
        }

    def restore(self, saved: Mapping[str, Any]) -> None:
        """Take over :meth:`saved`."""
        super().restore(saved)
        self._searched = saved["searched"].tolist()
        terms = {term.name: saved["terms"][term.name] for term in self._terms}
        self._stiffness = {name: (rows["node"], rows["stiffness"]) for name, rows in terms.items()}

    def bound(self, state: State) -> float:
        """Return the safe bound on the step at the last known frequencies [s]."""
        counted: dict[str, NodeStiffness] = {}
        for term in self._terms:
            counted[term.name] = term.stiffness(state, counted)
        quads, omega_c2 = self._stiffened(state, counted)
        return min(self._free_step(), *self._steps(quads, omega_c2, np.empty(quads.size)))

    def _free_step(self) -> float:
        """Return the safe step of all quads without contact and cables [s]."""
        every = np.arange(self._shell.frequencies.squared.size)
        return float(np.minimum(*self._steps(every, np.zeros(every.size), np.empty(every.size))))

    def _look_at_all(self, state: State) -> float:
        n, frequencies = state.node, self._shell.frequencies
        self._next = state.step + self.stepping.evaluate_every
        frequencies.follow(n.x, n.t, state.quads)
        self._known = np.zeros(state.n_quad, np.bool_)
        omega_c2 = np.zeros(state.n_quad)
        quads, of_terms = self._stiffened(state, self._ask(state, again=True))
        omega_c2[quads] = of_terms
        bound = self._settle(state, np.arange(omega_c2.size), omega_c2)
        self._free = self._free_step()
        self._stretch.take(state, frequencies.squared + omega_c2)
        return bound

    def _look_at_stiffness(self, state: State) -> float:
        copies = state.n_quad - self._known.size
        self._known = np.append(self._known, np.zeros(copies, np.bool_))
        again = not self._topology.is_of(state)
        quads, of_terms = self._stiffened(state, self._ask(state, again=again))
        bound = min(self._free, self._settle(state, quads, of_terms))
        omega2 = self._shell.frequencies.squared.copy()
        omega2[quads] += of_terms
        self._stretch.follow(state, omega2)
        return bound

    def _ask(self, state: State, *, again: bool) -> dict[str, NodeStiffness]:
        """Return the stiffness of each term; of those that search some are asked, or all again.

        In their order: what one adds to another that is evaluated before it may be less than its
        own stiffness.
        """
        searched = list(map(_n_search, self._terms))
        for term, now, then in zip(self._terms, searched, self._searched, strict=True):
            if again or now != then or now < 0:
                self._stiffness[term.name] = term.stiffness(state, self._stiffness)
        self._searched = searched
        self._topology.take(state)
        return self._stiffness

    def _settle(self, state: State, quads: Ints, omega_c2: Floats) -> float:
        """Return the safe step of some quads [s], those that limit it being evaluated."""
        steps = np.empty(quads.size)
        while True:
            of_known, of_others = self._steps(quads, omega_c2, steps)
            tight = _TIGHT * of_known
            if not of_others < tight:
                return float(np.minimum(of_others, of_known))  # NaN if one of them is
            open_ = np.flatnonzero(~self._known[quads] & (steps < tight))
            worst = quads[open_[np.argsort(steps[open_], kind="stable")[:_BATCH]]]
            self._shell.evaluate_frequencies(state, worst)
            self._known[worst] = True

    def _steps(self, quads: Ints, omega_c2: Floats, steps: Floats) -> tuple[float, float]:
        """Write the largest safe steps of single quads; return the least of known ones and others.

        steps : (n,), [s].
        """
        frequencies = self._shell.frequencies
        return self._safe_steps(
            quads,
            omega_c2,
            self._shell.damping_beta,
            frequencies.squared,
            frequencies.damped,
            self._known,
            steps,
        )

    def _stiffened(self, state: State, terms: StiffnessBy) -> tuple[Ints, Floats]:
        """Return the quads at nodes of the terms, ascending, and omega_c² of each [1/s²]."""
        n = state.node
        nodes = np.concatenate([ids for ids, _ in terms.values()])
        stiffness = np.concatenate([of_nodes for _, of_nodes in terms.values()])
        if state.flank.count:
            nodes, stiffness = hand_on_stiffness(state, nodes, stiffness)
        quads, largest = np.empty(state.n_quad, np.int64), np.empty(state.n_quad)
        count = self._stiffest_nodes(nodes, stiffness, n.mass, n.quads, n.n_quad_at, quads, largest)
        return quads[:count], largest[:count]


@kernel
def stiffest_nodes(
    nodes: Ints,
    stiffness: Floats,
    mass: Floats,
    at: SmallIds,
    n_at: SmallIds,
    quads: Ints,
    largest: Floats,
) -> int:
    """Write the quads at some nodes, ascending, and the largest K_c / m of the nodes of each.

    nodes, stiffness : (n,), a node may come more than once.  mass, at, n_at : of all nodes, with
    the quads at each.  quads, largest : (n_quad,), [1/s²]; returns how many are written.
    """
    of_node, of_quad = np.zeros(mass.shape[0]), np.full(quads.shape[0], -1.0)
    for i in range(nodes.shape[0]):
        of_node[nodes[i]] += stiffness[i]
    for i in range(nodes.shape[0]):
        n = nodes[i]
        for j in range(n_at[n]):
            of_quad[at[n, j]] = max(of_quad[at[n, j]], of_node[n] / mass[n])
    count = 0
    for q in range(quads.shape[0]):
        if of_quad[q] >= 0.0:
            quads[count], largest[count] = q, of_quad[q]
            count += 1
    return count


@kernel
def safe_steps(
    quads: Ints,
    omega_c2: Floats,
    beta: float,
    squared: Floats,
    damped: Floats,
    known: Bools,
    steps: Floats,
) -> tuple[float, float]:
    """Write the largest safe step of single quads [s]; return the least of known ones and others.

    quads, omega_c2, steps : (n,), with omega_c² of each [1/s²].  beta : [s].  squared, damped,
    known : of all quads: omega_e² and omega_d² [1/s²], and whether they have been evaluated. The
    least is NaN if one is, infinite of none.
    """
    of_known = of_others = np.inf
    for i in range(quads.shape[0]):
        q = quads[i]
        b, total = beta * damped[q], squared[q] + omega_c2[i]
        step = (np.sqrt(b * b + 4.0 * total) - b) / total
        steps[i] = step
        if known[q]:
            of_known = of_known if of_known <= step or np.isnan(of_known) else step
        else:
            of_others = of_others if of_others <= step or np.isnan(of_others) else step
    return of_known, of_others
