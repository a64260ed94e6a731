"""How much the loads on the film do as it slides: their part in the force on the tip of a crack.

In a domain around the tip the reference slides by q(X) e below the film, the film in space follows
by q(X) c (:mod:`shellcut.fracture.tip_force`). What the film gives up then is the change of its
energy *and* the work of the loads on it.

*A dead load* b(X), per area of the reference, has the potential -∫ b · x dA. A slide moves the
reference points, hence the area that each corner bears, and the film in space:

    work = Σ_a F_a' · x_a + q_a F_a · c,    F_a = ∫ b N_a dA,

a prime for the change per mm of the slide. It is what the sum ∫ b · (c - ∂x/∂e) q dA becomes on
quads: nothing where the film is strained evenly. The F_a' of a domain within the film add to zero,
so that it does not matter from where x counts. Dead pressure is quadratic in the reference places,
so that the difference that gives F_a' is exact over any step.

*Following pressure* acts on the film in space, whatever lies below. It does p times the volume that
the film there sweeps, Σ_a q_a F_a · c: nothing where the domain is flat.

Loads on the rim do not slide and have no part in it; forces on single nodes are those of
:mod:`shellcut.fracture.point_forces`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from shellcut.arrays import Floats, Ints, product
from shellcut.state import State

from .dead_loads import DeadLoad
from .pressure import FollowingPressure

# Of the slide, over 1 mm: any step is exact for pressure, and for the mass of flat quads.
_STEP = 0.01


class SlidingLoads:
    """The work of loads on some quads with some slides, as long as the topology stays.

    rows : (n,), quads and copies of which something slides.  X : (n, 4, 3), their corners in the
    reference film [mm].  q : (n, 4), share of each corner in a slide.  slides : (n_slide, n, 4, 3),
    how far these slide, along their quads, per mm of each slide.  mass : gives those of corners
    that lie at X [t], (n, 4).
    """

    def __init__(
        self,
        state: State,
        rows: Ints,
        X: Floats,
        q: Floats,
        slides: Floats,
        mass: Callable[[Floats], Floats],
        dead: Sequence[DeadLoad],
        following: Sequence[FollowingPressure],
    ) -> None:
        self._rows, self._q, self._following = rows, q, list(following)
        self._dead: list[tuple[DeadLoad, Floats, Floats]] = []
        for one in dead:
            on = one.rule.on_slid
            if on is None:
                continue
            changes = np.empty_like(slides)
            for k, slide in enumerate(slides):
                far, near = (X + step * slide for step in (_STEP, -_STEP))
                changes[k] = on(state, rows, far, mass(far)) - on(state, rows, near, mass(near))
            self._dead.append((one, on(state, rows, X, mass(X)), changes / (2.0 * _STEP)))

    def works(self, state: State, moved: Floats) -> Floats:
        """Return what the loads do per mm of each slide [N], shape (n_slide,).

        moved : (n_slide, 3), how far the film in space moves with each where q is 1, per mm.
        """
        found = np.zeros(len(moved))
        x = state.node.x[state.quads[self._rows]]
        x = x - x.mean(axis=(0, 1))
        for one, now, changes in self._dead:
            done = np.einsum("keai,eai->k", changes, x)
            done += product(moved, np.einsum("ea,eai->i", self._q, now))
            found += one.factor(state.time) * done
        for push in self._following:
            force = push.on_rows(state, self._rows)
            found += product(moved, np.einsum("ea,eai->i", self._q, force))
        return found
