"""Upper bounds of the largest frequency of every quad.

The largest eigenvalue omega² of a quad's tangent stiffness K (with pre-stress) on its own share of
mass and inertia bounds that of the assembly, because mass and stiffness are sums over quads.

*One quad.* A power iteration approaches omega² from below. The factorisation of sigma M - K proves
that sigma is not below it: otherwise some pivot would not be positive. Congruent quads of the
reference mesh are evaluated once.

*In between.* A quad need not be evaluated again while it hardly changes shape. Let p be the
positions and directors at its last evaluation, rotated as a whole to the present ones, p + d, and V
a motion. The strain rates B(p, V) are linear in p, so with |.| the energy norm of the section

    |B(p + d, V)| <= |B(p, V)| + |B(d, V)|,     |B(p, V)| <= omega |V|.

A motion psi e along one direction e has the strain sym(e grad psi); summed over two orthogonal
directions, its energy is at least 2 a |grad psi|², where 2 a is the least trace of the acoustic
tensor (½ [E/(1 - nu²) + G] = 0.74 E for nu = 0.3). Hence omega² |V|² >= a |grad V|².

* A stretch by epsilon takes B to at most 1 + epsilon times itself. The stress grows by at most
  C_max epsilon, C_max being the largest modulus (E/(1 - nu) = 1.43 E), which adds C_max/a epsilon
  omega² to omega². Together omega grows by at most (1 + ½ C_max/a) epsilon to first order.
* Where one part of the quad turns by theta against the whole, by bending, twisting or shear, the
  change of the base vectors there can have any direction: |B(d, V)|² <= theta² C_max |grad V|², and
  omega grows by at most sqrt(C_max/a) theta.

All this also applies to nonlinear laws: the evaluated stiffness is that of the moduli C with the
law's own stresses, and C bounds its tangent.

*What is damped.* Stiffness damping acts with Bᵀ H B, H being that of the elastic moduli. On the
film of a linear law that is K without the pre-stress, and K is taken for it. Other laws soften
where H does not: on a quad of a film of Hencky's law that is twice as long it is the stiffer by a
factor of two, more where it is drawn out further. So it is evaluated for itself, and grows no
faster than omega².

Bending strains have the same moduli times h²/12, which the rotary inertia m h²/12 or more
outweighs, and shear strains have G or less. Epsilon is the largest principal strain and theta the
sum of the angle bent from the centre to a corner, the shear, and the spread of the strains over the
quad, all as changes since the evaluation. A test finds no more than 0.6 of this growth.
"""

from __future__ import annotations

from collections.abc import Callable
from math import cos, sin, sqrt
from typing import Annotated, NamedTuple

import numpy as np

from shellcut.arrays import Floats, Ints, Vec3, each, product
from shellcut.material.shell_material import ShellMaterial
from shellcut.mesh.mesh import Mesh
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.jit import inline, kernel
from shellcut.numerics.kept import Kept
from shellcut.numerics.small_matrices import symmetric_eigen
from shellcut.numerics.vec3 import add, combine, cross, dot, load, norm, sub

from .element import GAUSS, N_STRAIN, modes, products
from .surface import Surface
from .tangent import N_FREEDOM, quad_products

# Quads are congruent if their scalar products agree to this fraction of the largest; the effect on
# a frequency is far below what the bound adds to it.
_CONGRUENT = 1e-9

# Relative excess of the tried bound over the power iteration's value, and iterations per try. Two
# eigenvalues with a ratio of 0.8 are separated to 1e-5 in twelve iterations; closer ones need not
# be.
_ABOVE = 1.002
_TURNS = 12
_TRIES = 4

Shares = Callable[[Ints], tuple[Floats, Floats]]
Tangents = Callable[[Floats, Floats, Ints], Floats]


