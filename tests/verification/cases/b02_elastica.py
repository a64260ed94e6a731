"""B02 Cantilever under end shear: the exact elastica.

As B01. The elastica neither stretches nor shears: EI = 100, EI theta'' = -P cos(theta), clamped at
the root, no moment at the tip. The strip's own stretch and shear are of order (h / L)² = 1e-4.

Source: boundary-value problem solved to 1e-10. The mesh series shows the order of convergence, the
distance between the solutions on three meshes, which needs no exact one.
"""

import numpy as np

from cases.b01_cantilever_shear import deflections
from cases.paths import curve, rows_of, table_checks
from harness import Check

ID, TITLE, FAST = "B02", "Cantilever, end shear: exact elastica", True
CURVES: dict[str, dict[str, list[float]]] = {}
AXES = "displacement of the tip", "load over the largest load"

# P / Pmax, -U, W
TABLE = rows_of(
    """
    0.05 0.026465 0.663645; 0.1 0.103539 1.309752; 0.15 0.224877 1.923503; 0.2 0.381656 2.494515;
    0.25 0.564332 3.017208; 0.3 0.764003 3.490101; 0.35 0.973168 3.914657; 0.4 1.185961 4.294128;
    0.45 1.398055 4.632639; 0.5 1.606417 4.934575; 0.55 1.809032 5.204202; 0.6 2.004643 5.44547;
    0.65 2.192544 5.661928; 0.7 2.372414 5.856706; 0.75 2.544202 6.032534; 0.8 2.708031 6.191775;
    0.85 2.86414 6.336467; 0.9 3.012838 6.468368; 0.95 3.154474 6.588991; 1.0 3.289412 6.699642
    """
)
MESHES = (16, 32, 64, 128)


def checks() -> list[Check]:
    ours = {n: deflections(n, TABLE[:, 0]) for n in MESHES}
    rows = []
    for n in MESHES:
        rows += table_checks((f"-U, {n} x 1", f"W, {n} x 1"), ours[n], TABLE)
    for k, name in ((0, "-U tip"), (1, "W tip")):
        CURVES[f"{name}, 128 x 1"] = curve(
            ours[128][:, k], TABLE[:, 0], TABLE[:, k + 1], TABLE[:, 0]
        )
        change = [ours[n][-1, k] - ours[2 * n][-1, k] for n in MESHES[:-1]]
        order = np.log2(change[1] / change[2])
        rows.append(
            Check(f"order of {name} at full load", 2.0, order, 0.1, "linear element", absolute=True)
        )
        limit = ours[128][-1, k] - change[2] / 3.0
        rows.append(
            Check(
                f"{name} at full load, extrapolated",
                TABLE[-1, k + 1],
                limit,
                5e-4,
                "stretch and shear, some (h/L)²",
            )
        )
    return rows
