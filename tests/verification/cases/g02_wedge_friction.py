"""G02 A wedge with Coulomb friction splits a stiff strip: the force over G h.

A plate 1 mm thick and 2 mm wide, free at its sides and clamped at its far end, is split along its
middle by a long wedge of half-angle a that drives the crack ahead of itself. The two arms bend in
their plane like beams until they lie on the faces of the wedge, and slide on. The cables never meet
the edge. Read: force over G h, from the work of the tool, and the work of friction over that.

Source: Williams and Patel (2016), rederived. With N on each face, F = 2 N (sin a + mu cos a), and F
= G h + 2 mu N: with mu = tan b

    F / (G h) = sin(a + b) / (sin(a + b) - sin b),   friction / F = sin b / sin(a + b).

Bands: 5 % as asked of a mesh with four quads over each arm; of it the damping of the cables that
break one by one takes some 2 %. What is left of the force is stored: within 1 % of it.
"""

import numpy as np

from courses import course, moved_by
from harness import Check, zero
from shellcut import CohesiveLaw, Contact, Fracture, ShellMaterial, Simulation, Support
from shellcut.mesh.structured import rectangle
from shellcut.tool.motion import StraightMotion
from shellcut.tool.shapes import straight_blade

ID, TITLE, FAST = "G02", "Wedge with friction", False

THICKNESS, ARM, SIZE, SPEED = 1.0, 1.0, 0.25, 6000.0  # mm, mm, mm, mm/s
LAW = CohesiveLaw(
    strength=9.0, plateau=6.0, opening_a=0.01, opening_p=0.06, opening_u=0.08, onset=8e-4
)
TRAVEL = {10.0: 20.0, 20.0: 28.0, 30.0: 40.0}  # mm: of them the first half until it is steady


def force(angle_deg, friction):
    """Return force over G h, friction over force, and the rest of the energy balance over force."""
    travel = TRAVEL[angle_deg]
    length = travel + 25.0
    strip = rectangle(length, 2.0 * ARM, size=SIZE)
    line = strip.nodes_where(lambda x, y, z: (np.abs(y) < 1e-9) & (x < 4.0 * ARM + 1e-9))
    strip = strip.cut(line[np.argsort(strip.nodes[line, 0])])
    wedge = straight_blade(
        wedge_half_angle_deg=angle_deg, half_thickness=30.0, length=length, height=3.0
    )
    sim = Simulation(
        strip,
        ShellMaterial.homogeneous(thickness=THICKNESS),
        supports=[Support.clamped("right")],
        tool=wedge.translated((-0.01, 0.0, 0.0)),
        motion=StraightMotion((1.0, 0.0, 0.0), speed=SPEED, ramp=1e-4),
        law=LAW,
        contact=Contact(friction=friction),
        fracture=Fracture(path="edges", blade_cut=False, turn_limit_deg=20.0),
        directional=False,
        damping_alpha=20.0,
    )

    names = "tool_work", "friction_work", "cohesive_work", "damping", "imbalance"
    path, *works = course(sim, moved_by(travel), *names, every=50)
    steady = path > 0.5 * travel
    # The slope by least squares: the force is a sawtooth of the nodes.
    slopes = [np.polyfit(path[steady], work[steady], 1)[0] for work in works]
    tool, rubbed, cables, damped, missing = slopes
    left = tool - rubbed - cables - damped - missing
    return tool / (LAW.fracture_energy * THICKNESS), rubbed / tool, left / tool


def checks():
    for friction in (0.1, 0.2, 0.3):
        for angle in (10.0, 20.0, 30.0):
            ratio, rubbed, left = force(angle, friction)
            a, b = np.radians(angle), np.arctan(friction)
            said = f"mu {friction}, half-angle {angle:.0f} deg"
            exact = np.sin(a + b) / (np.sin(a + b) - np.sin(b))
            yield Check(f"F/(G h), {said}", exact, ratio, 0.05, "mesh, damping, arms that stretch")
            share, why = 1.0 - 1.0 / exact, "mesh, damping"
            yield Check(f"friction/F, {said}", share, rubbed, 0.05, why, gate=False)
            yield zero(f"left over/F, {said}", left, 0.03, "arms still growing", gate=False)
