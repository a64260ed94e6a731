"""Limits of films that yield: P04 a strip in tension, P06 a plate under pressure."""

import numpy as np
from scipy.optimize import minimize_scalar

import shellcut as sc
from harness import Check, case
from shellcut.material import MaterialPoint
from shellcut.mesh.structured import disc, rectangle

K, EXPONENT, H = 100.0, 0.2, 0.1
PLASTIC = np.append(0.0, np.geomspace(1e-7, 1.0, 8000))
FILM = sc.Plastic(sc.Elastic(1e6, 0.3, 1e-9), sc.Table(PLASTIC, K * (1e-5 + PLASTIC) ** EXPONENT))
ELASTIC = "elastic strain 1e-4 and first yield at 1e-5"


def largest_of_point(sides_held):
    """Return the nominal strength [MPa] and the strain at which it is reached."""

    def carried(strain):
        point = MaterialPoint(FILM)
        return -float(point.pull(strain, sides_held=sides_held).stress[0]) * np.exp(-strain)

    found = minimize_scalar(carried, bracket=(0.1, 0.2, 0.3), tol=1e-9)
    return -found.fun, found.x


def largest_of_strip():
    """Return the same of a strip whose end is drawn out step by step."""
    mesh = rectangle(4.0, 2.0, n_x=4, n_y=2)
    corner = np.flatnonzero(np.isclose(mesh.nodes[:, 1], mesh.nodes[:, 1].min()))
    strip = sc.Statics(
        mesh,
        sc.ShellMaterial([sc.Layer(FILM, H)], points_per_layer=1),
        supports=[
            sc.Support("left", translation="x"),
            sc.Support("right", translation="x"),
            sc.Support(np.arange(mesh.n_node), translation="z", rotation="xyz"),
            sc.Support(corner, translation="y", rotation=""),
        ],
    )
    end, before = mesh.node_set("right"), 0.0
    strains, stresses = [], []
    for strain in (0.02, 0.06, 0.1, 0.14, 0.17, 0.18, 0.19, 0.2, 0.21, 0.22, 0.23):
        longer = mesh.nodes[:, 0] * (np.exp(strain) - np.exp(before))
        thinner = mesh.nodes[:, 1] * (np.exp(-0.5 * strain) - np.exp(-0.5 * before))
        strip.move(np.stack([longer, thinner, 0.0 * longer], axis=1))
        found = strip.load_steps([1.0])[-1]
        strains.append(strain)
        stresses.append(abs(float(found.reaction[end, 0].sum())) / (2.0 * H))
        before = strain
    fit = np.polyfit(strains[-7:], stresses[-7:], 3)
    top = min(np.roots(np.polyder(fit)).real, key=lambda root: abs(root - EXPONENT))
    return float(np.polyval(fit, top)), float(top)


@case("P04", "Considère's maximum", fast=False)
def p04():
    """sigma = K eps^n, rigid before it yields: the force of a strip with free sides has its maximum
    at eps = n, F = A0 K n^n exp(-n). With fixed sides it is at eps_1 = n as well, and larger by
    (2/sqrt 3)^(n+1). As a point, and as a strip of 4 x 2 quads by statics, drawn out beyond the
    maximum; it stays a prism. The maximum is flat: the law is a table of so many points that its
    place is seen to a thousandth.

    Source: Considère 1885; in plane strain by the equivalent strain 2/sqrt 3 eps_1.
    """
    n = EXPONENT
    closed = K * n**n * np.exp(-n)
    for name, held, factor in (
        ("free sides", False, 1.0),
        ("fixed sides", True, (2 / 3**0.5) ** (n + 1)),
    ):
        strength, strain = largest_of_point(held)
        yield Check(f"strength [MPa], {name}", factor * closed, strength, 1e-3, ELASTIC)
        yield Check(f"strain, {name}", n, strain, 2e-3, ELASTIC)
    strength, strain = largest_of_strip()
    yield Check("strength of a strip [MPa]", closed, strength, 1e-3, ELASTIC)
    yield Check("strain of a strip", n, strain, 1e-2, "cubic through seven steps")


YIELD, T, RADIUS = 1.0, 1.0, 10.0
M0 = YIELD * T**2 / 4.0
UNIT = M0 / RADIUS**2


def limit(expected, n_side, *, clamped):
    """Return p R²/M0 at which the deflection is twenty times that of the elastic plate."""
    mesh = disc(RADIUS, n_side=n_side)
    supports = [sc.Support.clamped("rim")] if clamped else _on_its_rim(mesh)
    law = sc.Plastic(sc.Elastic(1e5, 0.3, 1e-9), sc.Linear(YIELD))
    film = sc.ShellMaterial([sc.Layer(law, T)], points_per_layer=9)
    plate = sc.Statics(mesh, film, supports=supports, loads=[sc.Pressure(UNIT)])
    first = plate.load_steps([0.3 * expected])[-1]
    soft = np.abs(first.displacement[:, 2]).max() / 0.3
    for share in (0.6, 0.8, 0.9, *np.arange(0.94, 1.3, 0.005)):
        found = plate.load_steps([share * expected])[-1]
        if np.abs(found.displacement[:, 2]).max() > 20.0 * soft:
            break
    return found.factor


def _on_its_rim(mesh):
    """Return a simple support, and what keeps the plate from moving and turning in its plane."""
    aside = int(np.argmax(mesh.nodes[:, 0]))
    return [
        sc.Support("rim", translation="z", rotation=""),
        sc.Support("centre", translation="xy", rotation=""),
        sc.Support([aside], translation="y", rotation=""),
    ]


@case("P06", "Limit load of a circular plate", fast=False)
def p06():
    """Uniform pressure, von Mises: p = 6.516 M0/R² simply supported, 12.552 M0/R² clamped, M0 =
    sigma_y t²/4. The plate is so stiff (E/sigma_y = 1e5, R/t = 10) that its deflection at the limit
    is a thousandth of its thickness, where membrane action hides nothing. The pressure is raised by
    half a per cent at a time until the deflection is twenty times the elastic one. A clamped border
    is a plastic hinge, which the quads have at their Gauss points, beside the border: this lowers
    the limit by the first order of the quads' size.

    Source: Hopkins & Wang 1954.
    """
    ours, why = limit(6.516, 8, clamped=False), "mesh, and half a per cent of a step"
    yield Check("p R²/M0, simply supported", 6.516, ours, 0.02, why)
    coarse, fine = (limit(12.552, n, clamped=True) for n in (10, 20))
    yield Check("p R²/M0, clamped, 20 along a side", 12.552, fine, 0.1, "first order", gate=False)
    name = "p R²/M0, clamped, from 10 and 20"
    yield Check(name, 12.552, 2.0 * fine - coarse, 0.02, "mesh, and steps of a per cent")
