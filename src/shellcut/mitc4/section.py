"""Stiffness H of every quad for the strains of its modes, and its mass, integrated once.

At a Gauss point the generalised strains are v = (E_11, E_22, 2E_12, K_11, K_22, 2K_12, 2E_13,
2E_23), all covariant, and the energy there is ½ vᵀ h v with

    h = ∫ Pᵀ Qᵀ C Q P √G dxi³ (Gauss weight 1),      √G = det(G_1, G_2, G_3).

P (5 x 8) gives the covariant strains at the height xi³: E + xi³ K, and the tied shear; Q (5 x 5)
maps covariant to Cartesian components in the frame ê_3 = T/|T|, ê_1 ∝ G_2 x ê_3 of
[DvorkinBathe1984], by e_ij = (ê_i·G^k)(ê_j·G^l) E_kl; C is the plane-stress law with the shear
moduli. Because G_alpha = A_alpha + xi³ T_,alpha ([Frangi2010] 6) is taken at its own height, the
curvature of the reference surface and the volume factor mu ([Frangi2010] 20) are exact, also for
warped quads, and the coupling of stretching and bending in a layered section is included.

The strains at a Gauss point are v = B s, with s the sixteen strains of the quad
(:mod:`shellcut.mitc4.element`), so the quad has the energy ½ sᵀ H s with

    H = sum over the four Gauss points of Bᵀ h B:

136 numbers. If the reference quad is flat (T constant and normal to it) and the ratio of bending to
membrane stiffness is one number, as in any homogeneous or evenly layered film, four numbers remain
besides the metric of the reference surface (:func:`shellcut.mitc4.element.flat_resultants`).

Between nodes the interpolated director is slightly shorter than one: by 0.4 % on a curved quad that
turns by 10°. The stiffness is that of this body, as in [DvorkinBathe1984], whose values it matches
mesh by mesh; the mass is that of the film, rho |G_1 x G_2| ([Frangi2010] 20).

**Axes of the film.** ê_1 and ê_2 follow the sides of the quad. A law with axes needs them along the
film's direction d, of which the part normal to the director is left out, and across it. With the
angle θ from ê_1 to d, cos θ and sin θ are two numbers a Gauss point, the same for all heights: on a
curved film ê_1 turns about the director by less than the square of height over radius.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice

import numpy as np

from shellcut.arrays import Bools, Floats, Number, Vector, product, unit
from shellcut.material.orthotropic import strain_turns
from shellcut.material.shell_material import ShellMaterial
from shellcut.mesh.mesh import Mesh
from shellcut.numerics.bilinear import shape_functions, slopes_by_eta, slopes_by_xi
from shellcut.numerics.jit import always_inline
from shellcut.numerics.small_matrices import inverse

from .element import GAUSS, N_STRAIN, FlatModuli

# A quad counts as flat if its directors agree and are normal to its corners' edges within this
# relative size: round-off of normalised normals, far below any relevant curvature.
_FLAT = 1e-12

# Of a direction's length, that must lie in the sheet: below, round-off of normals decides.
LEAST_IN_SHEET = 1e-6

N_AXES = 8
"""Floats a quad: cos θ, sin θ of the four Gauss points."""


def shape_and_slopes(xi: float, eta: float) -> tuple[Floats, Floats, Floats]:
    """Return N_a and its derivatives by xi and eta, each of shape (4,), at one point."""
    n, by_xi, by_eta = shape_functions(xi, eta), slopes_by_xi(eta), slopes_by_eta(xi)
    return np.array(n), np.array(by_xi), np.array(by_eta)


def gauss_geometry(X: Floats, T: Floats) -> Iterator[tuple[Floats, ...]]:
    """Yield N_a, A_1, A_2, T, T_,1, T_,2 at the four Gauss points of quads.

    Parameters
    ----------
    X, T : ndarray, shape (n_quad, 4, 3)
        Reference positions [mm] and directors.
    """
    for xi, eta in GAUSS:
        n, n1, n2 = shape_and_slopes(xi, eta)
        A1, A2 = np.einsum("a,eai->ei", n1, X), np.einsum("a,eai->ei", n2, X)
        T0 = np.einsum("a,eai->ei", n, T)
        yield n, A1, A2, T0, np.einsum("a,eai->ei", n1, T), np.einsum("a,eai->ei", n2, T)


def strain_map(xi: float, eta: float) -> Floats:
    """Return B, shape (8, 16): the generalised strains at a point from those of the modes."""
    B = np.zeros((8, N_STRAIN))
    for row, first in ((0, 0), (3, 6)):
        B[row, [first, first + 4, first + 2]] = 1.0, eta, eta * eta
        B[row + 1, [first + 1, first + 5, first + 2]] = 1.0, xi, xi * xi
        B[row + 2, [first + 3, first + 4, first + 5, first + 2]] = 1.0, xi, eta, 2.0 * xi * eta
    B[6, 12:14] = 1.0, eta
    B[7, 14:16] = 1.0, xi
    return B / 16.0


def reference_quads(
    mesh: Mesh, material: ShellMaterial, at_a_time: int
) -> tuple[Bools, Floats, Floats]:
    """Return what the section knows of all quads of a film at rest.

    Parameters
    ----------
    mesh : Mesh
        The reference.
    material : ShellMaterial
        Layers.
    at_a_time : int
        Quads that are worked out together: bounds the memory.

    Returns
    -------
    flat : ndarray of bool, shape (n_quad,)
        Which have the four numbers of a flat quad's stiffness.
    mass : ndarray, shape (n_quad, 4)
        Share of each corner [t], as of :func:`lumped_mass`.
    area : ndarray, shape (n_quad,)
        Of the mid-surface [mm²].
    """
    n = mesh.n_quad
    flat, mass, area = np.zeros(n, np.bool_), np.empty((n, 4)), np.empty(n)
    for first in range(0, n, at_a_time):
        some = slice(first, first + at_a_time)
        X, T = mesh.nodes[mesh.quads[some]], mesh.directors[mesh.quads[some]]
        flat[some] = flat_quads(X, T) & (material.bending_ratio is not None)
        mass[some], area[some] = lumped_mass(X, T, material)
    return flat, mass, area


def flat_quads(X: Floats, T: Floats) -> Bools:
    """Return which quads are flat, with directors normal to them, shape (n_quad,)."""
    size = np.linalg.norm(X[:, 2] - X[:, 0], axis=1)[:, None]
    edges = np.roll(X, -1, axis=1) - X
    bent = np.abs(T - T[:, :1]).max(axis=(1, 2)) > _FLAT
    tilted = (np.abs(np.einsum("eai,ei->ea", edges, T[:, 0])) > _FLAT * size).any(axis=1)
    return np.asarray(~(bent | tilted))


def flat_stiffness(X: Floats, T: Floats, material: ShellMaterial) -> Floats:
    """Return C_11 J⁻³ / 2¹⁴ at the Gauss points of flat quads, shape (n_quad, 4).

    See :func:`shellcut.mitc4.element.flat_resultants`.

    Parameters
    ----------
    X, T : ndarray, shape (n_quad, 4, 3)
        Reference positions [mm] and directors of flat quads.
    material : ShellMaterial
        With a ``bending_ratio``.
    """
    points = gauss_geometry(X, T)
    volume = [np.einsum("ei,ei->e", _cross(A1, A2), T0) for _, A1, A2, T0, _, _ in points]
    J = np.stack(volume, axis=1)
    # Products round alike on all processors; NumPy's powers do not.
    return np.asarray(material.membrane_stiffness[0, 0] / 2**14 / (J * J * J))


def flat_moduli(material: ShellMaterial) -> FlatModuli:
    """Return the constants shared by all flat quads.

    Raises
    ------
    ValueError
        If the ratio of bending to membrane stiffness is not one number.
    """
    if material.bending_ratio is None:
        raise ValueError("flat quads need a material with a bending_ratio, this one has none")
    plane = material.membrane_stiffness
    return FlatModuli(
        material.bending_ratio,
        float(2.0 * plane[2, 2] / plane[0, 0]),
        float(material.shear_stiffness[0, 0] / (8.0 * plane[0, 0])),
    )


def full_stiffness(X: Floats, T: Floats, material: ShellMaterial) -> Floats:
    """Return the upper triangle of :func:`stiffness` of any quads, shape (n_quad, 136)."""
    i, j = np.triu_indices(N_STRAIN)
    return np.asarray(stiffness(X, T, material)[:, i, j])


def stiffness(X: Floats, T: Floats, material: ShellMaterial) -> Floats:
    """Return H of any quads, shape (n_quad, 16, 16).

    Parameters
    ----------
    X, T : ndarray, shape (n_quad, 4, 3)
        Reference positions [mm] and directors.
    material : ShellMaterial
        Layers.
    """
    H = np.zeros((len(X), N_STRAIN, N_STRAIN))
    for q, point in enumerate(GAUSS):
        B = strain_map(*point)
        H += product(B.T, point_stiffness(X, T, material, q), B)
    return H


def point_stiffness(X: Floats, T: Floats, material: ShellMaterial, q: int) -> Floats:
    """Return h at the Gauss point ``q`` of any quads, shape (n_quad, 8, 8)."""
    n, A1, A2, T0, T1, T2 = next(islice(gauss_geometry(X, T), q, None))
    h = np.zeros((len(X), 8, 8))
    turn = turn_into_axes(A1, A2, T0, material.direction_at(np.einsum("a,eac->ec", n, X)))
    for z, weight, layer in zip(*material.thickness_points(), strict=True):
        G1, G2 = A1 + z * T1, A2 + z * T2  # [Frangi2010] (6)
        volume = weight * np.einsum("ei,ei->e", _cross(G1, G2), T0)
        C = np.zeros((5, 5))
        C[:3, :3] = layer.plane_stress()
        C[3:, 3:] = material.transverse_shear(layer.transverse_shear())
        P = np.zeros((5, 8))
        P[:3, :3], P[:3, 3:6], P[3:, 6:] = np.eye(3), z * np.eye(3), np.eye(2)
        Q, _ = cartesian_map(G1, G2, T0)
        q_p = product(Q, P)
        if material.has_axes:
            q_p = product(turn, q_p)
        h += volume[:, None, None] * (product(q_p.transpose(0, 2, 1), C, q_p))
    return h


def turn_into_axes(A1: Floats, A2: Floats, T0: Floats, direction: Floats) -> Floats:
    """Return the matrices, shape (n, 5, 5), that turn Cartesian strains into the film's axes."""
    c, s = axes_in_frame(A1, A2, T0, direction)
    turn = np.zeros((len(A1), 5, 5))
    turn[:, :3, :3] = strain_turns(c, s)
    turn[:, 3, 3], turn[:, 3, 4], turn[:, 4, 3], turn[:, 4, 4] = c, s, -s, c
    return turn


