"""Contact and friction: G01 a block on an incline, G02 a wedge, G03 a ball on a membrane."""

import numpy as np

import shellcut as sc
from blunt_tools import BOX_FACES, ball, blunt, box_corners
from courses import course, moved_by, recorded
from harness import Check, case, zero
from shellcut.mesh.structured import disc, rectangle
from shellcut.tool.shapes import straight_blade

FRICTION, TILT = 0.3, np.radians(25.0)
PRESSED, SLOPE = 1.8e7, 1e-3  # mm/s² along the normal; s in which the slope load grows by as much
RAMP = 6e-4  # s of the normal load

# Columns: along the slope, across, normal.
FRAME = np.array(
    [[np.cos(TILT), 0.0, np.sin(TILT)], [0.0, 1.0, 0.0], [-np.sin(TILT), 0.0, np.cos(TILT)]]
)


def pressing(t):
    return np.sin(0.5 * np.pi * min(1.0, t / RAMP)) ** 2


def pulling(t):
    return max(0.0, (t - RAMP) / SLOPE)


@case("G01", "Block on an incline")
def g01():
    """It holds up to tan b = mu, then slides. A square of film, flat, lies on a plane of the tool
    inclined by 25 degrees, pressed on it by a load on its mass along the normal; a second load
    along the slope grows slowly. Read: the ratio of the two at which it begins to slide, its
    acceleration afterwards, and what friction has dissipated.

    Source: Coulomb's law. It sticks while the slope load is below mu times the normal one, and then
    accelerates by their difference; friction does the work mu N times the distance.

    Bands: discretisation in time, and the oscillation of the springs after the start. Limit and
    growth are read from the root of the speed, which is linear in time.
    """
    flat = rectangle(2.0, 2.0, size=0.5)
    mesh = sc.Mesh.from_arrays((flat.nodes + np.array([0.0, 0.0, 1e-9])) @ FRAME.T, flat.quads)
    loads = [
        sc.Gravity(tuple(-PRESSED * FRAME[:, 2]), factor=pressing),
        sc.Gravity(tuple(PRESSED * FRAME[:, 0]), factor=pulling),
    ]
    corners = box_corners((-20.0, -5.0, -5.0), (20.0, 5.0, 0.0))  # the origin in its upper face
    sim = sc.Simulation(
        mesh,
        sc.ShellMaterial.homogeneous(),
        loads=loads,
        tool=blunt(corners @ FRAME.T, BOX_FACES),
        motion=sc.StraightMotion((0.0, 1.0, 0.0), speed=1e-9),  # at rest
        contact=sc.Contact(friction=FRICTION),
        damping_alpha=0.0,
    )
    s = sim.state
    mass = s.node.mass[: s.n_node]

    def read(sim):
        momentum = mass @ s.node.velocity_half[: s.n_node]
        return s.time + 0.5 * s.dt, momentum @ FRAME[:, 0] / mass.sum()

    time, speed = recorded(sim, RAMP + 0.7 * SLOPE, read)
    # The slope load grows with time, so from the limit on speed = ½ growth (time - limit)².
    slides = time > RAMP + (FRICTION + 0.1) * SLOPE
    slope, cut = np.polyfit(time[slides], np.sqrt(speed[slides]), 1)
    begins, growth = (-cut / slope - RAMP) / SLOPE, 2.0 * slope**2
    way = growth / 6.0 * (time[-1] + cut / slope) ** 3
    ledger = sim.close_ledger()
    spent = FRICTION * PRESSED * mass.sum() * way
    both = ledger.friction_stored + ledger.friction_dissipated
    why, share = "time step", both / ledger.friction_work
    yield Check("slope load over normal load where it slides", FRICTION, begins, 5e-3, why)
    yield Check("growth of its acceleration, mm/s³", PRESSED / SLOPE, growth, 5e-3, why)
    yield Check("dissipated by friction, N mm", spent, ledger.friction_dissipated, 5e-3, why)
    yield Check("stored and dissipated over work", 1.0, share, 1e-9, "round-off")


