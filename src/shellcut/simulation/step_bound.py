"""The largest safe step of a film with what touches it, by bounds on its quads.

With stiffness damping lagging half a step, a vector u grows unless, for every u,

    dt² uᵀ(K + K_c)u + 2 dt beta uᵀK_d u <= 4 uᵀM u.                                            (1)

K is the tangent of the shells (pre-stress counted), K_c that of contact and cables, which are not
damped, and K_d the stiffness that is damped: that of the elastic moduli. Let omega_e² and omega_d²
be the largest eigenvalues of a quad's own K and K_d on its share of the mass, and omega_c² the
largest K_c / m of its nodes. The sum over the quads gives the sufficient condition

    dt <= [-beta omega_d² + sqrt((beta omega_d²)² + 4 omega²)] / omega²,                        (2)
    omega² = omega_e² + omega_c²,

for the worst quad. A linear film's omega_d is omega_e; then, without contact, (2) is the known
2/omega (sqrt(1 + xi²) - xi), xi = beta omega/2. On squares the bound omega_e is some 12 % above the
exact frequency of the assembly.

**What is evaluated.** omega_e is a bound that grows with the change of shape since a quad was last
evaluated (:mod:`shellcut.mitc4.frequency`). :meth:`StepBound.of_all` brings the bounds of all quads
up to date and evaluates the quads that limit the step: worst first, until no other could shorten it
by more than 1 %. Between two such evaluations :meth:`StepBound.of_changed` does the same for the
quads at which contact and cables have changed: after a split, and when a contact has searched for
what is near the tool, as the tool may have come to nodes that were not near before. A term that
lists what is near, and counts its searches (``n_search``), keeps its stiffness until the next one.
Cables (``n_search`` -1) are asked at each evaluation and are never the reason for one: the safety
factor covers the steps between. Stretch since then is estimated
(:mod:`shellcut.mitc4.stretch_since`).
"""

from __future__ import annotations

import copy
import math
from collections.abc import Mapping, Sequence
from operator import attrgetter
from typing import Any

import numpy as np

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

# Quads evaluated at a time: after the worst few, few others are left to evaluate.
_BATCH = 32

# A growth of omega² below this factor is not worth an evaluation, whatever the safety.
_LEAST_GROWTH = 1.01

_n_search = attrgetter("n_search")


