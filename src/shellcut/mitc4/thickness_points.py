"""Resultants from points through the thickness: the general path, for any material.

At every Gauss point of the quad and every point xi³ of the thickness, with Q and √G as in
:mod:`shellcut.mitc4.section`,

    e = Q (E + xi³ K, 2E_13, 2E_23),   S = law(e, history),   (N, M, q) += w √G Qᵀ (S, xi³ S, ..),

so curved and warped references, the volume factor and layers are treated as in the pre-integrated
section. For a St.Venant-Kirchhoff material both paths agree to round-off; this one costs more but
needs no linearity. The transverse shear stays elastic.

Q follows from the frame ê_n · G^k, of which a, b, p = ê_1 · G^1, G^2, G^3 and f, r = ê_2 · G^2, G^3
and d = ê_3 · G^3 do not vanish. On a flat quad the frame is the same at all heights, p = r = 0 and
d = 1: strains are turned once per Gauss point, and the law is evaluated at e + xi³ k.

The loop over the heights with a linear law is a few operations and inlined. With other laws it is a
function of its own, called at each Gauss point: while the law is evaluated, the 32 strains and
resultants of the quad would take the registers that it needs, and four copies of it would exceed
the processor's cache for instructions.
"""

# Functions that call a law of any kind take arguments of several kinds.
# mypy: disable-error-code="no-untyped-def"

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

import numpy as np

from shellcut.arrays import Floats, Number, Vector, product
from shellcut.material.law_dispatch import (
    HistoryStep,
    PointLaws,
    borrowed_history,
    chosen_by_laws,
    dissipates,
    has_axes,
    point_stress,
)
from shellcut.material.shell_material import ShellMaterial
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.jit import always_inline, apart_as
from shellcut.numerics.lane_instructions import Lane
from shellcut.numerics.lanes import pick_all, zero
from shellcut.numerics.processor import not_inlined

from .element import G, Sixteen
from .section import frame_components, gauss_geometry, into_axes, out_of_axes

N_FLAT_FRAME, N_FULL_FRAME = 4, 7
"""Floats per frame: (a, b, f, √G), and (a, b, p, f, r, d, w √G)."""


class PointRule(NamedTuple):
    """The points through the thickness, the same for all quads."""

    place: Annotated[Floats, "(n_point,)"]
    """xi³ [mm]."""
    weight: Annotated[Floats, "(n_point,)"]
    """Weights of the quadrature [mm]."""
    lever: Annotated[Floats, "(n_point,)"]
    """Place times weight [mm²]."""
    laws: PointLaws
    """Material laws of the points."""
    shear: Annotated[Floats, "(n_point, 3)"]
    """Effective transverse shear moduli 11, 12, 22 [MPa]."""
    whole_shear: Annotated[Floats, "(3,)"]
    """Their integrals over the thickness [N/mm]."""
    n_history: int
    """History numbers per point, for the law with the most."""


class PointTables(NamedTuple):
    """Frames of all quads, and the points."""

    flat_frame: Annotated[Floats, "(n_flat_frame, 16, width)"]
    full_frame: Annotated[Floats, "(n_full_frame, n_number, width)"]
    """4 n_point 7 numbers per block."""
    axes: Annotated[Floats, "(n_axes, 8, width)"]
    """Of :func:`.section.film_axes`, of all blocks; empty if no law has axes."""
    rule: PointRule


class PointPlace(NamedTuple):
    """A block of quads in the tables of its points."""

    points: PointTables
    lent: PointTables
    """The same, or their address, for functions that are not inlined."""
    block: int
    """In the tables of frames."""
    axes_block: int


def build_rule(material: ShellMaterial) -> PointRule:
    """Return the thickness points of a material; none without ``integration_points``."""
    if material.integration_points is None:
        none = np.zeros(0)
        nothing = PointLaws((), np.zeros(0, np.int64), np.zeros((0, 1)))
        return PointRule(none, none, none, nothing, np.zeros((0, 3)), np.zeros(3), 0)
    place, weight, layers = material.thickness_points(material.integration_points)
    laws = list(dict.fromkeys(layer.law for layer in layers))
    rows = [np.asarray(layer.parameters(), float) for layer in layers]
    parameters = np.zeros((len(rows), max(1, *(row.size for row in rows))))
    for row, given in zip(parameters, rows, strict=True):
        row[: given.size] = given
    moduli = [material.transverse_shear(layer.transverse_shear()) for layer in layers]
    shear = np.array([[block[0, 0], block[0, 1], block[1, 1]] for block in moduli])
    return PointRule(
        place,
        weight,
        place * weight,
        PointLaws(tuple(laws), np.array([laws.index(layer.law) for layer in layers]), parameters),
        shear,
        product(weight, shear),
        max(len(law.history) for law in laws),
    )