class _Evaluations(NamedTuple):
    """The last evaluation of each quad."""

    row: Annotated[Ints, "(n_quad,)"]
    """Row of each quad in ``strain``."""
    strain: Annotated[Floats, "(n_row, 16)"]
    """Strains of the evaluations; row 0 is the reference."""
    evaluated: Annotated[Floats, "(n_quad,)"]
    """omega² at the evaluation [1/s²]."""
    damped: Annotated[Floats, "(n_quad,)"]
    """That of the stiffness which is damped."""


class QuadFrequencies(Kept):
    """Bounds of the largest frequency of all quads.

    Parameters
    ----------
    mesh : Mesh
        The reference.
    material : ShellMaterial
        Its moduli bound the growth of a frequency.
    shares : callable
        Takes quad ids; returns their own shares of mass [t] and inertia [t·mm²] at their corners,
        shape (n, 4) each.
    tangents : callable
        Takes x, t and quad ids; returns their stiffness, shape (n, 20, 20).
    damping : callable, optional
        Likewise, the stiffness that is damped, if it is another stiffness.
    """

    # The bounds depend on when each was evaluated.
    kept_names = "_row", "_strain", "_evaluated", "squared", "_evaluated_damped", "damped"

    def __init__(
        self,
        mesh: Mesh,
        material: ShellMaterial,
        shares: Shares,
        tangents: Tangents,
        damping: Tangents | None = None,
    ) -> None:
        self._mesh, self._shares = mesh, shares
        self._tangents, self._damping = tangents, damping
        self.reference = Surface.of(mesh)
        """Of every quad and copy."""
        self.by_stretch, self._by_turn = growth_rates(material)
        """Growth of omega over stretch."""
        # Quads evaluated in a deformed state have a row with their strains then; row 0 is the
        # reference, where all are evaluated first.
        self._row: Ints = np.zeros(mesh.n_quad, np.int32)
        self._strain = np.zeros((1, N_STRAIN))
        self._evaluated, self._evaluated_damped = self._at_rest()
        self.squared = self._evaluated.copy()
        """Bound of omega² of each quad at the last :meth:`follow` [1/s²], shape (n_quad,)."""
        self.damped = self._evaluated_damped.copy()
        """Likewise, of the stiffness that is damped."""

    def follow(self, x: Floats, t: Floats, quads: Ints) -> None:
        """Update the bounds to the present positions and directors, without an evaluation."""
        _follow(
            reference=self.reference,
            present=Surface(x, t, quads),
            known=_Evaluations(self._row, self._strain, self._evaluated, self._evaluated_damped),
            by_stretch=self.by_stretch,
            by_turn=self._by_turn,
            squared=self.squared,
            damped=self.damped,
        )

    def evaluate(self, x: Floats, t: Floats, quads: Ints, which: Ints) -> None:
        """Evaluate some quads at the present positions and directors."""
        new = which[self._row[which] == 0]
        self._row[new] = len(self._strain) + np.arange(new.size)
        self._strain = np.concatenate([self._strain, np.zeros((new.size, N_STRAIN))])
        X, T, corners = self.reference
        products = quad_products(x[quads[which]], t[quads[which]])
        products -= quad_products(X[corners[which]], T[corners[which]])
        self._strain[self._row[which]] = products
        squared, damped = self._bounds(x, t, which)
        self._evaluated[which] = self.squared[which] = squared
        self._evaluated_damped[which] = self.damped[which] = damped

    def cut(self, row: int, growth: Floats) -> None:
        """Take the two parts of a row that has been cut; the new one is the last.

        Parameters
        ----------
        row : int
            Quad or copy.
        growth : ndarray, shape (2,)
            Stiffness over mass of the part that keeps the row and of the new one, relative to that
            of the row before. The stiffness of a copy is that of its quad times a number, so that
            its omega² grows as much.
        """
        self._row = np.append(self._row, np.int32(0))
        for name in ("_evaluated", "squared", "_evaluated_damped", "damped"):
            before = getattr(self, name)
            after = np.append(before, growth[1] * before[row])
            after[row] *= growth[0]
            setattr(self, name, after)
        if self._row[row]:
            self._row[-1] = len(self._strain)
            self._strain = np.concatenate([self._strain, self._strain[self._row[row]][None]])

    def _at_rest(self) -> tuple[Floats, Floats]:
        first, same = _classes(self._mesh)
        # In the layout of a state's arrays, so that the kernel is not compiled for a second layout.
        x, t = np.asfortranarray(self._mesh.nodes), np.asfortranarray(self._mesh.directors)
        squared, damped = self._bounds(x, t, first)
        return squared[same], damped[same]

    def _bounds(self, x: Floats, t: Floats, which: Ints) -> tuple[Floats, Floats]:
        """Return the bounds of omega² of some quads, and those of what is damped [1/s²]."""
        squared = self._bounds_of(self._tangents, x, t, which)
        if self._damping is None:
            return squared, squared
        return squared, self._bounds_of(self._damping, x, t, which)

    def _bounds_of(self, stiffness: Tangents, x: Floats, t: Floats, which: Ints) -> Floats:
        squared = np.empty(which.size)
        # In pieces: a single stiffness needs 3.2 kB.
        for begin in range(0, which.size, _PIECE):
            piece = which[begin : begin + _PIECE]
            mass, inertia = self._shares(piece)
            bound_largest_eigenvalues(
                tangent=stiffness(x, t, piece),
                mass=mass,
                inertia=inertia,
                squared=squared[begin : begin + _PIECE],
            )
        return squared


