"""The guillotine of the film of 2010 with a blade whose edge has a radius, half-angle 10°."""

import numpy as np

from courses import steady_works
from shellcut import CohesiveLaw, guillotine
from shellcut.tool.shapes import straight_blade

THICKNESS = 0.074  # mm
HALF_ANGLE = np.radians(10.0)
FRICTION = 0.3
SIZE = 0.8  # mm
LENGTH = 20.0  # mm
NOTCH, WIDTH = 2.0, 8.0  # mm


def cut(radius, size=SIZE, **joint):
    """Return the tool's work, its parts and the largest imbalance, per length over G h.

    An edge that severs cables takes G_s for G. The cut is steady once all its cables, up to half a
    drawn one behind the edge, are a width of the strip beyond the notch, from which on the border
    has no influence. Measured with full G: the cables take G h times 0.10 mm more than beyond 8 mm
    of travel, on 9 and on 19 mm of cut alike, and 0.01 to 0.02 mm more beyond 12 mm.
    """
    law = CohesiveLaw(**joint)
    blade = straight_blade(length=LENGTH, height=3.0, edge_radius=radius)
    case = guillotine(size, length=LENGTH, width=WIDTH, notch=NOTCH, law=law, tool=blade)
    begin = NOTCH + WIDTH + 0.5 * law.opening_u
    names = "tool_work", "cohesive_work", "joint_friction", "damping"
    means, worst, _ = steady_works(case, size, begin, *names)
    whole = law.at_edge(radius).fracture_energy * THICKNESS
    return (*(mean / whole for mean in means), worst)


def on_the_blade(radius, friction):
    """Return friction over G h of cables whose ends lie on the flanks of the blade.

    Drawn out evenly (shellcut.cables.joint_slip), the cable of length l has the arc r phi on the
    round, phi = l / r until it is the whole of it, pi - 2 a. The mean of the tension over the
    length is that of the law.
    """
    if not radius * friction:
        return 0.0
    law = CohesiveLaw()
    opening = np.linspace(0.0, law.opening_u, 400_001)[1:]
    phi = np.minimum(opening / radius, np.pi - 2.0 * HALF_ANGLE)
    half = 0.5 * friction * phi
    held = radius * phi * (1.0 + np.expm1(-half) / half)
    stress = np.array([law.traction(x) for x in opening[::100]])
    extra = np.interp(opening, opening[::100], stress) * held / (opening - held)
    return float(np.trapezoid(extra, opening) / law.fracture_energy)