class StepBound(Kept):
    """Evaluate the bound (2); :attr:`shell` keeps the bounds of its quads.

    An evaluation of some quads needs what it does not evaluate: the stiffness of terms that have
    not searched since, the bound of the other quads, and which quads have been evaluated.
    """

    kept_names = "_topology", "_free", "_known", "_stretch"

    def __init__(self, shell: MITC4Shell, terms: Sequence[ForceTerm]) -> None:
        self.shell = shell
        self._terms = tuple(terms)
        self._stiffened_quads, self._safe_steps = BoundOnce(stiffened_quads), BoundOnce(safe_steps)
        # When the terms were asked last: their searches until then, the film's topology, ...
        self._searched = [0 for _ in self._terms]
        self._topology = KnownTopology()
        # ... and their stiffness K_c at nodes.
        nothing = np.zeros(0, np.int64), np.zeros(0)
        self._stiffness: dict[str, NodeStiffness] = {term.name: nothing for term in self._terms}
        # When all quads were evaluated last: (2) with omega_c = 0 [s], ...
        self._free = math.inf
        # ... and their omega² and shape, from which stretch is measured.
        self._stretch = StretchSince(shell.frequencies.by_stretch)
        # Quads whose omega_e² has been evaluated since: that of others is a bound only.
        self._known = np.zeros(shell.frequencies.squared.size, np.bool_)

    def of_all(self, state: State) -> float:
        """Return the bound [s], all quads being brought up to date."""
        n, frequencies = state.node, self.shell.frequencies
        frequencies.follow(n.x, n.t, state.quads)
        self._known = np.zeros(state.n_quad, np.bool_)
        omega_c2 = np.zeros(state.n_quad)
        quads, of_terms = self._stiffened(state, self._ask(state, again=True))
        omega_c2[quads] = of_terms
        bound = self._settle(state, np.arange(omega_c2.size), omega_c2)
        self._free = self._free_step()
        self._stretch.take(state, frequencies.squared + omega_c2)
        return bound

    def is_outdated(self, state: State) -> bool:
        """Return whether a term has searched, or the film has split, since the last evaluation."""
        return self._searches() != self._searched or not self._topology.is_of(state)

    def of_changed(self, state: State) -> float:
        """Return the bound [s], only the quads at contact and cables being brought up to date."""
        copies = state.n_quad - self._known.size
        self._known = np.append(self._known, np.zeros(copies, np.bool_))
        again = not self._topology.is_of(state)
        quads, of_terms = self._stiffened(state, self._ask(state, again=again))
        bound = min(self._free, self._settle(state, quads, of_terms))
        omega2 = self.shell.frequencies.squared.copy()
        omega2[quads] += of_terms
        self._stretch.follow(state, omega2)
        return bound

    def is_exceeded_by_stretch(self, state: State, dt: float) -> bool:
        """Return whether stretch since the last evaluation may have made a step unsafe.

        The growth is estimated high: the film's true growth is smaller.
        """
        growth, beta = self._stretch.growth(state), self.shell.damping_beta
        # The left side of (1) over its right side, for the largest eigenvalues grown alike.
        damped = float(self.shell.frequencies.damped.max())
        used_up = 0.25 * growth * (dt * dt * self._stretch.largest + 2.0 * dt * beta * damped)
        return used_up > 1.0 and growth > _LEAST_GROWTH

    def of_present(self, state: State) -> float:
        """Return the bound [s] by the quads' present omega_e; nothing is evaluated."""
        counted: dict[str, NodeStiffness] = {}
        for term in self._terms:
            counted[term.name] = term.stiffness(state, counted)
        quads, omega_c2 = self._stiffened(state, counted)
        return min(self._free_step(), *self._steps(quads, omega_c2, np.empty(quads.size)))

    def of_all_once(self, state: State) -> float:
        """Return what :meth:`of_all` would [s], and leave everything as it was."""
        frequencies = self.shell.frequencies
        before = copy.deepcopy(frequencies.saved())
        safe = StepBound(self.shell, self._terms).of_all(state)
        frequencies.restore(before)
        return safe

    def of_quad_alone(self, quad: int) -> float:
        """Return the bound of one quad without contact and cables [s]."""
        return min(self._steps(np.array([quad]), np.zeros(1), np.empty(1)))

    def saved(self) -> dict[str, Any]:
        """Return what was evaluated; the frequencies are the shell's."""
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

    def _free_step(self) -> float:
        """Return the bound of all quads without contact and cables [s]."""
        every = np.arange(self.shell.frequencies.squared.size)
        return float(np.minimum(*self._steps(every, np.zeros(every.size), np.empty(every.size))))

    def _searches(self) -> list[int]:
        return list(map(_n_search, self._terms))

    def _ask(self, state: State, *, again: bool) -> dict[str, NodeStiffness]:
        """Return the stiffness of each term; of those that search some are asked, or all again.

        In their order: what one term adds to another that is evaluated before it may be less than
        its own stiffness.
        """
        searched = self._searches()
        for term, now, then in zip(self._terms, searched, self._searched, strict=True):
            if again or now != then or now < 0:
                self._stiffness[term.name] = term.stiffness(state, self._stiffness)
        self._searched = searched
        self._topology.take(state)
        return self._stiffness

    def _settle(self, state: State, quads: Ints, omega_c2: Floats) -> float:
        """Return the bound of some quads [s], those that limit it being evaluated."""
        steps = np.empty(quads.size)
        while True:
            of_known, of_others = self._steps(quads, omega_c2, steps)
            # The bound of a quad that is not evaluated yet may be too short by much.
            tight = _TIGHT * of_known
            if not of_others < tight:
                return float(np.minimum(of_others, of_known))  # NaN if one of them is
            open_ = np.flatnonzero(~self._known[quads] & (steps < tight))
            worst = quads[open_[np.argsort(steps[open_], kind="stable")[:_BATCH]]]
            self.shell.evaluate_frequencies(state, worst)
            self._known[worst] = True

    def _steps(self, quads: Ints, omega_c2: Floats, steps: Floats) -> tuple[float, float]:
        """Write the largest safe steps of single quads; return the least of known ones and others.

        steps : (n,), [s].
        """
        frequencies = self.shell.frequencies
        return self._safe_steps(
            quads,
            omega_c2,
            self.shell.damping_beta,
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
        count = self._stiffened_quads(
            nodes, stiffness, n.mass, n.quads, n.n_quad_at, quads, largest
        )
        return quads[:count], largest[:count]


@kernel
def stiffened_quads(
    nodes: Ints,
    stiffness: Floats,
    mass: Floats,
    at: SmallIds,
    n_at: SmallIds,
    quads: Ints,
    largest: Floats,
) -> int:
    """Write the quads at some nodes, ascending, and the largest K_c / m of the nodes of each quad.

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
        step = (np.sqrt(b * b + 4.0 * total) - b) / total  # (2)
        steps[i] = step
        # Of two the smaller, and NaN if one is: a comparison with NaN is false.
        if known[q]:
            of_known = of_known if of_known <= step or np.isnan(of_known) else step
        else:
            of_others = of_others if of_others <= step or np.isnan(of_others) else step
    return of_known, of_others
