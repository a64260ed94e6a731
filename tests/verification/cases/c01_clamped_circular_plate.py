"""C01 Circular thin plate, clamped: natural frequencies.

Radius a, nu = 0.3, a / h = 1000. Read: lambda² = omega a² sqrt(rho h / D) of the modes with n nodal
diameters and s nodal circles, found by their likeness to the exact shape
J_n(k r) - J_n(k a) / I_n(k a) I_n(k r).

Source: exact, J_n I_n' - I_n J_n' = 0 (Leissa, NASA SP-160). Band as in C04, s the mean spacing.
"""

import numpy as np
from scipy.special import iv, jv

from cases.c04_square_plate_ssss import MATERIAL, mesh_band, observed_order, unit
from cases.paths import order_curve
from harness import Check
from shellcut import Mesh, Support
from shellcut.mesh.structured import disc
from shellcut.statics.statics import Modes, Statics

ID, TITLE, FAST = "C01", "Clamped circular plate, frequencies", True

RADIUS = 100.0
MESHES = (16, 32)  # n_side
EXACT = {0: [10.21583, 39.77115, 89.10414], 1: [21.2604, 60.82867, 120.07924]}

CURVES = {}
AXES = "side of a quad over the radius, s / a", "relative error of the first frequency"


def likest(mesh: Mesh, modes: Modes, radial: np.ndarray, n: int) -> float:
    """Return the frequency [Hz] of the mode most like radial(r) cos n(phi - phi_0)."""
    x, y = mesh.nodes[:, 0], mesh.nodes[:, 1]
    angle = np.arctan2(y, x)
    w = modes.shape[:, :, 2]
    likeness = np.zeros(len(w))
    for part in (np.cos(n * angle), np.sin(n * angle)):
        likeness += (w @ (radial * part)) ** 2 / (w * w).sum(axis=1)
    return float(modes.frequency[likeness.argmax()])


def spacing(mesh: Mesh) -> float:
    return float(np.sqrt(mesh.quad_areas().mean()))


def parameters(n_side: int, n_mode: int) -> tuple[dict[tuple[int, int], float], float]:
    """Return lambda² of the modes (n, s), and the spacing."""
    mesh = disc(RADIUS, n_side=n_side)
    modes = Statics(mesh, MATERIAL, supports=[Support.clamped("rim")]).modes(n_mode)
    r = np.hypot(mesh.nodes[:, 0], mesh.nodes[:, 1]) / RADIUS
    ours = {}
    for n, row in EXACT.items():
        for s, value in enumerate(row):
            k = np.sqrt(value)
            radial = jv(n, k * r) - jv(n, k) / iv(n, k) * iv(n, k * r)
            frequency = likest(mesh, modes, radial, n)
            ours[n, s] = 2.0 * np.pi * frequency / unit(RADIUS, MATERIAL)
    return ours, spacing(mesh)


def checks() -> list[Check]:
    rows, error, sizes = [], [], []
    for n_side in MESHES:
        ours, size = parameters(n_side, 40)
        for (n, s), one in ours.items():
            value = EXACT[n][s]
            band = mesh_band(np.sqrt(value) / RADIUS, size)
            name = f"lambda², n = {n}, s = {s}, n_side = {n_side}"
            rows.append(Check(name, value, one, band, "mesh, (k s)²/8"))
        error.append(ours[0, 0] / EXACT[0][0] - 1.0)
        sizes.append(size / RADIUS)
    CURVES["mode 1"] = order_curve(sizes, error)
    order = observed_order(error) / np.log2(sizes[0] / sizes[1])
    rows.append(Check("order, mode 1, n_side = 16 to 32", 2.0, order, 0.3, "order", absolute=True))
    return rows
