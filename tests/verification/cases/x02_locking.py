"""X02 locking: none in shear; in the membrane of curved quads, as it is.

*Shear.* Plates and an arch from thick to t / L = 1e-4 on coarse meshes, regular and skewed. The
deflection over the exact one stays flat: MITC4 ties the transverse shear. Exact: hard simply
supported plate, thin plate plus shear, 0.0736713 q L² / (κ G h); arch, Timoshenko's curved bar,
π P (a² + b²) / (E (a² - b² + (a² + b²) ln b/a)). The arch of h / R = 0.1 is 0.75 (h / R)² too
stiff beside the error of its mesh: the strain is linear in ξ³ (:mod:`shellcut.mitc4`).

*Membrane.* MITC4 interpolates the membrane strains as the displacements give them. Where mesh lines
follow the lines of curvature (or the rulings of the twisted strip) quads bend without stretching,
and nothing locks. On skewed meshes of doubly curved shells bending without stretching is not in the
element, and the error grows as (s² / R t)²: the pinched hemisphere below. This limit is MITC4's
own, MITC4+ (Ko, Lee, Bathe 2017) was made to lift it. Nothing here has a verdict.

The skewed mesh: the sides are divided as 1 : 2 : ... : N, opposite ones in reverse, and joined by
lines straight in the map.
"""

from collections.abc import Callable

import numpy as np

from cases import a03_curved_shells as shells
from cases.a08_plates import EXACT_THIN, POISSON, YOUNG, deflection, flat, stiffness
from cases.paths import curve
from cases.x01_convergence import arch_deflection
from harness import Check
from patches import Place, mapped_patch, sphere

ID, TITLE, FAST = "X02", "Locking", True

THICKNESSES = (0.1, 1e-2, 1e-3, 1e-4)
N = 8
HEMISPHERE = {0.04: 1.0, 0.004: 1e-3, 0.0004: 1e-6}  # thickness and force for about the same u
THIN_TWISTED = {"in plane": 5.256e-3, "out of plane": 1.294e-3}  # t = 0.0032, force 1e-6

CURVES = {}
AXES = "thickness over length, t / L", "w over the exact w"


def skewed(place: Place, n_u: int, n_v: int) -> Place:
    """Return the map with a skewed mesh of n_u x n_v quads."""

    def graded(n: int) -> np.ndarray:
        steps = np.cumsum(np.arange(n + 1.0))
        return steps / steps[-1]

    u_of, v_of = graded(n_u), graded(n_v)

    def skew(u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        i, j = np.rint(n_u * u).astype(int), np.rint(n_v * v).astype(int)
        # one line from (a, 0) to (b, 1), the other from (0, c) to (1, d)
        a, b, c, d = u_of[i], 1.0 - u_of[n_u - i], 1.0 - v_of[n_v - j], v_of[j]
        across = (a + (b - a) * c) / (1.0 - (b - a) * (d - c))
        return place(across, c + (d - c) * across)

    return skew


def supported_plate(thickness: float) -> float:
    """Return the exact alpha of the simply supported plate with its shear deflection."""
    shear = 5.0 / 6.0 * 0.5 * YOUNG / (1.0 + POISSON) * thickness
    return EXACT_THIN["simply supported"] + 0.0736713 * stiffness(thickness) / shear


def curved_bar(thickness: float) -> float:
    """Return Timoshenko's deflection over that of a thin one, π P R³ / (4 E I), to (h / R)⁴."""
    return 1.0 + 0.15 * thickness**2


def flat_rows(
    name: str,
    ratio: Callable[[float], float],
    *,
    thicknesses: tuple[float, ...] = THICKNESSES,
    curved: bool = False,
) -> list[Check]:
    """Check a normalised deflection over the thicknesses, and that it does not change when thin."""
    ours = {t: ratio(t) for t in thicknesses}
    rows = [
        Check(
            f"{name}, t/L = {t:g}, N = {N}",
            1.0,
            value,
            1.0 / N**2 + curved * t**2,
            "discretisation, 1/N²" + (", and (t/R)²" if curved else ""),
        )
        for t, value in ours.items()
    ]
    rows.append(
        Check(
            f"{name}, t/L from 1e-3 to 1e-4",
            1.0,
            ours[1e-4] / ours[1e-3],
            1e-4,
            "no locking: flat when thin",
        )
    )
    CURVES[name] = curve(ours, ours.values(), [thicknesses[0], thicknesses[-1]], [1.0, 1.0])
    return rows


def limit_rows() -> list[Check]:
    """Return the membrane's limits, beside."""
    rows = []
    for thickness, force in HEMISPHERE.items():
        for mesh_name in ("regular", "skewed"):
            for n in (8, 16, 32):
                place = skewed(sphere, n, n) if mesh_name == "skewed" else sphere
                ours = shells.pinch(mapped_patch(n, n, place), thickness, force)
                name = f"hemisphere, R/t = {10 / thickness:g}, {mesh_name}, N = {n}"
                rows.append(Check(name, 1.0, ours / 0.093, 0.05, "limit of MITC4", gate=False))
    for load, reference in THIN_TWISTED.items():
        for mesh_name in ("regular", "skewed"):
            for n in (4, 8, 16):
                strip = shells.strip
                place = skewed(strip, 6 * n, n) if mesh_name == "skewed" else strip
                ours = 1e-6 * shells.of_strip(load, n, thickness=0.0032, place=place)
                name = f"twisted, {load}, L/t = 3750, {mesh_name}, N = {n}"
                rows.append(Check(name, 1.0, ours / reference, 0.05, "limit of MITC4", gate=False))
    return rows


def checks() -> list[Check]:
    rows = []
    for name, place in (("regular", flat), ("skewed", skewed(flat, N, N))):

        def supported(t: float, place: Place = place) -> float:
            return deflection("simply supported", t, N, place) / supported_plate(t)

        def clamped(t: float, place: Place = place) -> float:
            return deflection("clamped", t, N, place) / EXACT_THIN["clamped"]

        rows += flat_rows(f"supported plate, {name}", supported)
        # the thick clamped plate has no closed form
        rows += flat_rows(f"clamped plate, {name}", clamped, thicknesses=THICKNESSES[1:])
    rows += flat_rows("arch", lambda t: arch_deflection(N, t) / curved_bar(t), curved=True)
    return rows + limit_rows()
