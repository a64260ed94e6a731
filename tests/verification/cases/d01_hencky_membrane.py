"""D01 Hencky's membrane: a flat disc without prestress under dead pressure, rim held.

Radius a, nu = 0.3. Read, over the powers of q a / E h that belong to them: deflection w0 and radial
stress in the middle, radial stress at the rim, volume swept.

Source: exact for Foeppl's model, the power series to 30 digits (Hencky, Alekseev, Fichter: 0.653
and 0.431). Foeppl's model is the limit of small slopes without bending: here w0 / a = 0.01, which
departs from it by the slope squared, (2 w0 / a)² = 4e-4, and w0 / h = 100.

Bands: kind mesh, 2 / n² for n quads along a side of the core, and model, the slope squared.

Flat and slack, the disc has no stiffness to the load: Newton's iteration starts from a paraboloid.
"""

import numpy as np

from cases.paths import order_curve
from harness import Check
from shellcut import Mesh, Pressure, ShellMaterial, Statics, Support
from shellcut.mesh.structured import disc

ID, TITLE, FAST = "D01", "Hencky's membrane", True

RADIUS, YOUNG, POISSON = 100.0, 1000.0, 0.3
DEFLECTION = 0.01  # w0 / a
THICKNESS = 1e-4 * RADIUS
MATERIAL = ShellMaterial.homogeneous(young=YOUNG, poisson=POISSON, thickness=THICKNESS)
EXACT = {"w0": 0.6534433447, "S centre": 0.4311010161, "S rim": 0.3329568069, "V": 1.0703166865}
MESHES = (8, 16, 32)  # n_side

CURVES = {}
AXES = "1 / n, n quads along a side of the core", "relative error"


def radial_stress(mesh: Mesh, body: Statics, place: str) -> tuple[np.ndarray, np.ndarray]:
    """Return radius and radial stress at the centres of all quads, by ascending radius."""
    centre = mesh.nodes[mesh.quads].mean(axis=1)
    r = np.hypot(centre[:, 0], centre[:, 1])
    outward = centre / r[:, None]
    stress = body.shell.stress(body.state, np.arange(mesh.n_quad), place=place)
    order = np.argsort(r)
    return r[order], np.einsum("ei,eij,ej->e", outward, stress, outward)[order]


def in_the_middle(r: np.ndarray, value: np.ndarray, spacing: float) -> float:
    """Return the value at r = 0 by a parabola in r² through the quads within four spacings."""
    near = r < 4.0 * spacing
    return float(np.polyfit(r[near] ** 2, value[near], 1)[-1])


def at_the_rim(r: np.ndarray, value: np.ndarray, radius: float, n_around: int) -> float:
    """Return the value at the rim by a parabola through the last three layers of quads."""
    rings = np.stack([r, value])[:, -3 * n_around :].reshape(2, 3, n_around).mean(axis=2)
    return float(np.polyval(np.polyfit(rings[0] - radius, rings[1], 2), 0.0))


def coefficients(n_side: int) -> dict[str, float]:
    scale = DEFLECTION / EXACT["w0"]  # (q a / E h)^(1/3)
    pressure = scale**3 * YOUNG * THICKNESS / RADIUS
    mesh = disc(RADIUS, n_side=n_side)
    film = Statics(mesh, MATERIAL, supports=[Support.pinned("rim")], loads=[Pressure(pressure)])
    z = film.state.node.x[: mesh.n_node, 2]
    r2 = (mesh.nodes**2).sum(axis=1) / RADIUS**2
    z[:] = 0.5 * DEFLECTION * RADIUS * (1.0 - r2)
    film.load_steps([1.0])
    spacing = np.sqrt(mesh.quad_areas().mean())
    r, stress = radial_stress(mesh, film, "nominal")
    unit = YOUNG * scale**2
    return {
        "w0": float(z[mesh.node_set("centre")].mean()) / (RADIUS * scale),
        "S centre": in_the_middle(r, stress, spacing) / unit,
        "S rim": at_the_rim(r, stress, RADIUS, 4 * n_side) / unit,
        "V": float((mesh.quad_areas() * z[mesh.quads].mean(axis=1)).sum()) / (RADIUS**3 * scale),
    }


def checks() -> list[Check]:
    rows, found = [], [coefficients(n) for n in MESHES]
    for name, exact in EXACT.items():
        error = [one[name] / exact - 1.0 for one in found]
        CURVES[name] = order_curve([1.0 / n for n in MESHES], error)
    for n_side, one in zip(MESHES, found, strict=True):
        band, why = 2.0 / n_side**2 + (2.0 * DEFLECTION) ** 2, "mesh, 2 / n²; model, slope²"
        rows += [
            Check(f"{name}, n_side = {n_side}", EXACT[name], value, band, why)
            for name, value in one.items()
        ]
    return rows