def flat_frames(X: Floats, T: Floats) -> Floats:
    """Return a, b, f and √G at the four Gauss points of flat quads, shape (n_quad, 16)."""
    rows = []
    for _, A1, A2, T0, _, _ in gauss_geometry(X, T):
        c, _ = frame_components(A1, A2, T0)
        volume = np.einsum("ei,ei->e", np.cross(A1, A2), T0)
        rows += [c[:, 0, 0], c[:, 0, 1], c[:, 1, 1], volume]
    return np.stack(rows, axis=1)


def full_frames(X: Floats, T: Floats, rule: PointRule) -> Floats:
    """Return the frames of any quads, shape (n_quad, 4 n_point 7), thickness points innermost."""
    rows = []
    for _, A1, A2, T0, T1, T2 in gauss_geometry(X, T):
        for z, w in zip(rule.place, rule.weight, strict=True):
            G1, G2 = A1 + z * T1, A2 + z * T2  # [Frangi2010] (6)
            c, _ = frame_components(G1, G2, T0)
            volume = w * np.einsum("ei,ei->e", np.cross(G1, G2), T0)
            rows += [*c[:, 0].T, c[:, 1, 1], c[:, 1, 2], c[:, 2, 2], volume]
    return np.stack(rows, axis=1)


@always_inline
def strain_at(s: Sixteen, i: int, xi: float, eta: float) -> Vector:
    """Return 16 (E_11, E_22, 2E_12) for i = 0, 16 (K_11, K_22, 2K_12) for i = 6."""
    return (
        s[i] + eta * s[i + 4] + (eta * eta) * s[i + 2],
        s[i + 1] + xi * s[i + 5] + (xi * xi) * s[i + 2],
        s[i + 3] + xi * s[i + 4] + eta * s[i + 5] + (2.0 * xi * eta) * s[i + 2],
    )


@always_inline
def turn_strain(a: Number, b: Number, f: Number, v: Vector) -> Vector:
    """Return (e_11, e_22, 2e_12) of the in-plane covariant strain v."""
    return (
        a * (a * v[0] + b * v[2]) + b * b * v[1],
        f * f * v[1],
        f * (2.0 * (b * v[1]) + a * v[2]),
    )


@always_inline
def _turn_back(a: Number, b: Number, f: Number, n: Vector) -> Vector:
    """Return the covariant resultants of the in-plane Cartesian ones."""
    along = b * n[0] + f * n[2]
    return a * a * n[0], b * along + f * (f * n[1] + b * n[2]), a * along


@always_inline
def _sixteen(v: Number) -> Sixteen:
    four = v, v, v, v
    return four + four + four + four


@always_inline
def _add_resultants(
    r: Sixteen, n: Vector, m: Vector, q1: Number, q2: Number, xi: float, eta: float
) -> Sixteen:
    """Return r + Bᵀ (n, m, q) / 16 of one Gauss point; n, m, q contain the factor 1/16."""
    xx, ee, xe = xi * xi, eta * eta, 2.0 * xi * eta
    return (
        r[0] + n[0],
        r[1] + n[1],
        r[2] + ee * n[0] + xx * n[1] + xe * n[2],
        r[3] + n[2],
        r[4] + eta * n[0] + xi * n[2],
        r[5] + xi * n[1] + eta * n[2],
        r[6] + m[0],
        r[7] + m[1],
        r[8] + ee * m[0] + xx * m[1] + xe * m[2],
        r[9] + m[2],
        r[10] + eta * m[0] + xi * m[2],
        r[11] + xi * m[1] + eta * m[2],
        r[12] + q1,
        r[13] + eta * q1,
        r[14] + q2,
        r[15] + xi * q2,
    )


def _by_laws(layers: Any, name: str) -> Any:
    """Return a function that sums up the layers of a block: within the kernel if laws are linear.

    Otherwise by a call: ``layers`` takes the tables of points, the block there, the Gauss point,
    strains, history and lane.
    """

    @always_inline
    def within(place, q, s, history, lane):
        return layers(place.points, place.block, q, s, history, lane)

    @apart_as(name)
    def called(points, b, q, s, history, lane):
        not_inlined()
        return layers(borrowed(points), b, q, s, borrowed_history(history), lane)

    @always_inline
    def call(place, q, s, history, lane):
        return called(place.lent, place.block, q, s, history, lane)

    return chosen_by_laws(within, call)


