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

from harness import Check
from shellcut import EdgeTraction, Mesh, NodalMoment, ShellMaterial, Statics, Support
from shellcut.loads.loads import Load

ID, TITLE, FAST = "A01", "Patch tests and rigid motions", True

YOUNG, POISSON, SHEAR_FACTOR = 2.1e6, 0.3, 5.0 / 6.0
CORNERS = [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)]
INNER = [(2.0, 2.0), (8.0, 3.0), (8.0, 7.0), (4.0, 7.0)]
QUADS = [[4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
NORMALS = [(0.0, -1.0), (1.0, 0.0), (0.0, 1.0), (-1.0, 0.0)]
STATES = {"x": [[1.0, 0.0], [0.0, 0.0]], "y": [[0.0, 0.0], [0.0, 1.0]], "xy": [[0, 1.0], [1.0, 0]]}
ROUND_OFF = 1e-10


def star(corners: list[tuple[float, float]], inner: list[tuple[float, float]]) -> Mesh:
    """Return four quads around an inner one; nodes 0 to 3 are the corners of a rectangle."""
    return Mesh.from_arrays([*corners, *inner], QUADS)


def plane_stress(strain: np.ndarray, young: float, poisson: float) -> np.ndarray:
    """Return the stress of a plane strain tensor, shape (2, 2)."""
    return (
        young / (1 - poisson**2) * ((1 - poisson) * strain + poisson * strain.trace() * np.eye(2))
    )


def plane_strain(stress: np.ndarray, young: float, poisson: float) -> np.ndarray:
    """Return the strain of a plane stress tensor, shape (2, 2)."""
    return ((1 + poisson) * stress - poisson * stress.trace() * np.eye(2)) / young


def edge_forces(force: np.ndarray) -> list[Load]:
    """Return the tractions of a membrane force tensor [N/mm] on the four sides."""
    pairs = [(a, (a + 1) % 4) for a in range(4)]
    sides = zip(pairs, NORMALS, strict=True)
    return [EdgeTraction(pair, (*(force @ n), 0.0)) for pair, n in sides]


def edge_moments(mesh: Mesh, moment: np.ndarray) -> list[Load]:
    """Return the nodal moments of a moment tensor [N·mm/mm] on the four sides.

    The stress pulls on the directors by m = moment · n a length; its moment is t x m.
    """
    loads: list[Load] = []
    for a, n in enumerate(NORMALS):
        pair = [a, (a + 1) % 4]
        half = 0.5 * np.linalg.norm(mesh.nodes[pair[1]] - mesh.nodes[pair[0]])
        m = half * (moment @ n)
        loads.append(NodalMoment(pair, (-m[1], m[0], 0.0)))
    return loads


def supported() -> list[Support]:
    """Hold the six rigid motions at three corners: no reaction under a state of equilibrium."""
    held = {0: "xyz", 1: "yz", 3: "z"}
    return [Support([n], translation=axes, rotation="") for n, axes in held.items()]


def membrane_field(mesh: Mesh, strain: np.ndarray) -> np.ndarray:
    """Return the displacements that turn no edge along x."""
    x, y = mesh.nodes[:, 0], mesh.nodes[:, 1]
    return np.stack([strain[0, 0] * x + 2 * strain[0, 1] * y, strain[1, 1] * y, 0 * x], axis=1)


def bending_field(mesh: Mesh, curvature: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return displacement and spin of a given curvature, w = 0 at corners 0, 1 and 3."""
    x = mesh.nodes[:, :2]
    start = 0.5 * curvature.diagonal() * x[2]
    w = 0.5 * ((x @ curvature) * x).sum(axis=1) - x @ start
    slope = x @ curvature - start
    zero = np.zeros_like(w)
    return np.stack([zero, zero, w], axis=1), np.stack([slope[:, 1], -slope[:, 0], zero], axis=1)


def linear_stress(
    model: Statics, displacement: np.ndarray, spin: np.ndarray, place: str, scale: float
) -> np.ndarray:
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
            total += (
                sign * weight / (60.0 * scale) * model.shell.stress(model.state, quads, place=place)
            )
    node.x[:], node.t[:] = start
    return total


def farthest(ours: np.ndarray, exact: np.ndarray) -> float:
    """Return the largest difference over the largest exact value."""
    return float(np.abs(ours - exact).max() / np.abs(exact).max())


def zero(quantity: str, error: float, *, gate: bool = True) -> Check:
    return Check(quantity, 0.0, error, ROUND_OFF, "patch test", gate=gate, absolute=True)


def membrane_errors(stress: np.ndarray, thickness: float) -> tuple[float, float]:
    mesh = star(CORNERS, INNER)
    strain = plane_strain(stress, YOUNG, POISSON)
    model = Statics(
        mesh, material(thickness), supports=supported(), loads=edge_forces(thickness * stress)
    )
    u, spin = model.linear()
    found = linear_stress(model, u, spin, "mid", 3e-3 / np.abs(strain).max())
    return farthest(u, membrane_field(mesh, strain)), farthest(found[:, :2, :2], stress)


def bending_errors(stress: np.ndarray, thickness: float) -> tuple[float, float, float]:
    """``stress`` is that of the top face."""
    mesh = star(CORNERS, INNER)
    curvature = -plane_strain(stress, YOUNG, POISSON) / (0.5 * thickness)
    loads = edge_moments(mesh, thickness**2 / 6.0 * stress)
    model = Statics(mesh, material(thickness), supports=supported(), loads=loads)
    u, spin = model.linear()
    w, turned = bending_field(mesh, curvature)
    found = linear_stress(model, u, spin, "top", 5e-3 / np.abs(turned).max())
    return farthest(u, w), farthest(spin, turned), farthest(found[:, :2, :2], stress)


def shear_error(shear: np.ndarray, thickness: float) -> float:
    mesh = star(CORNERS, INNER)
    force = SHEAR_FACTOR * 0.5 * YOUNG / (1 + POISSON) * thickness * shear
    loads = [
        EdgeTraction((a, (a + 1) % 4), (0.0, 0.0, float(force @ n))) for a, n in enumerate(NORMALS)
    ]
    supports = [
        Support([0], rotation=""),
        Support([1], translation="y", rotation=""),
        Support(np.arange(mesh.n_node), translation=""),
    ]
    u, _ = Statics(mesh, material(thickness), supports=supports, loads=loads).linear()
    return farthest(u[:, 2], mesh.nodes[:, :2] @ shear)


def material(thickness: float) -> ShellMaterial:
    return ShellMaterial.homogeneous(young=YOUNG, poisson=POISSON, thickness=thickness)


def rigid_motions(mesh: Mesh) -> int:
    """Return how many eigenvalues of a free quad vanish to round-off."""
    model = Statics(mesh, material(0.1))
    values = np.sort(np.linalg.eigvalsh(model.shell.tangents(model.state, np.array([0]))[0]))
    return int((np.abs(values) < 1e-13 * values[-1]).sum())


def free_quads() -> dict[str, Mesh]:
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


def checks() -> list[Check]:
    rows = []
    for thickness in (1.0, 0.1, 0.01):
        at, gate = f"t/L = {thickness / 10:g}", thickness > 0.05
        for name, state in STATES.items():
            stress = np.array(state)
            u, s = membrane_errors(stress, thickness)
            rows.append(zero(f"membrane {name}, displacement, {at}", u))
            rows.append(zero(f"membrane {name}, stress, {at}", s))
            w, turn, s = bending_errors(stress, thickness)
            rows.append(zero(f"bending {name}, deflection, {at}", w, gate=gate))
            rows.append(zero(f"bending {name}, spin, {at}", turn, gate=gate))
            rows.append(zero(f"bending {name}, surface stress, {at}", s, gate=gate))
        for k, name in enumerate(("x", "y")):
            error = shear_error(np.eye(2)[k], thickness)
            rows.append(zero(f"transverse shear {name}, deflection, {at}", error))
    for name, mesh in free_quads().items():
        count = rigid_motions(mesh)
        rows.append(Check(f"vanishing eigenvalues, {name} quad", 6, count, 0.0, "exact"))
    return rows
