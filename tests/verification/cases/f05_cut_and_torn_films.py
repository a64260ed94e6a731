"""F05 Cut and torn polyester films: cutting force from the fracture energy of tearing.

Four 3M films of 15 to 70 µm, of which both were measured: the steady force of a razor blade through
the film, and the fracture energy by tearing it without a blade. Here the law has the fracture
energy of tearing, and the cutting force is computed.

Source: Millar, Patel, Wang, Chang, Balint and Williams, Procedia Structural Integrity 2 (2016)
190-196, Table 1 and section 4 [Millar2016]: thickness, modulus, G by tearing with its scatter, and
the cutting force; for 9736 the force is G by cutting, 3.8 kJ/m², times the thickness. Radius and
angle of the blade, friction and, for two films, the yield stress are not given. The specimens are
replaced by strips of 1.6 x 5 mm at 3 m/s, the blade by a sharp one of 10 µm and 10°; the law has
the paper's shape and 24 MPa, or the yield stress of 70 MPa of 9757.

The library gives G h of the tearing, so this tests whether cutting takes the fracture energy of
tearing. For information: the measured force, which docs/verification.md discusses.
"""

from dataclasses import dataclass

from courses import steady_works
from harness import Check, case, zero
from shellcut import CohesiveLaw, ShellMaterial, guillotine
from shellcut.tool.shapes import straight_blade

SIZE = 0.05  # mm
LENGTH = 5.0  # mm


@dataclass
class Film:
    """h [mm], E [MPa], G by tearing and its scatter [N/mm], strength [MPa], cutting force [N]."""

    name: str
    thickness: float
    young: float
    torn: float
    scatter: float
    strength: float
    force: float

    def law(self):
        """Return a law of the paper's shape with the fracture energy of tearing."""
        paper = CohesiveLaw()
        stress = self.strength / paper.strength
        stretch = self.torn / paper.fracture_energy / stress
        return CohesiveLaw(
            strength=self.strength,
            plateau=stress * paper.plateau,
            opening_a=stretch * paper.opening_a,
            opening_p=stretch * paper.opening_p,
            opening_u=stretch * paper.opening_u,
            onset=0.01 * stretch * paper.opening_u,
        )


FILMS = (
    Film("9730", 0.070, 1100.0, 2.3, 0.3, 24.0, 0.167),
    Film("9733", 0.050, 1380.0, 2.1, 0.2, 24.0, 0.092),
    Film("9736", 0.040, 1600.0, 3.6, 0.3, 24.0, 0.152),
    Film("9757", 0.015, 4000.0, 6.0, 0.5, 70.0, 0.053),
)


def cut(film):
    """Return the cut of a film."""
    return guillotine(
        SIZE,
        length=LENGTH,
        width=1.6,
        notch=0.4,
        speed=3000.0,
        law=film.law(),
        material=ShellMaterial.homogeneous(
            young=film.young, poisson=0.38, density=1.38e-9, thickness=film.thickness
        ),
        tool=straight_blade(length=LENGTH, height=3.0, half_thickness=0.005),
    )


@case("F05", "Cut and torn films", fast=False)
def f05():
    for film in FILMS:
        (ours,), worst, _ = steady_works(cut(film), SIZE, 2.0, "tool_work")
        exact, scatter = film.torn * film.thickness, film.scatter / film.torn
        yield Check(f"{film.name}: force, G by tearing times h, N", exact, ours, 0.03, "damping")
        what, why = f"{film.name}: measured force, N", "scatter of G"
        yield Check(what, film.force, ours, scatter, why, gate=False)
        yield zero(f"{film.name}: imbalance", worst, 5e-3, "time step")
