"""A03 Scordelis-Lo roof, linear.

Cylindrical roof R = 25, L = 50, half angle 40°, t = 0.25, E = 4.32e8, nu = 0; 90 a unit area
downwards; rigid diaphragms at the curved ends, straight edges free; a quarter with symmetry. Read:
the vertical displacement in the middle of the free edge over 0.3024.

Source: Ko, Lee, Lee, Bathe, C&S 193 (2017) 187-206, Tables 10-11 (MITC4, N = 16: 0.9886). The
shear factor is 1 as in the source.
"""

import numpy as np

from cases.patches import cylinder_patch, same_element
from harness import Check
from shellcut import Gravity, Mesh, ShellMaterial, Statics, Support

ID, TITLE, FAST = "A03", "Scordelis-Lo roof", True

PUBLISHED = {16: 0.9886}
CROSS_CHECK = {4: 0.94683, 8: 0.97354, 16: 0.98882}


def patch(n: int, *, exact: bool = True) -> Mesh:
    return cylinder_patch(25.0, 25.0, 40.0, n, n, exact=exact)


def deflection(mesh: Mesh) -> float:
    """Return that of the corner of u1 and v0, the middle of the whole roof's edge, over 0.3024."""
    thickness, density = 0.25, 1e-9
    material = ShellMaterial.homogeneous(
        young=4.32e8, poisson=0.0, density=density, thickness=thickness, shear_factor=1.0
    )
    roof = Statics(
        mesh,
        material,
        supports=[
            Support.symmetry("u0", "x"),
            Support.symmetry("v0", "y"),
            Support("v1", translation="xz", rotation="y"),
        ],
        loads=[Gravity((0.0, 0.0, -90.0 / (density * thickness)))],
    )
    displacement, _ = roof.linear()
    middle = np.intersect1d(mesh.node_set("u1"), mesh.node_set("v0"))
    return -float(displacement[middle[0], 2]) / 0.3024


def checks() -> list[Check]:
    return same_element("w / 0.3024", deflection, patch, CROSS_CHECK, PUBLISHED)
