"""Strain energy and nodal forces of shells by plain tensor algebra ([Frangi2010] 2 and 3).

Every tensor is a 3 x 3 matrix in space, E = E_ij G^i (x) G^j; the plane-stress law acts on its part
in the plane normal to the director, the transverse shear on the rest. No frame, no table of
sections, no strain vector. The energy is a polynomial in the current positions and directors, so
it takes complex numbers and its gradient follows exactly by complex steps.
"""

from functools import cache

import numpy as np
from numpy.polynomial import Polynomial

G = 1.0 / np.sqrt(3.0)
GAUSS = ((-G, -G), (G, -G), (G, G), (-G, G))
CORNERS = ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0))


def shape(xi, eta):
    """Bilinear shape functions and their derivatives by xi and eta, rows of a (3, 4) array."""
    n = [0.25 * (1 + xi * a) * (1 + eta * b) for a, b in CORNERS]
    by_xi = [0.25 * a * (1 + eta * b) for a, b in CORNERS]
    by_eta = [0.25 * b * (1 + xi * a) for a, b in CORNERS]
    return np.array([n, by_xi, by_eta])


def tied_shear(x, t, xi, eta):
    """a_alpha . t interpolated from the mid-edge points of one configuration [DvorkinBathe1984]."""

    def at(u, v, alpha):
        value, *by = shape(u, v)
        return (by[alpha] @ x) @ (value @ t)

    first = 0.5 * (1 - eta) * at(0.0, -1.0, 0) + 0.5 * (1 + eta) * at(0.0, 1.0, 0)
    second = 0.5 * (1 - xi) * at(-1.0, 0.0, 1) + 0.5 * (1 + xi) * at(1.0, 0.0, 1)
    return first, second


def thickness_rule(material, n_point):
    """Place, weight and material of Gauss points, n_point a layer, from the bottom up."""
    place, weight = np.polynomial.legendre.leggauss(n_point)
    bottom = -0.5 * sum(layer.thickness for layer in material.layers)
    rule = []
    for layer in material.layers:
        half = 0.5 * layer.thickness
        rule += [
            (bottom + half * (1 + p), half * w, layer.material)
            for p, w in zip(place, weight, strict=True)
        ]
        bottom += layer.thickness
    return rule


def _along(law):
    """E' and the shear modulus through the thickness along axis 1 of a layer."""
    if hasattr(law, "young_along"):
        nu = law.poisson**2 * law.young_across / law.young_along
        return law.young_along / (1 - nu), law.shear
    return law.young / (1 - law.poisson**2), law.young / (2 * (1 + law.poisson))


@cache
def shear_factor(material):
    """(∫E' z̄² dz)² / (∫G dz ∫S²/G dz) of isotropic layers, S = ∫E' z̄ dz, with polynomials of z."""
    if material.shear_factor is not None:
        return material.shear_factor
    top = np.cumsum([layer.thickness for layer in material.layers])
    spans = list(zip([0.0, *top], top, strict=False))
    moduli, shear = zip(*(_along(layer.material) for layer in material.layers), strict=True)

    def integral(polynomials):
        return sum(
            np.diff(polynomial.integ()(np.array(span)))[0]
            for polynomial, span in zip(polynomials, spans, strict=True)
        )

    z, unity = Polynomial([0.0, 1.0]), Polynomial([1.0])
    z = z - integral(E * z for E in moduli) / integral(E * unity for E in moduli)
    S, at_bottom = [], 0.0
    for E, (low, high) in zip(moduli, spans, strict=True):
        S.append((E * z).integ(lbnd=low) + at_bottom)
        at_bottom = S[-1](high)
    flow = integral(E * z**2 for E in moduli)
    energy = integral(s**2 / G for s, G in zip(S, shear, strict=True))
    return flow**2 / (integral(G * unity for G in shear) * energy)


