"""B01 Cantilever under end shear, large displacement.

L = 10, b = 1, h = 0.1, E = 1.2e6, nu = 0; dead shear of 4 in all along the end edge, the other end
clamped; 16 x 1 quads. Read: tip deflections over load.

Source: Sze, Liu, Lo, Finite Elem. Anal. Des. 40 (2004) 1551-1569, Table 1 (Abaqus S4R, 16 x 1).
The table is itself up to 0.1 % off the exact elastica, which is B02.
"""

import numpy as np

from cases.cantilever import cantilever
from cases.paths import curve, rows_of, table_checks
from harness import Check
from shellcut import EdgeTraction

ID, TITLE, FAST = "B01", "Cantilever, end shear", True
CURVES: dict[str, dict[str, list[float]]] = {}
AXES = "displacement of the tip", "load over the largest load"

# P / Pmax, -U, W
TABLE = rows_of(
    """
    0.05 0.026 0.663; 0.1 0.103 1.309; 0.15 0.224 1.922; 0.2 0.381 2.493; 0.25 0.563 3.015;
    0.3 0.763 3.488; 0.35 0.971 3.912; 0.4 1.184 4.292; 0.45 1.396 4.631; 0.5 1.604 4.933;
    0.55 1.807 5.202; 0.6 2.002 5.444; 0.65 2.19 5.66; 0.7 2.37 5.855; 0.75 2.541 6.031;
    0.8 2.705 6.19; 0.85 2.861 6.335; 0.9 3.01 6.467; 0.95 3.151 6.588; 1.0 3.286 6.698
    """
)


def deflections(n: int, factors: np.ndarray) -> np.ndarray:
    """Return -U and W of the tip at load factors, shape (n_factor, 2)."""
    strip = cantilever(10.0, n, [EdgeTraction("right", (0.0, 0.0, 4.0))])
    tip = strip.mesh.node_set("right")[0]
    path = strip.load_steps(factors)
    return np.array([[-e.displacement[tip, 0], e.displacement[tip, 2]] for e in path])


def checks() -> list[Check]:
    ours = deflections(16, TABLE[:, 0])
    for k, name in ((0, "-U tip"), (1, "W tip")):
        CURVES[f"{name}, 16 x 1"] = curve(ours[:, k], TABLE[:, 0], TABLE[:, k + 1], TABLE[:, 0])
    return table_checks(("-U, 16 x 1", "W, 16 x 1"), ours, TABLE)
