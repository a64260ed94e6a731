"""A05 pinched hemisphere with an 18° hole, linear.

R = 10, t = 0.04, E = 6.825e7, nu = 0.3, hole of 18° at the pole, equator free; four radial forces
of 2, alternately in and out, at the quarters of the equator. A quarter with two symmetry planes, 1
at each loaded node; the loaded node on x holds the axial displacement. Read: the radial
displacement under a load, the mean of both, over 0.093.

Source: 0.094 (MacNeal, Harder 1985), 0.0930 (Simo, Fox, Rifai 1989), converged 0.0934 to 0.0935.
Per mesh: an independent MITC4, with shear factor 1 as in the source; confidence medium.
"""

import numpy as np

from cases.patches import mapped_patch, same_element
from cases.paths import curve
from harness import Check
from shellcut import Mesh, NodalForce, ShellMaterial, Statics, Support

ID, TITLE, FAST = "A05", "Pinched hemisphere with hole", True

CROSS_CHECK = {4: 1.04408, 8: 1.00674, 16: 1.00092}
CONVERGED = (0.0934, 0.0935)
RADIUS, HOLE_DEG = 10.0, 18.0

CURVES = {}
AXES = "quads a side of a quarter", "u / 0.093"


def sphere(u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Map u to the azimuth from x to y, v to the height from the equator to the hole."""
    azimuth, height = 0.5 * np.pi * u, np.radians(90.0 - HOLE_DEG) * v
    out = [np.cos(height) * np.cos(azimuth), np.cos(height) * np.sin(azimuth), np.sin(height)]
    director = np.stack(out, axis=-1)
    return RADIUS * director, director


def pinch(mesh: Mesh, thickness: float, force: float) -> float:
    """Return the mean radial displacement under the two loads."""
    on_x, on_y = (
        int(np.intersect1d(mesh.node_set(side), mesh.node_set("v0"))[0]) for side in ("u0", "u1")
    )
    material = ShellMaterial.homogeneous(
        young=6.825e7, poisson=0.3, thickness=thickness, shear_factor=1.0
    )
    model = Statics(
        mesh,
        material,
        supports=[
            Support.symmetry("u0", "y"),
            Support.symmetry("u1", "x"),
            Support([on_x], translation="z", rotation=""),
        ],
        loads=[NodalForce([on_x], (force, 0, 0)), NodalForce([on_y], (0, -force, 0))],
    )
    u, _ = model.linear()
    return 0.5 * float(u[on_x, 0] - u[on_y, 1])


def patch(n: int, *, exact: bool = True) -> Mesh:
    return mapped_patch(n, n, sphere, exact=exact)


def deflection(mesh: Mesh) -> float:
    return pinch(mesh, 0.04, 1.0) / 0.093


def checks() -> list[Check]:
    rows = same_element("u / 0.093", deflection, patch, CROSS_CHECK)
    fine, middle = deflection(patch(64)), 0.5 * sum(CONVERGED)
    rows.append(
        Check("u, N = 64, converged", middle, 0.093 * fine, 2e-3, "spread of the references")
    )
    ours = [row.ours for row in rows[: len(CROSS_CHECK)]]
    CURVES["u under the load"] = curve(
        [*CROSS_CHECK, 64], [*ours, fine], CROSS_CHECK, CROSS_CHECK.values()
    )
    return rows
