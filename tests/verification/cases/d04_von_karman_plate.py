"""D04 Von Karman's clamped circular plate, rim held in its plane too.

Radius a, nu = 0.3, a / h = 1000, dead pressure Q = q a⁴ / E h⁴ up to 1000. Read: w0 / h; membrane
stress in the middle and radial at the rim, bending stress in the middle and radial at the rim, all
by a² / E h².

Source: exact for von Karman's theory, Chebyshev collocation, Newton to 1e-11. The model differs by
the slope squared, 2e-4 at the last load.

Bands: kind mesh. w0: 2 / n², n quads along a side of the core, and half a digit. Stresses are of
the quads' middles, extrapolated to centre and rim by parabolas: ten times as much. The bending at
the rim decays within sqrt(D / N) (0.057 a at Q = 1000), which the mesh must resolve besides: the
square of its size over that length.
"""

import numpy as np

from cases.d01_hencky_membrane import at_the_rim, in_the_middle, radial_stress
from cases.paths import curve
from harness import Check
from shellcut import Pressure, ShellMaterial, Statics, Support
from shellcut.mesh.structured import disc

ID, TITLE, FAST = "D04", "Von Karman's clamped circular plate", True

RADIUS, YOUNG, POISSON, N_SIDE = 100.0, 1000.0, 0.3, 32
H = 1e-3 * RADIUS
NAMES = ("w0 / h", "membrane, centre", "membrane, rim", "bending, centre", "bending, rim")
EXACT = {
    0.1: (0.01706, 0.00028, 0.00014, 0.04874, 0.07499),
    1: (0.16803, 0.02754, 0.01347, 0.47783, 0.74388),
    3: (0.45884, 0.20435, 0.10163, 1.26679, 2.12308),
    5: (0.6796, 0.44574, 0.2264, 1.8061, 3.32749),
    10: (1.05196, 1.05721, 0.56194, 2.56636, 5.8441),
    20: (1.49379, 2.11407, 1.19099, 3.24609, 9.8793),
    50: (2.19801, 4.56858, 2.78465, 4.05685, 19.1623),
    100: (2.85571, 7.75166, 4.97391, 4.75361, 31.2187),
    300: (4.22473, 17.1845, 11.7226, 6.31576, 66.7768),
    1000: (6.40024, 39.9712, 28.4845, 8.97663, 151.902),
}
DIGIT = 5e-6  # half of the last, w0 and small stresses

CURVES = {}
AXES = "Q = q a⁴ / (E h⁴)", "w0 / h; stresses times a² / (E h²)"


def path() -> np.ndarray:
    """Return the five numbers at every Q, shape (10, 5)."""
    mesh = disc(RADIUS, n_side=N_SIDE)
    spacing = np.sqrt(mesh.quad_areas().mean())
    material = ShellMaterial.homogeneous(young=YOUNG, poisson=POISSON, thickness=H)
    plate = Statics(
        mesh,
        material,
        supports=[Support.clamped("rim")],
        loads=[Pressure(YOUNG * H**4 / RADIUS**4)],  # Q = 1
    )
    unit = YOUNG * H**2 / RADIUS**2
    rows = []
    for Q in EXACT:
        point = plate.load_steps([Q])[-1]
        r, mid = radial_stress(mesh, plate, "mid")
        bending = radial_stress(mesh, plate, "bottom")[1] - mid
        rows.append(
            [
                point.displacement[mesh.node_set("centre"), 2].mean() / H,
                in_the_middle(r, mid, spacing) / unit,
                at_the_rim(r, mid, RADIUS, 4 * N_SIDE) / unit,
                abs(in_the_middle(r, bending, spacing)) / unit,
                abs(at_the_rim(r, bending, RADIUS, 4 * N_SIDE)) / unit,
            ]
        )
    return np.array(rows)


def checks() -> list[Check]:
    ours = path()
    reference = np.array(list(EXACT.values()))
    for k, name in enumerate(NAMES):
        CURVES[name] = curve(EXACT, ours[:, k], EXACT, reference[:, k])
    rows = []
    layer_size = RADIUS / N_SIDE / 2.0
    for i, Q in enumerate(EXACT):
        for k, name in enumerate(NAMES):
            value = reference[i, k]
            band = (2.0 if k == 0 else 20.0) / N_SIDE**2 + DIGIT / value
            if name == "bending, rim":
                decay = RADIUS / np.sqrt(12.0 * (1.0 - POISSON**2) * reference[i, 2])
                band += (layer_size / decay) ** 2
            rows.append(Check(f"{name}, Q = {Q:g}", value, ours[i, k], band, "mesh"))
    return rows
