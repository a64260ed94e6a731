"""P08 Trouser strip whose legs yield: what the pull does beyond G h is what the legs dissipate.

Two legs of breadth b/2 are pulled apart, out of the plane of the strip, each by a force F. In the
steady state, over one millimetre of crack (a), the work of the two ends, dW/da = 2 F dw/da with w
half their distance, is

    dW/da = G h + D + U + losses,

G h of the crack, D the plastic dissipation of the two legs as they are bent and straightened again,
U the elastic energy that their residual stresses keep. U/D is of the order of (sigma_y/E)/(kappa
h), so of a stiff film the excess is D alone:

    F - G h/2 = D/2      for dw/da = 1  (the ends rise by 1.4 % more: the torn edges are stretched).

The losses, moving and damped legs, are below one per cent of D; the film whose legs yield less is
torn at half the speed. The crack runs along a straight line of sides.

Source: energy balance. Slopes over w by fitted lines: the crack grows by one side at a time.
"""

import numpy as np

from courses import recorded
from harness import Check, case, zero
from shellcut import Elastic, Fracture, Layer, Linear, Plastic, ShellMaterial, Simulation, Support
from shellcut.models.trouser import TEAR_LAW, trouser_strip

LENGTH, WIDTH, NOTCH, THICKNESS, SIZE = 30.0, 6.0, 6.0, 0.2, 0.5
YIELD, HARDENING = 20.0, 100.0
FILMS = {"stiff": (26848.0, 2500.0), "soft": (1678.0, 1250.0)}
"""Young's modulus [MPa] and speed of each end [mm/s]."""
RISE = 3e-4  # s
START = 10.0  # mm of w, from which on a/w stays
END = LENGTH - 2.0 / 3.0 * WIDTH
TEARING = TEAR_LAW.fracture_energy * THICKNESS
EDGES = "the crack grows by element sides"
LOSSES = "losses, growth by element sides"


def strip(young, speed, length=LENGTH):
    """Return a strip whose two legs, beside a notch along its middle line of sides, are pulled."""
    mesh = trouser_strip(length, WIDTH, SIZE)
    x, y = mesh.nodes[:, 0], mesh.nodes[:, 1]
    slit = np.flatnonzero((np.abs(y) < 1e-9) & (x <= NOTCH + 1e-9))
    mesh = mesh.cut(slit[np.argsort(x[slit])])
    film = Plastic(Elastic(young, 0.3, 1e-9), Linear(YIELD, HARDENING))

    def pulled(leg, speed):
        rate = {"z": lambda time: speed * min(1.0, time / RISE)}
        return Support(leg, translation="yz", rotation="", velocity=rate)

    return Simulation(
        mesh,
        ShellMaterial([Layer(film, THICKNESS)], points_per_layer=5),
        supports=[Support.clamped("tail"), pulled("up", speed), pulled("down", -speed)],
        law=TEAR_LAW,
        fracture=Fracture(path="edges", check_every=5),
        damping_alpha=10.0,
    )


def works(sim, end=END, start=START):
    """Tear up to w = ``end`` [mm]; return works over a millimetre of crack [N] from ``start`` on.

    With them ``"way"``, dw/da, and the largest imbalance over the work of the pull.
    """
    up, down = (sim.mesh.node_set(leg)[0] for leg in ("up", "down"))

    def way(sim):
        z = sim.state.node.x[:, 2]
        return 0.5 * (z[up] - z[down])

    def read(sim):
        book = sim.close_ledger()
        lost = book.damping + book.kinetic
        works = book.support_work, book.cohesive_work, book.material_dissipated, book.strain, lost
        return way(sim), sim.state.crack_length, *works, book.imbalance

    def torn(sim):
        return sim.state.step % 50 == 0 and way(sim) >= end

    names = "way", "crack", "pull", "cables", "plastic", "elastic", "lost", "imbalance"
    table = dict(zip(names, recorded(sim, torn, read, every=50), strict=True))
    steady = table["way"] > start
    imbalance = np.abs(table.pop("imbalance")[steady]).max() / table["pull"][-1]
    slopes = {
        name: float(np.polyfit(table["way"][steady], column[steady], 1)[0])
        for name, column in table.items()
    }
    found = {name: slope / slopes["crack"] for name, slope in slopes.items()}
    return found | {"imbalance": float(imbalance)}


@case("P08", "Trouser with legs that yield", fast=False)
def p08():
    for name, (young, speed) in FILMS.items():
        work = works(strip(young, speed))
        excess = work["pull"] - TEARING
        kept = work["plastic"] + work["elastic"]
        stiff = name == "stiff"
        yield Check(f"{name}: cables over G h", 1.0, work["cables"] / TEARING, 0.01, EDGES)
        what = f"{name}: excess [N] against plastic"
        why = LOSSES if stiff else "energy kept in the legs"
        yield Check(what, work["plastic"], excess, 0.02, why, gate=stiff)
        yield Check(f"{name}: excess [N] against plastic and kept", kept, excess, 0.02, LOSSES)
        yield Check(f"{name}: dw/da", 1.0, work["way"], 0.03, "torn flanks are stretched")
        yield zero(f"{name}: imbalance", work["imbalance"], 1e-5, "time step")
