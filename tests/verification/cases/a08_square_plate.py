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
from harness import Check
from shellcut import Pressure, ShellMaterial, Support
from shellcut.statics.statics import Statics

ID, TITLE, FAST = "A08", "Square plate, uniform pressure", True

MITC4 = {
    ("clamped", 0.01): {
        4: 0.0012531533537911493,
        8: 0.0012641438405524355,
        16: 0.0012669187957834304,
        32: 0.0012676208337353005,
    },
    ("simply supported", 0.01): {
        4: 0.004043552614601451,
        8: 0.004059324155319192,
        16: 0.0040631800551416625,
        32: 0.004064138545316238,
    },
    ("clamped", 0.001): {
        4: 0.0012507134936287356,
        8: 0.0012616707545497772,
        16: 0.0012644239777179162,
        32: 0.00126511423544214,
    },
    ("simply supported", 0.001): {
        4: 0.0040414433312523325,
        8: 0.004057233880236195,
        16: 0.0040610946069681575,
        32: 0.004062054286439356,
    },
}
EXACT_THIN = {"clamped": 0.00126532, "simply supported": 0.004062353}
YOUNG, POISSON = 1e6, 0.3
SYMMETRY = [Support.symmetry("u0", "x"), Support.symmetry("v0", "y")]
EDGES = {
    "clamped": [Support.clamped("u1"), Support.clamped("v1")],
    "simply supported": [Support("u1", rotation="x"), Support("v1", rotation="y")],
}

CURVES = {}


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
    for (edge, h), table in MITC4.items():
        ours = {n: deflection(edge, h, n) for n in table}
        for n, value in table.items():
            name = f"alpha, {edge}, h/L = {h}, N = {n}"
            rows.append(Check(name, value, ours[n], 2e-3, "same element"))
        CURVES[f"alpha over N, {edge}, h/L = {h}"] = {
            "x": list(ours),
            "y": list(ours.values()),
            "x_ref": list(table),
            "y_ref": list(table.values()),
        }
        if h == 0.001:
            n = max(table)
            band = 1.0 / n**2 + 5.0 * h**2
            name = f"alpha, {edge}, thin plate exact, N = {n}"
            rows.append(Check(name, EXACT_THIN[edge], ours[n], band, "discretisation, 1/N²"))
    return rows