_PIECE = 1024


def growth_rates(material: ShellMaterial) -> tuple[float, float]:
    """Return the largest relative growth of omega per unit of stretch and per unit of turn."""
    h = material.thickness
    membrane, bending = np.zeros((3, 3)), np.zeros((3, 3))
    for z, weight, layer in zip(*material.thickness_points(), strict=True):
        membrane += weight / h * layer.plane_stress()
        bending += 12.0 * weight * z * z / (h * h * h) * layer.plane_stress()
    # The largest modulus as a quadratic form of tensors: shear counts twice in them.
    unit = np.diag([1.0, 1.0, np.sqrt(2.0)])
    largest = max(symmetric_eigen(product(unit, C, unit))[0][-1] for C in (membrane, bending))
    if not material.is_symmetric:
        largest *= 2.0  # stretching and bending may both be at their maximum
    # Trace of the acoustic tensor along (c, s): C_11 c² + C_22 s² + C_33 + 2 (C_13 + C_23) c s.
    angle = np.linspace(0.0, np.pi, 181)
    c, s = each(cos, angle), each(sin, angle)
    C = membrane
    trace = C[0, 0] * c * c + C[1, 1] * s * s + C[2, 2] + 2.0 * (C[0, 2] + C[1, 2]) * c * s
    ratio = float(largest / (0.5 * trace.min()))
    return 1.0 + 0.5 * ratio, sqrt(ratio)


def _classes(mesh: Mesh) -> tuple[Ints, Ints]:
    """Return the first quad of each class of congruent ones, and the class of every quad."""
    pieces = [slice(k, k + _PIECE) for k in range(0, mesh.n_quad, _PIECE)]

    def products_of(piece: slice) -> Floats:
        return quad_products(mesh.nodes[mesh.quads[piece]], mesh.directors[mesh.quads[piece]])

    # Congruent quads have the same scalar products: a hash of their digits identifies the classes.
    unit = _CONGRUENT * max(np.abs(products_of(piece)).max() for piece in pieces)
    factors = np.random.default_rng(0).integers(1, 2**62, N_STRAIN) | 1
    key = np.concatenate(
        [(np.rint(products_of(piece) / unit).astype(np.int64) * factors).sum(1) for piece in pieces]
    )
    _, first, same = np.unique(key, return_index=True, return_inverse=True)
    return first, same