@always_inline
def _flat_layers(
    points: PointTables,
    _b: int,
    q: int,
    strains: tuple[Vector, Vector],
    history: HistoryStep,
    lane: Lane,
) -> tuple[Vector, Vector, Number, Number]:
    """Return n, m, the stored energy of these and the just dissipated energy of flat quads.

    strains : of the mid-surface, and curvature, at Gauss point ``q``.
    """
    rule, (e, k) = points.rule, strains
    none, n_point = zero(lane), rule.place.shape[0]
    n, m, density, lost = (none, none, none), (none, none, none), none, none
    for j in range(n_point):
        z = rule.place[j]
        first = (q * n_point + j) * rule.n_history
        strain = (e[0] + z * k[0], e[1] + z * k[1], e[2] + z * k[2])
        stress, energy, dissipated = point_stress(rule.laws, j, strain, history, first, lane)
        w, zw = rule.weight[j], rule.lever[j]
        n = (n[0] + w * stress[0], n[1] + w * stress[1], n[2] + w * stress[2])
        m = (m[0] + zw * stress[0], m[1] + zw * stress[1], m[2] + zw * stress[2])
        density = density + w * energy
        if dissipates(rule.laws):
            lost = lost + w * dissipated
    return n, m, density, lost


_through_flat = _by_laws(_flat_layers, "flat")


@always_inline
def _flat_gauss_point(
    q: int,
    at: tuple[float, float],
    r: Sixteen,
    s: Sixteen,
    place: PointPlace,
    history: HistoryStep,
    lane: Lane,
) -> tuple[Sixteen, Number, Number]:
    """Return r with the part of one Gauss point, its stored and just dissipated energy."""
    xi, eta = at
    table, b, rule = place.points.flat_frame, place.block, place.points.rule
    none = zero(lane)
    a, c, f, volume = pick_all(table, b, N_FLAT_FRAME * q, 4, lane)
    # A quarter in the frame gives the factor 1/16 of the strains of the modes.
    a, c, f = 0.25 * a, 0.25 * c, 0.25 * f
    e = turn_strain(a, c, f, strain_at(s, 0, xi, eta))
    k = turn_strain(a, c, f, strain_at(s, 6, xi, eta))
    g1, g2 = 0.25 * (s[12] + eta * s[13]), 0.25 * (s[14] + xi * s[15])
    e13, e23 = a * g1 + c * g2, f * g2
    along, aside = none, none
    if has_axes(rule.laws):
        along, aside = pick_all(place.points.axes, place.axes_block, 2 * q, 2, lane)
        e, k = into_axes(along, aside, e), into_axes(along, aside, k)
        e13, e23 = along * e13 + aside * e23, along * e23 - aside * e13
    n, m, density, lost = _through_flat(rule.laws, place, q, (e, k), history, lane)
    # Shear is the same at all heights of a flat quad: once, with the moduli's integrals.
    g11, g12, g22 = rule.whole_shear[0], rule.whole_shear[1], rule.whole_shear[2]
    s13, s23 = g11 * e13 + g12 * e23, g12 * e13 + g22 * e23
    stored = volume * (density + 0.5 * (s13 * e13 + s23 * e23))
    if has_axes(rule.laws):
        n, m = out_of_axes(along, aside, n), out_of_axes(along, aside, m)
        s13, s23 = along * s13 - aside * s23, aside * s13 + along * s23
    # The volume last: the layers have summed per area of the mid-surface.
    n = (volume * n[0], volume * n[1], volume * n[2])
    m = (volume * m[0], volume * m[1], volume * m[2])
    quarter = 0.25 * volume
    r = _add_resultants(
        r,
        _turn_back(a, c, f, n),
        _turn_back(a, c, f, m),
        quarter * (a * s13),
        quarter * (c * s13 + f * s23),
        xi,
        eta,
    )
    return r, stored, volume * lost if dissipates(rule.laws) else none


class Lifted(NamedTuple):
    """Covariant strains at a Gauss point, of which those at any height follow."""

    e: Vector
    """Of the mid-surface."""
    k: Vector
    """Curvatures."""
    g1: Number
    """Transverse shear."""
    g2: Number
    along: Number
    """Direction of the film's axes, if any law has some."""
    aside: Number


