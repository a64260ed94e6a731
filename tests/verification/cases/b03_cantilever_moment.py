"""B03 Cantilever under an end moment: rolled up to a full circle.

L = 12, b = 1, h = 0.1, E = 1.2e6, nu = 0; the end moment 2 pi EI / L = 50 pi / 3 bends the strip to
a circle, U = L (sin k / k) - L, W = (L / k)(1 - cos k) with k = M L / EI.

Source: Sze, Liu, Lo, Finite Elem. Anal. Des. 40 (2004) 1551-1569, Table 2, which prints the closed
form; Abaqus S4R with 16 x 1. With 16 x 1 quads each of ours spans 22.5 degrees at the end. Between
its nodes the interpolated director is then shorter by up to 1 - cos(11.25°) = 1.9 %, so the strip
bends too easily and rolls up too far, by 1.6 % of its curvature. That error falls with the square
of the quad's size, as the rows of the finer meshes show; from 32 x 1 on all points lie within 1 %.
"""

import numpy as np

from cases.cantilever import cantilever
from cases.paths import ONE_PERCENT, curve, rows_of, table_checks
from harness import Check
from shellcut.loads.loads import NodalMoment

ID, TITLE, FAST = "B03", "Cantilever, end moment, roll-up", True
CURVES: dict[str, dict[str, list[float]]] = {}
AXES = "displacement of the tip", "moment over the largest moment"

# M / Mmax, -U, W
TABLE = rows_of(
    """
    0.05 0.196 1.87; 0.1 0.774 3.648; 0.15 1.699 5.248; 0.2 2.918 6.598; 0.25 4.361 7.639;
    0.3 5.945 8.333; 0.35 7.585 8.664; 0.4 9.194 8.637; 0.45 10.688 8.281; 0.5 12.0 7.639;
    0.55 13.073 6.775; 0.6 13.871 5.758; 0.65 14.377 4.665; 0.7 14.595 3.571; 0.75 14.546 2.546;
    0.8 14.27 1.65; 0.85 13.818 0.926; 0.9 13.247 0.405; 0.95 12.621 0.098; 1.0 12.0 0.0
    """
)
LENGTH, MOMENT = 12.0, 50.0 * np.pi / 3.0
MESHES = (16, 32, 64, 128)
COARSE = "16 x 1 is too coarse: see the finer meshes"


def exact(factors: np.ndarray) -> np.ndarray:
    k = 2.0 * np.pi * factors
    return LENGTH * np.stack([1.0 - np.sin(k) / k, (1.0 - np.cos(k)) / k], axis=1)


def deflections(n: int, factors: np.ndarray) -> np.ndarray:
    strip = cantilever(LENGTH, n, [NodalMoment("right", (0.0, -0.5 * MOMENT, 0.0))])
    tip = strip.mesh.node_set("right")[0]
    path = strip.load_steps(factors)
    return np.array([[-e.displacement[tip, 0], e.displacement[tip, 2]] for e in path])


def checks() -> list[Check]:
    factors = TABLE[:, 0]
    closed = np.column_stack([factors, exact(factors)])
    ours = {n: deflections(n, factors) for n in MESHES}
    rows = []
    for n in MESHES:
        reason, gate = (COARSE, False) if n == 16 else (ONE_PERCENT, True)
        names = (f"-U, {n} x 1, table", f"W, {n} x 1, table")
        rows += table_checks(names, ours[n], TABLE, gate=gate, reason=reason)
        names = (f"-U, {n} x 1, closed form", f"W, {n} x 1, closed form")
        rows += table_checks(names, ours[n], closed, gate=gate, reason=reason)
    for k, name in ((0, "-U tip"), (1, "W tip")):
        CURVES[f"{name}, 32 x 1"] = curve(ours[32][:, k], factors, closed[:, k + 1], factors)
        CURVES[f"{name}, 16 x 1"] = curve(ours[16][:, k], factors, closed[:, k + 1], factors)
        worst = [np.abs(ours[n] - ours[2 * n])[:, k].max() for n in MESHES[:-1]]
        order = np.log2(worst[1] / worst[2])
        rows.append(
            Check(f"order of {name}, worst point", 2.0, order, 0.1, "linear element", absolute=True)
        )
    return rows
