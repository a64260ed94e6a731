"""Strips that yield: P05 bent, P07 torn."""

import numpy as np

import shellcut as sc
from harness import Check, case, zero
from shellcut.material.plastic import HISTORY
from shellcut.mesh.structured import rectangle
from shellcut.state import BROKEN

E, YIELD, T, B, LENGTH = 10000.0, 1.0, 0.1, 0.5, 2.0
HALF = sc.Layer(sc.Plastic(sc.Elastic(E, 0.499, 1e-9), sc.Linear(YIELD)), 0.5 * T)
FILM = sc.ShellMaterial([HALF, HALF], points_per_layer=9)
POINTS = "eighteen points through the thickness"
STRAINS = "strains of 4e-4 over those at yield"
KAPPA_Y = 2.0 * YIELD / (E * T)
M_Y = YIELD * B * T**2 / 6.0


class Strip:
    """A strip whose right end is turned about y, free to move along x."""

    def __init__(self, wide):
        mesh = rectangle(LENGTH, B, n_x=8, n_y=1)
        corner = np.flatnonzero(np.isclose(mesh.nodes[:, 1], mesh.nodes[:, 1].min()))
        everyone = np.arange(mesh.n_node)
        self.statics = sc.Statics(
            mesh,
            FILM,
            supports=[
                sc.Support("left", translation="xz", rotation="y"),
                sc.Support("right", translation="", rotation="y"),
                sc.Support(everyone if wide else corner, translation="y", rotation="x" * wide),
            ],
        )
        self.mesh, self.angle = mesh, 0.0

    def turn_to(self, curvature):
        """Return the moment at a curvature [N·mm]."""
        angle = curvature * LENGTH
        share = self.mesh.nodes[:, 0] / LENGTH
        spin = np.zeros((self.mesh.n_node, 3))
        spin[:, 1] = (angle - self.angle) * share

        def arc(a):
            x = self.mesh.nodes[:, 0]
            k = max(abs(a) / LENGTH, 1e-12)
            rise = (1.0 - np.cos(k * x)) / k
            return np.stack([np.sin(k * x) / k, 0.0 * x, -np.sign(a) * rise], axis=1)

        self.statics.move(arc(angle) - arc(self.angle), spin)
        self.angle = angle
        found = self.statics.load_steps([1.0])[-1]
        return abs(float(found.reaction_moment[self.mesh.node_set("right"), 1].sum()))

    def stresses(self, curvature):
        """Return the heights of the points [mm], and E (kappa z - eps_p) in a middle quad [MPa]."""
        heights, _, _ = FILM.thickness_points(FILM.integration_points)
        history = self.statics.state.history  # (n_block, 4 n_point n_number, width)
        rows = history.reshape(len(history), 4, len(heights), len(HISTORY), -1)
        middle = np.argmin(np.abs(self.mesh.nodes[self.mesh.quads].mean(axis=1)[:, 0] - LENGTH / 2))
        block, lane = divmod(int(self.statics.shell.blocks.slot[middle]), history.shape[2])
        plastic = rows[block, :, :, HISTORY.index("plastic strain 11 [-]"), lane].mean(axis=0)
        return heights, E * (curvature * heights - plastic)


