"""Contact holds whatever the film: nodes stay out of the tool, and it gives the film no energy.

Thick films push with hundreds of newtons; where a tooth ends their nodes spring off it at 100 m/s,
as far in a step as a thin film is thick, and hit it again. Thin ones flutter.
"""

from dataclasses import dataclass

import pytest

from shellcut.material.shell_material import ShellMaterial
from shellcut.models import guillotine, opening_test
from shellcut.simulation.simulation import Simulation
from shellcut.tool.shapes import straight_blade


@dataclass(frozen=True)
class Shares:
    """What contact came to, over the tool's work, and how deep nodes went over its thickness."""

    held: float
    absorbed: float
    imbalance: float
    depth: float


def shares(sim: Simulation) -> Shares:
    ledger = sim.close_ledger()
    assert sim.tool is not None
    return Shares(
        ledger.relative(ledger.contact_work),
        ledger.relative(ledger.contact_absorbed),
        ledger.relative(ledger.imbalance),
        sim.contact.deepest / sim.tool.half_thickness(),
    )


@pytest.mark.parametrize("thickness", [0.02, 0.074, 0.3, 0.6, 1.0])
def test_a_short_blade_through_a_strip_of_any_thickness(thickness: float) -> None:
    # The nodes of the flanks come off the back end of the blade one by one. Before, of 0.6 mm:
    # 0.21 mm deep, 2 % of the work from nowhere; of 1 mm 0.20 mm and 2 %.
    blade = straight_blade(length=1.2, height=2.0, half_thickness=0.35, wedge_half_angle_deg=20.0)
    film = ShellMaterial.homogeneous(thickness=thickness)
    case = guillotine(0.8, length=9.6, width=4.8, notch=1.6, travel=6.0, tool=blade, material=film)
    sim = case.simulation
    sim.run(case.duration)
    found = shares(sim)
    # The step is that of the film, not of its contact: 1.4e-7 s whatever the thickness.
    assert sim.state.time / sim.state.step == pytest.approx(1.4e-7, rel=0.06)
    # Discretisation. Measured 0.05 to 0.16 of V / A, which is 0.135 mm, and -0.35 to +0.34 % of the
    # work; the imbalance is largest in the thickest, 0.42 %.
    assert found.depth < 0.2
    assert abs(found.held) < 6e-3
    assert abs(found.absorbed) < 1e-3
    assert abs(found.imbalance) < 6e-3


@pytest.mark.slow
@pytest.mark.parametrize(
    ("thickness", "young"),
    [
        *((thickness, 1678.0) for thickness in (0.005, 0.02, 0.15, 0.3, 0.6, 1.0)),
        *((0.074, 200.0), (0.3, 200.0)),
    ],
)
def test_the_opening_of_any_film(thickness: float, young: float) -> None:
    # Before, of 1678 MPa: 18 % of the work from nowhere at 5 µm, 4.7 % at 0.3 mm, 2.7 % at 0.6 mm;
    # 0.33 to 0.37 mm deep into teeth of 0.35 mm from 0.3 mm on, and steps of a third at 5 µm.
    film = ShellMaterial.homogeneous(thickness=thickness, young=young)
    case = opening_test("quick", material=film)
    sim = case.simulation
    sim.run(case.duration)
    found = shares(sim)
    assert len(sim.state.split_log) == 72
    # V / A of a tooth is 0.205 mm. Measured 0.014 to 0.17 of it; -0.35 to +0.24 % of the work, of
    # which absorbed jumps are 0.12 % at most.
    assert found.depth < 0.25
    assert abs(found.held) < 6e-3
    assert abs(found.absorbed) < 3e-3
    assert abs(found.imbalance) < 6e-3
