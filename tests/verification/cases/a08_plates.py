"""Plates under uniform pressure: A08 square, A14 circular."""

import numpy as np

from cases.paths import curve
from harness import Check, case
from patches import mapped_patch, spacing
from shellcut import Pressure, ShellMaterial, Statics, Support
from shellcut.mesh.structured import disc

YOUNG, POISSON = 1e6, 0.3


def stiffness(thickness):
    """Return the plate's D."""
    return YOUNG * thickness**3 / (12.0 * (1.0 - POISSON**2))


def shear_stiffness(thickness):
    """Return κ G h."""
    return 5.0 / 6.0 * 0.5 * YOUNG / (1 + POISSON) * thickness


MESHES = (4, 8, 16, 32)
MITC4 = {
    ("clamped", 0.01): (0.00125315335, 0.00126414384, 0.0012669188, 0.00126762083),
    ("simply supported", 0.01): (0.00404355261, 0.00405932416, 0.00406318006, 0.00406413855),
    ("clamped", 0.001): (0.00125071349, 0.00126167075, 0.00126442398, 0.00126511424),
    ("simply supported", 0.001): (0.00404144333, 0.00405723388, 0.00406109461, 0.00406205429),
}
EXACT_THIN = {"clamped": 0.00126532, "simply supported": 0.004062353}
SYMMETRY = [Support.symmetry("u0", "x"), Support.symmetry("v0", "y")]
EDGES = {
    "clamped": [Support.clamped("u1"), Support.clamped("v1")],
    "simply supported": [Support("u1", rotation="x"), Support("v1", rotation="y")],
}


def flat(u, v):
    """Map the unit square to a quarter of the plate, its middle at the origin."""
    zero = np.zeros_like(u)
    nodes = np.stack([0.5 * u, 0.5 * v, zero], axis=-1)
    return nodes, np.stack([zero, zero, zero + 1.0], axis=-1)


def deflection(edge, thickness, n, place=flat):
    """Return alpha of a quarter plate of n x n quads."""
    mesh = mapped_patch(n, n, place)
    material = ShellMaterial.homogeneous(young=YOUNG, poisson=POISSON, thickness=thickness)
    q = stiffness(thickness)
    model = Statics(mesh, material, supports=SYMMETRY + EDGES[edge], loads=[Pressure(q)])
    u, _ = model.linear()
    return float(u[0, 2])


@case(
    "A08",
    "Square plate, uniform pressure",
    axes=("quads a side of a quarter, N", "w D / (q L⁴) in the middle"),
)
def a08():
    """Side 1, h = 0.01 or 0.001, nu = 0.3; a quarter of N x N quads. Hard simple support: no tilt
    along the edge. Read: alpha = w D / (q L⁴) in the middle.

    Source: MITC4 values by OpenSees' ShellMITC4 and ASDShellQ4, which agree to nine digits on flat
    meshes; thin plate exact by Navier's series and a Ritz solution (Timoshenko 0.00126, 0.00406).
    The shear factor is 5/6, the library's default, as in the source.

    Bands: the same element, 0.2 %; the exact values to the order of the discretisation, 1 / N² of
    the quarter's quads, and the shear deflection of the thin plate, 5 (h / L)².
    """
    for (edge, h), values in MITC4.items():
        table = dict(zip(MESHES, values, strict=True))
        ours = {n: deflection(edge, h, n) for n in table}
        for n, value in table.items():
            name = f"alpha, {edge}, h/L = {h}, N = {n}"
            yield Check(name, value, ours[n], 2e-3, "same element")
        a08.CURVES[f"{edge}, h/L = {h}"] = curve(ours, ours.values(), table, table.values())
        if h == 0.001:
            n = max(table)
            band = 1.0 / n**2 + 5.0 * h**2
            name = f"alpha, {edge}, thin plate exact, N = {n}"
            yield Check(name, EXACT_THIN[edge], ours[n], band, "discretisation, 1/N²")


ROUND_THIN = {"clamped": 1.0 / 64.0, "simply supported": (5 + POISSON) / (64 * (1 + POISSON))}
CORES = (8, 16, 32)


def on_a_disc(edge, thickness, n_side):
    """Return w D / (q R⁴) in the middle, and the mean side of the quads."""
    mesh = disc(1.0, n_side=n_side)
    middle, rim = int(mesh.node_set("centre")[0]), mesh.node_set("rim")
    supports = {
        "clamped": [Support.clamped(rim)],
        "simply supported": [
            Support(rim, translation="z", rotation=""),
            Support([middle], translation="xy", rotation=""),
            Support([rim[0]], translation="y", rotation=""),
        ],
    }
    material = ShellMaterial.homogeneous(young=YOUNG, poisson=POISSON, thickness=thickness)
    load = Pressure(stiffness(thickness))
    u, _ = Statics(mesh, material, supports=supports[edge], loads=[load]).linear()
    return float(u[middle, 2]), spacing(mesh)


@case(
    "A14",
    "Circular plate, uniform pressure",
    axes=("mean side of the quads over the radius, s / R", "w D / (q R⁴) in the middle"),
)
def a14():
    """R = 1, h / R = 0.001, nu = 0.3; the library's disc, whose border is a polygon. Read: w D / (q
    R⁴) in the middle. The simple support fixes only the deflection of the border, so the directors
    are free to tilt along it, as on a round border (a hard support of a polygon's sides would tend
    to another limit, Babuska's paradox). A thick plate, h / R = 0.1, adds the shear deflection q R²
    / (4 k G h).

    Source: Timoshenko, 1/64 and (5 + nu) / (64 (1 + nu)); code_aster SSLS100, the same formula.

    Bands: to the order of the discretisation: (s / R)², s the mean side of the quads.
    """
    for thickness in (0.001, 0.1):
        for edge in ROUND_THIN:
            reference = ROUND_THIN[edge]
            if thickness > 0.01:
                reference += stiffness(thickness) / (4.0 * shear_stiffness(thickness))
            w, sizes = zip(*(on_a_disc(edge, thickness, n) for n in CORES), strict=True)
            for n, one, size in zip(CORES, w, sizes, strict=True):
                name = f"w D / q R⁴, {edge}, h/R = {thickness}, n_side = {n}"
                yield Check(name, reference, one, size**2, "discretisation, (s/R)²")
            a14.CURVES[f"{edge}, h/R = {thickness}"] = curve(
                sizes, w, [0.0, sizes[0]], [reference, reference]
            )
