"""B05 Hemisphere with an 18 degree hole under alternating radial forces, large displacement.

R = 10, h = 0.04, E = 6.825e7, nu = 0.3; four radial dead forces of up to 400 at the equator,
outward and inward in turn: 200 at each loaded node of the quarter with two symmetry planes; one
axial displacement fixed. Read: outward deflection of A, inward deflection of B.

Source: Sze, Liu, Lo, Finite Elem. Anal. Des. 40 (2004) 1551-1569, Table 4 (Abaqus S4R, 16 x 16).
S4R integrates its membrane strains once a quad and does not lock. Plain MITC4 takes them as they
are; the deformed quads are warped, and on 16 x 16 their membrane locks by 5 % at full load
(linearly the same mesh is right to 0.1 %). It fades with the mesh.
"""

import numpy as np

from cases.paths import ONE_PERCENT, path_checks, rows_of, table_checks
from harness import Check
from patches import mapped_patch
from shellcut import Mesh, NodalForce, ShellMaterial, Statics, Support

ID, TITLE, FAST = "B05", "Pinched hemisphere with hole, large displacement", False
CURVES: dict[str, dict[str, list[float]]] = {}
AXES = "deflection", "load over the largest load"

# P / Pmax, outward at A, inward at B
TABLE = rows_of(
    """
    0.05 0.855 0.955; 0.1 1.499 1.84; 0.15 1.969 2.604; 0.2 2.321 3.261; 0.25 2.596 3.833;
    0.3 2.819 4.339; 0.35 3.002 4.79; 0.4 3.158 5.196; 0.45 3.291 5.565; 0.5 3.406 5.902;
    0.55 3.508 6.212; 0.6 3.598 6.497; 0.65 3.678 6.761; 0.7 3.75 7.006; 0.75 3.816 7.234;
    0.8 3.875 7.448; 0.85 3.929 7.647; 0.9 3.979 7.835; 0.95 4.025 8.011; 1.0 4.067 8.178
    """
)
COARSE = "membrane locking of plain MITC4 on warped quads: see the finer meshes"


def hemisphere(n: int, *, exact: bool = True) -> Mesh:
    def place(u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        polar, angle = np.radians(18.0 + 72.0 * u), 0.5 * np.pi * v
        ring = np.sin(polar)
        director = np.stack([ring * np.cos(angle), ring * np.sin(angle), np.cos(polar)], axis=-1)
        return 10.0 * director, director

    return mapped_patch(n, n, place, exact=exact)


def deflections(n: int, *, exact: bool = True) -> np.ndarray:
    mesh = hemisphere(n, exact=exact)
    material = ShellMaterial.homogeneous(young=6.825e7, poisson=0.3, density=1e-9, thickness=0.04)
    a, b = (int(node) for node in mesh.node_set("u1")[[0, -1]])
    quarter = Statics(
        mesh,
        material,
        supports=[
            Support.symmetry("v0", "y"),
            Support.symmetry("v1", "x"),
            Support([a], translation="z", rotation=""),
        ],
        loads=[NodalForce([a], (200.0, 0.0, 0.0)), NodalForce([b], (0.0, -200.0, 0.0))],
    )
    path = quarter.load_steps(TABLE[:, 0])
    return np.array([[e.displacement[a, 0], -e.displacement[b, 1]] for e in path])


def checks() -> list[Check]:
    meshes = {16: (False, COARSE), 32: (True, ONE_PERCENT), 64: (True, ONE_PERCENT)}
    rows = path_checks(CURVES, ("outward at A", "inward at B"), TABLE, deflections, meshes)
    mesh = "32 x 32, directors left to the mesh"
    names = (f"outward at A, {mesh}", f"inward at B, {mesh}")
    return rows + table_checks(names, deflections(32, exact=False), TABLE)
