"""C04 Square thin plate, simply supported: natural frequencies.

Side a, nu = 0.3, a / h = 1000. Read: omega a² sqrt(rho h / D), first six. Hard simple support: no
tilt along the edge, as in the double sine.

Source: exact, pi² (m² + n²); the same numbers by Ritz with Legendre polynomials.

Band: the kind of error is that of the mesh. A mode of wave number k on quads of side s has, by the
one-dimensional analysis of a linear shear beam without locking on lumped mass, an error of
(k s)² / 24 in its frequency; three times as much is allowed, and 2e-4 for the digits of the tables
and what shear and rotary inertia take at a / h = 1000. The observed order must be 2.
"""

import numpy as np

from cases.patches import mapped_patch
from cases.paths import order_curve
from harness import Check
from shellcut import Mesh, ShellMaterial, Statics, Support

ID, TITLE, FAST = "C04", "Square plate SSSS, frequencies", True

SIDE = 100.0
MATERIAL = ShellMaterial.homogeneous(young=1000.0, poisson=0.3, density=1e-9, thickness=1e-3 * SIDE)
MESHES = (16, 32)
EXACT = [np.pi**2 * k for k in (2, 5, 5, 8, 10, 10)]
TABLE_DIGITS = 2e-4
HARD = [
    Support("u0", rotation="xz"),
    Support("u1", rotation="xz"),
    Support("v0", rotation="yz"),
    Support("v1", rotation="yz"),
]

CURVES = {}
AXES = "side of a quad over that of the plate, s / a", "relative error of the first frequency"


def mesh_band(wave_number: float, size: float) -> float:
    """Return the allowed relative error of a frequency, see above."""
    return (wave_number * size) ** 2 / 8.0 + TABLE_DIGITS


def observed_order(error: list[float]) -> float:
    """Return the order of the last halving of the mesh."""
    return float(np.log2(abs(error[-2] / error[-1])))


def unit(length: float, material: ShellMaterial) -> float:
    """Return sqrt(D / rho h) / length² of a thin plate [rad/s]."""
    m = material.layers[0].material
    stiffness = m.young * material.thickness**3 / (12.0 * (1.0 - m.poisson**2))
    return float(np.sqrt(stiffness / (m.density * material.thickness)) / length**2)


def square(n: int) -> Mesh:
    def place(u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        flat = np.zeros((*u.shape, 3))
        nodes, directors = flat.copy(), flat.copy()
        nodes[..., 0], nodes[..., 1], directors[..., 2] = SIDE * u, SIDE * v, 1.0
        return nodes, directors

    return mapped_patch(n, n, place)


def plate_parameters(n: int, supports: list[Support], n_mode: int) -> np.ndarray:
    """Return omega a² sqrt(rho h / D) of the first modes on n x n quads."""
    modes = Statics(square(n), MATERIAL, supports=supports).modes(n_mode)
    return 2.0 * np.pi * modes.frequency / unit(SIDE, MATERIAL)


def square_checks(reference: list[float], supports: list[Support]) -> list[Check]:
    """Compare the first modes on two meshes; fill the caller's rows."""
    rows = []
    for n in MESHES:
        ours = plate_parameters(n, supports, len(reference))
        for k, (value, one) in enumerate(zip(reference, ours, strict=True), start=1):
            band = mesh_band(np.sqrt(value) / SIDE, SIDE / n)
            rows.append(Check(f"lambda², mode {k}, N = {n}", value, one, band, "mesh, (k s)²/8"))
    return rows


def checks() -> list[Check]:
    rows = square_checks(EXACT, HARD)
    sizes = (8, 16, 32, 64)
    error = [plate_parameters(n, HARD, 1)[0] / EXACT[0] - 1.0 for n in sizes]
    CURVES["mode 1"] = order_curve([1.0 / n for n in sizes], error)
    order = observed_order(error[:-1])
    rows.append(Check("order, mode 1, N = 16 to 32", 2.0, order, 0.1, "order", absolute=True))
    return rows
