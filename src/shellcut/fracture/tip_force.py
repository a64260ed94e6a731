"""The force on the tip of a crack: the energy that the film gives up per mm of its advance.

Let the mesh slide through the film, by q(X) e along the reference, q being 1 around the tip and
falling to 0 at the border of its domain (:mod:`.tip_domain`). The film stays where it is in space:
a node moves to film that is q dx/de farther, dx/de being what e has become there. Where the film is
smooth the mesh then only describes it anew, and its energy Pi does not change. But the tip moves
along with the mesh, and

    J · e = - dPi / d(slide)

is the energy released per mm of a crack along e [N], in whichever direction the flanks part. J is a
vector of the sheet: the J-integral and its companion across the crack, with membrane, bending and
transverse shear alike ([Eshelby1951]; on meshes [MuellerMaugin2002]). For two legs that are pulled
out of the sheet J is the rate at which their ends part, times the force on them.

As the film stays, nothing that acts on it does work: loads, supports, a tool and the cables that
its edge bends, inertia. So it does not matter how much of that lies in the domain. The straight
cables of the process zone move along with the tip, by their work F · (q dx/de) at both ends; J then
is the energy that flows into them, too: in steady tearing J = G h. The crack's own flanks slide
with the mesh, no other edge. Across the crack that adds film to one flank and removes it from the
other: J · e has the difference of their energies per area times the reach in it, none where both
sides are alike.

The energy psi is what the film would give back: what has flowed stays where it is in the film. A
point that slides moves to film that has flowed differently, which adds the stress times the slope
of the plastic strain there to J (:mod:`shellcut.mitc4.sliding_points`). With it J is what flows
into the process zone, however the film around has flowed ([Simha2008]). A law that keeps a history
and names no ``frozen`` law has no such energy: for it a force is refused, and
:mod:`.free_direction` uses the stress ahead alone.
"""

from __future__ import annotations

import numpy as np
import scipy

from shellcut.arrays import Floats, Ints, product
from shellcut.material.shell_material import ShellMaterial
from shellcut.mitc4.shell import MITC4Shell
from shellcut.mitc4.sliding_points import SlidingHistory, SlidingPoints
from shellcut.numerics.small_matrices import inverse
from shellcut.state import STRAIGHT, State

from .quad_polygon import CORNERS, shape_slopes
from .tip_domain import TipDomain

_AT_CORNERS = np.array([shape_slopes(corner) for corner in CORNERS])


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
    """

    def __init__(self, state: State, shell: MITC4Shell, domain: TipDomain, base: Floats) -> None:
        film = shell.reference
        q = np.zeros((len(film.quads), 4))
        q[domain.rows] = domain.q
        self._rows: Ints = np.flatnonzero(q.any(axis=1))
        self._nodes, self._q = state.quads[self._rows], q[self._rows]
        X, T = film.x[film.quads[self._rows]], film.t[film.quads[self._rows]]
        slides = np.einsum("ea,ki->keai", self._q, base)
        self._energy = SlidingPoints(X, T, slides, shell.material)
        self._history: SlidingHistory | None = None
        if shell.points.rule.n_history:
            self._history = SlidingHistory.of(state, shell, self._rows, self._q, base)
        self._share = state.quad.share[self._rows]
        # At a node e has become the mean of what it has in the quads there.
        along = product(_AT_CORNERS, X[:, None])
        back = along.transpose(0, 1, 3, 2)
        n = state.n_node
        n_at = np.bincount(self._nodes.ravel(), minlength=n)[self._nodes]
        weights = product(base, back, inverse(product(along, back)), _AT_CORNERS)
        weights /= n_at[..., None, None]  # (n, 4, n_slide, 4)
        at = self._nodes[:, :, None, None] + n * np.arange(2)[:, None]
        at, of = np.broadcast_arrays(at, self._nodes[:, None, None, :])
        entries = weights.ravel(), (at.ravel(), of.ravel())
        self._slopes = scipy.sparse.csr_array(entries, shape=(2 * n, n))
        """Gives of what nodes have its slopes there along both vectors of the base."""
        self._q_at = np.bincount(self._nodes.ravel(), (self._q / n_at).ravel(), n)
        flank = state.flank
        self._tied = flank.node[: flank.count], flank.nodes[: flank.count]
        self._q_tied = flank.weight[: flank.count] * q[flank.row[: flank.count]]

    def of(self, state: State) -> Floats:
        """Return the components of the force along the base [N], shape (2,), as the film is now."""
        n, now = state.n_node, state.node
        slopes = (self._slopes @ np.hstack([now.x[:n], now.t[:n]])).reshape(2, n, 6)
        become, bend = slopes[..., :3], slopes[..., 3:]
        moves, turns = (self._q[..., None] * rows[:, self._nodes] for rows in (become, bend))
        x, t = now.x[self._nodes], now.t[self._nodes]
        history = None if self._history is None else self._history.of_state(state)
        changes = product(self._energy.changes(x, t, moves, turns, history), self._share)
        return np.asarray(self._of_cables(state, become) - changes)

    def _of_cables(self, state: State, become: Floats) -> Floats:
        """Return what straight cables do that move along with the tip [N], shape (n_slide,)."""
        moves, (point, nodes) = self._q_at[:, None] * become, self._tied
        moves[:, point] = np.einsum("fa,kfai->kfi", self._q_tied, become[:, nodes])
        cables = state.cable
        zone = np.flatnonzero(cables.status[: cables.count] == STRAIGHT)
        share = cables.share[zone, None, None]
        ends = (1.0 - share) * moves[:, cables.ends[zone]] + share * moves[:, cables.far[zone]]
        return np.asarray(np.einsum("cei,kcei->k", cables.force[zone], ends))
