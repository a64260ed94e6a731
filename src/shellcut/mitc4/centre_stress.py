"""Cauchy stress at the centres of quads, from the deformation at the centre.

With the base vectors G_alpha of the reference and g_alpha of the present surface at the height xi³
at the quad's centre, the strain is E_alphabeta = ½ (g_alpha·g_beta - G_alpha·G_beta). In the
Cartesian frame ê_3 = T/|T|, ê_1 ∝ G_2 x ê_3 of :mod:`shellcut.mitc4.section` the stress is S = C E,
and

    sigma = S_ij f_i f_j / J,      f_i = F ê_i = (ê_i·G^alpha) g_alpha,

with J = |g_1 x g_2| / |G_1 x G_2| the change of area.

**Membrane.** The stress resultant of a section is ∫ S dxi³ = A E + B K, with E and K the strain and
its slope over the height, A = ∫ C dxi³ and B = ∫ xi³ C dxi³. Over the thickness h it is the mean
stress S = (A E + B K)/h, pushed forward with the mid-surface. In a single layer B = 0 and this is
the stress at the mid-surface.

**Thickness.** The director is inextensible, and the forces use a constant thickness. But plane
stress is S_33 = 0, so E_33 = -nu/(1 - nu) (E_11 + E_22), and a fibre across a layer has the stretch
lambda = sqrt(1 + 2 E_33). The present thickness is the sum over the layers, lambda taken at the
middle of each:

    h = sum_k h_k sqrt(1 - 2 nu_k/(1 - nu_k) (E_11 + E_22)(xi³_k)).

It follows from the law and is used for output only, not in the solution.

All this is for layers whose law is S = C E; the output of any other law is in
:mod:`shellcut.mitc4.point_output`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from shellcut.arrays import Floats, Ints, Vec3, product
from shellcut.material.shell_material import ShellMaterial
from shellcut.mesh.mesh import Mesh
from shellcut.numerics.jit import inline, kernel
from shellcut.numerics.vec3 import combine, cross, dot, load, norm, scale

from .section import frame_components
from .surface import Surface

# Derivatives of the shape functions by xi and eta at the centre.
_AT_CENTRE = 0.25 * np.array([[-1.0, 1.0, 1.0, -1.0], [-1.0, -1.0, 1.0, 1.0]])


PLACES = ("mid", "top", "bottom", "nominal")
"""Places at which stresses are available."""


def check_place(place: str) -> None:
    """Refuse a place that is not in :data:`PLACES`."""
    if place not in PLACES:
        raise ValueError(f"place must be one of {sorted(PLACES)}, got {place!r}")


class FaceStresses(NamedTuple):
    """Output stresses of all quads."""

    stress: Floats
    """Cauchy stress s11, s22, s12 in the lamina frame of the mid-surface, shape (n_quad, 3, 3):
    of the membrane, at the top, at the bottom [MPa]."""
    principal: Floats
    """Its largest and smallest principal value, shape (n_quad, 3, 2) [MPa]."""
    thickness: Floats
    """Present thickness, shape (n_quad,) [mm]."""


class CentreStress:
    """Stresses at the quads' centres, from reference geometry and layers."""

    def __init__(self, mesh: Mesh, material: ShellMaterial) -> None:
        self.reference = Surface.of(mesh)
        """Of every quad and copy."""
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
        ply = np.array([layer.thickness for layer in layers])
        middle = bottom[:-1] + 0.5 * ply - 0.5 * h
        plane = np.array([layer.material.plane_stress() for layer in layers])
        slope = np.array([layer.material.thickness_slope() for layer in layers])
        mean = np.einsum("k,kij->ij", ply / h, plane)
        coupling = np.einsum("k,kij->ij", ply * middle / h, plane)
        if material.is_symmetric:  # round-off would leave it not quite zero
            coupling[:] = 0.0
        self._laws = np.stack([mean, coupling, self._law["top"], self._law["bottom"]])
        self._plies = np.stack([ply, middle, *2.0 * slope.T], axis=1)

    def cauchy(self, x: Floats, t: Floats, quads: Ints, which: Ints, place: str) -> Floats:
        """Return the stress tensors of some quads in space [MPa], shape (n, 3, 3).

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
        check_place(place)
        which = check_quads(which, len(quads))
        sigma = np.empty((len(which), 3, 3))
        _cauchy(
            which=which,
            reference=self.reference,
            present=Surface(x, t, quads),
            height=self._height[place],
            law=self._law[place][None],
            nominal=place == "nominal",
            sigma=sigma,
        )
        return sigma

    def linear(
        self, x: Floats, t: Floats, dx: Floats, dt: Floats, quads: Ints, which: Ints, place: str
    ) -> Floats:
        """Return the stress tensors of some quads after a small motion [MPa], shape (n, 3, 3).

        Stress and its linear change: d sigma = [dS_ij f_i f_j + S_ij (df_i f_j + f_i df_j)] / J
        - sigma dJ / J with dS = C dE, dE_ij = ½ (df_i·f_j + f_i·df_j).

        Parameters
        ----------
        dx, dt : ndarray, shape (n_node, 3)
            Motion of nodes [mm] and directors.
        x, t, quads, which
            As :meth:`cauchy`.
        place : {"mid", "top", "bottom"}
            As :meth:`MITC4Shell.stress`.
        """
        places = ("mid", "top", "bottom")
        if place not in places:
            raise ValueError(f"place must be one of {list(places)}, got {place!r}")
        which = check_quads(which, len(quads))
        nodes, directors, quad = self.reference
        corners = quad[which]

        def tangents(x: Floats, t: Floats, corners: Ints) -> Floats:
            lifted = x[corners] + self._height[place] * t[corners]
            return np.asarray(np.einsum("da,nac->ndc", _AT_CENTRE, lifted))

        G = tangents(nodes, directors, corners)
        T = directors[corners].mean(axis=1)
        up = frame_components(G[:, 0], G[:, 1], T)[0][:, :2, :2]
        g, dg = tangents(x, t, quads[which]), tangents(dx, dt, quads[which])
        f, df, F = (np.einsum("nia,nac->nic", up, base) for base in (g, dg, G))
        change = np.einsum("nic,njc->nij", df, f)
        e = 0.5 * np.stack(
            [
                np.einsum("nic,njc->nij", f, f) - np.einsum("nic,njc->nij", F, F),
                change + change.swapaxes(1, 2),
            ]
        )
        strains = np.stack([e[..., 0, 0], e[..., 1, 1], 2.0 * e[..., 0, 1]], axis=-1)
        s = product(strains, self._law[place])
        S, dS = s[..., [0, 2, 2, 1]].reshape(*s.shape[:2], 2, 2)
        area, old = (np.cross(base[:, 0], base[:, 1]) for base in (g, G))
        grown = np.cross(dg[:, 0], g[:, 1]) + np.cross(g[:, 0], dg[:, 1])
        size = np.einsum("nc,nc->n", area, area)
        J = np.sqrt(size / np.einsum("nc,nc->n", old, old))[:, None, None]
        dJ_over_J = (np.einsum("nc,nc->n", grown, area) / size)[:, None, None]
        stress = np.einsum("nij,nic,njd->ncd", S, f, f) / J
        turned = np.einsum("nij,nic,njd->ncd", S, df, f) / J
        strained = np.einsum("nij,nic,njd->ncd", dS, f, f) / J
        total = stress * (1.0 - dJ_over_J) + strained + turned + turned.swapaxes(1, 2)
        return np.asarray(total)

    def faces(self, x: Floats, t: Floats, quads: Ints) -> FaceStresses:
        """Return membrane stresses, stresses at both faces, and thickness of all quads.

        Parameters
        ----------
        x, t, quads
            As :meth:`cauchy`.
        """
        n = len(quads)
        stresses = FaceStresses(np.empty((n, 3, 3)), np.empty((n, 3, 2)), np.empty(n))
        # Of a state that is being drawn; the film itself may have been cut again meanwhile.
        reference = self.reference._replace(quads=self.reference.quads[:n])
        _faces(
            reference=reference,
            present=Surface(x, t, quads),
            height=self._height["top"],
            laws=self._laws,
            plies=self._plies,
            seen=stresses,
        )
        return stresses


def check_quads(which: Ints, n_quad: int) -> Ints:
    """Return checked quad ids: with wrong ones the kernels would read beyond their arrays."""
    ids = np.asarray(which)
    wanted = f"quads must be a list of quad ids from 0 to {n_quad - 1}, got "
    if ids.ndim != 1 or (ids.size and not np.issubdtype(ids.dtype, np.integer)):
        mask = "; of a mask take np.flatnonzero" if ids.dtype == np.bool_ else ""
        raise ValueError(f"{wanted}an array of shape {ids.shape} and type {ids.dtype}{mask}")
    outside = ids[(ids < 0) | (ids >= n_quad)]
    if outside.size:
        raise ValueError(f"{wanted}{', '.join(map(str, outside[:5].tolist()))}")
    return ids.astype(np.int64)


@inline
def _centre(x: Floats, quads: Ints, e: int) -> tuple[Vec3, Vec3, Vec3]:
    """Return value and derivatives by xi and eta at the centre of quad e."""
    x0, x1 = load(x, quads[e, 0]), load(x, quads[e, 1])
    x2, x3 = load(x, quads[e, 2]), load(x, quads[e, 3])
    near, far = combine(0.25, x0, 0.25, x1), combine(0.25, x2, 0.25, x3)
    left, right = combine(0.25, x0, 0.25, x3), combine(0.25, x1, 0.25, x2)
    return (
        combine(1.0, near, 1.0, far),
        combine(1.0, right, -1.0, left),
        combine(1.0, far, -1.0, near),
    )


@inline
def _strain(
    A: tuple[Vec3, Vec3],
    T: tuple[Vec3, Vec3, Vec3],
    a: tuple[Vec3, Vec3],
    t: tuple[Vec3, Vec3, Vec3],
    height: float,
) -> tuple[Vec3, Vec3, Vec3, float]:
    """Return (E_11, E_22, 2 E_12) in the Cartesian frame at a height, f_1, f_2, and J."""
    T0, T1, T2 = T
    _, t1, t2 = t
    G1, G2 = combine(1.0, A[0], height, T1), combine(1.0, A[1], height, T2)
    g1, g2 = combine(1.0, a[0], height, t1), combine(1.0, a[1], height, t2)
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
    strain = (
        c11 * c11 * E11 + c12 * c12 * E22 + c11 * c12 * E12,
        c21 * c21 * E11 + c22 * c22 * E22 + c21 * c22 * E12,
        2.0 * (c11 * c21 * E11 + c12 * c22 * E22) + (c11 * c22 + c12 * c21) * E12,
    )
    f1, f2 = combine(c11, g1, c12, g2), combine(c21, g1, c22, g2)
    return strain, f1, f2, norm(cross(g1, g2)) / norm(cross(G1, G2))


@inline
def _times(law: Floats, k: int, strain: Vec3) -> Vec3:
    """Return the product of matrix k of law : (n, 3, 3) and a strain."""
    a, b, c = strain
    return (
        law[k, 0, 0] * a + law[k, 0, 1] * b + law[k, 0, 2] * c,
        law[k, 1, 0] * a + law[k, 1, 1] * b + law[k, 1, 2] * c,
        law[k, 2, 0] * a + law[k, 2, 1] * b + law[k, 2, 2] * c,
    )


@inline
def _store_lamina(
    S: Vec3,
    carried: tuple[Vec3, Vec3, float],
    axes: tuple[Vec3, Vec3],
    e: int,
    k: int,
    seen: FaceStresses,
) -> None:
    """Write the Cauchy stress S_ij f_i f_j / J in the frame e1, e2 to place k of quad e."""
    f1, f2, J = carried
    e1, e2 = axes
    u1, v1 = dot(f1, e1), dot(f1, e2)
    u2, v2 = dot(f2, e1), dot(f2, e2)
    s11 = (S[0] * u1 * u1 + S[1] * u2 * u2 + 2.0 * S[2] * u1 * u2) / J
    s22 = (S[0] * v1 * v1 + S[1] * v2 * v2 + 2.0 * S[2] * v1 * v2) / J
    s12 = (S[0] * u1 * v1 + S[1] * u2 * v2 + S[2] * (u1 * v2 + u2 * v1)) / J
    mean, radius = 0.5 * (s11 + s22), np.sqrt((0.5 * (s11 - s22)) ** 2 + s12 * s12)
    seen.stress[e, k, 0], seen.stress[e, k, 1], seen.stress[e, k, 2] = s11, s22, s12
    seen.principal[e, k, 0], seen.principal[e, k, 1] = mean + radius, mean - radius


@kernel
def _faces(
    reference: Surface,
    present: Surface,
    height: float,
    laws: Floats,
    plies: Floats,
    seen: FaceStresses,
) -> None:
    """Write the arrays of ``seen``.

    height : of the top.  laws : (4, 3, 3), A/h, B/h, C of the top and of the bottom layer.
    plies : (n_layer, 5), thickness, height of the middle, a of 2 E_33 = - a · (E_11, E_22, 2 E_12).
    """
    for e in range(present.quads.shape[0]):
        _, A1, A2 = _centre(reference.x, reference.quads, e)
        T = _centre(reference.t, reference.quads, e)
        _, a1, a2 = _centre(present.x, present.quads, e)
        t = _centre(present.t, present.quads, e)
        e1 = scale(1.0 / norm(a1), a1)
        e2 = cross(cross(a1, a2), e1)
        e2 = scale(1.0 / norm(e2), e2)
        top, f1, f2, J = _strain((A1, A2), T, (a1, a2), t, height)
        _store_lamina(_times(laws, 2, top), (f1, f2, J), (e1, e2), e, 1, seen)
        bottom, f1, f2, J = _strain((A1, A2), T, (a1, a2), t, -height)
        _store_lamina(_times(laws, 3, bottom), (f1, f2, J), (e1, e2), e, 2, seen)
        mid, f1, f2, J = _strain((A1, A2), T, (a1, a2), t, 0.0)
        slope = combine(0.5 / height, top, -0.5 / height, bottom)
        S = combine(1.0, _times(laws, 0, mid), 1.0, _times(laws, 1, slope))
        _store_lamina(S, (f1, f2, J), (e1, e2), e, 0, seen)
        h = 0.0
        for k in range(plies.shape[0]):
            at = combine(1.0, mid, plies[k, 1], slope)
            thinning = plies[k, 2] * at[0] + plies[k, 3] * at[1] + plies[k, 4] * at[2]
            # With this law the thickness vanishes at an area strain of 117 % (nu 0.3).
            h += plies[k, 0] * np.sqrt(max(0.0, 1.0 - thinning))
        seen.thickness[e] = h


@kernel
def _cauchy(
    which: Ints,
    reference: Surface,
    present: Surface,
    height: float,
    law: Floats,
    nominal: bool,
    sigma: Floats,
) -> None:
    """Write the stress of the quads ``which`` at xi³ = height to sigma : (n, 3, 3).

    law : (1, 3, 3), plane
    stress.  nominal : S turned with the surface instead of sigma.
    """
    for i in range(which.shape[0]):
        e = which[i]
        _, A1, A2 = _centre(reference.x, reference.quads, e)
        T = _centre(reference.t, reference.quads, e)
        _, a1, a2 = _centre(present.x, present.quads, e)
        t = _centre(present.t, present.quads, e)
        strain, f1, f2, stretch = _strain((A1, A2), T, (a1, a2), t, height)
        S11, S22, S12 = _times(law, 0, strain)
        if nominal:
            normal = cross(f1, f2)
            f1 = scale(1.0 / norm(f1), f1)
            f2 = cross(scale(1.0 / norm(normal), normal), f1)
            stretch = 1.0
        for k in range(3):
            for m in range(3):
                sigma[i, k, m] = (
                    S11 * f1[k] * f1[m]
                    + S22 * f2[k] * f2[m]
                    + S12 * (f1[k] * f2[m] + f2[k] * f1[m])
                ) / stretch
