"""Axes of the film at the Gauss points, for layers that differ along and across.

The strains at a Gauss point are given in the frame ê_1, ê_2 of :mod:`.section`, which follows the
edges of the quad. A law with axes needs them along the film's direction d, of which the part normal
to the director is left out, and across it. With the angle θ from ê_1 to d, cos θ and sin θ are two
numbers a Gauss point, the same for all heights: on a curved film ê_1 turns about the director by
less than the square of height over radius.
"""

from __future__ import annotations

import numpy as np

from shellcut.arrays import Floats, Number, Vector
from shellcut.material.shell_material import ShellMaterial
from shellcut.numerics.jit import always_inline

from .section import axes_in_frame, gauss_geometry

N_AXES = 8
"""Floats a quad: cos θ, sin θ of the four Gauss points."""


def film_axes(X: Floats, T: Floats, material: ShellMaterial) -> Floats:
    """Return cos θ and sin θ at the four Gauss points of quads, shape (n_quad, 8).

    Parameters
    ----------
    X, T : ndarray, shape (n_quad, 4, 3)
        Reference positions [mm] and directors.
    material : ShellMaterial
        Knows the direction.

    Raises
    ------
    ValueError
        If the direction is normal to the sheet somewhere.
    """
    rows = []
    for n, A1, A2, T0, _, _ in gauss_geometry(X, T):
        place = np.einsum("a,eac->ec", n, X)
        cosine, sine = axes_in_frame(A1, A2, T0, material.direction_at(place))
        if np.isnan(cosine).any():
            x, y, z = place[np.argmax(np.isnan(cosine))]
            raise ValueError(
                "direction must have a part in the sheet everywhere, at "
                f"({x:.4g}, {y:.4g}, {z:.4g}) mm it is zero or normal to the film: give a function "
                "of positions, such as the circumference of a tube"
            )
        rows += [cosine, sine]
    return np.stack(rows, axis=1)


@always_inline
def into_axes(c: Number, s: Number, e: Vector) -> Vector:
    """Return strains (e_11, e_22, 2 e_12) in axes turned by θ."""
    cc, ss, cs = c * c, s * s, c * s
    return (
        cc * e[0] + ss * e[1] + cs * e[2],
        ss * e[0] + cc * e[1] - cs * e[2],
        2.0 * cs * (e[1] - e[0]) + (cc - ss) * e[2],
    )


@always_inline
def out_of_axes(c: Number, s: Number, S: Vector) -> Vector:
    """Return stresses (S_11, S_22, S_12), given in axes turned by θ, in the frame."""
    cc, ss, cs = c * c, s * s, c * s
    return (
        cc * S[0] + ss * S[1] - 2.0 * cs * S[2],
        ss * S[0] + cc * S[1] + 2.0 * cs * S[2],
        cs * (S[0] - S[1]) + (cc - ss) * S[2],
    )
