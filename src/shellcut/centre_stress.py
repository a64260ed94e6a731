"""Cauchy stress at the centres of quads, from the deformation there.

With the base vectors G_alpha of the reference and g_alpha of the present surface at the height xi³
at the quad's centre, the strain is E_alphabeta = ½ (g_alpha·g_beta - G_alpha·G_beta). In the
Cartesian frame ê_3 = T/|T|, ê_1 ∝ G_2 x ê_3 of :mod:`shellcut.section` the stress is S = C E, and

    sigma = S_ij f_i f_j / J,      f_i = F ê_i = (ê_i·G^alpha) g_alpha,

with J = |g_1 x g_2| / |G_1 x G_2| the change of area.
"""

from __future__ import annotations

import numpy as np

from ._jit import Floats, Ints, Vec3, inline, kernel
from ._vec3 import combine, cross, dot, load, norm, scale
from .material import ShellMaterial
from .mesh import Mesh


class CentreStress:
    """Reference geometry and layers, to recover stresses at the quads' centres."""

    def __init__(self, mesh: Mesh, material: ShellMaterial) -> None:
        self._mesh = mesh
        layers = material.layers
        bottom = np.cumsum([0.0, *(layer.thickness for layer in layers)])
        mid = int(np.searchsorted(bottom, 0.5 * material.thickness, side="right")) - 1
        self._law = {
            "mid": layers[mid].material.plane_stress(),
            "nominal": layers[mid].material.plane_stress(),
            "top": layers[-1].material.plane_stress(),
            "bottom": layers[0].material.plane_stress(),
        }
        h = material.thickness
        self._height = {"mid": 0.0, "nominal": 0.0, "top": 0.5 * h, "bottom": -0.5 * h}

    def cauchy(self, x: Floats, t: Floats, quads: Ints, which: Ints, place: str) -> Floats:
        """Return the stress tensors of some quads [MPa], shape (n, 3, 3), in space.

        Parameters
        ----------
        x, t : ndarray, shape (n_node, 3)
            Present positions [mm] and directors.
        quads : ndarray of int, shape (n_quad, 4)
            Present node ids.
        which : ndarray of int, shape (n,)
            The quads asked for.
        place : {"mid", "top", "bottom", "nominal"}
            As :meth:`MITC4Shell.stress`.
        """
        if place not in self._law:
            raise ValueError(f"place must be one of {sorted(self._law)}, got {place!r}")
        sigma = np.empty((len(which), 3, 3))
        _cauchy(
            which=np.asarray(which, np.int64),
            X=self._mesh.nodes,
            T=self._mesh.directors,
            reference_quads=self._mesh.quads,
            x=x,
            t=t,
            quads=quads,
            height=self._height[place],
            law=self._law[place],
            nominal=place == "nominal",
            sigma=sigma,
        )
        return sigma


@inline
def _centre(x: Floats, quads: Ints, e: int) -> tuple[Vec3, Vec3, Vec3]:
    """Return the value at the centre of quad e and the derivatives by xi and eta."""
    x0, x1 = load(x, quads[e, 0]), load(x, quads[e, 1])
    x2, x3 = load(x, quads[e, 2]), load(x, quads[e, 3])
    near, far = combine(0.25, x0, 0.25, x1), combine(0.25, x2, 0.25, x3)
    left, right = combine(0.25, x0, 0.25, x3), combine(0.25, x1, 0.25, x2)
    return (
        combine(1.0, near, 1.0, far),
        combine(1.0, right, -1.0, left),
        combine(1.0, far, -1.0, near),
    )


@kernel
def _cauchy(
    which: Ints,
    X: Floats,
    T: Floats,
    reference_quads: Ints,
    x: Floats,
    t: Floats,
    quads: Ints,
    height: float,
    law: Floats,
    nominal: bool,
    sigma: Floats,
) -> None:
    """Write the stress of the quads ``which`` at xi³ = height to sigma : (n, 3, 3).

    X, T, reference_quads : of the reference; x, t, quads : of the present.  law : (3, 3), plane
    stress.  nominal : S turned with the surface instead of sigma.
    """
    for i in range(which.shape[0]):
        e = which[i]
        _, A1, A2 = _centre(X, reference_quads, e)
        T0, T1, T2 = _centre(T, reference_quads, e)
        _, a1, a2 = _centre(x, quads, e)
        _, b1, b2 = _centre(t, quads, e)
        G1, G2 = combine(1.0, A1, height, T1), combine(1.0, A2, height, T2)
        g1, g2 = combine(1.0, a1, height, b1), combine(1.0, a2, height, b2)
        e3 = scale(1.0 / norm(T0), T0)
        e1 = cross(G2, e3)
        e1 = scale(1.0 / norm(e1), e1)
        e2 = cross(e3, e1)
        # G^1 and G^2 of the basis G_1, G_2, T.
        volume = dot(cross(G1, G2), T0)
        up1, up2 = cross(G2, T0), cross(T0, G1)
        c11, c12 = dot(e1, up1) / volume, dot(e1, up2) / volume
        c21, c22 = dot(e2, up1) / volume, dot(e2, up2) / volume
        E11 = 0.5 * (dot(g1, g1) - dot(G1, G1))
        E22 = 0.5 * (dot(g2, g2) - dot(G2, G2))
        E12 = dot(g1, g2) - dot(G1, G2)
        s1 = c11 * c11 * E11 + c12 * c12 * E22 + c11 * c12 * E12
        s2 = c21 * c21 * E11 + c22 * c22 * E22 + c21 * c22 * E12
        s12 = 2.0 * (c11 * c21 * E11 + c12 * c22 * E22) + (c11 * c22 + c12 * c21) * E12
        S11 = law[0, 0] * s1 + law[0, 1] * s2 + law[0, 2] * s12
        S22 = law[1, 0] * s1 + law[1, 1] * s2 + law[1, 2] * s12
        S12 = law[2, 0] * s1 + law[2, 1] * s2 + law[2, 2] * s12
        f1, f2 = combine(c11, g1, c12, g2), combine(c21, g1, c22, g2)
        stretch = 1.0
        if nominal:
            normal = cross(f1, f2)
            f1 = scale(1.0 / norm(f1), f1)
            f2 = cross(scale(1.0 / norm(normal), normal), f1)
        else:
            stretch = norm(cross(g1, g2)) / norm(cross(G1, G2))
        for k in range(3):
            for m in range(3):
                sigma[i, k, m] = (
                    S11 * f1[k] * f1[m]
                    + S22 * f2[k] * f2[m]
                    + S12 * (f1[k] * f2[m] + f2[k] * f1[m])
                ) / stretch
