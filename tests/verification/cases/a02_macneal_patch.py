"""A02 MacNeal-Harder patch.

Rectangle 0.24 x 0.12, t = 0.001, E = 1e6, nu = 0.25; five quads around a skewed inner one.
Membrane: u = 1e-3 (x + y/2), v = 1e-3 (y + x/2). Bending: w = 1e-3 (x² + xy + y²) / 2 with the
directors normal to it. Read: strains and stresses of all quads, and the inner nodes' place.

The source prescribes the field on the boundary. Here the boundary is moved so in the membrane
part, finite as it is, and the inner nodes are found by Newton's iteration. In bending, where the
field is exact in the linear limit only, the boundary carries the field's own moments instead.

Source: MacNeal, Harder, FEAD 1 (1985) 3-20 (geometry from memory); stresses follow from the field.
Bands: patch tests; round-off, 1e-10, and in bending times the condition of so thin a plate: with
t / L = 1/240 some 10 (L / t)² of 2e-16.
"""

import numpy as np

from cases import a01_patch_test as patch
from cases.a01_patch_test import farthest, round_off
from harness import Check, case
from shellcut import Mesh, ShellMaterial, Statics, Support

YOUNG, POISSON, THICKNESS = 1e6, 0.25, 0.001
CORNERS = [(0.0, 0.0), (0.24, 0.0), (0.24, 0.12), (0.0, 0.12)]
INNER = [(0.04, 0.02), (0.18, 0.03), (0.16, 0.08), (0.08, 0.08)]
STRAIN = np.array([[1.0, 0.5], [0.5, 1.0]]) * 1e-3  # in bending the curvature
MATERIAL = ShellMaterial.homogeneous(young=YOUNG, poisson=POISSON, thickness=THICKNESS)
MESH = Mesh.from_arrays([*CORNERS, *INNER], patch.QUADS)


def stress_rows(name, stress, exact):
    for part, i, j in (("x", 0, 0), ("y", 1, 1), ("xy", 0, 1)):
        worst = max(stress[:, i, j], key=lambda one, value=exact[part]: abs(one - value))
        yield Check(f"{name} {part}, worst quad", exact[part], worst, 1e-10, "patch test")


@case("A02", "MacNeal-Harder patch")
def a02():
    modulus, nu = YOUNG / (1 - POISSON**2), POISSON
    stress = modulus * ((1 - nu) * STRAIN + nu * STRAIN.trace() * np.eye(2))
    loads = patch.edge_forces(THICKNESS * stress)
    model = Statics(MESH, MATERIAL, supports=patch.supported(), loads=loads)
    u, spin = model.linear()
    found = patch.linear_stress(model, u, spin, "mid", 3.0)
    exact = {"x": 4000.0 / 3.0, "y": 4000.0 / 3.0, "xy": 400.0}
    yield from stress_rows("membrane stress", found, exact)
    off = farthest(u, patch.membrane_field(MESH, STRAIN))
    yield round_off("membrane, displacement by nodal forces", off)

    field = np.zeros((MESH.n_node, 3))
    field[:, :2] = MESH.nodes[:, :2] @ STRAIN
    held = Statics(MESH, MATERIAL, supports=[Support.clamped([0, 1, 2, 3])])
    held.state.node.x[:4] += field[:4]
    off = farthest(held.load_steps([1.0])[-1].displacement, field)
    yield round_off("membrane, inner nodes by prescribed boundary", off)

    loads = patch.edge_moments(MESH, -(THICKNESS**3) / 12.0 * stress)
    model = Statics(MESH, MATERIAL, supports=patch.supported(), loads=loads)
    u, spin = model.linear()
    found = patch.linear_stress(model, u, spin, "bottom", 30.0)
    yield from stress_rows("surface stress", found, {"x": 2.0 / 3.0, "y": 2.0 / 3.0, "xy": 0.2})
    w, turned = patch.bending_field(MESH, STRAIN)
    yield round_off("bending, deflection by nodal moments", farthest(u, w))
    yield round_off("bending, spin by nodal moments", farthest(spin, turned))