@kernel
def bound_largest_eigenvalues(
    tangent: Floats, mass: Floats, inertia: Floats, squared: Floats
) -> None:
    """Write a bound of the largest eigenvalue of M⁻¹ K of single quads [1/s²] to squared : (n,).

    tangent : (n, 20, 20), scaled by the mass on return.  mass, inertia : (n, 4), each quad's own
    share at its nodes.
    """
    n = N_FREEDOM
    scale = np.empty(n)
    v, w = np.empty(n), np.empty(n)
    left = np.empty((n, n))
    for i in range(tangent.shape[0]):
        K = tangent[i]
        for a in range(4):
            # K x = omega² M x with a diagonal M: M^-½ K M^-½ is symmetric and has the same omega².
            for c in range(3):
                scale[3 * a + c] = 1.0 / np.sqrt(mass[i, a])
            for b in range(2):
                scale[12 + 2 * a + b] = 1.0 / np.sqrt(inertia[i, a])
        for k in range(n):
            for j in range(n):
                K[k, j] *= scale[k] * scale[j]
            v[k] = 1.0 + 0.37 * ((7 * k) % 11)  # along no symmetry of any quad
        proved = False
        value = 0.0
        for _ in range(_TRIES):
            for _ in range(_TURNS):
                value = _turn(K, v, w)
            # The iteration comes from below: a little more is tried, and proved or not.
            value *= _ABOVE
            if _is_above(value, K, left):
                proved = True
                break
        if not proved:  # by rows, always true
            value = 0.0
            for k in range(n):
                value = max(value, np.abs(K[k]).sum())
        squared[i] = value


@inline
def _turn(K: Floats, v: Floats, w: Floats) -> float:
    """Replace v by K v of unit length; return the Rayleigh quotient of the old v."""
    # w = K v, column by column: K is symmetric, and its rows are contiguous.
    n = N_FREEDOM  # a constant: the loops are unrolled
    for k in range(n):
        w[k] = 0.0
    for j in range(n):
        for k in range(n):
            w[k] += K[j, k] * v[j]
    vv = vw = ww = 0.0
    for k in range(n):
        vv += v[k] * v[k]
        vw += v[k] * w[k]
        ww += w[k] * w[k]
    size = 1.0 / np.sqrt(ww)
    for k in range(n):
        v[k] = size * w[k]
    return float(vw / vv)


@inline
def _is_above(value: float, K: Floats, left: Floats) -> bool:
    """Whether value exceeds all eigenvalues of K : (n, n): all pivots of value - K are positive."""
    n = N_FREEDOM
    for k in range(n):
        for j in range(n):
            left[k, j] = -K[k, j]
        left[k, k] += value
    for k in range(n):
        # Without row exchanges: of a positive matrix all pivots are positive in any order.
        pivot = left[k, k]
        if not pivot > 0.0:
            return False
        for i in range(k + 1, n):
            f = left[i, k] / pivot
            for j in range(k + 1, n):
                left[i, j] -= f * left[k, j]
    return True


@inline
def _products_of(surface: Surface, e: int, m: Floats) -> None:
    x, t, quads = surface
    n0, n1, n2, n3 = quads[e, 0], quads[e, 1], quads[e, 2], quads[e, 3]
    row = products(
        modes(load(x, n0), load(x, n1), load(x, n2), load(x, n3)),
        modes(load(t, n0), load(t, n1), load(t, n2), load(t, n3)),
    )
    for k in range(N_STRAIN):
        m[k] = row[k]


@kernel
def _follow(
    reference: Surface,
    present: Surface,
    known: _Evaluations,
    by_stretch: float,
    by_turn: float,
    squared: Floats,
    damped: Floats,
) -> None:
    """Write squared and damped : (n_quad,), evaluated times the square of the growth since."""
    reference, present, known = borrowed(reference), borrowed(present), borrowed(known)
    m, s = np.empty(N_STRAIN), np.empty(N_STRAIN)
    for e in range(present.quads.shape[0]):
        _products_of(reference, e, m)
        _products_of(present, e, s)
        for k in range(N_STRAIN):
            # The change of the strains since the evaluation.
            s[k] -= m[k] + known.strain[known.row[e], k]
        stretch, turned = change_of_shape(reference.x, reference.quads, e, s)
        growth = (1.0 + by_stretch * stretch + by_turn * turned) ** 2
        squared[e], damped[e] = known.evaluated[e] * growth, known.damped[e] * growth


