"""Frequencies of flat plates and membranes: circular C01 and C03, square C04, C05, C06, C09.

Plates: nu = 0.3, side or radius a = 1000 h. Read: omega a² sqrt(rho h / D), of squares the first
six.

Band: the kind of error is that of the mesh. A mode of wave number k on quads of side s has, by the
one-dimensional analysis of a linear shear beam without locking on lumped mass, an error of
(k s)² / 24 in its frequency; three times as much is allowed, and 2e-4 for the digits of the tables
and what shear and rotary inertia take at a / h = 1000. The observed order must be 2.
"""

import numpy as np
from scipy.special import iv, jv

from cases.paths import order_curve
from harness import Check, case, zero
from patches import spacing
from shellcut import ShellMaterial, Support
from shellcut.mesh.structured import disc, rectangle
from shellcut.statics.statics import Statics

SIDE = RADIUS = 100.0
MATERIAL = ShellMaterial.homogeneous(young=1000.0, poisson=0.3, density=1e-9, thickness=1e-3 * SIDE)
MESHES = (16, 32)  # quads a side of a square, or of a disc's core
TABLE_DIGITS = 2e-4
WHY = "mesh, (k s)²/8"
ERROR = "relative error of the first frequency"
OVER_RADIUS = "side of a quad over the radius, s / a", ERROR


def mesh_band(wave_number, size):
    """Return the allowed relative error of a frequency."""
    return (wave_number * size) ** 2 / 8.0 + TABLE_DIGITS


def observed_order(error):
    """Return the order of the last halving of the mesh."""
    return float(np.log2(abs(error[-2] / error[-1])))


def unit(length, material):
    """Return sqrt(D / rho h) / length² of a thin plate [rad/s]."""
    m = material.layers[0].material
    stiffness = m.young * material.thickness**3 / (12.0 * (1.0 - m.poisson**2))
    return float(np.sqrt(stiffness / (m.density * material.thickness)) / length**2)


def likest(mesh, modes, radial, n):
    """Return the frequency [Hz] of the mode most like radial(r) cos n(phi - phi_0)."""
    x, y = mesh.nodes[:, 0], mesh.nodes[:, 1]
    angle = np.arctan2(y, x)
    w = modes.shape[:, :, 2]
    likeness = np.zeros(len(w))
    for part in (np.cos(n * angle), np.sin(n * angle)):
        likeness += (w @ (radial * part)) ** 2 / (w * w).sum(axis=1)
    return float(modes.frequency[likeness.argmax()])


def disc_rows(of, quantity, exact, wave, parameters):
    """Compare modes (n, s) on two meshes with exact parameters; wave : k a of one of these."""
    error, sizes = [], []
    for n_side in MESHES:
        ours, size = parameters(n_side)
        for (n, s), one in ours.items():
            value = exact[n][s]
            band = mesh_band(wave(value) / RADIUS, size)
            yield Check(f"{quantity}, n = {n}, s = {s}, n_side = {n_side}", value, one, band, WHY)
        error.append(ours[0, 0] / exact[0][0] - 1.0)
        sizes.append(size / RADIUS)
    of.CURVES["mode 1"] = order_curve(sizes, error)
    order = observed_order(error) / np.log2(sizes[0] / sizes[1])
    yield Check("order, mode 1, n_side = 16 to 32", 2.0, order, 0.3, "order", absolute=True)


CLAMPED = {0: [10.21583, 39.77115, 89.10414], 1: [21.2604, 60.82867, 120.07924]}


def clamped_disc(n_side):
    """Return lambda² of the modes (n, s), and the spacing."""
    mesh = disc(RADIUS, n_side=n_side)
    modes = Statics(mesh, MATERIAL, supports=[Support.clamped("rim")]).modes(40)
    r = np.hypot(mesh.nodes[:, 0], mesh.nodes[:, 1]) / RADIUS
    ours = {}
    for n, row in CLAMPED.items():
        for s, value in enumerate(row):
            k = np.sqrt(value)
            radial = jv(n, k * r) - jv(n, k) / iv(n, k) * iv(n, k * r)
            frequency = likest(mesh, modes, radial, n)
            ours[n, s] = 2.0 * np.pi * frequency / unit(RADIUS, MATERIAL)
    return ours, spacing(mesh)


@case("C01", "Clamped circular plate, frequencies", axes=OVER_RADIUS)
def c01():
    """Radius a, nu = 0.3, a / h = 1000. Read: lambda² = omega a² sqrt(rho h / D) of the modes with
    n nodal diameters and s nodal circles, found by their likeness to the exact shape J_n(k r) -
    J_n(k a) / I_n(k a) I_n(k r).

    Source: exact, J_n I_n' - I_n J_n' = 0 (Leissa, NASA SP-160). Band: s the mean spacing.
    """
    return disc_rows(c01, "lambda²", CLAMPED, np.sqrt, clamped_disc)


STRETCH, TENSE_YOUNG, TENSE_POISSON, TENSE_DENSITY = 1.01, 1000.0, 0.3, 1e-9
TENSE = ShellMaterial.homogeneous(
    young=TENSE_YOUNG, poisson=TENSE_POISSON, density=TENSE_DENSITY, thickness=1e-4 * RADIUS
)
ZEROS = {
    0: [2.404826, 5.520078, 8.653728],
    1: [3.831706, 7.015587, 10.173468],
    2: [5.135622, 8.417244, 11.619841],
    3: [6.380162, 9.761023, 13.015201],
}