PLATE, ARM, SIZE, SPEED = 1.0, 1.0, 0.25, 6000.0  # mm, mm, mm, mm/s
LAW = sc.CohesiveLaw(
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
    sim = sc.Simulation(
        strip,
        sc.ShellMaterial.homogeneous(thickness=PLATE),
        supports=[sc.Support.clamped("right")],
        tool=wedge.translated((-0.01, 0.0, 0.0)),
        motion=sc.StraightMotion((1.0, 0.0, 0.0), speed=SPEED, ramp=1e-4),
        law=LAW,
        contact=sc.Contact(friction=friction),
        fracture=sc.Fracture(path="edges", blade_cut=False, turn_limit_deg=20.0),
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
    return tool / (LAW.fracture_energy * PLATE), rubbed / tool, left / tool


@case("G02", "Wedge with friction", fast=False)
def g02():
    """A plate 1 mm thick and 2 mm wide, free at its sides and clamped at its far end, is split
    along its middle by a long wedge of half-angle a that drives the crack ahead of itself. The two
    arms bend in their plane like beams until they lie on the faces of the wedge, and slide on. The
    cables never meet the edge. Read: force over G h, from the work of the tool, and the work of
    friction over that.

    Source: Williams and Patel (2016), rederived. With N on each face, F = 2 N (sin a + mu cos a),
    and F = G h + 2 mu N: with mu = tan b

        F / (G h) = sin(a + b) / (sin(a + b) - sin b),   friction / F = sin b / sin(a + b).

    Bands: 5 % as asked of a mesh with four quads over each arm; of it the damping of the cables
    that break one by one takes some 2 %. What is left of the force is stored: within 1 % of it.
    """
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


RIM, BALL, TOUCHED, STRETCH = 10.0, 10.0, 0.7, 1.2  # mm, mm, mm, -
ASIDE = np.array([0.3, 0.17])  # mm
YOUNG, POISSON, THICKNESS = 1678.0, 0.3, 0.02
GAP = 0.002


def pressed(n_side, n_layer, depth):
    """Return the force at a depth, and the imbalance over the work."""
    mesh = disc(RIM / STRETCH, n_side=n_side, n_layer=n_layer)
    sim = sc.Simulation(
        mesh,
        sc.ShellMaterial.homogeneous(young=YOUNG, poisson=POISSON, thickness=THICKNESS),
        supports=[sc.Support.clamped("rim")],
        tool=ball(BALL, 5).translated((ASIDE[0], ASIDE[1], BALL + GAP)),
        motion=sc.StraightMotion((0.0, 0.0, -1.0), speed=100.0, ramp=2e-4),
        contact=sc.Contact(),
        damping_alpha=3000.0,
    )
    sim.relax((STRETCH - 1.0) * mesh.nodes)
    forces = recorded(sim, moved_by(depth + GAP), lambda sim: sim.tooth_wrenches[0, 2])
    # Over a swing of the film on its springs; meanwhile it goes 2 µm down.
    ledger = sim.ledger
    return float(np.mean(forces[-100:])), abs(ledger.imbalance) / ledger.tool_work


@case("G03", "Ball on a membrane")
def g03():
    """A round film under an isotropic tension, clamped at its border; a triangulated ball moves
    down slowly, a little off its middle. On the coarse mesh the circle of contact is smaller than a
    quad: the film is met by the ball's corners between its nodes. Read: the force at a given depth.

    Source: membrane under a load F at the distance d from the middle of a disc of radius a, and the
    ball of radius R touching it within the radius c, frictionless (slopes small, tension T
    constant): outside w = F / (2 pi T) ln((a² - d²) / (a r)), inside the ball itself; with equal
    slopes at c

        F = 2 pi T c² / R,    depth = c² / (2 R) + c² / R ln((a² - d²) / (a c)).

    Bands: mesh. The mean slope of 0.05 raises the tension by 1 %; the ball's facets, 0.5 mm wide,
    lie 3 µm inside the sphere, 2 % of the depth. A quad of the coarse mesh is 2.7 c wide.
    """
    tension = THICKNESS * YOUNG / (1.0 - POISSON) * 0.5 * (STRETCH**2 - 1.0)
    force = 2.0 * np.pi * tension * TOUCHED**2 / BALL
    reach = (RIM**2 - ASIDE @ ASIDE) / RIM
    depth = TOUCHED**2 / BALL * (0.5 + np.log(reach / TOUCHED))
    for n_side, n_layer, band in ((4, 2, 0.1), (12, 6, 0.05)):
        found, imbalance = pressed(n_side, n_layer, depth)
        edge = 2.0 * RIM / (n_side + 2.0 * n_layer)
        said = f"quads of {edge:.1f} mm, circle of {TOUCHED} mm"
        yield Check(f"force on the ball, N, {said}", force, found, band, "mesh, facets, slope")
        yield zero(f"imbalance / work, {said}", imbalance, 1e-6, "round-off")