def stress_of(E, normal, elastic, shear_factor):
    """Stress tensor of the St.Venant-Kirchhoff plane-stress law with transverse shear [MPa]."""
    plane = np.eye(3) - np.outer(normal, normal)
    inside = plane @ E @ plane
    nu, modulus = elastic.poisson, elastic.young / (1 - elastic.poisson**2)
    mu = elastic.young / (2 * (1 + nu))
    shear = 2.0 * shear_factor * mu * (plane @ E @ normal)
    stress = modulus * ((1 - nu) * inside + nu * np.trace(inside) * plane)
    return stress + np.outer(shear, normal) + np.outer(normal, shear)


def quad_energy(X, T, x, t, material, n_point=4):
    """Strain energy of one quad [N·mm]; X, T, x, t of shape (4, 3)."""
    energy, factor = 0.0, shear_factor(material)
    for xi, eta in GAUSS:
        value, *by = shape(xi, eta)
        A, dT, T0 = [d @ X for d in by], [d @ T for d in by], value @ T
        a, dt = [d @ x for d in by], [d @ t for d in by]
        now, then = tied_shear(x, t, xi, eta), tied_shear(X, T, xi, eta)
        for z, weight, elastic in thickness_rule(material, n_point):
            covariant = [A[0] + z * dT[0], A[1] + z * dT[1], T0]
            volume = np.cross(covariant[0], covariant[1]) @ covariant[2]
            contra = np.linalg.inv(np.array(covariant).T)
            E = np.zeros((3, 3), np.result_type(x, t))
            for i in range(2):
                for j in range(2):
                    stretch = 0.5 * (a[i] @ a[j] - A[i] @ A[j])
                    bend = a[i] @ dt[j] + a[j] @ dt[i] - A[i] @ dT[j] - A[j] @ dT[i]
                    E += (stretch + 0.5 * z * bend) * np.outer(contra[i], contra[j])
                half = 0.5 * (now[i] - then[i])
                E += half * (np.outer(contra[i], contra[2]) + np.outer(contra[2], contra[i]))
            normal = T0 / np.sqrt(T0 @ T0)
            stress = stress_of(E, normal, elastic, factor)
            energy += weight * volume * 0.5 * np.sum(stress * E)
    return energy


def energy(X, T, x, t, quads, material, n_point=4):
    """Strain energy of all quads [N·mm]."""
    return sum(quad_energy(X[q], T[q], x[q], t[q], material, n_point) for q in quads)


def forces(X, T, x, t, quads, material):
    """dW/dx [N] and dW/dt [N·mm], shape (n_node, 3) each, by complex steps: exact to round-off."""
    tiny = 1e-30
    by_x, by_t = np.zeros_like(x), np.zeros_like(t)
    for q in quads:
        for out, which in ((by_x, 0), (by_t, 1)):
            for a in range(4):
                for c in range(3):
                    now = [x[q].astype(complex), t[q].astype(complex)]
                    now[which][a, c] += 1j * tiny
                    out[q[a], c] += quad_energy(X[q], T[q], *now, material).imag / tiny
    return by_x, by_t


def modes(v):
    """Bilinear modes p, q, h and the sum m of four corner vectors (4, 3): 4 v = m + xi p + ..."""
    sign = np.array(CORNERS)
    return sign[:, 0] @ v, sign[:, 1] @ v, (sign[:, 0] * sign[:, 1]) @ v, v.sum(axis=0)


def products(x, t):
    """The sixteen scalar products of the table in the mitc4 module, shape (16,)."""
    p, q, h, _ = modes(x)
    tp, tq, th, tm = modes(t)
    return np.array(
        [
            *(0.5 * p @ p, 0.5 * q @ q, 0.5 * h @ h, p @ q, p @ h, q @ h),
            *(p @ tp, q @ tq, h @ th, p @ tq + q @ tp, p @ th + h @ tp, q @ th + h @ tq),
            *(p @ tm + h @ tq, p @ tq + h @ tm, q @ tm + h @ tp, q @ tp + h @ tm),
        ]
    )