def axes_in_frame(A1: Floats, A2: Floats, T0: Floats, direction: Floats) -> tuple[Floats, Floats]:
    """Return cos θ and sin θ from ê_1 to a direction, shape (n,); nan where it is normal."""
    _, frame = frame_components(A1, A2, T0)
    along, aside = np.einsum("enc,ec->ne", frame, direction)
    size = np.hypot(along, aside)
    size[~(size > LEAST_IN_SHEET * np.linalg.norm(direction, axis=1))] = np.nan
    return along / size, aside / size


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


def lumped_mass(X: Floats, T: Floats, material: ShellMaterial) -> tuple[Floats, Floats]:
    """Return the share of each corner in the mass [t], and the area [mm²], of quads.

    Parameters
    ----------
    X, T : ndarray, shape (n_quad, 4, 3)
        Reference positions [mm] and directors.
    material : ShellMaterial
        Layers.

    Returns
    -------
    mass : ndarray, shape (n_quad, 4)
        ∫ N_a rho |G_1 x G_2|, row-sum lumped.
    area : ndarray, shape (n_quad,)
        Of the reference mid-surface.
    """
    mass, area = np.zeros((len(X), 4)), np.zeros(len(X))
    for n, A1, A2, _, T1, T2 in gauss_geometry(X, T):
        area += np.linalg.norm(_cross(A1, A2), axis=1)
        for z, weight, layer in zip(*material.thickness_points(), strict=True):
            normal = _cross(A1 + z * T1, A2 + z * T2)
            surface = weight * np.linalg.norm(normal, axis=1)  # [Frangi2010] (20)
            mass += layer.density * surface[:, None] * n
    return mass, area