def stretched_disc(n_side):
    """Return k of the modes (n, s), and the spacing."""
    mesh = disc(RADIUS, n_side=n_side)
    film = Statics(mesh, TENSE, supports=[Support.pinned("rim")])
    film.state.node.x[: mesh.n_node, :2] *= STRETCH  # in equilibrium: the stress is uniform
    stress = TENSE_YOUNG / (1.0 - TENSE_POISSON) * 0.5 * (STRETCH**2 - 1.0)
    modes = film.modes(40)
    r = np.hypot(mesh.nodes[:, 0], mesh.nodes[:, 1]) / RADIUS
    to_k = 2.0 * np.pi * RADIUS / np.sqrt(stress / TENSE_DENSITY)
    ours = {
        (n, s): to_k * likest(mesh, modes, jv(n, k * r), n)
        for n, row in ZEROS.items()
        for s, k in enumerate(row)
    }
    return ours, spacing(mesh)


@case("C03", "Circular membrane, frequencies", axes=OVER_RADIUS)
def c03():
    """Radius a, a / h = 1e4, stretched by 1 %, border fixed. Read: k = omega a / sqrt(T / m) of the
    modes with n nodal diameters and s circles, found by their likeness to J_n(k r). With S the
    second Piola-Kirchhoff stress of the stretch, T per present length and m per present area, k is
    omega a / sqrt(S / rho), a of the reference. The border is free to turn: bending then has no
    boundary layer, and adds (k / a)² D / 2 T < 1e-5 to a frequency.

    Source: exact, zeros of J_n.
    """
    return disc_rows(c03, "k", ZEROS, float, stretched_disc)


def plate_parameters(n, supports, n_mode):
    """Return omega a² sqrt(rho h / D) of the first modes on n x n quads."""
    square = rectangle(SIDE, SIDE, n_x=n, n_y=n)
    modes = Statics(square, MATERIAL, supports=supports).modes(n_mode)
    return 2.0 * np.pi * modes.frequency / unit(SIDE, MATERIAL)


def square_checks(reference, supports):
    """Compare the first modes on two meshes."""
    for n in MESHES:
        ours = plate_parameters(n, supports, len(reference))
        for k, (value, one) in enumerate(zip(reference, ours, strict=True), start=1):
            band = mesh_band(np.sqrt(value) / SIDE, SIDE / n)
            yield Check(f"lambda², mode {k}, N = {n}", value, one, band, WHY)


DOUBLE_SINE = [np.pi**2 * k for k in (2, 5, 5, 8, 10, 10)]
TURNS = {"left": "xz", "right": "xz", "bottom": "yz", "top": "yz"}
HARD = [Support(side, rotation=axes) for side, axes in TURNS.items()]


@case(
    "C04",
    "Square plate SSSS, frequencies",
    axes=("side of a quad over that of the plate, s / a", ERROR),
)
def c04():
    """Hard simple support: no tilt along the edge, as in the double sine.

    Source: exact, pi² (m² + n²); the same numbers by Ritz with Legendre polynomials.
    """
    yield from square_checks(DOUBLE_SINE, HARD)
    sizes = (8, 16, 32, 64)
    error = [plate_parameters(n, HARD, 1)[0] / DOUBLE_SINE[0] - 1.0 for n in sizes]
    c04.CURVES["mode 1"] = order_curve([1.0 / n for n in sizes], error)
    order = observed_order(error[:-1])
    yield Check("order, mode 1, N = 16 to 32", 2.0, order, 0.1, "order", absolute=True)


@case("C05", "Square plate CCCC, frequencies")
def c05():
    """Source: Ritz, 10 x 10 Legendre polynomials, to about 0.02 % (Leissa 1973: at most 35.992)."""
    ritz = [35.9852, 73.3939, 73.3939, 108.2165, 131.5808, 132.2049]
    return square_checks(ritz, [Support.clamped(side) for side in TURNS])


@case("C06", "Square plate CFFF, frequencies")
def c06():
    """Source: Ritz, as C05; Barton 1951 (code_aster SDLS01) has bounds 0.2 to 0.6 % higher."""
    ritz = [3.4713, 8.5077, 21.2875, 27.1992, 30.9602, 54.1935]
    return square_checks(ritz, [Support.clamped("left")])


NAFEMS = [1.622, 2.36, 2.922, 4.19, 4.19, 7.356, 7.356, 7.668]
LAST_DIGIT = [0.0005, 0.005, 0.0005, 0.005, 0.005, 0.0005, 0.0005, 0.0005]


@case("C09", "NAFEMS FV12 free square plate")
def c09():
    """10 m x 10 m, t = 0.05 m, E = 200 GPa, nu = 0.3, rho = 8000 kg/m³, all edges free. Read: the
    frequencies after the six rigid modes.

    Source: NAFEMS FV12 as in FinEtoolsFlexStructures.jl, FV12_vibration_examples.jl. Band: also
    half a digit of the table. The tangent is singular: no support holds the rigid modes.

    The table is of thin plates. At t / a = 1 / 200 shear along the free edges lowers the converged
    frequencies by 0.1 % (f7: -0.13 % on 96 x 96; -0.04 % with a tenth of the thickness).
    """
    side = 1e4  # mm
    thick = ShellMaterial.homogeneous(young=200e3, poisson=0.3, density=8e-9, thickness=50.0)
    plate = Statics(rectangle(side, side, n_x=32, n_y=32), thick)
    frequency = plate.modes(6 + len(NAFEMS)).frequency
    rigid = float(frequency[5])
    yield zero("largest of the rigid modes, Hz", rigid, 1e-2, "round-off")
    for k, value in enumerate(NAFEMS):
        wave_number = np.sqrt(2.0 * np.pi * value / unit(1.0, thick))
        band = mesh_band(wave_number, side / 32) + LAST_DIGIT[k] / value
        ours = float(frequency[6 + k])
        yield Check(f"f{k + 7}, N = 32, Hz", value, ours, band, f"{WHY}, digits")
