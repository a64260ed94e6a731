"""Section stiffness H of every Gauss point, in covariant components, integrated once.

At a Gauss point the generalised strains are v = (E_11, E_22, 2E_12, K_11, K_22, 2K_12, 2E_13,
2E_23), all covariant, and the energy there is ½ vᵀ H v with

    H = ∫ Pᵀ Qᵀ C Q P √G dxi³ (Gauss weight 1),      √G = det(G_1, G_2, G_3).

P (5 x 8) gives the covariant strains at the height xi³: E + xi³ K, and the tied shear; Q (5 x 5)
takes covariant to Cartesian components in the frame ê_3 = T/|T|, ê_1 ∝ G_2 x ê_3 of
[DvorkinBathe1984], by e_ij = (ê_i·G^k)(ê_j·G^l) E_kl; C is the plane-stress law with the shear
moduli. Because G_alpha = A_alpha + xi³ T_,alpha ([Frangi2010] 6) is taken at its own height, the
curvature of the reference surface and the volume factor mu ([Frangi2010] 20) are exact, warped
quads included, and a layered section brings its coupling of stretching and bending along.

Between nodes the interpolated director is a little shorter than one: on a curved quad that turns by
10° by 0.4 %. The stiffness is that of this body, as in [DvorkinBathe1984], whose values it
matches mesh by mesh; the mass is that of the film, rho |G_1 x G_2| ([Frangi2010] 20).

Where the reference quad is flat (T constant and normal to it) and the layers are symmetric, H falls
apart into membrane, bending and shear: fifteen numbers instead of thirty-six.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ._jit import Bools, Floats, Ints
from .material import ShellMaterial

# A quad counts as flat when its directors agree and stand normal to its corners' edges to this
# relative size: round-off of normalised normals, far below any curvature that matters.
_FLAT = 1e-12

_XI = np.array([-1.0, 1.0, 1.0, -1.0])
_ETA = np.array([-1.0, -1.0, 1.0, 1.0])


def shape_functions(xi: float, eta: float) -> tuple[Floats, Floats, Floats]:
    """Return N_a and its derivatives by xi and eta, each of shape (4,), at one point."""
    n = 0.25 * (1.0 + xi * _XI) * (1.0 + eta * _ETA)
    return n, 0.25 * _XI * (1.0 + eta * _ETA), 0.25 * _ETA * (1.0 + xi * _XI)


def gauss_geometry(X: Floats, T: Floats) -> Iterator[tuple[Floats, ...]]:
    """Yield N_a, A_1, A_2, T, T_,1, T_,2 at the four Gauss points of quads.

    Parameters
    ----------
    X, T : ndarray, shape (n_quad, 4, 3)
        Reference positions [mm] and directors.
    """
    g = 1.0 / np.sqrt(3.0)
    for xi, eta in zip(g * _XI, g * _ETA, strict=True):
        n, n1, n2 = shape_functions(xi, eta)
        A1, A2 = np.einsum("a,eai->ei", n1, X), np.einsum("a,eai->ei", n2, X)
        T0 = np.einsum("a,eai->ei", n, T)
        yield n, A1, A2, T0, np.einsum("a,eai->ei", n1, T), np.einsum("a,eai->ei", n2, T)


@dataclass(frozen=True)
class SectionTable:
    """Section stiffness of every quad at its four Gauss points.

    Attributes
    ----------
    flat : ndarray of bool, shape (n_quad,)
        Whether the quad takes the compact form.
    row : ndarray of int, shape (n_quad,)
        Its row in ``h_flat`` or ``h_full``.
    h_flat : ndarray, shape (n_flat, 4, 15)
        Upper triangles of membrane (6), bending (6) and shear (3) stiffness.
    h_full : ndarray, shape (n_curved, 4, 8, 8)
        Full stiffness.
    mass : ndarray, shape (n_quad, 4)
        Share of each node in the quad's mass, ∫ N_a rho |G_1 x G_2|, row-sum lumped [t].
    area : ndarray, shape (n_quad,)
        Reference area [mm²].
    """

    flat: Bools
    row: Ints
    h_flat: Floats
    h_full: Floats
    mass: Floats
    area: Floats


def build_sections(
    nodes: Floats, directors: Floats, quads: Ints, material: ShellMaterial
) -> SectionTable:
    """Integrate the section stiffness and the mass of every quad.

    Parameters
    ----------
    nodes, directors : ndarray, shape (n_node, 3)
        Reference positions [mm] and unit directors.
    quads : ndarray, shape (n_quad, 4)
        Node ids, counter-clockwise seen from the director's side.
    material : ShellMaterial
        Layers and shear factor.
    """
    X, T = nodes[quads], directors[quads]
    n_quad = quads.shape[0]
    flat = _is_flat(X, T) & material.is_symmetric
    row = np.where(flat, np.cumsum(flat), np.cumsum(~flat)) - 1

    h_flat = np.zeros((int(flat.sum()), 4, 15))
    h_full = np.zeros((int((~flat).sum()), 4, 8, 8))
    mass = np.zeros((n_quad, 4))
    area = np.zeros(n_quad)
    for q, (n, A1, A2, T0, T1, T2) in enumerate(gauss_geometry(X, T)):
        area += np.linalg.norm(np.cross(A1, A2), axis=1)
        for z, weight, layer in zip(*material.thickness_points(), strict=True):
            G1, G2 = A1 + z * T1, A2 + z * T2  # [Frangi2010] (6)
            normal = np.cross(G1, G2)
            surface = weight * np.linalg.norm(normal, axis=1)  # [Frangi2010] (20)
            mass += layer.density * surface[:, None] * n
            volume = weight * np.einsum("ei,ei->e", normal, T0)
            C = np.zeros((5, 5))
            C[:3, :3] = layer.plane_stress()
            C[3:, 3:] = material.shear_factor * layer.transverse_shear()
            h_flat[:, q] += _compact(
                _covariant_stiffness(C, G1[flat], G2[flat], T0[flat]), volume[flat], z
            )
            h_full[:, q] += _spread(
                _covariant_stiffness(C, G1[~flat], G2[~flat], T0[~flat]), volume[~flat], z
            )
    return SectionTable(flat, row.astype(np.int64), h_flat, h_full, mass, area)


def _is_flat(X: Floats, T: Floats) -> Bools:
    size = np.linalg.norm(X[:, 2] - X[:, 0], axis=1)[:, None]
    edges = np.roll(X, -1, axis=1) - X
    bent = np.abs(T - T[:, :1]).max(axis=(1, 2)) > _FLAT
    tilted = (np.abs(np.einsum("eai,ei->ea", edges, T[:, 0])) > _FLAT * size).any(axis=1)
    return np.asarray(~(bent | tilted))


def cartesian_map(G1: Floats, G2: Floats, G3: Floats) -> tuple[Floats, Floats]:
    """Return Q, shape (n, 5, 5), and the in-plane frame (ê_1, ê_2), shape (n, 2, 3).

    Q takes the covariant (E_11, E_22, 2E_12, 2E_13, 2E_23), with E_33 = 0, to the Cartesian
    (e_11, e_22, 2e_12, 2e_13, 2e_23).
    """
    e3 = G3 / np.linalg.norm(G3, axis=1, keepdims=True)
    e1 = np.cross(G2, e3)
    e1 /= np.linalg.norm(e1, axis=1, keepdims=True)
    e2 = np.cross(e3, e1)
    contra = np.linalg.inv(np.stack([G1, G2, G3], axis=2))  # rows G^1, G^2, G^3
    c = np.einsum("eki,eni->enk", contra, np.stack([e1, e2, e3], axis=1))  # ê_n · G^k
    (a, b, p), (d, f, r), d3 = c[:, 0].T, c[:, 1].T, c[:, 2, 2]
    zero = np.zeros_like(a)
    rows = [
        [a * a, b * b, a * b, a * p, b * p],
        [d * d, f * f, d * f, d * r, f * r],
        [2 * a * d, 2 * b * f, a * f + b * d, a * r + p * d, b * r + p * f],
        [zero, zero, zero, d3 * a, d3 * b],
        [zero, zero, zero, d3 * d, d3 * f],
    ]
    Q = np.stack([np.stack(row, axis=1) for row in rows], axis=1)
    return Q, np.stack([e1, e2], axis=1)


def _covariant_stiffness(C: Floats, G1: Floats, G2: Floats, G3: Floats) -> Floats:
    Q, _ = cartesian_map(G1, G2, G3)
    return np.asarray(np.einsum("eki,kl,elj->eij", Q, C, Q))


def _compact(D: Floats, volume: Floats, z: float) -> Floats:
    upper = (np.array([0, 0, 0, 1, 1, 2]), np.array([0, 1, 2, 1, 2, 2]))
    membrane = D[:, upper[0], upper[1]]
    shear = D[:, [3, 3, 4], [3, 4, 4]]
    return np.asarray(volume[:, None] * np.concatenate([membrane, z * z * membrane, shear], axis=1))


def _spread(D: Floats, volume: Floats, z: float) -> Floats:
    P = np.zeros((5, 8))
    P[:3, :3] = np.eye(3)
    P[:3, 3:6] = z * np.eye(3)
    P[3:, 6:] = np.eye(2)
    return np.asarray(volume[:, None, None] * np.einsum("ki,ekl,lj->eij", P, D, P))
