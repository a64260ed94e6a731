"""A08 square plate under uniform pressure, clamped and simply supported, per mesh.

Side 1, h = 0.01 or 0.001, nu = 0.3; a quarter of N x N quads. Hard simple support: no tilt along
the edge. Read: alpha = w D / (q L⁴) in the middle.

Source: MITC4 values by OpenSees' ShellMITC4 and ASDShellQ4, which agree to nine digits on flat
meshes; thin plate exact by Navier's series and a Ritz solution (Timoshenko 0.00126, 0.00406). The
shear factor is 5/6, the library's default, as in the source.

Bands: the same element, 0.2 %; the exact values to the order of the discretisation, 1 / N² of the
quarter's quads, and the shear deflection of the thin plate, 5 (h / L)².
"""

import numpy as np

from cases.patches import Place, mapped_patch
from cases.paths import curve
from harness import Check
from shellcut import Pressure, ShellMaterial, Statics, Support

ID, TITLE, FAST = "A08", "Square plate, uniform pressure", True

MESHES = (4, 8, 16, 32)
MITC4 = {
    ("clamped", 0.01): (0.00125315335, 0.00126414384, 0.0012669188, 0.00126762083),
    ("simply supported", 0.01): (0.00404355261, 0.00405932416, 0.00406318006, 0.00406413855),
    ("clamped", 0.001): (0.00125071349, 0.00126167075, 0.00126442398, 0.00126511424),
    ("simply supported", 0.001): (0.00404144333, 0.00405723388, 0.00406109461, 0.00406205429),
}
EXACT_THIN = {"clamped": 0.00126532, "simply supported": 0.004062353}
YOUNG, POISSON = 1e6, 0.3
SYMMETRY = [Support.symmetry("u0", "x"), Support.symmetry("v0", "y")]
EDGES = {
    "clamped": [Support.clamped("u1"), Support.clamped("v1")],
    "simply supported": [Support("u1", rotation="x"), Support("v1", rotation="y")],
}

CURVES = {}
AXES = "quads a side of a quarter, N", "w D / (q L⁴) in the middle"


def flat(u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Map the unit square to a quarter of the plate, its middle at the origin."""
    zero = np.zeros_like(u)
    nodes = np.stack([0.5 * u, 0.5 * v, zero], axis=-1)
    return nodes, np.stack([zero, zero, zero + 1.0], axis=-1)


def stiffness(thickness: float) -> float:
    """Return the plate's D."""
    return YOUNG * thickness**3 / (12.0 * (1.0 - POISSON**2))


def deflection(edge: str, thickness: float, n: int, place: Place = flat) -> float:
    """Return alpha of a quarter plate of n x n quads."""
    mesh = mapped_patch(n, n, place)
    material = ShellMaterial.homogeneous(young=YOUNG, poisson=POISSON, thickness=thickness)
    q = stiffness(thickness)
    model = Statics(mesh, material, supports=SYMMETRY + EDGES[edge], loads=[Pressure(q)])
    u, _ = model.linear()
    return float(u[0, 2])


def checks() -> list[Check]:
    rows = []
    for (edge, h), values in MITC4.items():
        table = dict(zip(MESHES, values, strict=True))
        ours = {n: deflection(edge, h, n) for n in table}
        for n, value in table.items():
            name = f"alpha, {edge}, h/L = {h}, N = {n}"
            rows.append(Check(name, value, ours[n], 2e-3, "same element"))
        CURVES[f"{edge}, h/L = {h}"] = curve(ours, ours.values(), table, table.values())
        if h == 0.001:
            n = max(table)
            band = 1.0 / n**2 + 5.0 * h**2
            name = f"alpha, {edge}, thin plate exact, N = {n}"
            rows.append(Check(name, EXACT_THIN[edge], ours[n], band, "discretisation, 1/N²"))
    return rows
