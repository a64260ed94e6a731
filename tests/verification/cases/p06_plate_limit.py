"""P06 Limit load of a circular plate under uniform pressure, von Mises.

p = 6.516 M0/R² simply supported, 12.552 M0/R² clamped, M0 = sigma_y t²/4. The plate is so stiff
(E/sigma_y = 1e5, R/t = 10) that its deflection at the limit is a thousandth of its thickness, where
membrane action hides nothing. The pressure is raised until no equilibrium is found, not with a
thousandth of the last step either.

Source: Hopkins & Wang 1954; values of ../shared/METHOD2.md 9.
"""

from contextlib import suppress

from harness import Check
from shellcut import Support
from shellcut.loads.loads import Pressure
from shellcut.material import Elastic, Layer, Linear, Plastic, ShellMaterial
from shellcut.mesh.structured import disc
from shellcut.statics.statics import NoConvergence, Statics

ID, TITLE, FAST = "P06", "Limit load of a circular plate", False

YIELD, T, RADIUS = 1.0, 1.0, 10.0
M0 = YIELD * T**2 / 4.0
UNIT = M0 / RADIUS**2
MESH = "mesh, and nine points through the thickness"


def limit(support: Support, expected: float, n_side: int) -> float:
    """Return p R²/M0 above which there is no equilibrium."""
    law = Plastic(Elastic(1e5, 0.3, 1e-9), Linear(YIELD))
    film = ShellMaterial([Layer(law, T)], points_per_layer=9)
    plate = Statics(disc(RADIUS, n_side=n_side), film, supports=[support], loads=[Pressure(UNIT)])
    with suppress(NoConvergence):
        plate.load_steps([share * expected for share in (0.5, 0.8, 0.9, 0.95, 1.0, 1.1)])
    return plate.factor


def checks() -> list[Check]:
    rows = []
    for name, support, wanted in (
        ("simply supported", Support("rim", translation="xyz", rotation=""), 6.516),
        ("clamped", Support.clamped("rim"), 12.552),
    ):
        ours = limit(support, wanted, 10)
        rows.append(Check(f"p R²/M0, {name}", wanted, ours, 0.02, MESH))
    return rows
