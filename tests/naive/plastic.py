"""Plasticity in plane stress, plainly: tensors, eigenvectors, a bisected root.

One step of the law of :mod:`shellcut.material.plastic` in logarithmic strain and its stress, from
the 3 x 3 matrices C and P and a function σ_y(p), with nothing brought to modes.
"""

import numpy as np
from scipy.optimize import brentq

from .layered_strip import PLANE, moduli


def logarithm(E):
    """Logarithmic strain (11, 22, 2·12) of a Green-Lagrange strain."""
    c, N = np.linalg.eigh(np.array([[1 + 2 * E[0], E[2]], [E[2], 1 + 2 * E[1]]]))
    L = N @ np.diag(0.5 * np.log(c)) @ N.T
    return np.array([L[0, 0], L[1, 1], 2 * L[0, 1]])


def second_piola_kirchhoff(T, E):
    """S of the stress T conjugate to the logarithmic strain, by S · dE = T · dε: differences."""
    T, E = np.asarray(T), np.asarray(E)
    S = np.empty(3)
    for k in range(3):
        step = np.zeros(3)
        step[k] = 1e-5
        ahead, behind = (logarithm(E + n * step) for n in (1, -1))
        far, back = (logarithm(E + n * step) for n in (2, -2))
        slope = (8 * (ahead - behind) - (far - back)) / 12e-5
        S[k] = T @ slope
    return S


def elastic(material):
    """Stiffness for (e_11, e_22, 2e_12) with no stress across, in the film's axes [MPa]."""
    C = moduli(material)
    return C[np.ix_(PLANE, PLANE)] - np.outer(C[PLANE, 2], C[2, PLANE]) / C[2, 2]


def flow(r_values, angle_deg):
    """P of σ_eq² = T · P T by [Hill1948] with R at 0, 45 and 90° to axes at an angle to the film's.

    Along the first axis σ_eq is the stress; all R = 1 is von Mises' rule.
    """
    r_0, r_45, r_90 = r_values
    F, G, H = r_0 / (r_90 * (1 + r_0)), 1 / (1 + r_0), r_0 / (1 + r_0)
    N = (r_0 + r_90) * (1 + 2 * r_45) / (2 * r_90 * (1 + r_0))
    c, s = np.cos(np.radians(angle_deg)), np.sin(np.radians(angle_deg))
    own = np.array(
        [[c * c, s * s, 2 * c * s], [s * s, c * c, -2 * c * s], [-c * s, c * s, c**2 - s**2]]
    )
    return own.T @ np.array([[G + H, -H, 0.0], [-H, F + H, 0.0], [0.0, 0.0, 2 * N]]) @ own


def linear(yield_stress, modulus=0.0):
    """σ_y(p) = σ_0 + H p [MPa]."""
    return lambda p: yield_stress + modulus * p


def swift(strength, start, exponent):
    """σ_y(p) = K (ε_0 + p)^n [MPa]."""
    return lambda p: strength * (start + p) ** exponent


def voce(yield_stress, gain, strain, modulus=0.0):
    """σ_y(p) = σ_0 + Q (1 - exp(-p/p_c)) + H p [MPa]."""
    return lambda p: yield_stress + gain * (1.0 - np.exp(-p / strain)) + modulus * p


def table(strain, stress):
    """σ_y(p) straight between points, constant beyond [MPa]."""
    return lambda p: np.interp(p, strain, stress)


def step(C, P, yield_stress, strain, history):
    """Return T, p, ε_p after a step to a logarithmic strain; history = (p, ε_p)."""
    p, plastic = history
    trial = C @ (strain - plastic)
    if np.sqrt(trial @ P @ trial) <= yield_stress(p):
        return trial, p, plastic

    def at(flow):
        moved = np.linalg.solve(np.eye(3) + flow * (C @ P), trial)
        return moved, np.sqrt(moved @ P @ moved)

    def beyond(flow):
        _, eq = at(flow)
        return eq - yield_stress(p + flow * eq)

    most = 1.0 / np.linalg.eigvals(C @ P).real.min() * np.sqrt(trial @ P @ trial) / yield_stress(p)
    flow = brentq(beyond, 0.0, most, xtol=1e-300, rtol=1e-15)
    moved, eq = at(flow)
    plastic = plastic + flow * (P @ moved)
    return C @ (strain - plastic), p + flow * eq, plastic