def cartesian_map(G1: Floats, G2: Floats, G3: Floats) -> tuple[Floats, Floats]:
    """Return Q, shape (n, 5, 5), and the in-plane frame (ê_1, ê_2), shape (n, 2, 3).

    Q maps the covariant (E_11, E_22, 2E_12, 2E_13, 2E_23), with E_33 = 0, to the Cartesian
    (e_11, e_22, 2e_12, 2e_13, 2e_23).
    """
    c, frame = frame_components(G1, G2, G3)
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
    return Q, frame


def frame_components(G1: Floats, G2: Floats, G3: Floats) -> tuple[Floats, Floats]:
    """Return ê_n · G^k, shape (n, 3, 3), and (ê_1, ê_2), shape (n, 2, 3).

    ê_1 is normal to G_2 and G_3, hence along G^1, so ê_2 · G^1 = ê_3 · G^1 = 0.
    """
    e3 = unit(G3)
    e1 = unit(_cross(G2, e3))
    e2 = _cross(e3, e1)
    contra = inverse(np.stack([G1, G2, G3], axis=2))  # rows G^1, G^2, G^3
    return (
        np.einsum("eki,eni->enk", contra, np.stack([e1, e2, e3], axis=1)),
        np.stack([e1, e2], axis=1),
    )


def _cross(a: Floats, b: Floats) -> Floats:
    """Return a x b of rows : (n, 3); np.cross is four times as slow for a few rows."""
    product = np.empty_like(a)
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        product[:, i] = a[:, j] * b[:, k] - a[:, k] * b[:, j]
    return product
