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

from shellcut.arrays import Floats, Ints, cross, norm, product, unit
from shellcut.material.shell_material import ShellMaterial
from shellcut.state import State

from .section import frame_components
from .surface import Surface

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

    def __init__(self, reference: Surface, material: ShellMaterial) -> None:
        self._reference = reference
        self._at_height: dict[float, _Undeformed] = {}
        layers = material.layers
        bottom = np.cumsum([0.0, *(layer.thickness for layer in layers)])
        mid = int(np.searchsorted(bottom, 0.5 * material.thickness, side="right")) - 1
        self._law = {
            "mid": layers[mid].material.plane_stress(),
            "top": layers[-1].material.plane_stress(),
            "bottom": layers[0].material.plane_stress(),
        }
        h = material.thickness
        self._height = {"mid": 0.0, "nominal": 0.0, "top": 0.5 * h, "bottom": -0.5 * h}
        ply = np.array([layer.thickness for layer in layers])
        middle = bottom[:-1] + 0.5 * ply - 0.5 * h
        plane = np.array([layer.material.plane_stress() for layer in layers])
        slope = np.array([2.0 * layer.material.thickness_slope() for layer in layers])
        mean = np.einsum("k,kij->ij", ply / h, plane)
        coupling = np.einsum("k,kij->ij", ply * middle / h, plane)
        if material.is_symmetric:  # round-off would leave it not quite zero
            coupling[:] = 0.0
        self._membrane, self._plies = (mean, coupling), (ply, middle, slope)

    def add_copies(self, reference: Surface, copies: Ints) -> None:
        """Take over the reference to which copies of these quads have been added."""
        self._reference = reference
        for height, at in self._at_height.items():
            rows = (np.concatenate([values, values[copies]]) for values in at)
            self._at_height[height] = _Undeformed(*rows)

    def cauchy(self, state: State, which: Ints, place: str) -> Floats:
        """Return the stress tensors of some quads, as :meth:`.PointOutput.cauchy`."""
        check_place(place)
        which = check_quads(which, len(state.quads))
        x, t, quads, height = state.node.x, state.node.t, state.quads, self._height[place]
        g, slope = _tangents(x, quads[which]), _tangents(t, quads[which])
        now = self._deformed(which, g + height * slope, height)
        if place != "nominal":
            return _pushed(product(now.strain, self._law[place]), now.f, now.J)
        h = self._height["top"]
        top, bottom = (self._deformed(which, g + z * slope, z) for z in (h, -h))
        mean, coupling = self._membrane
        S = product(now.strain, mean) + product(top.strain - bottom.strain, coupling) / (2.0 * h)
        normal = unit(cross(now.f[:, 0], now.f[:, 1]))
        along = unit(now.f[:, 0])
        f = np.stack([along, cross(normal, along)], axis=1)
        return _pushed(S, f, np.ones(len(which)))

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
        x, t : ndarray, shape (n_node, 3)
            Present positions [mm] and directors.
        quads : ndarray of int, shape (n_quad, 4)
            Present node ids.
        which : ndarray of int, shape (n,)
            The quads whose stress is wanted.
        place : {"mid", "top", "bottom"}
            As :meth:`MITC4Shell.stress`.
        """
        places = ("mid", "top", "bottom")
        if place not in places:
            raise ValueError(f"place must be one of {list(places)}, got {place!r}")
        which = check_quads(which, len(quads))
        law, height = self._law[place], self._height[place]
        g, dg = (
            _tangents(a, quads[which]) + height * _tangents(b, quads[which])
            for a, b in ((x, t), (dx, dt))
        )
        now = self._deformed(which, g, height)
        df = _along_axes(now.up, dg)
        S, dS = product(now.strain, law), product(2.0 * _products(df, now.f), law)
        area = cross(g[:, 0], g[:, 1])
        grown = cross(dg[:, 0], g[:, 1]) + cross(g[:, 0], dg[:, 1])
        size = np.einsum("nc,nc->n", area, area)
        dJ_over_J = (np.einsum("nc,nc->n", grown, area) / size)[:, None, None]
        stress, strained = (_pushed(stress, now.f, now.J) for stress in (S, dS))
        turned = np.einsum("nij,nic,njd->ncd", _tensors(S), df, now.f) / now.J[:, None, None]
        total = stress * (1.0 - dJ_over_J) + strained + turned + turned.swapaxes(1, 2)
        return np.asarray(total)

    def faces(self, state: State) -> FaceStresses:
        """Return membrane stresses, stresses at both faces, and thickness of all quads."""
        x, t, quads = state.node.x, state.node.t, state.quads
        every = np.arange(len(quads))
        g, g_slope = _tangents(x, quads), _tangents(t, quads)
        mid, top, bottom = (
            self._deformed(every, g + height * g_slope, height)
            for height in (self._height[place] for place in ("mid", "top", "bottom"))
        )
        slope = (top.strain - bottom.strain) / (2.0 * self._height["top"])
        mean, coupling = self._membrane
        axes = _lamina_axes(g)
        at_places = [
            _in_plane(product(mid.strain, mean) + product(slope, coupling), mid, axes),
            _in_plane(product(top.strain, self._law["top"]), top, axes),
            _in_plane(product(bottom.strain, self._law["bottom"]), bottom, axes),
        ]
        ply, middle, lateral = self._plies
        at = mid.strain[:, None] + middle[:, None] * slope[:, None]
        thinning = np.einsum("nkc,kc->nk", at, lateral)
        # With this law the thickness vanishes at an area strain of 117 % (nu 0.3).
        thickness = product(np.sqrt(np.maximum(0.0, 1.0 - thinning)), ply)
        return _with_principal(np.stack(at_places, axis=1), np.asarray(thickness))

    def history_means(self, _state: State) -> dict[str, Floats]:
        """Return none: linear laws have no history."""
        return {}

    def _deformed(self, which: Ints, g: Floats, height: float) -> _Deformed:
        """Return the deformation of some quads with the present base vectors g : (n, 2, 3)."""
        at = self._at_height.get(height)
        if at is None:
            at = self._at_height[height] = _Undeformed.of(self._reference, height)
        up = at.up[which]
        f = _along_axes(up, g)
        J = norm(cross(g[:, 0], g[:, 1])) / at.J[which]
        return _Deformed(up, f, _products(f, f) - at.products[which], J)


class _Undeformed(NamedTuple):
    """The reference at the centres of all quads, at a height."""

    up: Floats
    """ê_i·G^alpha, shape (n, 2, 2)."""
    products: Floats
    """Of F_i as :func:`_products`, shape (n, 3)."""
    J: Floats
    """|G_1 x G_2|, shape (n,)."""

    @classmethod
    def of(cls, reference: Surface, height: float) -> _Undeformed:
        nodes, directors, corners = reference
        G = _tangents(nodes, corners) + height * _tangents(directors, corners)
        T = directors[corners].mean(axis=1)
        up = frame_components(G[:, 0], G[:, 1], T)[0][:, :2, :2]
        F = _along_axes(up, G)
        return cls(up, _products(F, F), norm(cross(G[:, 0], G[:, 1])))


class _Deformed(NamedTuple):
    """The deformation at the centres of some quads, at a height."""

    up: Floats
    """ê_i·G^alpha, shape (n, 2, 2)."""
    f: Floats
    """f_i, shape (n, 2, 3)."""
    strain: Floats
    """(e_11, e_22, 2 e_12), shape (n, 3)."""
    J: Floats
    """Change of area, shape (n,)."""


def _tangents(x: Floats, corners: Ints) -> Floats:
    """Return the derivatives of x : (n_node, 3) by xi and eta at quads' centres, (n, 2, 3)."""
    first, second, third, fourth = np.moveaxis(x[corners], 1, 0)
    along, across = third - first, second - fourth
    return np.stack([0.25 * (along + across), 0.25 * (along - across)], axis=1)


