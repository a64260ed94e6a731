"""A film that tears more easily in one direction than in another: strength and energy by direction.

Drawn and rolled films part along the direction in which they were made (MD) at another G than
across it (CD). With the angle theta between a crack and MD in the reference film,

    G(theta) = G f(theta),   sigma_F(theta) = sigma_F f(theta),
    f(theta) = ½ (along + across) + ½ (along - across) cos 2 theta:

the cohesive law times f, its openings being the same. A cable across a segment has the area f times
that of the film that it replaces, which is the same and needs nothing else.

A crack that lacks energy then runs in the direction where J · e / f is largest: with theta_T the
direction of J, where G(theta) / cos(theta - theta_T) is least, (ln G)' = -tan(theta - theta_T). It
follows from :mod:`.free_direction`, without any rule of its own.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from shellcut.arguments import Option, checked
from shellcut.arrays import Floats, product, unit
from shellcut.mesh.quad_geometry import corner_normals
from shellcut.numerics.bilinear import shape_functions

from .quad_polygon import Point


@checked
@dataclass(frozen=True, kw_only=True)
class Anisotropy:
    """Factor on the law's strength and energy by the direction of a crack.

    Parameters
    ----------
    direction : sequence of float
        Machine direction in the reference film, of any length; its part in the sheet counts.

    Raises
    ------
    ValueError
        If the direction is zero or not finite.

    Examples
    --------
    Half as tough along MD as across it:

    >>> film = Anisotropy(direction=(1.0, 0.0, 0.0), along=0.5, across=1.0)
    >>> film.factors(np.eye(3), np.array([0.0, 0.0, 1.0]))[:2].tolist()
    [0.5, 1.0]
    """

    direction: tuple[float, float, float]
    along: Annotated[float, Option("", "f of a crack along MD", above=0)] = 1.0
    across: Annotated[float, Option("", "f of a crack across MD", above=0)] = 1.0

    def __post_init__(self) -> None:
        along = np.asarray(self.direction, float)
        if along.shape != (3,) or not np.isfinite(along).all() or not along.any():
            raise ValueError(f"direction must be a vector that is not zero, got {self.direction!r}")

    def factors(self, directions: Floats, normal: Floats) -> Floats:
        """Return f for cracks along some directions, shape (n,).

        Parameters
        ----------
        directions : ndarray, shape (n, 3)
            In the reference sheet, of any length but 0.
        normal : ndarray, shape (3,)
            Unit normal of the sheet; where MD is along it, f is the mean of both.
        """
        md = unit(np.asarray(self.direction, float))
        md = md - product(md, normal) * normal
        size = product(md, md)
        cosine = product(directions, md) ** 2 / np.einsum("ij,ij->i", directions, directions)
        twice = 2.0 * cosine - size
        return np.asarray(0.5 * (self.along + self.across + (self.along - self.across) * twice))


def factor_along(film: Anisotropy | None, X: Floats, chord: tuple[Point, Point]) -> float:
    """Return f for a crack along a chord of a quad with corners at X : (4, 3); 1 if all f are."""
    if film is None:
        return 1.0
    start, stop = (product(shape_functions(*p), X) for p in chord)
    return float(film.factors((stop - start)[None], corner_normals(X))[0])
