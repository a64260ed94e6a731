"""G01 A block on an incline: it holds up to tan b = mu, then slides.

A square of film, flat, lies on a plane of the tool inclined by 25 degrees, pressed on it by a load
on its mass along the normal; a second load along the slope grows slowly. Read: the ratio of the two
at which it begins to slide, its acceleration afterwards, and what friction has dissipated.

Source: Coulomb's law. It sticks while the slope load is below mu times the normal one, and then
accelerates by their difference; friction does the work mu N times the distance.

Bands: discretisation in time, and the oscillation of the springs after the start. Limit and growth
are read from the root of the speed, which is linear in time.
"""

import numpy as np

from blunt_tools import BOX_FACES, blunt, box_corners
from courses import recorded
from harness import Check
from shellcut import Contact, Gravity, Mesh, ShellMaterial, Simulation, StraightMotion
from shellcut.mesh.structured import rectangle

ID, TITLE, FAST = "G01", "Block on an incline", True

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


def checks():
    flat = rectangle(2.0, 2.0, size=0.5)
    mesh = Mesh.from_arrays((flat.nodes + np.array([0.0, 0.0, 1e-9])) @ FRAME.T, flat.quads)
    loads = [
        Gravity(tuple(-PRESSED * FRAME[:, 2]), factor=pressing),
        Gravity(tuple(PRESSED * FRAME[:, 0]), factor=pulling),
    ]
    corners = box_corners((-20.0, -5.0, -5.0), (20.0, 5.0, 0.0))  # the origin in its upper face
    sim = Simulation(
        mesh,
        ShellMaterial.homogeneous(),
        loads=loads,
        tool=blunt(corners @ FRAME.T, BOX_FACES),
        motion=StraightMotion((0.0, 1.0, 0.0), speed=1e-9),  # at rest
        contact=Contact(friction=FRICTION),
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
