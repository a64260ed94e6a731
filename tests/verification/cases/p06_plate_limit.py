"""P06 Limit load of a circular plate under uniform pressure, von Mises.

p = 6.516 M0/R² simply supported, 12.552 M0/R² clamped, M0 = sigma_y t²/4. The plate is so stiff
(E/sigma_y = 1e5, R/t = 10) that its deflection at the limit is a thousandth of its thickness, where
membrane action hides nothing. The pressure is raised by half a per cent at a time until the
deflection is twenty times the elastic one. A clamped border is a plastic hinge, which the quads
have at their Gauss points, beside the border: this lowers the limit by the first order of the
quads' size.

Source: Hopkins & Wang 1954.
"""

import numpy as np

import shellcut as sc
from harness import Check
from shellcut.mesh.structured import disc

ID, TITLE, FAST = "P06", "Limit load of a circular plate", False

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


def checks():
    ours, why = limit(6.516, 8, clamped=False), "mesh, and half a per cent of a step"
    yield Check("p R²/M0, simply supported", 6.516, ours, 0.02, why)
    coarse, fine = (limit(12.552, n, clamped=True) for n in (10, 20))
    yield Check("p R²/M0, clamped, 20 along a side", 12.552, fine, 0.1, "first order", gate=False)
    name = "p R²/M0, clamped, from 10 and 20"
    yield Check(name, 12.552, 2.0 * fine - coarse, 0.02, "mesh, and steps of a per cent")