@inline
def change_of_shape(X: Floats, quads: Ints, e: int, s: Floats) -> tuple[float, float]:
    """Return epsilon and theta of the strain changes s : (16,)."""
    x0, x1 = load(X, quads[e, 0]), load(X, quads[e, 1])
    x2, x3 = load(X, quads[e, 2]), load(X, quads[e, 3])
    x01, x32, x03, x12 = sub(x1, x0), sub(x2, x3), sub(x3, x0), sub(x2, x1)
    stretch = 0.0
    bend = 0.0
    least = (np.inf, np.inf, np.inf)
    most = (-np.inf, -np.inf, -np.inf)
    for q in range(4):
        xi, eta = GAUSS[q]
        a1 = combine(0.25 * (1.0 - eta), x01, 0.25 * (1.0 + eta), x32)
        a2 = combine(0.25 * (1.0 - xi), x03, 0.25 * (1.0 + xi), x12)
        # In the plane of a_1 and a_2: a_1 = (a, 0), a_2 = (p, h).
        a = norm(a1)
        p = dot(a1, a2) / a
        h = norm(cross(a1, a2)) / a
        E = _in_plane(s, 0, xi, eta, a, p, h)
        K = _in_plane(s, 6, xi, eta, a, p, h)
        stretch = max(stretch, 0.5 * (E[0] + E[1]) + _radius(E))
        bend = max(bend, 0.5 * abs(K[0] + K[1]) + _radius(K))
        least = (min(least[0], E[0]), min(least[1], E[1]), min(least[2], E[2]))
        most = (max(most[0], E[0]), max(most[1], E[1]), max(most[2], E[2]))
    # Bending turns a corner by the curvature times half the diagonal.
    reach = 0.5 * max(norm(sub(x2, x0)), norm(sub(x3, x1)))
    g1 = max(abs(s[12] - s[13]) / norm(x01), abs(s[12] + s[13]) / norm(x32)) / 16.0
    g2 = max(abs(s[14] - s[15]) / norm(x03), abs(s[14] + s[15]) / norm(x12)) / 16.0
    # Covariant shear over the sides' lengths is the angle; where the sides are not
    # normal to each other it is larger, by one over the sine between them.
    area = norm(cross(sub(x2, x0), sub(x3, x1)))
    slant = norm(add(x01, x32)) * norm(add(x03, x12)) / (2.0 * area)
    shear = 2.0 * slant * (g1 + g2)
    spread = sub(most, least)
    turned = reach * bend + shear + spread[0] + spread[1] + spread[2]
    return stretch, turned


@inline
def _in_plane(s: Floats, first: int, xi: float, eta: float, a: float, p: float, h: float) -> Vec3:
    """Return xx, yy, xy at a point of the strains from ``first`` on; a_1 = (a, 0), a_2 = (p, h)."""
    h_h = s[first + 2]
    c11 = (s[first] + eta * s[first + 4] + eta * eta * h_h) / 16.0
    c22 = (s[first + 1] + xi * s[first + 5] + xi * xi * h_h) / 16.0
    c12 = (s[first + 3] + xi * s[first + 4] + eta * s[first + 5] + 2.0 * xi * eta * h_h) / 32.0
    xx = c11 / (a * a)
    xy = (c12 / a - xx * p) / h
    yy = (c22 - 2.0 * c12 * p / a + xx * p * p) / (h * h)
    return xx, yy, xy


@inline
def _radius(c: Vec3) -> float:
    """Return half the difference of the principal values."""
    return sqrt(0.25 * (c[0] - c[1]) ** 2 + c[2] ** 2)
