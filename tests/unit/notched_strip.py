"""A small run with all that a run may have, for the tests of restart and records."""

import numpy as np

from shellcut.cables.cohesive_law import CohesiveLaw
from shellcut.fracture.options import Fracture
from shellcut.loads.loads import EdgeTraction, Gravity, NodalForce, Pressure
from shellcut.loads.supports import Support
from shellcut.material.shell_material import ShellMaterial
from shellcut.mesh.structured import rectangle
from shellcut.simulation.simulation import Simulation
from shellcut.tool.motion import StraightMotion
from shellcut.tool.shapes import straight_blade


def cutting(
    *,
    size=0.4,
    material=None,
    blade=0.1,
    motion=None,
    strength=18.0,
    pressure=1e-3,
    set_name="sides",
    pulled=True,
    **options,
):
    """A blade that cuts a notched strip whose long sides move, under loads of every kind.

    pulled : whether they move, so that the film goes aside by a hundredth of the blade's way.
    """
    mesh = rectangle(8 * size, 4 * size, n_x=8, n_y=4)
    mesh = mesh.cut([18, 19])
    sides = {name: mesh.node_set(name) for name in ("bottom", "top")}
    mesh = mesh.with_sets(node_sets={"sides": [*sides["bottom"], *sides["top"]]})
    options.setdefault("fracture", Fracture(path="edges", check_every=5))
    short = CohesiveLaw(strength=strength, opening_a=0.05, opening_p=0.2, opening_u=0.3)
    options.setdefault("law", short)
    supports = [Support.clamped(sides["bottom"]), Support.clamped(sides["top"])]
    if set_name != "sides":
        supports = supports[:1]
    elif pulled:
        supports = [
            Support(sides["bottom"], velocity={"y": lambda t: -200.0 * np.sin(3e4 * t)}),
            Support(sides["top"], velocity={"y": lambda t: 300.0}),
        ]
    return Simulation(
        mesh,
        material or ShellMaterial.homogeneous(),
        supports=supports,
        loads=[
            Pressure(pressure),
            Pressure(1e-3, following=True, factor=lambda t: 1.0 + 1e4 * t),
            Gravity((0.0, 0.0, -1e6)),
            EdgeTraction("right", (0.05, 0.0, 0.0), factor=lambda t: 2e4 * t),
            NodalForce([12], (0.0, 0.0, 1e-4)),
        ],
        tool=straight_blade(half_thickness=blade, length=2.0, height=2.0),
        motion=motion or StraightMotion((1, 0, 0), 2e4, ramp=5e-6),
        **options,
    )
