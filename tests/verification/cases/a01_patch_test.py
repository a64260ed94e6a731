"""A01 patch tests: membrane, bending, transverse shear; rigid motions of a single quad.

Square 10 x 10 of five quads around a skewed inner one; the corners carry the nodal forces and
moments of a constant state of stress, the least supports hold the rigid motion. All nodes must take
the linear (in bending quadratic) displacement, all quads the stress, to round-off. In transverse
shear the directors are fixed: otherwise a constant shear force needs moments that grow along the
plate. A free quad has 20 freedoms and six rigid motions.

In bending the solution carries round-off times the condition of the stiffness, some 10 (L / t)²:
1e-10 is reached down to t / L = 0.01; what is left at 0.001 is printed for information.

Source: Ko, Lee, Bathe, C&S 182 (2017) 404-418, Fig. 5. Bands: patch tests, 1e-10.
"""

import numpy as np

from harness import Check, case, zero
from shellcut import EdgeTraction, Mesh, NodalMoment, ShellMaterial, Statics, Support

YOUNG, POISSON, SHEAR_FACTOR = 2.1e6, 0.3, 5.0 / 6.0
CORNERS = [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)]
INNER = [(2.0, 2.0), (8.0, 3.0), (8.0, 7.0), (4.0, 7.0)]
QUADS = [[4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
NORMALS = [(0.0, -1.0), (1.0, 0.0), (0.0, 1.0), (-1.0, 0.0)]
SIDES = [((a, (a + 1) % 4), np.array(n)) for a, n in enumerate(NORMALS)]
STATES = {"x": [[1.0, 0.0], [0.0, 0.0]], "y": [[0.0, 0.0], [0.0, 1.0]], "xy": [[0, 1.0], [1.0, 0]]}
MESH = Mesh.from_arrays([*CORNERS, *INNER], QUADS)


def plane_strain(stress):
    """Return the strain of a plane stress tensor, shape (2, 2)."""
    return ((1 + POISSON) * stress - POISSON * stress.trace() * np.eye(2)) / YOUNG


def edge_forces(force):
    """Return the tractions of a membrane force tensor [N/mm] on the four sides."""
    return [EdgeTraction(pair, (*(force @ n), 0.0)) for pair, n in SIDES]


def edge_moments(mesh, moment):
    """Return the nodal moments of a moment tensor [N·mm/mm] on the four sides.

    The stress pulls on the directors by m = moment · n a length; its moment is t x m.
    """
    loads = []
    for pair, n in SIDES:
        x, y = 0.5 * np.linalg.norm(np.diff(mesh.nodes[list(pair)], axis=0)) * (moment @ n)
        loads.append(NodalMoment(pair, (-y, x, 0.0)))
    return loads


def supported():
    """Hold the six rigid motions at three corners: no reaction under a state of equilibrium."""
    held = {0: "xyz", 1: "yz", 3: "z"}
    return [Support([n], translation=axes, rotation="") for n, axes in held.items()]


def membrane_field(mesh, strain):
    """Return the displacements that turn no edge along x."""
    x, y = mesh.nodes[:, 0], mesh.nodes[:, 1]
    return np.stack([strain[0, 0] * x + 2 * strain[0, 1] * y, strain[1, 1] * y, 0 * x], axis=1)


def bending_field(mesh, curvature):
    """Return displacement and spin of a given curvature, w = 0 at corners 0, 1 and 3."""
    x = mesh.nodes[:, :2]
    start = 0.5 * curvature.diagonal() * x[2]
    w = 0.5 * ((x @ curvature) * x).sum(axis=1) - x @ start
    slope = x @ curvature - start
    zero = np.zeros_like(w)
    return np.stack([zero, zero, w], axis=1), np.stack([slope[:, 1], -slope[:, 0], zero], axis=1)


def linear_stress(model, displacement, spin, place, scale):
    """Return the stresses at the quads' centres that are linear in the solution, (n_quad, 3, 3).

    The sixth order central difference of the stress along the solution, in steps ``scale``.
    """
    node, n = model.state.node, model.mesh.n_node
    start = node.x.copy(), node.t.copy()
    quads = np.arange(model.mesh.n_quad)
    angle = np.linalg.norm(spin, axis=1, keepdims=True)
    across = np.cross(spin, node.t[:n])
    total = np.zeros((quads.size, 3, 3))
    for step, weight in ((1, 45.0), (2, -9.0), (3, 1.0)):
        for sign in (1, -1):
            s = sign * step * scale
            node.x[:n] = start[0][:n] + s * displacement
            node.t[:n] = np.cos(s * angle) * start[1][:n] + s * np.sinc(s * angle / np.pi) * across
            stress = model.shell.stress(model.state, quads, place=place)
            total += sign * weight / (60.0 * scale) * stress
    node.x[:], node.t[:] = start
    return total


def farthest(ours, exact):
    """Return the largest difference over the largest exact value."""
    return float(np.abs(ours - exact).max() / np.abs(exact).max())


def round_off(quantity, error, *, gate=True):
    return zero(quantity, error, 1e-10, "patch test", gate=gate)


def material(thickness):
    return ShellMaterial.homogeneous(young=YOUNG, poisson=POISSON, thickness=thickness)


def membrane_errors(stress, thickness):
    strain, loads = plane_strain(stress), edge_forces(thickness * stress)
    model = Statics(MESH, material(thickness), supports=supported(), loads=loads)
    u, spin = model.linear()
    found = linear_stress(model, u, spin, "mid", 3e-3 / np.abs(strain).max())
    return farthest(u, membrane_field(MESH, strain)), farthest(found[:, :2, :2], stress)


def bending_errors(stress, thickness):
    """``stress`` is that of the top face."""
    curvature = -plane_strain(stress) / (0.5 * thickness)
    loads = edge_moments(MESH, thickness**2 / 6.0 * stress)
    model = Statics(MESH, material(thickness), supports=supported(), loads=loads)
    u, spin = model.linear()
    w, turned = bending_field(MESH, curvature)
    found = linear_stress(model, u, spin, "top", 5e-3 / np.abs(turned).max())
    return farthest(u, w), farthest(spin, turned), farthest(found[:, :2, :2], stress)


def shear_error(shear, thickness):
    force = SHEAR_FACTOR * 0.5 * YOUNG / (1 + POISSON) * thickness * shear
    loads = [EdgeTraction(pair, (0.0, 0.0, float(force @ n))) for pair, n in SIDES]
    supports = [
        Support([0], rotation=""),
        Support([1], translation="y", rotation=""),
        Support(np.arange(MESH.n_node), translation=""),
    ]
    u, _ = Statics(MESH, material(thickness), supports=supports, loads=loads).linear()
    return farthest(u[:, 2], MESH.nodes[:, :2] @ shear)


def rigid_motions(mesh):
    """Return how many eigenvalues of a free quad vanish to round-off."""
    model = Statics(mesh, material(0.1))
    values = np.sort(np.linalg.eigvalsh(model.shell.tangents(model.state, np.array([0]))[0]))
    return int((np.abs(values) < 1e-13 * values[-1]).sum())


def free_quads():
    one = [[0, 1, 2, 3]]
    angle = np.array([0.0, 0.4, 0.4, 0.0])
    radial = np.stack([np.sin(angle), 0 * angle, np.cos(angle)], axis=1)
    bent = 2.5 * radial + np.array([[0, 0, 0], [0, 0, 0], [0, 1.0, 0], [0, 1.0, 0]])
    return {
        "square": Mesh.from_arrays([[0, 0], [1, 0], [1, 1], [0, 1]], one),
        "skewed": Mesh.from_arrays([[0, 0], [1.1, 0.2], [1.4, 1.3], [-0.2, 0.9]], one),
        "cylindrical": Mesh.from_arrays(bent, one, directors=radial),
        "warped": Mesh.from_arrays([[0, 0, 0], [1, 0, 0.2], [1.2, 1, 0], [0, 1.1, 0.3]], one),
    }


@case("A01", "Patch tests and rigid motions")
def a01():
    for thickness in (1.0, 0.1, 0.01):
        at, gate = f"t/L = {thickness / 10:g}", thickness > 0.05
        for name, state in STATES.items():
            stress = np.array(state)
            u, s = membrane_errors(stress, thickness)
            yield round_off(f"membrane {name}, displacement, {at}", u)
            yield round_off(f"membrane {name}, stress, {at}", s)
            w, turn, s = bending_errors(stress, thickness)
            yield round_off(f"bending {name}, deflection, {at}", w, gate=gate)
            yield round_off(f"bending {name}, spin, {at}", turn, gate=gate)
            yield round_off(f"bending {name}, surface stress, {at}", s, gate=gate)
        for k, name in enumerate(("x", "y")):
            error = shear_error(np.eye(2)[k], thickness)
            yield round_off(f"transverse shear {name}, deflection, {at}", error)
    for name, mesh in free_quads().items():
        count = rigid_motions(mesh)
        yield Check(f"vanishing eigenvalues, {name} quad", 6, count, 0.0, "exact")
