"""A14 circular plate under uniform pressure, clamped and simply supported.

R = 1, h / R = 0.001, nu = 0.3; the library's disc, whose rim is a polygon. Read: w D / (q R⁴) in
the middle. The simple support holds the deflection of the rim only, so the directors are free to
tilt along it, as on a round rim (a hard support of a polygon's sides would tend to another limit,
Babuska's paradox). A thick plate, h / R = 0.1, adds the shear deflection q R² / (4 k G h).

Source: Timoshenko, 1/64 and (5 + nu) / (64 (1 + nu)); code_aster SSLS100, the same formula.

Bands: to the order of the discretisation: (s / R)², s the mean edge of the quads.
"""

import numpy as np

from cases.paths import curve
from harness import Check
from shellcut import Pressure, ShellMaterial, Statics, Support
from shellcut.mesh.structured import disc

ID, TITLE, FAST = "A14", "Circular plate, uniform pressure", True

YOUNG, POISSON = 1e6, 0.3
EXACT_THIN = {"clamped": 1.0 / 64.0, "simply supported": (5 + POISSON) / (64 * (1 + POISSON))}
MESHES = (8, 16, 32)

CURVES = {}
AXES = "mean side of the quads over the radius, s / R", "w D / (q R⁴) in the middle"


def stiffness(thickness: float) -> float:
    """Return the plate's D."""
    return YOUNG * thickness**3 / (12.0 * (1.0 - POISSON**2))


def exact(edge: str, thickness: float) -> float:
    """Return w D / (q R⁴) with the shear deflection, R = 1."""
    shear = 5.0 / 6.0 * 0.5 * YOUNG / (1 + POISSON) * thickness
    return EXACT_THIN[edge] + stiffness(thickness) / (4.0 * shear)


def deflection(edge: str, thickness: float, n_side: int) -> tuple[float, float]:
    """Return w D / (q R⁴) in the middle, and the mean edge of the quads."""
    mesh = disc(1.0, n_side=n_side)
    middle, rim = int(mesh.node_set("centre")[0]), mesh.node_set("rim")
    supports = {
        "clamped": [Support.clamped(rim)],
        "simply supported": [
            Support(rim, translation="z", rotation=""),
            Support([middle], translation="xy", rotation=""),
            Support([rim[0]], translation="y", rotation=""),
        ],
    }
    material = ShellMaterial.homogeneous(young=YOUNG, poisson=POISSON, thickness=thickness)
    load = Pressure(stiffness(thickness))
    u, _ = Statics(mesh, material, supports=supports[edge], loads=[load]).linear()
    return float(u[middle, 2]), float(np.sqrt(mesh.quad_areas().mean()))


def checks() -> list[Check]:
    rows = []
    for thickness in (0.001, 0.1):
        for edge in EXACT_THIN:
            reference = EXACT_THIN[edge] if thickness < 0.01 else exact(edge, thickness)
            found = [deflection(edge, thickness, n) for n in MESHES]
            for n, (w, size) in zip(MESHES, found, strict=True):
                name = f"w D / q R⁴, {edge}, h/R = {thickness}, n_side = {n}"
                rows.append(Check(name, reference, w, size**2, "discretisation, (s/R)²"))
            CURVES[f"{edge}, h/R = {thickness}"] = curve(
                [size for _, size in found],
                [w for w, _ in found],
                [0.0, found[0][1]],
                [reference, reference],
            )
    return rows
