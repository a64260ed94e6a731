"""The tension that a film has where a tip presses it, without what the tip adds.

The force that pierces a film depends on the tension that it has far from the tip
(:mod:`.puncture`). There the film carries the tip as a membrane, by a radial tension n and one of
n/3 around the tip: p ~ x^(1/3) in the plate's equations. The mean of these tensions over a ring
around the tip is 2n/3 in all directions, and the mean difference of radial and circumferential
tension is 2n/3, too. A uniform tension of the film adds itself to the first mean and nothing to the
second. So it is the first less the second, whatever has stretched the film: supports, loads, other
tips or an earlier relaxation. In both means a quad counts by the part of the turn around the tip
that it takes.

By the plate's equations this is within 0.1 of N_F, at 4 L from the tip and farther, of a tension
that is equal in all directions.
"""

from __future__ import annotations

import math

import numpy as np

from shellcut.arrays import Floats, norm, product, unit
from shellcut.mitc4.shell import MITC4Shell
from shellcut.state import State

from .film_around import with_neighbours

# Part of a turn that one quad of a closed ring may take. Beside a gap of more than a quarter of a
# turn it takes more, and part of the tip's own tension would count as that of the film.
_WIDEST = 0.15


def tension_around(
    shell: MITC4Shell, state: State, row: int, place: Floats, distance: float
) -> tuple[float, float]:
    """Return the principal membrane stresses around a tip without its own, the larger first [MPa].

    They are 0 if the film ends before the ring, or the ring is open.

    Parameters
    ----------
    shell : MITC4Shell
        Its stresses.
    state : State
        Current positions.
    row : int
        Quad that the tip presses. Two quads at least lie between it and the ring, because the mesh
        smooths the stress near a tip.
    place : ndarray, shape (3,)
        Of the tip [mm].
    distance : float
        From the tip to the centres of the quads in the ring, at least [mm].
    """
    n, inner = state.node, with_neighbours(state, with_neighbours(state, np.array([row])))
    while True:
        every = with_neighbours(state, inner)
        ring, inner = np.setdiff1d(every, inner), every
        ring = ring[n.real[state.quads[ring]].all(axis=1)]  # stresses in cut quads are not smooth
        if not ring.size:
            return 0.0, 0.0
        gap = n.x[state.quads[ring]].mean(axis=1) - place
        if (away := norm(gap)).min() >= distance:
            break
    stress, out = shell.stress(state, ring, place="nominal"), gap / away[:, None]
    share = _shares_of_turn(out, n.t[state.quads[row]].mean(axis=0))
    if share.max() > _WIDEST:
        return 0.0, 0.0
    radial = float(product(share, (product(stress, out[:, :, None])[:, :, 0] * out).sum(axis=1)))
    mean = np.einsum("n,nij->ij", share, stress)
    half = 0.5 * float(mean.trace())
    apart = math.sqrt(max(0.5 * float((mean * mean).sum()) - half * half, 0.0))
    without = half - 2.0 * (radial - half)
    return without + apart, without - apart


def _shares_of_turn(out: Floats, normal: Floats) -> Floats:
    """Return which part of a turn about a normal belongs to each direction : (n, 3), shape (n,)."""
    t = unit(normal)
    first = unit(out[0] - product(out[0], t) * t)
    along, across = product(out, first).tolist(), product(out, np.cross(t, first)).tolist()
    angle = np.array([math.atan2(y, x) for x, y in zip(along, across, strict=True)])
    order = np.argsort(angle, kind="stable")
    gaps = np.diff(angle[order], append=angle[order[0]] + 2.0 * np.pi) / (2.0 * np.pi)
    share = np.empty(len(out))
    share[order] = 0.5 * (gaps + np.roll(gaps, 1))
    return share
