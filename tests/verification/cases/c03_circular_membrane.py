"""C03 Circular membrane under uniform tension: natural frequencies.

Radius a, a / h = 1e4, stretched by 1 %, rim held. Read: k = omega a / sqrt(T / m) of the modes with
n nodal diameters and s circles, found by their likeness to J_n(k r). With S the second
Piola-Kirchhoff stress of the stretch, T per present length and m per present area, k is
omega a / sqrt(S / rho), a of the reference. The rim is free to turn: bending then takes no edge
layer, and adds (k / a)² D / 2 T < 1e-5 to a frequency.

Source: exact, zeros of J_n. Band as in C04.
"""

import numpy as np
from scipy.special import jv

from cases.c01_clamped_circular_plate import likest, spacing
from cases.c04_square_plate_ssss import mesh_band, observed_order
from cases.paths import order_curve
from harness import Check
from shellcut import ShellMaterial, Statics, Support
from shellcut.mesh.structured import disc

ID, TITLE, FAST = "C03", "Circular membrane, frequencies", True

RADIUS, STRETCH = 100.0, 1.01
YOUNG, POISSON, DENSITY = 1000.0, 0.3, 1e-9
MATERIAL = ShellMaterial.homogeneous(
    young=YOUNG, poisson=POISSON, density=DENSITY, thickness=1e-4 * RADIUS
)
MESHES = (16, 32)  # n_side
EXACT = {
    0: [2.404826, 5.520078, 8.653728],
    1: [3.831706, 7.015587, 10.173468],
    2: [5.135622, 8.417244, 11.619841],
    3: [6.380162, 9.761023, 13.015201],
}

CURVES = {}
AXES = "side of a quad over the radius, s / a", "relative error of the first frequency"


def parameters(n_side: int) -> tuple[dict[tuple[int, int], float], float]:
    """Return k of the modes (n, s), and the spacing."""
    mesh = disc(RADIUS, n_side=n_side)
    film = Statics(mesh, MATERIAL, supports=[Support.pinned("rim")])
    film.state.node.x[: mesh.n_node, :2] *= STRETCH  # in equilibrium: the stress is uniform
    stress = YOUNG / (1.0 - POISSON) * 0.5 * (STRETCH**2 - 1.0)
    modes = film.modes(40)
    r = np.hypot(mesh.nodes[:, 0], mesh.nodes[:, 1]) / RADIUS
    to_k = 2.0 * np.pi * RADIUS / np.sqrt(stress / DENSITY)
    ours = {
        (n, s): to_k * likest(mesh, modes, jv(n, k * r), n)
        for n, row in EXACT.items()
        for s, k in enumerate(row)
    }
    return ours, spacing(mesh)


def checks() -> list[Check]:
    rows, error, sizes = [], [], []
    for n_side in MESHES:
        ours, size = parameters(n_side)
        for (n, s), one in ours.items():
            k = EXACT[n][s]
            band = mesh_band(k / RADIUS, size)
            name = f"k, n = {n}, s = {s}, n_side = {n_side}"
            rows.append(Check(name, k, one, band, "mesh, (k s)²/8"))
        error.append(ours[0, 0] / EXACT[0][0] - 1.0)
        sizes.append(size / RADIUS)
    CURVES["mode 1"] = order_curve(sizes, error)
    order = observed_order(error) / np.log2(sizes[0] / sizes[1])
    rows.append(Check("order, mode 1, n_side = 16 to 32", 2.0, order, 0.3, "order", absolute=True))
    return rows
