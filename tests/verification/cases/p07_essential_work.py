"""P07 Essential work of fracture: strips notched on both sides, of five ligaments.

A strip of a yielding film is pulled apart through a ligament L between two notches. The work W is
that of the cables, G h L, and that of yielding beside the ligament, in an area of the order L²:

    w_f = W/(h L) = w_e + beta w_p L.

The line through the five works, taken back to no ligament, must give the law's G; at the longest
ligament w_f itself is far from it.

Source: Cotterell & Reddel 1977. The whole ligament must yield before it parts: it does, the film
yields at 10 MPa (11.5 in plane strain) and the law asks for 14.
"""

import numpy as np

from harness import Check, zero
from shellcut import CohesiveLaw, Fracture, Simulation, Support
from shellcut.material import Elastic, Layer, Linear, Plastic, ShellMaterial
from shellcut.mesh.structured import rectangle
from shellcut.state import BROKEN

ID, TITLE, FAST = "P07", "Essential work of fracture", True

WIDTH, LENGTH, THICKNESS, SIZE = 14.0, 12.0, 0.1, 0.5
LIGAMENTS = (2.0, 3.0, 4.0, 5.0, 6.0)
FILM = Plastic(Elastic(1000.0, 0.3, 1e-9), Linear(10.0, 25.0))
LAW = CohesiveLaw(
    strength=14.0, plateau=13.3, opening_a=0.02, opening_p=0.4, opening_u=0.5, onset=0.005
)
SPEED, RISE = 600.0, 2e-4  # mm/s of either end, s


def strip(ligament):
    """Return a strip that is pulled along y, notched from both sides on y = 0."""
    mesh = rectangle(WIDTH, LENGTH, size=SIZE)
    x, y = mesh.nodes[:, 0] - 0.5 * WIDTH, mesh.nodes[:, 1]
    line = np.flatnonzero(np.abs(y) < 1e-9)
    line = line[np.argsort(x[line])]
    for notch in (line[x[line] <= -0.5 * ligament + 1e-9], line[x[line] >= 0.5 * ligament - 1e-9]):
        mesh = mesh.cut(notch)

    def pulled(name, way):
        return Support(name, velocity={"y": lambda t: way * SPEED * min(1.0, t / RISE)})

    return Simulation(
        mesh,
        ShellMaterial([Layer(FILM, THICKNESS)], points_per_layer=1),
        supports=[pulled("bottom", -1.0), pulled("top", 1.0)],
        law=LAW,
        fracture=Fracture(path="edges"),
        damping_alpha=200.0,
    )


def works(ligament):
    """Return the work of the supports and of the cables over h L [N/mm], and the imbalance."""
    sim = strip(ligament)
    while sim.state.time < 5e-3:
        sim.step()
        whole = sim.state.crack_length > ligament - 1e-9
        cables = sim.state.cable.status[: sim.state.n_cable]
        if sim.state.step % 100 == 0 and whole and (cables == BROKEN).all():
            break
    book = sim.close_ledger()
    area = ligament * THICKNESS
    return book.support_work / area, book.cohesive_work / area, book.imbalance / book.support_work


def checks():
    G = LAW.fracture_energy
    found = np.array([works(ligament) for ligament in LIGAMENTS])
    slope, essential = np.polyfit(LIGAMENTS, found[:, 0], 1)
    line = essential + slope * np.array(LIGAMENTS)
    worst = float(np.abs(found[:, 0] - line).max())
    yield Check(
        "line at no ligament [N/mm]", G, float(essential), 0.05, "plastic area not quite L²"
    )
    yield Check("cables at 2 mm [N/mm]", G, float(found[0, 1]), 1e-3, "trapezoidal rule")
    yield Check("cables at 6 mm [N/mm]", G, float(found[-1, 1]), 1e-3, "trapezoidal rule")
    yield zero("off the line, over G", worst / G, 0.02, "as above")
    yield zero("imbalance", float(np.abs(found[:, 2]).max()), 1e-4, "time step")
    yield Check("whole work at 6 mm [N/mm]", G, float(found[-1, 0]), 0.05, "yielding", gate=False)