@always_inline
def _full_layers(
    points: PointTables, b: int, q: int, s: Lifted, history: HistoryStep, lane: Lane
) -> tuple[Vector, Vector, tuple[Number, Number], Number, Number]:
    """Return n, m, q, the stored and the just dissipated energy over the thickness of any quad."""
    table, rule = points.full_frame, points.rule
    n_point = rule.place.shape[0]
    none = zero(lane)
    stored, lost, q1, q2 = none, none, none, none
    e, k, g1, g2, along, aside = s
    n, m = (none, none, none), (none, none, none)
    for j in range(n_point):
        z, at = rule.place[j], N_FULL_FRAME * (q * n_point + j)
        a, c, p, f, t, d, w = pick_all(table, b, at, N_FULL_FRAME, lane)
        a, c, f = 0.25 * a, 0.25 * c, 0.25 * f
        e1, e2, e12 = turn_strain(a, c, f, (e[0] + z * k[0], e[1] + z * k[1], e[2] + z * k[2]))
        # On a curved or warped quad ê_1 and ê_2 have parts along G^3: shear adds to the strain.
        ag, fg = a * g1 + c * g2, f * g2
        strain = (e1 + p * ag, e2 + t * fg, e12 + t * ag + p * fg)
        e13, e23 = d * ag, d * fg
        if has_axes(rule.laws):
            strain = into_axes(along, aside, strain)
            e13, e23 = along * e13 + aside * e23, along * e23 - aside * e13
        first = (q * n_point + j) * rule.n_history
        (s1, s2, s12), density, dissipated = point_stress(
            rule.laws, j, strain, history, first, lane
        )
        s13 = rule.shear[j, 0] * e13 + rule.shear[j, 1] * e23
        s23 = rule.shear[j, 1] * e13 + rule.shear[j, 2] * e23
        stored = stored + w * (density + 0.5 * (s13 * e13 + s23 * e23))
        if dissipates(rule.laws):
            lost = lost + w * dissipated
        if has_axes(rule.laws):
            s1, s2, s12 = out_of_axes(along, aside, (s1, s2, s12))
            s13, s23 = along * s13 - aside * s23, aside * s13 + along * s23
        # Each height has a frame of its own, so stresses are turned back before they are summed.
        back = _turn_back(a, c, f, (w * s1, w * s2, w * s12))
        n = (n[0] + back[0], n[1] + back[1], n[2] + back[2])
        m = (m[0] + z * back[0], m[1] + z * back[1], m[2] + z * back[2])
        # dW/d(ag) and dW/d(fg), with the quarter included.
        to_ag = (0.25 * w) * (p * s1 + t * s12 + d * s13)
        to_fg = (0.25 * w) * (t * s2 + p * s12 + d * s23)
        q1 = q1 + a * to_ag
        q2 = q2 + c * to_ag + f * to_fg
    return n, m, (q1, q2), stored, lost


_through_full = _by_laws(_full_layers, "full")


@always_inline
def _full_gauss_point(
    q: int,
    at: tuple[float, float],
    r: Sixteen,
    s: Sixteen,
    place: PointPlace,
    history: HistoryStep,
    lane: Lane,
) -> tuple[Sixteen, Number, Number]:
    """Return r with the part of one Gauss point, its stored and just dissipated energy."""
    xi, eta = at
    along, aside = zero(lane), zero(lane)
    if has_axes(place.points.rule.laws):
        along, aside = pick_all(place.points.axes, place.axes_block, 2 * q, 2, lane)
    lifted = Lifted(
        strain_at(s, 0, xi, eta),
        strain_at(s, 6, xi, eta),
        0.25 * (s[12] + eta * s[13]),
        0.25 * (s[14] + xi * s[15]),
        along,
        aside,
    )
    laws = place.points.rule.laws
    n, m, (q1, q2), stored, lost = _through_full(laws, place, q, lifted, history, lane)
    return _add_resultants(r, n, m, q1, q2, xi, eta), stored, lost


@always_inline
def _gauss_point(
    flat: bool,
    q: int,
    at: tuple[float, float],
    r: Sixteen,
    s: Sixteen,
    place: PointPlace,
    history: HistoryStep,
    lane: Lane,
) -> tuple[Sixteen, Number, Number]:
    if flat:
        return _flat_gauss_point(q, at, r, s, place, history, lane)
    return _full_gauss_point(q, at, r, s, place, history, lane)


@always_inline
def resultants_at(
    flat: bool, s: Sixteen, place: PointPlace, history: HistoryStep, lane: Lane
) -> tuple[Sixteen, Number, Number]:
    """Return the resultants of a block, its stored and just dissipated energy [N·mm]."""
    # One call per point, no loop: with constant xi and eta most of their products vanish.
    r = _sixteen(zero(lane))
    r, w0, d0 = _gauss_point(flat, 0, (-G, -G), r, s, place, history, lane)
    r, w1, d1 = _gauss_point(flat, 1, (G, -G), r, s, place, history, lane)
    r, w2, d2 = _gauss_point(flat, 2, (G, G), r, s, place, history, lane)
    r, w3, d3 = _gauss_point(flat, 3, (-G, G), r, s, place, history, lane)
    return r, (w0 + w1) + (w2 + w3), (d0 + d1) + (d2 + d3)
