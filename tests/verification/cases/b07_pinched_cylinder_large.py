"""B07 Pinched cylinder with rigid end diaphragms, large displacement.

R = 100, L = 200, h = 1, E = 30000, nu = 0.3; two opposite inward dead forces of up to 12000 at mid
length: 3000 on the eighth; end diaphragms hold the displacements in their plane. Read: inward
deflection of A under the force, and U of B, the side at mid length. The path is followed by arc
length, since near 0.16 of the load it is almost flat; deflections at the table's load factors come
from a cubic through its points.

Source: Sze, Liu, Lo, Finite Elem. Anal. Des. 40 (2004) 1551-1569, Table 6 (Abaqus S4R, 48 x 48).

Around 0.15 of the load the deflection doubles within 15 % of load, so at given load a point says
little: what decides is the distance of the table's points to our curve, axes scaled by the
table's largest values. It falls with the mesh (32, 48, 64, 96: 4.4, 2.6, 2.0, 1.6 % for A and 6.8,
2.7, 1.4, 0.8 % for B), for B below 1 %, while A tends to some 1.2 %. Two reasons lie in the table.
It is one mesh of another element, itself not converged: below 0.13 of the load it lies between our
48 x 48 and 64 x 64, which still move by 1 %. And around the force membrane strains reach 5 % and
bending strains 14 % at full load, where a law between logarithmic strains and true stresses with a
thickness that changes, as S4R has, is not the St. Venant-Kirchhoff law of ours; from 0.4 of the
load on A differs by the same 1.2 of length, a dimple, while B agrees.
"""

import numpy as np

from cases.paths import at_factors, curve, distance_to_curve, rows_of, table_checks
from harness import Check
from patches import cylinder_patch
from shellcut import NodalForce, ShellMaterial, Statics, Support

ID, TITLE, FAST = "B07", "Pinched cylinder, large displacement", False
CURVES: dict[str, dict[str, list[float]]] = {}
AXES = "deflection", "load over the largest load"

# P / Pmax, -W at A, U at B
TABLE = rows_of(
    """
    0.05 9.561 -0.233; 0.075 15.648 -0.922; 0.1 23.164 -2.391; 0.125 29.375 -3.872;
    0.15 36.208 -2.154; 0.175 51.499 6.792; 0.2 56.373 10.448; 0.25 61.877 14.905;
    0.3 65.498 17.979; 0.35 68.229 20.365; 0.4 70.424 22.321; 0.45 72.204 23.916; 0.5 73.79 25.381;
    0.55 75.139 26.631; 0.6 76.331 27.735; 0.65 77.472 28.843; 0.7 78.451 29.772;
    0.75 79.339 30.604; 0.8 80.218 31.471; 0.85 81.045 32.299; 0.9 81.766 32.989;
    0.95 82.435 33.619; 1.0 83.102 34.272
    """
)


COARSE = "MITC4 on 48 x 48 resolves the wrinkles worse than S4R: see the finer mesh"
DISTANCE = "1 % of the largest deflection"
DIMPLE = "2 %: bending strains of 14 % at A, where the laws part; the table is one coarse mesh"
STEEP = "at given load; around 0.15 of the load 1 % of load is 8 % of deflection"


def pinched_path(n: int, *, exact: bool = True) -> np.ndarray:
    """Return load factor, -W at A and U at B along the path, from no load."""
    mesh = cylinder_patch(100.0, 100.0, 90.0, n, n, exact=exact)
    material = ShellMaterial.homogeneous(young=3e4, poisson=0.3, density=1e-9, thickness=1.0)
    a, b = int(mesh.node_set("u0")[0]), int(mesh.node_set("u1")[0])
    eighth = Statics(
        mesh,
        material,
        supports=[
            Support.symmetry("u0", "x"),
            Support.symmetry("u1", "z"),
            Support.symmetry("v0", "y"),
            Support("v1", translation="xz", rotation="y"),
        ],
        loads=[NodalForce([a], (0.0, 0.0, -3000.0))],
    )
    path = eighth.arc_length(0.05, until=lambda e: e.factor > 1.0)
    points = [[e.factor, -e.displacement[a, 2], e.displacement[b, 0]] for e in path]
    return np.array([[0.0, 0.0, 0.0], *points])


def checks() -> list[Check]:
    rows = []
    for n in (48, 96):
        path = pinched_path(n)
        ours = at_factors(path, TABLE[:, 0])
        for k, name, band, reason in ((1, "-W at A", 0.02, DIMPLE), (2, "U at B", 0.01, DISTANCE)):
            CURVES[f"{name}, {n} x {n}"] = curve(path[:, k], path[:, 0], TABLE[:, k], TABLE[:, 0])
            rows.append(
                Check(
                    f"{name}: distance to the curve, {n} x {n}",
                    0.0,
                    distance_to_curve(path[:, [0, k]], TABLE[:, [0, k]]),
                    band,
                    reason if n == 96 else COARSE,
                    gate=n == 96,
                    absolute=True,
                )
            )
        names = (f"-W at A, {n} x {n}", f"U at B, {n} x {n}")
        rows += table_checks(names, ours, TABLE, gate=False, reason=STEEP)
        if n == 48:
            path_of_means = pinched_path(n, exact=False)
            rows += [
                Check(
                    f"{name}: distance to the curve of directors left to the mesh, {n} x {n}",
                    0.0,
                    distance_to_curve(path[:, [0, k]], path_of_means[:, [0, k]]),
                    1e-3,
                    "mean normals; points between those of the path",
                    absolute=True,
                )
                for k, name in ((1, "-W at A"), (2, "U at B"))
            ]
    return rows
