"""How the energy of quads changes as their corners slide along the reference film.

The film in space stays where it is while the corners of some quads slide along the reference
surface: the *inner variation* of the energy, whose sum over a domain around the tip of a crack is
the force on that tip ([Eshelby1951]; on meshes [MuellerMaugin2002]). The energy of a quad is
½ sᵀ H s with its sixteen strains s, the present products minus those p of the reference
(:mod:`shellcut.mitc4.element`), so that a slide changes it by

    ½ sᵀ H' s - sᵀ H p',

a prime for the change of what belongs to the reference. H' and p' are differences over ``_STEP``.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple, TypeAlias

import numpy as np

from shellcut.arrays import Floats
from shellcut.material.shell_material import ShellMaterial
from shellcut.numerics.small_matrices import inverse

from .element import N_STRAIN
from .section import stiffness
from .tangent import quad_products

# Of a quad's size: the central difference is exact to its square, 1e-8; round-off is 1e-12.
_STEP = 1e-4

# Parametric derivatives of the shape functions at the four corners, shape (4, 2, 4).
_AT_CORNERS = 0.5 * np.array(
    [
        [[-1, 1, 0, 0], [-1, 0, 0, 1]],
        [[-1, 1, 0, 0], [0, -1, 1, 0]],
        [[0, 0, 1, -1], [0, -1, 1, 0]],
        [[0, 0, 1, -1], [-1, 0, 0, 1]],
    ],
    float,
)


Ends: TypeAlias = tuple[Floats, Floats]
"""Reference positions [mm] and directors of quads that have slid, shape (n, 4, 3)."""


class SlidingEnergy(NamedTuple):
    """The energy of some quads, and its change with some slides, as functions of the strains."""

    reference: Floats
    """Products of the reference, shape (n, 16) [mm²; mm]."""
    stiffness: Floats
    """H, shape (n, 16, 16)."""
    stiffness_change: Floats
    """H' of each slide, per mm, shape (n_slide, n, 16, 16)."""
    force_change: Floats
    """H p' of each slide, per mm, shape (n_slide, n, 16)."""

    @classmethod
    def of(cls, X: Floats, T: Floats, slides: Floats, material: ShellMaterial) -> SlidingEnergy:
        """Return the energy of some quads and its changes.

        Parameters
        ----------
        X, T : ndarray, shape (n, 4, 3)
            Reference positions [mm] and directors.
        slides : ndarray, shape (n_slide, n, 4, 3)
            How far each corner slides per mm of the slide: along the quad's own surface, the part
            across it does not count.
        material : ShellMaterial
            Whose law is linear.
        """
        ends = list(slide_ends(X, T, slides))
        places = [(X, T), *(place for far, near, _ in ends for place in (far, near))]
        every_X, every_T = (np.concatenate(part) for part in zip(*places, strict=True))
        every = stiffness(every_X, every_T, material)
        H, *slid_to = every.reshape(len(places), len(X), N_STRAIN, N_STRAIN)
        changes, forces = [], []
        for k, (far, near, step) in enumerate(ends):
            changes.append((slid_to[2 * k] - slid_to[2 * k + 1]) / step)
            products = (quad_products(*far) - quad_products(*near)) / step
            forces.append(np.einsum("eij,ej->ei", H, products))
        return cls(quad_products(X, T), H, np.array(changes), np.array(forces))

    def changes(self, x: Floats, t: Floats, moves: Floats) -> Floats:
        """Return the changes of the energies with each slide [N], shape (n_slide, n).

        Parameters
        ----------
        x, t : ndarray, shape (n, 4, 3)
            Present positions [mm] and directors.
        moves : ndarray, shape (n_slide, n, 4, 3)
            How far each corner moves in space with each slide, per mm.
        """
        s = quad_products(x, t) - self.reference
        forces = np.einsum("eij,ej->ei", self.stiffness, s)
        found = np.empty(self.force_change.shape[:2])
        for k, move in enumerate(moves):
            # Products are quadratic, so that this difference is exact over any step.
            moved = 0.5 * (quad_products(x + move, t) - quad_products(x - move, t))
            bent = 0.5 * np.einsum("eij,ej->ei", self.stiffness_change[k], s)
            found[k] = np.einsum("ei,ei->e", s, bent - self.force_change[k])
            found[k] += np.einsum("ei,ei->e", forces, moved)
        return found


def slide_ends(X: Floats, T: Floats, slides: Floats) -> Iterator[tuple[Ends, Ends, float]]:
    """Yield, for each slide, (X, T) a little way along it and before it, and that way [mm].

    Parameters as of :meth:`SlidingEnergy.of`.
    """
    base = np.einsum("apb,ebi->eapi", _AT_CORNERS, X)
    step = _STEP * float(np.sqrt(np.einsum("eapi,eaqi->eapq", base, base)[..., 0, 0].mean()))
    for dX, dT in zip(*slid(X, T, slides), strict=True):
        yield (X + step * dX, T + step * dT), (X - step * dX, T - step * dT), 2.0 * step


def slid(X: Floats, T: Floats, slides: Floats) -> tuple[Floats, Floats]:
    """Return how corners and directors change that slide along their quads, (n_slide, n, 4, 3).

    Parameters as of :meth:`SlidingEnergy.of`.
    """
    base = np.einsum("apb,ebi->eapi", _AT_CORNERS, X)
    turn = np.einsum("apb,ebi->eapi", _AT_CORNERS, T)
    metric = np.einsum("eapi,eaqi->eapq", base, base)
    covariant = np.einsum("eapi,keai->keap", base, slides)
    by = np.einsum("eapq,keaq->keap", inverse(metric), covariant)
    return np.einsum("keap,eapi->keai", by, base), np.einsum("keap,eapi->keai", by, turn)
