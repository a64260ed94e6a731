"""The force on the tip of a crack: the energy that the film gives up per mm of its advance.

Let the reference slide by q(X) e below the film, q being 1 around the tip and falling to 0 at the
border of its domain (:mod:`.tip_domain`), and let the film in space follow by q(X) c, c being what
e has become there. The energy Pi of the film then changes as if the tip with all that surrounds it
were a little further along e, so that

    J · e = - dPi / d(slide)

is the energy released per mm of a crack along e [N], whichever way the flanks part. J is a vector
of the sheet: the J-integral and its companion across the crack, with membrane, bending and
transverse shear alike ([Eshelby1951]; on meshes [MuellerMaugin2002]). For two legs that are pulled
out of the sheet J is the rate at which their ends part, times the force on them.

At rest the motion in space changes nothing: the forces that hold the nodes in the domain add to
zero. In a film that swings they do not. Without that motion they would act over a whole mm instead
of over a strain, and hide the energy released. What presses on the film does work in both motions,
which is part of Pi: pressure and weight (:mod:`shellcut.loads.sliding_loads`), and a tool or forces
on single nodes (:mod:`.point_forces`).

The domain holds the process zone as far as it reaches; J then is the energy that goes into the
cables, too: in steady tearing J = G h. The crack's own flanks slide with the film, no other edge.
Across the crack that adds film to one flank and takes it from the other: J · e has the difference
of their energies per area times the reach in it, none where both sides are alike.

The energy psi is what the film would give back: what has flowed stays where it is in the film. A
point that slides comes to film that has flowed differently, which adds the stress times the slope
of the plastic strain there to J (:mod:`shellcut.mitc4.sliding_points`). With it J is what goes into
the process zone, however the film around has flowed ([Simha2008]). A law that keeps a history and
names no ``frozen`` law has no such energy: for it a force is refused, and :mod:`.free_direction`
takes the stress ahead alone.
"""

from __future__ import annotations

import numpy as np

from shellcut.arrays import Floats, Ints, product
from shellcut.loads.loads import LoadSet
from shellcut.loads.sliding_loads import SlidingLoads
from shellcut.material.shell_material import ShellMaterial
from shellcut.mitc4.section import lumped_mass
from shellcut.mitc4.shell import MITC4Shell
from shellcut.mitc4.sliding_history import SlidingHistory
from shellcut.mitc4.sliding_points import SlidingPoints, slid
from shellcut.state import State

from .point_forces import PointForces
from .tip_domain import TipDomain


def gives_back(material: ShellMaterial) -> bool:
    """Whether the energy is known that a film would give back."""
    laws = [layer.material.law for layer in material.layers]
    return not any(law.history and law.frozen is None for law in laws)


class TipForce:
    """The force on one tip, as long as topology and tip stay the same.

    Parameters
    ----------
    state : State
        Of the topology.
    shell : MITC4Shell
        Whose law keeps no history, or can be frozen.
    domain : TipDomain
        Which of the film slides, and how far.
    base : ndarray, shape (2, 3)
        Unit vectors of the sheet at the tip.
    loads : LoadSet, optional
        On the film.
    """

    def __init__(
        self,
        state: State,
        shell: MITC4Shell,
        domain: TipDomain,
        base: Floats,
        loads: LoadSet | None = None,
    ) -> None:
        film = shell.reference
        X, T = film.x[film.quads], film.t[film.quads]
        q = np.zeros((len(X), 4))
        q[domain.rows] = domain.q
        material, rule = shell.material, shell.points.rule
        # Where all corners slide alike nothing changes but the history below.
        moves = np.abs(q).max(axis=1) if rule.n_history else np.ptp(q, axis=1)
        self._rows: Ints = np.flatnonzero(moves > 0.0)
        self._q = q[self._rows]
        slides = np.einsum("ea,ki->keai", self._q, base)
        self._energy = SlidingPoints(X[self._rows], T[self._rows], slides, material)
        self._history: SlidingHistory | None = None
        if rule.n_history:
            self._history = SlidingHistory.of(state, shell, self._rows, self._q, base)
        self._share = state.quad.share[self._rows]
        # Within the domain the loads move even where all corners slide alike.
        rows = np.flatnonzero(np.abs(q).max(axis=1) > 0.0)
        X, T, q = X[rows], T[rows], q[rows]
        self._points = PointForces(state, rows, X, q, base)
        self._loads: SlidingLoads | None = None
        if loads is not None and any(loads.on_film):
            slides, _ = slid(X, T, np.einsum("ea,ki->keai", q, base))
            whole, _ = lumped_mass(X, T, shell.material)

            def mass(corners: Floats) -> Floats:
                found, _ = lumped_mass(corners, T, shell.material)
                return shell.mass[rows] / whole * found

            self._loads = SlidingLoads(state, rows, X, q, slides, mass, *loads.on_film)

    def of(self, state: State, moved: Floats, held: Floats | None = None) -> Floats:
        """Return the components of the force along the base [N], shape (2,).

        Parameters
        ----------
        state : State
            Present positions.
        moved : ndarray, shape (2, 3)
            What the vectors of the base have become in space, at the tip.
        held : ndarray, shape (n_node, 3), optional
            Forces on nodes and flank points: of contact, and loads of single nodes [N].
        """
        nodes = state.quads[self._rows]
        x, t = state.node.x[nodes], state.node.t[nodes]
        moves = np.einsum("ea,ki->keai", self._q, moved)
        history = None if self._history is None else self._history.of_state(state)
        changes = self._energy.changes(x, t, moves, history)
        force = np.asarray(product(-changes, self._share))
        if self._loads is not None:
            force += self._loads.works(state, moved)
        if held is not None:
            force += self._points.works(state, held, moved)
        return force