def _along_axes(up: Floats, g: Floats) -> Floats:
    """Return (ê_i·G^alpha) g_alpha, shape (n, 2, 3)."""
    return np.asarray(up[:, :, :1] * g[:, :1] + up[:, :, 1:] * g[:, 1:])


def _dots(a: Floats, b: Floats) -> Floats:
    """Return the scalar products of many vectors; a sum along a short axis takes much longer."""
    terms = a * b
    return np.asarray(terms[..., 0] + terms[..., 1] + terms[..., 2])


def _products(a: Floats, b: Floats) -> Floats:
    """Return ½ a_1·b_1, ½ a_2·b_2, ½ (a_1·b_2 + a_2·b_1), shape (n, 3)."""
    same, crossed = _dots(a, b), _dots(a, b[:, ::-1])
    return 0.5 * np.stack([same[:, 0], same[:, 1], crossed[:, 0] + crossed[:, 1]], axis=1)


def _tensors(S: Floats) -> Floats:
    return S[:, [0, 2, 2, 1]].reshape(-1, 2, 2)


def _pushed(S: Floats, f: Floats, J: Floats) -> Floats:
    """Return S_ij f_i f_j / J, shape (n, 3, 3)."""
    return np.asarray(np.einsum("nij,nic,njd->ncd", _tensors(S), f, f) / J[:, None, None])


def _in_plane(S: Floats, now: _Deformed, axes: Floats) -> Floats:
    """Return S_ij f_i f_j / J as s11, s22, s12 along two axes : (n, 2, 3), shape (n, 3)."""
    p, q = (_dots(now.f[:, i, None], axes).T for i in (0, 1))
    first, second, both = S.T / now.J
    return np.stack(
        [
            first * p[a] * p[b] + second * q[a] * q[b] + both * (p[a] * q[b] + q[a] * p[b])
            for a, b in ((0, 0), (1, 1), (0, 1))
        ],
        axis=-1,
    )


def in_lamina(sigma: Floats, thickness: Floats, x: Floats, quads: Ints) -> FaceStresses:
    """Return stresses of membrane, top and bottom, sigma : (n_quad, 3, 3, 3), as output."""
    axes = _lamina_axes(_tangents(x, quads))
    plane = np.einsum("nic,npcd,njd->npij", axes, sigma, axes)
    return _with_principal(plane[..., [0, 1, 0], [0, 1, 1]], thickness)


def _lamina_axes(g: Floats) -> Floats:
    """Return the unit vectors along g_1 and across it in the sheet, g : (n, 2, 3), same shape."""
    return unit(np.stack([g[:, 0], cross(cross(g[:, 0], g[:, 1]), g[:, 0])], axis=1))


def _with_principal(stress: Floats, thickness: Floats) -> FaceStresses:
    s11, s22, s12 = np.moveaxis(stress, -1, 0)
    mean, radius = 0.5 * (s11 + s22), np.hypot(0.5 * (s11 - s22), s12)
    principal = np.stack([mean + radius, mean - radius], axis=-1)
    return FaceStresses(stress, principal, thickness)


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
