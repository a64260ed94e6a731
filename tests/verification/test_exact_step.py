"""The stable step against the largest eigenvalue of the assembled stiffness.

Without contact and cables the central difference with stiffness damping lagging half a step is
stable below 2/omega (sqrt(1 + xi²) - xi), xi = ½ beta omega, omega² the largest eigenvalue of
M⁻¹ K. Here K is assembled by central differences of the nodal forces of the whole mesh.
"""

from collections.abc import Callable

import numpy as np
import pytest

from shellcut.material.shell_material import ShellMaterial
from shellcut.mesh.mesh import Mesh
from shellcut.mesh.structured import cylinder, rectangle
from shellcut.simulation.instability import UnstableStep
from shellcut.simulation.simulation import Simulation
from shellcut.simulation.stable_step import Stepping

DIFFERENCE = 1e-5  # mm and rad: the forces are cubic, the error 1e-10, round-off 1e-11 relative
KICK = 1e-2  # mm/s, strains of 1e-8: far from any non-linearity, also after growth by GROWN
CALM, GROWN = 10.0, 1e4  # bound of stable, and least of unstable growth


def _jittered() -> Mesh:
    mesh = rectangle(3.0, 2.0, n_x=6, n_y=4)
    nodes = mesh.nodes.copy()
    inner = np.setdiff1d(np.arange(mesh.n_node), mesh.boundary_nodes())
    nodes[inner, :2] += np.random.default_rng(1).uniform(-0.12, 0.12, (inner.size, 2))
    return Mesh.from_arrays(nodes, mesh.quads)


# Mesh and the least ratio of the library's bound to the exact step. The bound of the quad that is
# worst by itself ignores what its neighbours add: on regular meshes it costs 0.2 % (slender quads),
# 10 % (cylinder), 12 % (squares); on the jittered mesh, scaled Jacobians down to 0.6, 26 to 29 %.
MESHES: dict[str, tuple[Callable[[], Mesh], float]] = {
    "squares": (lambda: rectangle(3.0, 2.0, n_x=6, n_y=4), 0.8),
    "slender": (lambda: rectangle(3.0, 2.0, n_x=3, n_y=10), 0.8),
    "cylinder": (lambda: cylinder(3.0, 3.0, n_around=6, n_along=4, arc_deg=90.0), 0.8),
    "jittered": (_jittered, 0.65),
}


def _simulation(mesh: Mesh, beta: float, dt: float | None = None) -> Simulation:
    return Simulation(
        mesh,
        ShellMaterial.homogeneous(),
        damping_alpha=0.0,
        damping_beta=beta,
        stepping=Stepping(fixed=dt),
    )


def _exact_frequency(mesh: Mesh) -> float:
    """Return omega of the free, unstressed mesh [rad/s]; five freedoms a node."""
    sim = _simulation(mesh, beta=0.0)
    s, n = sim.state, sim.state.n_node
    x, t = s.node.x.copy(), s.node.t.copy()
    helper = np.eye(3)[np.abs(t[:n]).argmin(axis=1)]
    b1 = np.cross(t[:n], helper)
    b1 /= np.linalg.norm(b1, axis=1, keepdims=True)
    tangent = np.stack([b1, np.cross(t[:n], b1)], axis=1)

    def force() -> np.ndarray:
        s.node.force[:] = s.node.director_force[:] = 0.0
        sim.shell.add_forces(s)
        turning = np.einsum("nbi,ni->nb", tangent, s.node.director_force[:n])
        return np.hstack([s.node.force[:n], turning]).ravel()

    stiffness = np.empty((5 * n, 5 * n))
    for i in range(n):
        for c in range(5):
            sides = []
            for sign in (1.0, -1.0):
                s.node.x[:], s.node.t[:] = x, t
                if c < 3:
                    s.node.x[i, c] += sign * DIFFERENCE
                else:
                    s.node.t[i] += sign * DIFFERENCE * tangent[i, c - 3]
                sides.append(force())
            stiffness[:, 5 * i + c] = (sides[1] - sides[0]) / (2.0 * DIFFERENCE)
    mass = np.hstack([np.tile(s.node.mass[:n, None], 3), np.tile(s.node.inertia[:n, None], 2)])
    scaled = stiffness / np.sqrt(np.outer(mass.ravel(), mass.ravel()))
    eigenvalues = np.linalg.eigvalsh(0.5 * (scaled + scaled.T))
    # Six rigid motions and no other mode without energy: none is hidden below round-off.
    assert (np.abs(eigenvalues) < 1e-7 * eigenvalues[-1]).sum() == 6
    return float(np.sqrt(eigenvalues[-1]))


def _growth(mesh: Mesh, beta: float, dt: float) -> float:
    """Return by how much a small random motion grows in 600 steps."""
    sim = _simulation(mesh, beta, dt)
    kick = KICK * np.random.default_rng(0).standard_normal((mesh.n_node, 3))
    sim.state.node.velocity_half[: mesh.n_node] = kick
    start = largest = float(np.abs(kick).max())
    for _ in range(600):
        try:
            sim.step()
        except UnstableStep:
            return np.inf
        largest = max(largest, float(np.abs(sim.state.node.velocity_half).max()))
        if largest > GROWN * start:
            break
    return largest / start


@pytest.mark.parametrize("name", MESHES)
def test_the_step_is_stable_below_the_exact_limit_only(name: str) -> None:
    build, least = MESHES[name]
    mesh = build()
    omega = _exact_frequency(mesh)
    for beta in (0.0, 5e-8):
        xi = 0.5 * beta * omega
        exact = 2.0 / omega * (np.sqrt(1.0 + xi * xi) - xi)
        # Kind: a bound. Measured growth 0.8 to 2.6 below; without limit above, 1.01 included.
        assert _growth(mesh, beta, 0.95 * exact) < CALM
        assert _growth(mesh, beta, 1.05 * exact) > GROWN
        # The library's own bound is safe, and near enough; 1e-6 for its differences.
        sim = _simulation(mesh, beta)
        assert least < sim.time_step.bound(sim.state) / exact <= 1.0 + 1e-6


def test_the_damped_limit_is_the_shorter_one() -> None:
    # With the undamped limit the damped film is unstable: the formula is needed, not only safe.
    mesh = rectangle(3.0, 2.0, n_x=6, n_y=4)
    undamped = 2.0 / _exact_frequency(mesh)
    assert _growth(mesh, 5e-8, 0.95 * undamped) > GROWN
