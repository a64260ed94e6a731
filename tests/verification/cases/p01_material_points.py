"""One point of a film that yields: P01 on a path, P02 by angle, P03 in large strains."""

import numpy as np

from harness import Check, case, zero
from shellcut.material import Elastic, Linear, MaterialPoint, Plastic, Swift, Table, Voce

STRAIN = "equivalent plastic strain [-]"
MODULUS = 1930.0 * 195000.0 / (195000.0 - 1930.0)
A, B = np.array([151.2, 0.0, 93.1]), np.array([257.2, 0.0, 33.1])
REFERENCE = (0.0148297, 0.0136014, 0.0205473), (0.0352649, 0.0204709, 0.0423293)
NAMES = ("strain xx", "strain xy", "equivalent plastic strain")


def walk(steps):
    """Return strain xx, strain xy and equivalent plastic strain at A and B."""
    film = Plastic(Elastic(195000.0, 0.3, 1e-9), Linear(181.0, MODULUS))
    point, found = MaterialPoint(film), []
    for start, end in ((np.zeros(3), A), (A, B)):
        for k in range(1, steps + 1):
            state = point.stress_to(start + k / steps * (end - start))
        strain = state.strain
        found.append(np.array([strain[0], 0.5 * strain[2], state.history[STRAIN]]))
    return found


@case("P01", "Plasticity on a path that turns")
def p01():
    """Von Mises, isotropic: E = 195,000, nu = 0.3, yield stress 181, tangent 1,930 MPa (H =
    1949.29). One point is led by stresses from zero to A (151.2, 93.1) and on a straight line to B
    (257.2, 33.1), sigma_xx and tau_xy. The law is that of the films, between logarithmic strain and
    its stress, where a path of small strains is exact at any size.

    Source: inputs of Code_Aster V6.03.015 (SSNP15); values integrated from the rate equations in
    small steps, converged. The return at the end of the step is of the first order in the step on
    the leg that turns: the strains at B are extrapolated from 80 and 160 steps.
    """
    bands = (5e-6, "last digit of the reference"), (5e-5, "second order in the step")
    for at, one, other, wanted, (band, why) in zip(
        "AB", walk(80), walk(160), REFERENCE, bands, strict=True
    ):
        for quantity, value, ours in zip(NAMES, wanted, 2.0 * other - one, strict=True):
            yield Check(f"{quantity} at {at}, isotropic", value, float(ours), band, why)


R0, R45, R90 = 0.8, 1.2, 1.6
G, H, F = 1.0 / (1.0 + R0), R0 / (1.0 + R0), R0 / (R90 * (1.0 + R0))
N = (R0 + R90) * (1.0 + 2.0 * R45) / (2.0 * R90 * (1.0 + R0))
STRENGTH = {45.0: 1.04447, 90.0: 1.17670}


def point_at(angle):
    """Return a point of a film in the axes of a strip cut at an angle [degrees]."""
    film = Plastic(Elastic(1e4, 0.3, 1e-9), Linear(1.0), (R0, R45, R90), angle_deg=-angle)
    return MaterialPoint(film)


@case("P02", "Hill's strips")
def p02():
    """r = 0.8, 1.2, 1.6 at 0, 45 and 90°; a strip along MD yields at 1. Strips are cut at angles of
    0 to 90° and pulled far beyond yield; their strength and the ratio of plastic strains in width
    and thickness are those of the closed form,

        r(theta) = [H + (2N - F - G - 4H) s² c²] / (F s² + G c²).

    Source: Hill 1948.
    """
    for angle in (0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 90.0):
        s, c = np.sin(np.radians(angle)), np.cos(np.radians(angle))
        state = point_at(angle).pull(0.5)
        along, across = (state.history[f"plastic strain {k} [-]"] for k in (11, 22))
        r = (H + (2.0 * N - F - G - 4.0 * H) * s * s * c * c) / (F * s * s + G * c * c)
        ours, why = across / (-along - across), "closed form; the rest is elastic"
        yield Check(f"r at {angle:g}°", r, ours, 1e-7, why)
        if angle in STRENGTH:
            strength = float(state.stress[0])
            yield Check(f"strength at {angle:g}°", STRENGTH[angle], strength, 5e-6, "last digit")
    # Where both stresses agree the normal to the surface, and so the flow, has the ratio G : F.
    both = point_at(0.0).strain_to([0.4 * G, 0.4 * F, 0.0])
    yield Check("equibiaxial strength", 1.09545, float(both.stress[0]), 1e-4, "elastic part")
    shear = point_at(0.0).strain_to([0.0, 0.0, 0.8])
    yield Check("strength in shear", 0.59409, float(shear.stress[2]), 1e-5, "last digit")


E, NU = 1678.0, 0.3
LAWS = {
    "linear": Linear(15.0, 40.0),
    "Swift": Swift(50.0, 0.002, 0.25),
    "Voce": Voce(15.0, 20.0, 0.1, 5.0),
    "table": Table((0.0, 0.02, 0.2, 1.5), (15.0, 20.0, 30.0, 55.0)),
}
FORMULAE = {
    "linear": lambda p: 15.0 + 40.0 * p,
    "Swift": lambda p: 50.0 * (0.002 + p) ** 0.25,
    "Voce": lambda p: 15.0 + 20.0 * (1.0 - np.exp(-p / 0.1)) + 5.0 * p,
}
PATHS = {  # strain, number of the stress; equivalent stress and strain over these, modulus
    "pull": (None, 0, 1.0, 1.0, E),
    "equibiaxial": (np.array([1.0, 1.0, 0.0]), 0, 1.0, 2.0, E / (1.0 - NU)),
    "shear": (np.array([0.0, 0.0, 2.0]), 2, np.sqrt(3.0), 2.0 / np.sqrt(3.0), E / (1.0 + NU)),
}


@case("P03", "Large strains of every law", fast=False)
def p03():
    """Each is pulled, stretched equibiaxially and sheared to a true strain of one.

    In a monotonic path the stress is the hardening curve itself: with the equivalent stress q and
    the plastic strain ε - q/E' of the path, q = sigma_y(p), exactly and in one step or many.

    Source: closed form; the same for all kinds of hardening. The yield stress of Swift's and Voce's
    law is that of a table, itself compared with the formula.
    """
    p = np.append(0.0, np.geomspace(1e-8, 5.0, 5000))
    for name, formula in FORMULAE.items():
        far = float(np.abs(LAWS[name].stress(p) / formula(p) - 1.0).max())
        text = f"yield stress over the formula's, {name}, farthest from 1"
        yield zero(text, far, 1e-4, "points of the table")
    for name, hardening in LAWS.items():
        for steps in (1, 50):
            for kind, (strain, k, q_of_stress, p_of_strain, modulus) in PATHS.items():
                point = MaterialPoint(Plastic(Elastic(E, NU, 1e-9), hardening))
                for e in np.arange(1, steps + 1) / steps:
                    state = point.pull(float(e)) if kind == "pull" else point.strain_to(e * strain)
                text, stress = f"{name}, {kind}, {steps} steps", state.stress[k]
                p = p_of_strain * (1.0 - stress / modulus)
                wanted, q = float(hardening.stress(p)), float(q_of_stress * stress)
                yield Check(f"stress, {text}", wanted, q, 1e-8, "closed form")
                got = state.history[STRAIN]
                yield Check(f"plastic strain, {text}", float(p), got, 1e-8, "closed form")
