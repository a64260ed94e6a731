"""Cauchy stress at the centres of quads, for the criterion, the recovery and the pictures."""

from __future__ import annotations

import numpy as np

from ._jit import Floats, Ints
from .material import ShellMaterial
from .mesh import Mesh
from .section import cartesian_map, shape_functions


class CentreStressMap:
    """Reference geometry at the quads' centres, to recover stresses there."""

    def __init__(self, mesh: Mesh, material: ShellMaterial) -> None:
        X, T = mesh.nodes[mesh.quads], mesh.directors[mesh.quads]
        n, n1, n2 = shape_functions(0.0, 0.0)
        self._n1, self._n2 = n1, n2
        self._A1, self._A2 = np.einsum("a,eai->ei", n1, X), np.einsum("a,eai->ei", n2, X)
        self._T0 = np.einsum("a,eai->ei", n, T)
        self._T1, self._T2 = np.einsum("a,eai->ei", n1, T), np.einsum("a,eai->ei", n2, T)
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

    def cauchy(self, x: Floats, t: Floats, quads: Ints, place: str) -> Floats:
        if place not in self._law:
            raise ValueError(f"place must be one of {sorted(self._law)}, got {place!r}")
        z = self._height[place]
        G1 = self._A1[quads] + z * self._T1[quads]
        G2 = self._A2[quads] + z * self._T2[quads]
        g1 = np.einsum("a,eai->ei", self._n1, x) + z * np.einsum("a,eai->ei", self._n1, t)
        g2 = np.einsum("a,eai->ei", self._n2, x) + z * np.einsum("a,eai->ei", self._n2, t)
        Q, frame = cartesian_map(G1, G2, self._T0[quads])

        def product(a: Floats, b: Floats) -> Floats:
            return np.asarray(np.einsum("ei,ei->e", a, b))

        covariant = np.stack(
            [
                0.5 * (product(g1, g1) - product(G1, G1)),
                0.5 * (product(g2, g2) - product(G2, G2)),
                product(g1, g2) - product(G1, G2),
            ],
            axis=1,
        )
        s = np.einsum("eij,ej->ei", Q[:, :3, :3], covariant) @ self._law[place]
        # F ê_i, the frame carried along by the deformation, from ê_i = (ê_i · G^alpha) G_alpha.
        contra = np.linalg.inv(np.stack([G1, G2, self._T0[quads]], axis=2))[:, :2]
        c = np.einsum("eki,eni->enk", contra, frame)
        f1 = c[:, 0, :1] * g1 + c[:, 0, 1:] * g2
        f2 = c[:, 1, :1] * g1 + c[:, 1, 1:] * g2
        if place == "nominal":
            f1, f2 = _orthonormal(f1, f2)
            volume = np.ones(len(quads))
        else:
            volume = np.linalg.norm(np.cross(g1, g2), axis=1) / np.linalg.norm(
                np.cross(G1, G2), axis=1
            )
        outer = np.einsum
        sigma = (
            s[:, 0, None, None] * outer("ei,ej->eij", f1, f1)
            + s[:, 1, None, None] * outer("ei,ej->eij", f2, f2)
            + s[:, 2, None, None] * (outer("ei,ej->eij", f1, f2) + outer("ei,ej->eij", f2, f1))
        )
        return np.asarray(sigma / volume[:, None, None])


def _orthonormal(f1: Floats, f2: Floats) -> tuple[Floats, Floats]:
    normal = np.cross(f1, f2)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    e1 = f1 / np.linalg.norm(f1, axis=1, keepdims=True)
    return e1, np.cross(normal, e1)
