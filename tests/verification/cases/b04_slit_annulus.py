"""B04 Annular plate slit along a radius, one lip lifted.

Radii 6 and 10, h = 0.03, E = 21e6, nu = 0; vertical dead line force of 0.8 a unit length on one lip
of the slit, the other lip clamped. Read: lift of the inner corner A and the outer corner B of the
loaded lip.

Source: Sze, Liu, Lo, Finite Elem. Anal. Des. 40 (2004) 1551-1569, Table 3 (Abaqus S4R, 10 x 80).
"""

import numpy as np

from cases.paths import ONE_PERCENT, path_checks, rows_of
from harness import Check
from patches import mapped_patch
from shellcut import EdgeTraction, Mesh, ShellMaterial, Statics, Support

ID, TITLE, FAST = "B04", "Slit annular plate, lifted lip", False
CURVES: dict[str, dict[str, list[float]]] = {}
AXES = "lift of the lip", "load over the largest load"

# P / Pmax, W at A, W at B
TABLE = rows_of(
    """
    0.025 1.305 1.789; 0.05 2.455 3.37; 0.075 3.435 4.72; 0.1 4.277 5.876; 0.125 5.007 6.872;
    0.15 5.649 7.736; 0.2 6.725 9.16; 0.25 7.602 10.288; 0.3 8.34 11.213; 0.35 8.974 11.992;
    0.4 9.529 12.661; 0.45 10.023 13.247; 0.5 10.468 13.768; 0.55 10.876 14.24; 0.6 11.257 14.674;
    0.65 11.62 15.081; 0.7 11.97 15.469; 0.75 12.31 15.842; 0.8 12.642 16.202; 0.85 12.966 16.55;
    0.9 13.282 16.886; 0.95 13.59 17.212; 1.0 13.891 17.528
    """
)
COARSE = "MITC4 on 10 x 80 is stiffer than S4R in the fully lifted state: see the finer mesh"


def slit_annulus(n_radial: int, n_around: int) -> Mesh:
    def place(u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        radius, angle = 6.0 + 4.0 * u, 2.0 * np.pi * v
        nodes = np.stack([radius * np.cos(angle), radius * np.sin(angle), 0.0 * u], axis=-1)
        return nodes, np.broadcast_to([0.0, 0.0, 1.0], nodes.shape)

    return mapped_patch(n_radial, n_around, place)


def deflections(n_radial: int) -> np.ndarray:
    """Return the lifts of A and B at the load factors of the table."""
    mesh = slit_annulus(n_radial, 8 * n_radial)
    material = ShellMaterial.homogeneous(young=21e6, poisson=0.0, density=1e-9, thickness=0.03)
    plate = Statics(
        mesh,
        material,
        supports=[Support.clamped("v0")],
        loads=[EdgeTraction("v1", (0.0, 0.0, 0.8))],
    )
    lip = mesh.node_set("v1")
    path = plate.load_steps(TABLE[:, 0])
    return np.array([e.displacement[lip[[0, -1]], 2] for e in path])


def checks() -> list[Check]:
    meshes = {10: (False, COARSE), 20: (True, ONE_PERCENT)}
    names = ("W at A", "W at B")
    rows = []
    for n, why in meshes.items():
        label = f"{{0}} x {8 * n}"
        rows += path_checks(CURVES, names, TABLE, deflections, {n: why}, label)
    return rows
