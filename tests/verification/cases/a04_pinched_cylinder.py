"""A04 pinched cylinder with rigid end diaphragms, linear.

R = 300, L = 600, t = 3, E = 3e6, nu = 0.3; two opposite unit radial forces at mid length; an eighth
with three symmetry planes. Read: the radial displacement under the load over 1.8248e-5.

Source: Ko, Lee, Lee, Bathe, C&S 193 (2017) 187-206, Tables 8-9 (MITC4, N = 16: 0.9286). The shear
factor is 1 as in the source.
"""

import numpy as np

from cases.patches import cylinder_patch, same_element
from harness import Check
from shellcut import Mesh, NodalForce, ShellMaterial, Statics, Support

ID, TITLE, FAST = "A04", "Pinched cylinder with diaphragms", True

PUBLISHED = {16: 0.9286}
CROSS_CHECK = {4: 0.37881, 8: 0.74691, 16: 0.92858}


def patch(n: int, *, exact: bool = True) -> Mesh:
    return cylinder_patch(300.0, 300.0, 90.0, n, n, exact=exact)


def deflection(mesh: Mesh) -> float:
    """Return that of the corner of u0 and v0, under the force, over 1.8248e-5."""
    material = ShellMaterial.homogeneous(young=3e6, poisson=0.3, thickness=3.0, shear_factor=1.0)
    load = int(np.intersect1d(mesh.node_set("u0"), mesh.node_set("v0"))[0])
    cylinder = Statics(
        mesh,
        material,
        supports=[
            Support.symmetry("u0", "x"),
            Support.symmetry("u1", "z"),
            Support.symmetry("v0", "y"),
            Support("v1", translation="xz", rotation="y"),
        ],
        loads=[NodalForce([load], (0.0, 0.0, -0.25))],
    )
    displacement, _ = cylinder.linear()
    return -float(displacement[load, 2]) / 1.8248e-5


def checks() -> list[Check]:
    return same_element("w / 1.8248e-5", deflection, patch, CROSS_CHECK, PUBLISHED)
