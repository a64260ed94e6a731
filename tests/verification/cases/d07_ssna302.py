"""D07 code_aster SSNA302: simply supported circular plate, large deflection.

R = 10, h = 1 mm, E = 200 GPa, nu = 0.3, pressure 222.72 MPa. Read: w0.

Source: V6.01.302 (solid elements, SAMCEF): 1.5 mm; the support acts at one fibre of a thick plate.
Confidence low to medium: beside. Von Karman's theory, rim held in its plane at mid-height, gives
1.4355; ours has the transverse shear of a thick plate too.
"""

from harness import Check
from shellcut import Pressure, ShellMaterial, Statics, Support
from shellcut.mesh.structured import disc

ID, TITLE, FAST = "D07", "code_aster SSNA302", True

PRESSURE = 222.72


def deflection(scale: float) -> float:
    """Return w0 [mm] of the plate made ``scale`` times thinner at equal Q, times scale."""
    thickness = 1.0 / scale
    mesh = disc(10.0, n_side=16)
    material = ShellMaterial.homogeneous(young=2e5, poisson=0.3, thickness=thickness)
    plate = Statics(
        mesh,
        material,
        supports=[Support.pinned("rim")],
        loads=[Pressure(PRESSURE * thickness**4)],
    )
    path = plate.load_steps([0.05, 0.2, 0.5, 1.0])
    return float(path[-1].displacement[mesh.node_set("centre"), 2].mean()) * scale


def checks() -> list[Check]:
    thick, thin = deflection(1.0), deflection(100.0)
    return [
        Check("w0, mm, SAMCEF solids", 1.5, thick, 0.05, "another model", gate=False),
        Check("w0 / h, thick, von Karman", 1.4355, thick, 0.05, "another model", gate=False),
        Check("w0 / h, h / 100, von Karman", 1.4355, thin, 2.0 / 16**2, "mesh", gate=False),
    ]