@case("P05", "Bent strip, springback", fast=False)
def p05():
    """Perfectly plastic, turned at its ends to a curvature kappa. Narrow, so that its section may
    warp:

        M / M_y = 3/2 [1 - (kappa_y/kappa)²/3],   M_y = sigma_y b t²/6,   kappa_y = 2 sigma_y/(E t),

    and the curvature that springs back is 12 M/(E b t³). It leaves at the height z the stress of
    the bent strip less that of an elastic one,

        sigma = min(E kappa z, sigma_y) - 12 M z/(b t³)     (z > 0, and the opposite below).

    In a wide strip, whose width is fixed, the limit is M_p 2/sqrt 3, M_p = 3/2 M_y.

    Source: closed form (beam theory). Two layers of nine Gauss points see the border of the elastic
    core between two of them: up to 1 % of the moment. Beam theory knows no stress across the strip,
    so nu is that of plastic flow.
    """
    strip = Strip(wide=False)
    for ratio in (0.8, 1.2, 1.6, 2.0, 3.0, 4.0):
        moment = strip.turn_to(ratio * KAPPA_Y)
        wanted = ratio if ratio < 1.0 else 1.5 * (1.0 - ratio**-2 / 3.0)
        name = f"M/M_y at {ratio:g} kappa_y"
        yield Check(name, wanted, moment / M_Y, 0.015, POINTS)
    less = strip.turn_to(3.7 * KAPPA_Y)
    slope = (moment - less) / (0.3 * KAPPA_Y)
    back = moment / slope
    wanted = 12.0 * 1.5 * (1.0 - 4.0**-2 / 3.0) * M_Y / (E * B * T**3)
    yield Check("springback [1/mm]", wanted, back, 0.015, POINTS)
    left = strip.turn_to(4.0 * KAPPA_Y - wanted)
    yield zero("M/M_y, let go", left / M_Y, 0.015, POINTS)
    z, residual = strip.stresses(4.0 * KAPPA_Y - wanted)
    closed = np.clip(4.0 * KAPPA_Y * E * z, -YIELD, YIELD) - wanted * E * z
    # By the plastic strain that is left, hence only where there is some.
    for k in np.flatnonzero(4.0 * KAPPA_Y * E * z > YIELD):
        name = f"sigma/sigma_y left at {2.0 * z[k] / T:.3f} t/2"
        yield Check(name, closed[k] / YIELD, residual[k] / YIELD, 0.003, STRAINS, absolute=True)
    odd = float(np.abs(residual + residual[::-1]).max())
    yield zero("sigma left, the two halves", odd / YIELD, 0.003, STRAINS)
    wide = Strip(wide=True)
    for ratio in (1.0, 2.0, 4.0, 8.0, 12.0):
        moment = wide.turn_to(ratio * KAPPA_Y)
    limit = 1.5 * 2.0 / np.sqrt(3.0)
    yield Check("M/M_y of a wide strip, far", limit, moment / M_Y, 0.015, POINTS)


WIDTH, LONG, THICKNESS, SIZE = 14.0, 12.0, 0.1, 0.5
LIGAMENTS = (2.0, 3.0, 4.0, 5.0, 6.0)
SHEET = sc.Plastic(sc.Elastic(1000.0, 0.3, 1e-9), sc.Linear(10.0, 25.0))
LAW = sc.CohesiveLaw(
    strength=14.0, plateau=13.3, opening_a=0.02, opening_p=0.4, opening_u=0.5, onset=0.005
)
SPEED, RISE = 600.0, 2e-4  # mm/s of either end, s


def strip(ligament):
    """Return a strip that is pulled along y, notched from both sides on y = 0."""
    mesh = rectangle(WIDTH, LONG, size=SIZE)
    x, y = mesh.nodes[:, 0] - 0.5 * WIDTH, mesh.nodes[:, 1]
    line = np.flatnonzero(np.abs(y) < 1e-9)
    line = line[np.argsort(x[line])]
    for notch in (line[x[line] <= -0.5 * ligament + 1e-9], line[x[line] >= 0.5 * ligament - 1e-9]):
        mesh = mesh.cut(notch)

    def pulled(name, way):
        return sc.Support(name, velocity={"y": lambda t: way * SPEED * min(1.0, t / RISE)})

    return sc.Simulation(
        mesh,
        sc.ShellMaterial([sc.Layer(SHEET, THICKNESS)], points_per_layer=1),
        supports=[pulled("bottom", -1.0), pulled("top", 1.0)],
        law=LAW,
        fracture=sc.Fracture(path="edges"),
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


@case("P07", "Essential work of fracture")
def p07():
    """A strip of a yielding film is pulled apart through a ligament L between two notches. The work
    W is that of the cables, G h L, and that of yielding beside the ligament, in an area of the
    order L²:

        w_f = W/(h L) = w_e + beta w_p L.

    The line through the five works, taken back to no ligament, must give the law's G; at the
    longest ligament w_f itself is far from it.

    Source: Cotterell & Reddel 1977. The whole ligament must yield before it parts: it does, the
    film yields at 10 MPa (11.5 in plane strain) and the law asks for 14.
    """
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
