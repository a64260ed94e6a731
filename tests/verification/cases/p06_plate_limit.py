"""P06 Limit load of a circular plate under uniform pressure, von Mises.

p = 6.516 M0/R² simply supported, 12.552 M0/R² clamped, M0 = sigma_y t²/4. The plate is so stiff
(E/sigma_y = 1e5, R/t = 10) that its deflection at the limit is a thousandth of its thickness, where
membrane action hides nothing.

Source: Hopkins & Wang 1954; values of ../shared/METHOD2.md 9. Along the path the pressure rises to
the limit, and the last step is quoted.
"""

import numpy as np

from harness import Check
from shellcut import Support
from shellcut.loads.loads import Pressure
from shellcut.material import Elastic, Layer, Linear, Plastic, ShellMaterial
from shellcut.mesh.structured import disc
from shellcut.statics import Statics

ID, TITLE, FAST = "P06", "Limit load of a circular plate", False

YIELD, T, RADIUS = 1.0, 1.0, 10.0
M0 = YIELD * T**2 / 4.0
UNIT = M0 / RADIUS**2
MESH = "mesh, and nine points through the thickness"


def limit(support: Support, expected: float, n_side: int) -> float:
    """Return p R²/M0 where the deflection has grown twenty times beyond the elastic one."""
    law = Plastic(Elastic(1e5, 0.3, 1e-9), Linear(YIELD))
    film = ShellMaterial([Layer(law, T)], points_per_layer=9)
    plate = Statics(disc(RADIUS, n_side=n_side), film, supports=[support], loads=[Pressure(UNIT)])
    first = plate.load_steps([0.3 * expected])[-1]
    elastic = np.abs(first.displacement[:, 2]).max() / 0.3
    path = plate.arc_length(
        0.1 * expected,
        until=lambda e: np.abs(e.displacement[:, 2]).max() > 15.0 * elastic,
        most_steps=80,
        longest=30.0,
    )
    return path[-1].factor


def checks() -> list[Check]:
    rows = []
    for name, support, wanted in (
        ("simply supported", Support("rim", translation="xyz", rotation=""), 6.516),
        ("clamped", Support.clamped("rim"), 12.552),
    ):
        ours = limit(support, wanted, 12)
        rows.append(Check(f"p R²/M0, {name}", wanted, ours, 0.02, MESH))
    return rows
