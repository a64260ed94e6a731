"""X01 observed order of convergence on smooth problems with closed forms.

- plate: hard simply supported, h / L = 0.1, sine load; w = q / (D k⁴) + q / (κ G h k²), k² = 2 π².
- disc: clamped circular plate, h / R = 0.01, uniform pressure;
  w = q (R² - r²)² / (64 D) + q (R² - r²) / (4 κ G h), on the library's unstructured disc.
- tube: long cylinder under internal pressure, a membrane state; w = p R² / (E h), h / R = 1e-4.
- arch: quarter of a ring, one end clamped, pulled radially at the other: inextensional bending,
  π P R³ / (4 E I), h / R = 1e-3.

Errors: plate and disc, root mean square over the nodes; tube and arch, the displacement itself.
The slope is fitted over the series; a four-node element has 2, and the band of 0.15 is what the
coarsest meshes still differ from it.
"""

import numpy as np

from cases.a08_plates import EDGES, POISSON, SYMMETRY, YOUNG, flat, stiffness
from cases.paths import order_curve
from harness import Check
from patches import mapped_patch
from shellcut import EdgeTraction, Mesh, NodalForce, Pressure, ShellMaterial, Statics, Support
from shellcut.mesh.structured import disc

ID, TITLE, FAST = "X01", "Order of convergence", True

SHEAR_MODULUS = 0.5 * YOUNG / (1.0 + POISSON)

CURVES = {}
AXES = "side of a quad", "relative error"


def material(thickness: float, poisson: float = POISSON) -> ShellMaterial:
    return ShellMaterial.homogeneous(young=YOUNG, poisson=poisson, thickness=thickness)


def relative(ours: np.ndarray, exact: np.ndarray) -> float:
    return float(np.sqrt(((ours - exact) ** 2).mean() / (exact**2).mean()))


def spacing(mesh: Mesh) -> float:
    return float(np.sqrt(mesh.quad_areas().mean()))


def plate(n: int) -> tuple[float, float]:
    """Return quad size and error; so for the others."""
    thickness, wave = 0.1, 2.0 * np.pi**2
    mesh = mapped_patch(n, n, flat)
    shape = np.cos(np.pi * mesh.nodes[:, 0]) * np.cos(np.pi * mesh.nodes[:, 1])
    area = np.bincount(mesh.quads.ravel(), weights=np.repeat(0.25 * mesh.quad_areas(), 4))
    loads = [NodalForce([i], (0.0, 0.0, f)) for i, f in enumerate(shape * area)]
    supports = SYMMETRY + EDGES["simply supported"]
    u, _ = Statics(mesh, material(thickness), supports=supports, loads=loads).linear()
    shear = 5.0 / 6.0 * SHEAR_MODULUS * thickness
    exact = shape * (1.0 / (stiffness(thickness) * wave**2) + 1.0 / (shear * wave))
    return spacing(mesh), relative(u[:, 2], exact)


def round_plate(n: int) -> tuple[float, float]:
    thickness = 0.01
    mesh = disc(1.0, n_side=n)
    model = Statics(
        mesh, material(thickness), supports=[Support.clamped("rim")], loads=[Pressure(1.0)]
    )
    u, _ = model.linear()
    inside = 1.0 - (mesh.nodes**2).sum(axis=1)
    shear = 5.0 / 6.0 * SHEAR_MODULUS * thickness
    exact = inside**2 / (64.0 * stiffness(thickness)) + inside / (4.0 * shear)
    return spacing(mesh), relative(u[:, 2], exact)


def arc(u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Map u to a quarter circle of radius 1 from the top to the x axis, v along y."""
    angle = 0.5 * np.pi * u
    director = np.stack([np.sin(angle), 0.0 * v, np.cos(angle)], axis=-1)
    nodes = director.copy()
    nodes[..., 1] = 0.1 * v
    return nodes, director


def tube(n: int) -> tuple[float, float]:
    thickness = 1e-4
    mesh = mapped_patch(n, 1, arc)
    model = Statics(
        mesh,
        material(thickness),
        supports=[
            Support.symmetry("u0", "x"),
            Support.symmetry("u1", "z"),
            Support.symmetry("v0", "y"),
        ],
        loads=[Pressure(1.0)],
    )
    u, _ = model.linear()
    radial = (u * mesh.directors).sum(axis=1)
    return 0.5 * np.pi / n, relative(radial, np.full(mesh.n_node, 1.0 / (YOUNG * thickness)))


def arch_deflection(n: int, thickness: float) -> float:
    """Return the radial deflection under a radial end force over π P R³ / (4 E I)."""
    mesh = mapped_patch(n, 1, arc)
    force = YOUNG * thickness**3 / (3.0 * np.pi)
    model = Statics(
        mesh,
        material(thickness, poisson=0.0),
        supports=[Support.clamped("u0")],
        loads=[EdgeTraction("u1", (force, 0.0, 0.0))],
    )
    u, _ = model.linear()
    return float(u[mesh.node_set("u1"), 0].mean())


def arch(n: int) -> tuple[float, float]:
    return 0.5 * np.pi / n, abs(arch_deflection(n, 1e-3) - 1.0)


SERIES = {
    "plate, sine load, h/L = 0.1": (plate, (4, 8, 16, 32)),
    "clamped disc, pressure": (round_plate, (8, 16, 32, 48)),
    "tube, internal pressure": (tube, (8, 16, 32, 64)),
    "arch, end force": (arch, (8, 16, 32, 64)),
}


def checks() -> list[Check]:
    rows = []
    for name, (problem, meshes) in SERIES.items():
        size, error = zip(*(problem(n) for n in meshes), strict=True)
        slope = np.polyfit(np.log(size), np.log(error), 1)[0]
        rows.append(
            Check(f"order, {name}", 2.0, float(slope), 0.15, "order of the element", absolute=True)
        )
        CURVES[name] = order_curve(size, error)
    return rows
