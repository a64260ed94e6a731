"""Where a crack goes that no blade drives: across the largest principal stress ahead of it.

The stress at a tip depends on the mesh. What decides is the mean of the Cauchy stress at the
mid-surface over the quads ahead of the tip, weighted by the area of their film and a Gaussian of
``AVERAGE`` edge lengths around the tip. On a curved film each stress is first turned into the sheet
at the tip by the least rotation that takes one normal to the other: the mean of tensors in planes
that lean against each other would lose the part across the lean. The crack runs in the sheet,
forward, normal to the largest principal direction of that mean.
"""

from __future__ import annotations

import numpy as np

from shellcut.arrays import Floats
from shellcut.mitc4.shell import MITC4Shell
from shellcut.state import State

from .tip import Place

AVERAGE = 2.5
"""Standard deviation of the weights around a tip, in local edge lengths."""

# Of 1 + c, for film folded back onto itself, where no rotation is the least one.
_FOLDED = 1e-3

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

    def of(self, state: State, place: Floats, at: Place, heading: Floats) -> Floats | None:
        """Return the unit direction in space, shape (3,); None if nothing ahead is pulled.

        Parameters
        ----------
        state : State
            Present positions.
        place : ndarray, shape (3,)
            Of the tip in the reference film [mm].
        at : Place
            Where it is now.
        heading : ndarray, shape (3,)
            In which it came, in the reference film.
        """
        corners = state.node.X[self._shell.mesh_quads]
        gap = corners.mean(axis=1) - place
        squared = np.einsum("ij,ij->i", gap, gap)
        width = AVERAGE * at.size
        near = np.flatnonzero((squared < (_FAR * width) ** 2) & (gap @ heading > 0.0))
        # The far wall of a tube is not ahead.
        near = near[_normals(corners[near]) @ at.T > 0.0]
        if near.size == 0:
            return None
        weight = np.exp(-0.5 * squared[near] / width**2)
        weight *= self._shell.area[near] * state.quad.share[near]
        stress = self._shell.stress(state, near, place="mid")
        turn = _turns(_normals(state.node.x[state.quads[near]]), at.t)
        stress = turn @ stress @ turn.transpose(0, 2, 1)
        mean = np.einsum("i,ijk->jk", weight, stress) / weight.sum()
        # Two unit vectors of the sheet, the first one forward.
        forward = at.heading - (at.heading @ at.t) * at.t
        forward /= np.linalg.norm(forward)
        base = np.stack([forward, np.cross(at.t, forward)])
        values, vectors = np.linalg.eigh(base @ mean @ base.T)
        if values[1] <= 0.0:
            return None
        across = vectors[:, 1] @ base
        way = np.cross(at.t, across)
        way /= np.linalg.norm(way)
        return np.asarray(way if way @ forward >= 0.0 else -way)


def _normals(corners: Floats) -> Floats:
    """Return the unit normals of quads with these corners : (n, 4, 3), shape (n, 3)."""
    normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    return np.asarray(normal / np.linalg.norm(normal, axis=1)[:, None])


def _turns(start: Floats, end: Floats) -> Floats:
    """Return the least rotations that take unit vectors start : (n, 3) to end, shape (n, 3, 3).

    With v = start x end and c their cosine, R = 1 + [v] + [v]² / (1 + c): exactly 1 where v is 0.
    """
    x, y, z = np.cross(start, end).T
    zero = np.zeros_like(x)
    v = np.array([[zero, -z, y], [z, zero, -x], [-y, x, zero]]).transpose(2, 0, 1)
    squared = v @ v / np.maximum(1.0 + start @ end, _FOLDED)[:, None, None]
    return np.asarray(np.eye(3) + v + squared)
