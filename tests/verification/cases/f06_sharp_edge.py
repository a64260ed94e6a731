"""F06 Sharp edge: what the edge severs, over its radius.

The guillotine of F04 and the opening test of 2010, with an edge that severs the film: G_0 = 1 N/mm
with a razor, H = 450 MPa, the paper's film and law (G = 43.5 N/mm, r_c = 0.047 mm). And a film that
is torn at 10 N/mm and cut with a razor at 1 N/mm. Read: work of the cables and of the tool per
length of cut, over G_s h with G_s = min(G, G_0 + 2 r H).

Source: exact as a statement of energy, once the law is taken (docs/theory/cables.md). For
information: Gent and Wang, J. Polym. Sci. B 34 (1996) 2231 [GentWang1996], LDPE 1 kJ/m² cut and
about 10 torn; a run with the razor has to give the first.

Bands: cables 1 %, whole node periods of a sawtooth; from r_c on 3 %, as in F04. The work of the
tool includes damping, 0.1 to 1 N/mm whatever the radius: it is printed for information.
"""

from dataclasses import replace
from itertools import pairwise

import numpy as np

from blunt_edge import cut
from cases.paths import curve
from courses import course, steady_works
from harness import Check, case, zero
from shellcut import CohesiveLaw, ShellMaterial, guillotine, opening_test
from shellcut.models.opening import steady_work_per_radian
from shellcut.tool.shapes import straight_blade, tooth_ring

EDGE = {"cutting_energy": 1.0, "severing_pressure": 450.0}
LAW = CohesiveLaw(**EDGE)
SIZES = (0.8, 0.4, 0.2)  # mm
RADII = (0.005, 0.01, 0.02, 0.04)  # mm
ROW = (1e-3, 5e-3, 0.01, 0.02, 0.03, 0.04, 0.047, 0.0475, 0.06)  # mm
TORN, RAZOR = 10.0, 1.0  # N/mm


def opening(radius, law):
    """Return cables' and tool's work per radian over theory, from 30 to 70°, and the imbalance."""
    case = opening_test(
        "M1",
        tool=tooth_ring(edge_radius=radius),
        law=law,
        angle_deg=70.0,
        duration=6e-3 * 70.0 / 95.0,
    )
    names = "cohesive_work", "tool_work", "imbalance"
    angle, *works, imbalance = course(case.simulation, case.duration, *names, every=1, close=False)
    late = angle > np.radians(30.0)
    exact = steady_work_per_radian(law=law.at_edge(radius))
    slopes = [float(np.polyfit(angle[late], work[late], 1)[0]) / exact for work in works]
    return (*slopes, float(np.abs(imbalance).max() / works[1].max()))


def ldpe():
    """Return cables' and tool's work per area of cut with a razor [N/mm]."""
    size, length, thickness = 0.08, 3.2, 0.1
    stretch = TORN / CohesiveLaw(strength=9.0, plateau=7.0).fracture_energy
    law = CohesiveLaw(
        strength=9.0,
        plateau=7.0,
        opening_a=0.5 * stretch,
        opening_p=3.0 * stretch,
        opening_u=4.0 * stretch,
        onset=1e-3,  # ring of new cables: of sigma_F onset beside G_0
        cutting_energy=RAZOR,
    )
    case = guillotine(
        size,
        length=length,
        width=2.4,
        notch=0.4,
        travel=2.6,
        speed=3000.0,
        law=law,
        material=ShellMaterial.homogeneous(
            young=200.0, poisson=0.4, density=0.92e-9, thickness=thickness
        ),
        tool=straight_blade(length=length, height=3.0, half_thickness=0.01),
    )
    works, _, _ = steady_works(case, size, 1.2, "cohesive_work", "tool_work")
    return [work / thickness for work in works]


@case(
    "F06",
    "Sharp edge",
    fast=False,
    axes=("radius r of the edge, mm", "work of the cables over h, N/mm"),
)
def f06():
    worst = 0.0
    for size in SIZES:
        for radius in RADII:
            force, cables, _, _, imbalance = cut(radius, size, **EDGE)
            name = f"quads of {size:g} mm, r = {1e3 * radius:g} um"
            yield Check(f"{name}: cables / G_s h", 1.0, cables, 0.01, "whole periods")
            yield Check(f"{name}: F / G_s h", 1.0, force, 0.05, "damping", gate=False)
            worst = max(worst, imbalance)
    exact = [LAW.at_edge(radius).fracture_energy for radius in ROW]
    ours = []
    for radius, energy in zip(ROW, exact, strict=True):
        _, cables, _, _, imbalance = cut(radius, 0.4, **EDGE)
        ours.append(cables * energy)
        band, why = (0.01, "whole periods") if radius < LAW.blunt_radius else (0.03, "as F04")
        name = f"r = {1e3 * radius:g} um: cables / h, N/mm"
        yield Check(name, energy, ours[-1], band, why)
        worst = max(worst, imbalance)
    severed = [energy for energy, r in zip(ours, ROW, strict=True) if r < LAW.blunt_radius]
    grows = float(all(b > a for a, b in pairwise(severed)))
    yield Check("it grows with r up to r_c (1: yes)", 1.0, grows, 0.0, "exact")
    for law in (LAW, replace(LAW, severing_pressure=1450.0)):
        cables, tool, imbalance = opening(0.01, law)
        name = f"opening M1, r = 10 um, G_s = {law.at_edge(0.01).fracture_energy:g} N/mm"
        yield Check(f"{name}: dW_coh/dtheta over theory", 1.0, cables, 0.01, "periods")
        yield Check(f"{name}: dW/dtheta", 1.0, tool, 0.06, "damping", gate=False)
        worst = max(worst, imbalance)
    yield zero("largest imbalance / work", worst, 1e-4, "time step")
    cables, tool = ldpe()
    yield Check("LDPE cut: cables / h, N/mm", RAZOR, cables, 0.02, "periods")
    yield Check("LDPE: torn over cut [GentWang1996]", 10.0, TORN / tool, 0.2, "damping", gate=False)
    f06.CURVES["work of the cables"] = curve(ROW, ours, ROW, exact)
