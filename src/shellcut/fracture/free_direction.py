"""Where a crack goes that no blade drives: across the largest principal stress ahead of it.

The stress at a tip depends on the mesh. What decides is the mean of the Cauchy stress at the
mid-surface over the quads ahead of the tip, weighted by the area of their film and a Gaussian of
``AVERAGE`` edge lengths around the tip. The crack runs in the sheet, forward, normal to the largest
principal direction of that mean.
"""

from __future__ import annotations

import numpy as np

from shellcut.arrays import Floats
from shellcut.mitc4.shell import MITC4Shell
from shellcut.state import State

AVERAGE = 2.5
"""Standard deviation of the weights around a tip, in local edge lengths."""

# Quads farther than this many standard deviations have no weight.
_FAR = 2.5


class FreeDirection:
    """Finds directions of cracks by the stress ahead.

    Parameters
    ----------
    shell : MITC4Shell
        Gives the stresses.
    """

    def __init__(self, shell: MITC4Shell) -> None:
        self._shell = shell

    def of(
        self, state: State, place: Floats, t: Floats, size: float, heading: Floats
    ) -> Floats | None:
        """Return the unit direction in space, shape (3,); None if nothing ahead is pulled.

        Parameters
        ----------
        state : State
            Present positions.
        place : ndarray, shape (3,)
            Of the tip in the reference film [mm].
        t : ndarray, shape (3,)
            Director there.
        size : float
            Local edge length [mm].
        heading : ndarray, shape (3,)
            In which the tip came, in the reference film.
        """
        corners = state.node.X[self._shell.mesh_quads]
        gap = corners.mean(axis=1) - place
        squared = np.einsum("ij,ij->i", gap, gap)
        width = AVERAGE * size
        near = np.flatnonzero((squared < (_FAR * width) ** 2) & (gap @ heading > 0.0))
        if near.size == 0:
            return None
        weight = np.exp(-0.5 * squared[near] / width**2)
        weight *= self._shell.area[near] * state.quad.share[near]
        stress = self._shell.stress(state, near, place="mid")
        mean = np.einsum("i,ijk->jk", weight, stress) / weight.sum()
        # Two unit vectors of the sheet, the first one forward.
        forward = heading - (heading @ t) * t
        forward /= np.linalg.norm(forward)
        base = np.stack([forward, np.cross(t, forward)])
        values, vectors = np.linalg.eigh(base @ mean @ base.T)
        if values[1] <= 0.0:
            return None
        across = vectors[:, 1] @ base
        way = np.cross(t, across)
        way /= np.linalg.norm(way)
        return np.asarray(way if way @ heading >= 0.0 else -way)
