"""B09 Hinged cylindrical roof, h = 12.7: snap-through.

R = 2540, length 508, half angle 0.1, E = 3102.75, nu = 0.3; straight edges hinged, curved edges
free, a downward force of up to 3000 at the centre: 750 on the quarter. The load rises to a limit
point at 0.742 of it, falls to 0.173 and rises again; the path is followed by arc length. Read:
distance of the table's points to our curve of load factor over deflection, both axes scaled by the
table's largest value; the limit loads.

Source: Sze, Liu, Lo, Finite Elem. Anal. Des. 40 (2004) 1551-1569, Table 8 (Abaqus S4R). The table
gives its arc-length points, not the limit points themselves.
"""

import numpy as np

from cases.paths import curve, distance_to_curve, rows_of, spline
from harness import Check
from patches import hinged_roof

ID, TITLE, FAST = "B09", "Hinged cylindrical roof, snap-through", True
ONE_PERCENT = "1 % of the largest deflection"
CURVES: dict[str, dict[str, list[float]]] = {}
AXES = "deflection of the centre, mm", "load over the largest load"

# P / Pmax, -W at the centre
TABLE = rows_of(
    """
    0.0877 0.693; 0.198 1.638; 0.3473 3.087; 0.4686 4.477; 0.5647 5.802; 0.6381 7.057;
    0.6908 8.237; 0.7246 9.339; 0.7412 10.358; 0.7421 11.293; 0.7286 12.141; 0.7023 12.903;
    0.6649 13.583; 0.6182 14.188; 0.5643 14.728; 0.5055 15.217; 0.4442 15.676; 0.383 16.125;
    0.3245 16.59; 0.2717 17.094; 0.2272 17.657; 0.194 18.299; 0.175 19.028; 0.1729 19.852;
    0.1905 20.771; 0.2303 21.78; 0.295 22.875; 0.3871 24.049; 0.4443 24.663; 0.5093 25.293;
    0.5826 25.94; 0.6644 26.601; 0.7551 27.276; 0.8549 27.964; 0.9643 28.663; 1.0835 29.374
    """
)


def snap_path(n: int, *, exact: bool = True) -> np.ndarray:
    """Return load factor and deflection of the centre along the path, from no load."""
    roof, centre = hinged_roof(n, 12.7, exact=exact)
    path = roof.arc_length(0.1, until=lambda e: e.factor > 1.1, n_wanted=4)
    points = [[e.factor, -e.displacement[centre, 2]] for e in path]
    return np.array([[0.0, 0.0], *points])


def checks() -> list[Check]:
    rows = []
    for n in (16, 32):
        path = snap_path(n)
        fine = spline(path)
        rising = fine[:, 1] < 15.0
        CURVES[f"-W at the centre, {n} x {n}"] = curve(
            fine[::40, 1], fine[::40, 0], TABLE[:, 1], TABLE[:, 0]
        )
        off, upper = distance_to_curve(path, TABLE), TABLE[:, 0][TABLE[:, 1] < 15.0].max()
        highest, lowest = fine[rising, 0].max(), fine[~rising, 0].min()
        what, why = f"distance to the curve, {n} x {n}, worst of {len(TABLE)}", ONE_PERCENT
        rows.append(Check(what, 0.0, off, 0.01, why, absolute=True))
        what, why = f"upper limit load / Pmax, {n} x {n}", "largest of the table's points, 1 %"
        rows.append(Check(what, upper, highest, 0.01, why))
        what, why = (
            f"lower limit load / Pmax, {n} x {n}",
            "least of the table's points, 1 % of Pmax",
        )
        rows.append(Check(what, TABLE[8:, 0].min(), lowest, 0.01, why, absolute=True))
    off = distance_to_curve(snap_path(16, exact=False), TABLE)
    what = "distance to the curve, 16 x 16, directors left to the mesh"
    rows.append(Check(what, 0.0, off, 0.01, ONE_PERCENT, absolute=True))
    return rows
