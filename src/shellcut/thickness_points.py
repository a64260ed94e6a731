"""Resultants by points through the thickness: the general path, for any material with history.

At every Gauss point of the quad and every point xi³ of the thickness, with Q and √G as in
:mod:`shellcut.section`,

    e = Q (E + xi³ K, 2E_13, 2E_23),   S = law(e, history),   (N, M, q) += w √G Qᵀ (S, xi³ S, ..),

so curved and warped references, the volume factor and layers are treated as in the pre-integrated
section. For a St.Venant-Kirchhoff material both paths agree to round-off; this one costs more
and needs no linearity. The transverse shear stays elastic.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ._jit import Floats, Ints, inline
from .material import ShellMaterial
from .mitc4 import ETA_SIDE, FAR, NEAR, XI_SIDE
from .point_law import N_PARAMETER, point_stress
from .section import cartesian_map, gauss_geometry


@dataclass(frozen=True)
class PointTable:
    """Thickness points of every quad; without any the arrays are empty.

    Attributes
    ----------
    map : ndarray, shape (n_quad, 4, n_point, 5, 5)
        Q at every point.
    weight : ndarray, shape (n_quad, 4, n_point)
        w √G [mm³].
    place : ndarray, shape (n_point,)
        xi³ [mm].
    kind : ndarray of int, shape (n_point,)
        Law of each point.
    parameters : ndarray, shape (n_point, N_PARAMETER)
        Of each point's law.
    shear : ndarray, shape (n_point, 3)
        Transverse shear moduli 11, 12, 22 with the shear factor [MPa].
    n_history : int
        Numbers kept at a point.
    """

    map: Floats
    weight: Floats
    place: Floats
    kind: Ints
    parameters: Floats
    shear: Floats
    n_history: int

    @property
    def n_point(self) -> int:
        """Points through the thickness; 0 where the section is pre-integrated."""
        return int(self.place.size)


def build_points(
    nodes: Floats, directors: Floats, quads: Ints, material: ShellMaterial
) -> PointTable:
    """Lay out the thickness points; an empty table for a pre-integrated material."""
    if material.points_per_layer is None:
        return PointTable(
            np.zeros((0, 4, 0, 5, 5)),
            np.zeros((0, 4, 0)),
            np.zeros(0),
            np.zeros(0, np.int64),
            np.zeros((0, N_PARAMETER)),
            np.zeros((0, 3)),
            0,
        )
    place, thickness_weight, layers = material.thickness_points(material.points_per_layer)
    n_point = place.size
    Q = np.zeros((quads.shape[0], 4, n_point, 5, 5))
    weight = np.zeros((quads.shape[0], 4, n_point))
    for q, (_, A1, A2, T0, T1, T2) in enumerate(gauss_geometry(nodes[quads], directors[quads])):
        for k in range(n_point):
            G1, G2 = A1 + place[k] * T1, A2 + place[k] * T2  # [Frangi2010] (6)
            Q[:, q, k], _ = cartesian_map(G1, G2, T0)
            weight[:, q, k] = thickness_weight[k] * np.einsum("ei,ei->e", np.cross(G1, G2), T0)
    shear = [material.shear_factor * layer.transverse_shear() for layer in layers]
    return PointTable(
        Q,
        weight,
        place,
        np.array([layer.kind for layer in layers]),
        np.array([layer.parameters() for layer in layers]),
        np.array([[s[0, 0], s[0, 1], s[1, 1]] for s in shear]),
        max(layer.n_history for layer in layers),
    )


@inline
def point_resultants(
    s: Floats,
    e: int,
    cartesian: Floats,
    weight: Floats,
    place: Floats,
    kind: Ints,
    parameters: Floats,
    shear: Floats,
    old: Floats,
    new: Floats,
    r: Floats,
) -> float:
    """Write r, the resultants of the strains s : (20,) of quad e; return its stored energy [N·mm].

    cartesian, weight, place, kind, parameters, shear : fields of PointTable.  old, new : (4,
    n_point, n_history), the quad's histories at t_{n-1} and t_n, which may be one array.
    """
    near, far = 2.0 * NEAR, 2.0 * FAR
    stored = 0.0
    for k in range(20):
        r[k] = 0.0
    for q in range(4):
        i, j = ETA_SIDE[q], XI_SIDE[q]
        w1m, w1p = (near, far) if i == 0 else (far, near)
        w2m, w2p = (near, far) if j == 0 else (far, near)
        g1 = w1m * s[16] + w1p * s[17]
        g2 = w2m * s[18] + w2p * s[19]
        q1 = q2 = 0.0
        for k in range(place.shape[0]):
            z, w = place[k], weight[e, q, k]
            v = (
                s[i] + z * s[8 + i],
                s[2 + j] + z * s[10 + j],
                s[4 + q] + z * s[12 + q],
                g1,
                g2,
            )
            Q = cartesian[e, q, k]
            c1 = c2 = c12 = c13 = c23 = 0.0
            for m in range(5):
                c1 += Q[0, m] * v[m]
                c2 += Q[1, m] * v[m]
                c12 += Q[2, m] * v[m]
                c13 += Q[3, m] * v[m]
                c23 += Q[4, m] * v[m]
            (s1, s2, s12), density = point_stress(
                kind[k], parameters, k, (c1, c2, c12), old[q], new[q]
            )
            s13 = shear[k, 0] * c13 + shear[k, 1] * c23
            s23 = shear[k, 1] * c13 + shear[k, 2] * c23
            stored += w * (density + 0.5 * (s13 * c13 + s23 * c23))
            n1 = w * (Q[0, 0] * s1 + Q[1, 0] * s2 + Q[2, 0] * s12 + Q[3, 0] * s13 + Q[4, 0] * s23)
            n2 = w * (Q[0, 1] * s1 + Q[1, 1] * s2 + Q[2, 1] * s12 + Q[3, 1] * s13 + Q[4, 1] * s23)
            n12 = w * (Q[0, 2] * s1 + Q[1, 2] * s2 + Q[2, 2] * s12 + Q[3, 2] * s13 + Q[4, 2] * s23)
            q1 += w * (Q[0, 3] * s1 + Q[1, 3] * s2 + Q[2, 3] * s12 + Q[3, 3] * s13 + Q[4, 3] * s23)
            q2 += w * (Q[0, 4] * s1 + Q[1, 4] * s2 + Q[2, 4] * s12 + Q[3, 4] * s13 + Q[4, 4] * s23)
            r[i] += n1
            r[2 + j] += n2
            r[4 + q] += n12
            r[8 + i] += z * n1
            r[10 + j] += z * n2
            r[12 + q] += z * n12
        r[16] += w1m * q1
        r[17] += w1p * q1
        r[18] += w2m * q2
        r[19] += w2p * q2
    return stored
