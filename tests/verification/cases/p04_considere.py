"""P04 Considère: the largest force that a strip of a hardening film carries.

sigma = K eps^n, rigid before it yields: the force of a strip with free sides has its maximum at eps
= n, F = A0 K n^n exp(-n). With fixed sides it is at eps_1 = n as well, and larger by (2/sqrt
3)^(n+1). As a point, and as a strip of 4 x 2 quads by statics, drawn out beyond the maximum; it
stays a prism. The maximum is flat: the law is a table of so many points that its place is seen to a
thousandth.

Source: Considère 1885; in plane strain by the equivalent strain 2/sqrt 3 eps_1.
"""

import numpy as np
from scipy.optimize import minimize_scalar

from harness import Check
from shellcut import Elastic, Layer, Plastic, ShellMaterial, Statics, Support, Table
from shellcut.material import MaterialPoint
from shellcut.mesh.structured import rectangle

ID, TITLE, FAST = "P04", "Considère's maximum", False

K, EXPONENT, H = 100.0, 0.2, 0.1
PLASTIC = np.append(0.0, np.geomspace(1e-7, 1.0, 8000))
FILM = Plastic(Elastic(1e6, 0.3, 1e-9), Table(PLASTIC, K * (1e-5 + PLASTIC) ** EXPONENT))
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
    strip = Statics(
        mesh,
        ShellMaterial([Layer(FILM, H)], points_per_layer=1),
        supports=[
            Support("left", translation="x"),
            Support("right", translation="x"),
            Support(np.arange(mesh.n_node), translation="z", rotation="xyz"),
            Support(corner, translation="y", rotation=""),
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


def checks():
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
