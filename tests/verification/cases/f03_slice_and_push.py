"""F03 Slice and push: a blade that cuts across its edge and slides along it.

A strip is cut by a blade with the speed v along the strip and xi v along its edge; V and H are the
forces along the two. Read: work of each force per length of cut, over whole node periods.

1. The film of 2010, whose flaps move out of plane, without friction: V + xi H = G h whatever the
   joints do. Source: exact as a statement of energy.
2. A stiff thin cut, 1 mm of film with a tenth of the paper's G and a blade of 4 µm, which stays in
   plane: perfect adhesion gives V = G h / (1 + xi²) and H = xi V ([Atkins2016]), free slip V = G h
   and H = 0, and Coulomb slip the same as adhesion with rho = min(xi, mu pi/2) in place of xi, and
   friction H (xi - rho). Source: derived in shellcut.cables.joint_slip.

Bands: the 2 % and 3 % that were asked for. In plane 0.8 mm gives V 4 % too high at xi = 2, 0.4 mm
half of it, because a cable begins across the blade and not along it.
"""

import numpy as np

from cases.paths import curve
from courses import over_periods, recorded
from harness import Check, case, zero
from shellcut import CohesiveLaw, ShellMaterial, guillotine
from shellcut.tool.shapes import straight_blade

RATIOS = (0.0, 0.5, 1.0, 2.0)
FRICTION = 0.3


def forces(*, size, slice_ratio, width=8.0, strength=18.0, thickness=0.074, blade=None, **joint):
    """Return V, H and the joints' friction per length over G h, and the largest imbalance."""
    length = 20.0
    law = CohesiveLaw(strength=strength, plateau=2.0 / 3.0 * strength, **joint)
    height = 3.0 + 2.0 * slice_ratio * length
    tool = blade and straight_blade(length=length, height=height, half_thickness=blade)
    case = guillotine(
        size,
        length=length,
        width=width,
        slice_ratio=slice_ratio,
        law=law,
        material=ShellMaterial.homogeneous(thickness=thickness),
        tool=tool,
        speed=6000.0 if blade is None else 3000.0,
    )
    before = case.simulation.pose.translation

    def read(sim):
        force, now = -sim.tooth_wrenches[:, :3].sum(axis=0), sim.pose.translation
        return *force[[0, 2]], *now[[0, 2]], sim.ledger.joint_friction, sim.ledger.imbalance

    found = recorded(case.simulation, case.duration, read)
    force, path = (np.insert(row, 0, 0.0, axis=1) for row in (found[:2], found[2:4]))
    path[:, 0] = before[[0, 2]]
    works = np.cumsum(0.5 * (force[:, 1:] + force[:, :-1]) * np.diff(path), axis=1)
    joints, imbalance = found[4:]
    per_length = over_periods(path[0, 1:], [*works, joints], 8.0, size)
    push, slide, friction = np.array(per_length) / (law.fracture_energy * thickness)
    worst = float(np.abs(imbalance).max() / works.sum(axis=0).max())
    return push, slide / slice_ratio if slice_ratio else 0.0, friction, worst


IN_PLANE = {"size": 0.4, "width": 4.8, "strength": 1.8, "thickness": 1.0, "blade": 0.002}


@case(
    "F03",
    "Slice and push",
    fast=False,
    axes=("ξ, speed along the edge over that along the strip", "force over G h"),
)
def f03():
    for joint in ("adhesion", "free"):
        for xi in RATIOS:
            push, along, _, worst = forces(size=0.8, slice_ratio=xi, joint=joint)
            name = f"{joint}, xi = {xi:g}, film of 2010"
            whole = float(push + xi * along)
            yield Check(f"{name}: (V + xi H) / G h", 1.0, whole, 0.02, "damping, waves")
            yield zero(f"{name}: imbalance", worst, 5e-3, "time step")
    ratios = np.array(RATIOS[1:])
    for joint, mu in (("adhesion", np.inf), ("free", 0.0), ("slip", FRICTION)):
        given = {"joint_friction": mu} if joint == "slip" else {}
        found = [forces(slice_ratio=xi, joint=joint, **IN_PLANE, **given)[:3] for xi in ratios]
        rhos = np.minimum(ratios, 0.5 * np.pi * mu)
        exacts = 1.0 / (1.0 + rhos**2)
        for xi, rho, exact, (push, along, friction) in zip(
            ratios, rhos, exacts, found, strict=True
        ):
            name = f"{joint}, xi = {xi:g}, in plane"
            yield Check(f"{name}: V / G h", exact, float(push), 0.03, "mesh")
            if rho > 0.0:
                yield Check(f"{name}: H / G h", rho * exact, float(along), 0.03, "mesh")
            else:
                yield zero(f"{name}: H / G h", float(along), 1e-6, "exact")
            if xi > rho > 0.0:
                rubbed = rho * exact * (xi - rho)
                yield Check(f"{name}: friction / G h", rubbed, float(friction), 0.03, "mesh")
        pushes, slides, _ = zip(*found, strict=True)
        f03.CURVES[f"V, {joint}"] = curve(ratios, pushes, ratios, exacts)
        f03.CURVES[f"H, {joint}"] = curve(ratios, slides, ratios, rhos * exacts)
