"""Films from their data sheets: the tear figures that a sheet does not give, before any comparison.

``python tests/predictions/data_sheet.py`` prints what follows from the sheets alone, without a run.
"""

import math
from dataclasses import dataclass

import numpy as np

import shellcut as sc
from prediction import BLIND, KNOWN, Figure, Prediction, Run
from shellcut.models.oscillating import bar_before, film_before, motion_of
from shellcut.models.trouser import trouser_strip
from shellcut.view import Curve, Diagram, draw_curves


@dataclass(frozen=True)
class Sheet:
    """What a data sheet says of a film, and Poisson's ratio and density where they are guessed."""

    thickness: float
    young: float
    curve: tuple[tuple[float, float], ...]
    """Nominal strain and stress [MPa], from the yield to the break."""
    poisson: float = 0.38
    density: float = 1.4e-9

    def material(self, yields=True):
        """Return the film; the true stress is linear in the true strain between the points."""
        film = sc.Elastic(self.young, self.poisson, self.density)
        if yields:
            strain, stress = np.array(self.curve).T
            true = stress * (1.0 + strain)
            plastic = np.log1p(strain) - true / self.young
            film = sc.Plastic(film, sc.Table(plastic - plastic[0], true))
        return sc.ShellMaterial([sc.Layer(film, self.thickness)], points_per_layer=5)

    def energy(self, force):
        """Return G [N/mm] of a mean force on each of two legs [N] that do not yield."""
        return 2.0 * force / self.thickness

    def yielding_leg(self, energy):
        """Return the breadth of a leg below which it may yield, 3 E G / sigma_y² [mm]."""
        return 3.0 * self.young * energy / self.curve[0][1] ** 2


def law_of(energy, strength):
    """Return a law with the shape of that of the trouser test."""
    opening = energy / (0.685 * strength)
    return sc.CohesiveLaw(
        strength=strength,
        plateau=0.8 * strength,
        opening_a=opening / 6.0,
        opening_p=opening * 2.0 / 3.0,
        opening_u=opening,
        onset=opening / 120.0,
    )


SLEEVE = Sheet(0.25, 1900.0, ((0.03, 50.0), (1.0, 50.5)), density=1.3e-9)
"""Film A. The sheet gives no elongation at break; the stress hardly changes after the yield."""
POLYIMIDE = Sheet(0.025, 2500.0, ((0.03, 69.0), (0.05, 90.0), (0.72, 231.0)), poisson=0.34)
"""Film B."""
POLYESTER = Sheet(0.012, 3790.0, ((0.025, 95.0), (0.95, 210.0)))
"""Film C: the mean of both directions; the yield stress is that of `pet`."""
SLEEVE_TORN = {"machine": 34.0, "cross": 37.0}
"""Trouser tear of film A [N/mm of thickness]."""
POLYIMIDE_LEG = 0.07
"""Elmendorf force of film B [N]."""
POLYESTER_ENERGY = 6.0, 3.0, 9.0
"""Of film C [N/mm], guessed with its band: a polyester film of 15 µm has 6.0 [Millar2016]."""
TORN_BELOW = 0.9
"""Strength of the cables over the least nominal stress of a film that has yielded: below it, or
cracks could not open, and the process zone is as short as that allows."""
SLEEVE_STRENGTH = TORN_BELOW * SLEEVE.curve[0][1]

TROUSER, PENDULUM = (25.4, 56.0, 12.7), (76.0, 66.0, 12.7)
"""Width, length and notch of the strips [mm]; D1938, and D1922 with its legs of 38 mm."""
SPEED, RISE = 2500.0, 3e-4
PROBE, TRAVEL = 3.2, 18.0
"""Diameter of the probe, which falls half a metre, and its way [mm]."""
PROBE_SPEED = 3160.0
JAWS = 12.7
"""Half the distance of the jaws, depth of the notch, and film left above it [mm] (D1004)."""


def rising(speed):
    """Return a velocity that rises to a speed [mm/s]."""
    return lambda time: speed * min(1.0, time / RISE)


def legs(size, energy, wide=False):
    """Tear film A between two legs; return the mean force on a leg, and its course."""
    width, length, notch = PENDULUM if wide else TROUSER
    mesh = trouser_strip(length, width, size)
    pulled = [
        sc.Support(leg, translation="yz", rotation="", velocity={"z": rising(speed)})
        for leg, speed in (("up", SPEED), ("down", -SPEED))
    ]
    sim = sc.Simulation(
        mesh,
        SLEEVE.material(),
        supports=[sc.Support.clamped("tail"), *pulled],
        law=law_of(energy, SLEEVE_STRENGTH),
        fracture=sc.Fracture(path="free", check_every=20, fibres=6),
        damping_alpha=50.0,
    )
    sim.notch((-length, 0.0, 0.0), (notch, 0.0, 0.0))
    up, down = (mesh.node_set(leg)[0] for leg in ("up", "down"))
    rows, end = [(0.0, 0.0)], 0.65 * length
    while rows[-1][0] < end and sim.cracks.tips:
        for _ in range(200):
            sim.step()
        z = sim.state.node.x[:, 2]
        rows.append((0.5 * (z[up] - z[down]), sim.close_ledger().support_work))
    way, work = np.array(rows).T
    late = way > 0.6 * end
    force = 0.5 * np.polyfit(way[late], work[late], 1)[0]
    return {"force": float(force), "way": way.round(3).tolist(), "work": work.round(3).tolist()}


def probe(size, energy, cuts):
    """Drive the probe through film A from one cut or two; return its force and the cracks."""
    length, width = TRAVEL + 12.0, 30.0
    mesh = film_before(PROBE, size=size, length=length, width=width, band=5.0)
    sim = sc.Simulation(
        mesh,
        SLEEVE.material(),
        supports=[sc.Support.clamped("bottom"), sc.Support.clamped("top")],
        tool=bar_before(PROBE, 10.0),
        motion=motion_of(PROBE_SPEED),
        law=law_of(energy, SLEEVE_STRENGTH),
        contact=sc.Contact(penalty=200.0, friction=0.2),
        fracture=sc.Fracture(path="free", check_every=20, fibres=6),
        damping_beta=3e-9,
    )
    for y in (0.3,) if cuts == 1 else (-0.5, 0.5):
        sim.notch((-length, y * PROBE, 0.0), (1.5 * PROBE, y * PROBE, 0.0))
    rows = [(0.0, 0.0, 0.0)]
    while rows[-1][0] < TRAVEL and sim.cracks.tips:
        for _ in range(200):
            sim.step()
        way = sim.motion.coordinate(sim.state.time)
        rows.append((way, sim.ledger.tool_work, sim.state.crack_length))
    way, work, crack = np.array(rows).T
    late = way > 0.5 * way[-1]
    return {
        "force": float(np.polyfit(way[late], work[late], 1)[0]),
        "crack over way": float(np.polyfit(way[late], crack[late], 1)[0]),
        "way": way.round(3).tolist(),
        "work": work.round(3).tolist(),
    }


def notched(size):
    """Return the film between the jaws of D1004, with a notch of 90° from below."""
    x, step = [0.0], size
    while x[-1] < JAWS:
        step = min(1.25 * step, 4.0 * size) if x[-1] > 2.5 else size
        x.append(x[-1] + step)
    k = int(np.searchsorted(x, 2.5))
    x = np.array(x)
    x[k:] = x[k] + (x[k:] - x[k]) * (JAWS - x[k]) / (x[-1] - x[k])
    x = np.concatenate([-x[:0:-1], x])
    low = JAWS - np.abs(x)
    share = np.linspace(0.0, 1.0, round(JAWS / size) + 1)[:, None]
    y = low + share * (2.0 * JAWS - low)
    # A shape of some micrometres, from which the film may buckle.
    z = np.random.default_rng(1).uniform(-5e-4, 5e-4, y.shape)
    nodes = np.stack([np.broadcast_to(x, y.shape), y, z], axis=-1).reshape(-1, 3)
    ids = np.arange(len(nodes)).reshape(y.shape)
    quads = np.stack([ids[:-1, :-1], ids[:-1, 1:], ids[1:, 1:], ids[1:, :-1]], axis=-1)
    return sc.Mesh.from_arrays(nodes, quads.reshape(-1, 4))


def graves(size, sheet, energy=None, speed=200.0):
    """Pull the notched film; return its largest force.

    With an energy, it is elastic and has a slit of 0.6 mm at the notch, and tears. Without one it
    yields, and is whole, until the film at the notch has the elongation at break.
    """
    mesh, films = notched(size), {"film B": POLYIMIDE, "film C": POLYESTER}
    film, x = films[sheet], mesh.nodes[:, 0]
    jaws = np.flatnonzero(x < x.min() + 1e-9), np.flatnonzero(x > x.max() - 1e-9)
    moved = [
        sc.Support(jaw, velocity={"x": rising(v)})
        for jaw, v in zip(jaws, (-0.5 * speed, 0.5 * speed), strict=True)
    ]
    tears = {}
    if energy:
        tears["law"] = law_of(energy, film.curve[0][1])
        tears["fracture"] = sc.Fracture(path="free", check_every=10, fibres=6)
    material = film.material(yields=not energy)
    sim = sc.Simulation(mesh, material, supports=moved, damping_alpha=500.0, **tears)
    if energy:
        sim.notch((1e-3 * size, 0.9 * JAWS, 0.0), (1e-3 * size, JAWS + 0.6, 0.0))
    at = int(np.linalg.norm(mesh.nodes[:, :2] - (0.0, JAWS), axis=1).argmin())
    side = mesh.quads[(mesh.quads[:, 0] == at).argmax()][:2]
    length = float(np.linalg.norm(np.diff(mesh.nodes[side], axis=0)))
    broken, rows = film.curve[-1][0], []
    while True:
        for _ in range(100):
            sim.step()
        x = sim.state.node.x
        stretch = float(np.linalg.norm(np.diff(x[side], axis=0))) / length - 1.0
        rows.append((speed * sim.state.time, sim.state.node.reaction[jaws[1], 0].sum()))
        torn = energy and (sim.state.crack_length > 5.0 or not sim.cracks.tips)
        if torn or (not energy and stretch > broken):
            break
    way, force = np.array(rows).T
    smooth = np.convolve(force, np.full(5, 0.2), "valid")
    step = max(1, len(way) // 100)
    largest = float(smooth.max())
    return {
        "force": largest,
        **({slit_of(sheet): largest} if energy else {}),
        "way": way[::step].round(4).tolist(),
        "course": force[::step].round(4).tolist(),
    }


def slit_of(sheet):
    """Return the name of the largest force of a film with a slit."""
    return f"{sheet}: largest force with a slit at the notch [N]"


TESTS = {"legs": legs, "probe": probe, "graves": graves}


def run(test, **keys):
    """Run one of the tests."""
    return TESTS[test](**keys)


GRAVES_BELOW, GRAVES_ABOVE, NICK = 0.78, 0.8, 1.15
"""Least force over that of a film with a slit: speed, jaws and modulus, 15, 15 and 5 %. Largest
force over that at which the whole film has the elongation at break. Most likely force over that
with a slit: a die leaves nicks smaller than it."""
SNAG_ENERGY, SNAG_BAND = 48.0, 0.4
"""G of the runs with the probe [N/mm]; band of its force: friction and the shape of the probe 30 %,
yield stress and speed 25 %."""
PROBE_SIZES = 0.8, 0.6
"""Sides of the quads in front of the probe [mm]."""
PENDULUM_BAND = 0.35
"""Of the pendulum's force: speed 30 %, jaws 15 %, yield stress 10 %."""


def said(value, low, high):
    """Return a value with its band, in words."""
    return f"{value:.2g}, 90 %: {low:.2g} to {high:.2g}"


def estimates(results):
    """Return what is asked for, from the runs."""
    force = {name: one["force"] for name, one in results.items() if "force" in one}
    given, tried = {}, np.array(LEGS_TRIED)
    narrow, wide = (
        np.array([force[f"{name}, G = {energy:g}"] for energy in LEGS_TRIED])
        for name in ("trouser", "pendulum")
    )
    for direction, torn in SLEEVE_TORN.items():
        leg = torn * SLEEVE.thickness
        energy = float(np.polyval(np.polyfit(narrow, tried, 1), leg))
        pendulum = float(np.polyval(np.polyfit(tried, wide, 1), energy))
        parts = {"guessed": PENDULUM_BAND * pendulum}
        given[f"film A: Elmendorf force, {direction} direction [N]"] = pendulum, parts, 4
        # The part of the cables follows G.
        coarse, fine = force["probe, cuts: 1"], force["probe, finer"]
        snag = fine + (energy - SNAG_ENERGY) * SLEEVE.thickness
        ratio = PROBE_SIZES[1] / PROBE_SIZES[0]
        parts = {
            "mesh": ratio / (1.0 - ratio) * abs(fine - coarse),
            "guessed": SNAG_BAND * snag,
        }
        given[f"film A: snag resistance, {direction} direction [N]"] = snag, parts, 2
    follow = [results[f"probe, cuts: {cuts}"]["crack over way"] for cuts in (1, 2)]
    slit = abs(follow[1] - follow[0]) < 0.5  # of two cuts, only one becomes longer
    given["film A: what the snag leaves"] = "a single slit, 4 in 5" if slit else "a V, 4 in 5"
    for name, energies in (("B", (1.0, 1.0, 1.0)), ("C", POLYESTER_ENERGY)):
        slit, whole = (force[f"{name}, {how}"] for how in ("with a slit", "whole"))
        middle, low, high = (slit * math.sqrt(one / energies[0]) for one in energies)
        given[f"film {name}: largest force, Graves [N]"] = said(
            NICK * middle, GRAVES_BELOW * low, max(GRAVES_ABOVE * whole, NICK * high)
        )
    return given


def picture(results, path):
    """Draw the forces of the legs and of the notched films over the way."""
    of_legs, of_notches = [], []
    for name, one in results.items():
        way = np.array(one["way"])
        if "course" in one:
            style = f"c{len(of_notches)}"
            of_notches.append(Curve(f"film {name}", one["course"], style, x=way))
        elif "work" in one and "crack over way" not in one:
            force = 0.5 * np.gradient(np.array(one["work"]), way)
            smooth = np.convolve(force, np.full(5, 0.2), "same")
            style = f"c{len(of_legs)}"
            of_legs.append(Curve(f"{name} N/mm", smooth[:-3], style, x=way[:-3]))
    draw_curves(
        path,
        [
            Diagram([0.0, 40.0], of_legs, "path of a leg", "mm", "force", "N", "film A"),
            Diagram([0.0, 1.5], of_notches, "path of the jaws", "mm", "force", "N", "Graves"),
        ],
        size=(9.0, 8.0),
    )


LEGS_TRIED = 42.0, 54.0
"""G [N/mm]; the trouser forces lie on both sides of that on the sheet."""


def _runs():
    for energy in LEGS_TRIED:
        keys = {"test": "legs", "energy": energy}
        yield f"trouser, G = {energy:g}", Run({**keys, "size": 0.7}, 0.7)
        yield f"pendulum, G = {energy:g}", Run({**keys, "size": 1.0, "wide": True}, 1.0)
    for name, sheet, energy in (
        ("B", "film B", POLYIMIDE.energy(POLYIMIDE_LEG)),
        ("C", "film C", POLYESTER_ENERGY[0]),
    ):
        keys = {"test": "graves", "sheet": sheet, "size": 0.4}
        yield f"{name}, with a slit", Run({**keys, "energy": energy}, 0.4, short=True)
        yield f"{name}, whole", Run({**keys, "speed": 400.0}, 0.4)
    keys = {"test": "graves", "sheet": "film B", "energy": POLYIMIDE.energy(POLYIMIDE_LEG)}
    yield "B, with a slit, finer", Run({**keys, "size": 0.2}, 0.2)
    for cuts in (1, 2):
        keys = {"test": "probe", "size": PROBE_SIZES[0], "energy": SNAG_ENERGY, "cuts": cuts}
        yield f"probe, cuts: {cuts}", Run(keys, PROBE_SIZES[0])
    keys = {"test": "probe", "size": PROBE_SIZES[1], "energy": SNAG_ENERGY, "cuts": 1}
    yield "probe, finer", Run(keys, PROBE_SIZES[1])


PREDICTION = Prediction(
    title="Films from their data sheets",
    source="""A data sheet has a modulus, some stresses and one tear value of a film, and its user
needs another value. Of these three films the other value is published, and was withheld from us.

- A, shrink sleeve of 0.25 mm. Known: E 1900 MPa; 51 and 50 MPa at break in machine and cross
  direction; 4 % at yield; density 1.30; trouser tear (D1938) 34 and 37 N per mm of thickness.
  Asked: Elmendorf force (D1922) and snag resistance (D2582) in both directions; does the snag leave
  a single slit, or a V of two legs?
- B, polyimide of 0.025 mm. Known: E 2500 MPa, ν 0.34; 69 MPa at 3 %, 90 at 5 %, 231 at 72 %;
  Elmendorf force 0.07 N. Asked: largest force of a Graves tear (D1004: a notch of 90°, no cut).
- C, oriented polyester of 0.012 mm. Known: E 3790 MPa; 186 and 234 MPa at 110 and 80 %. Asked: the
  same.
""",
    sure="""
No value has been compared. Nobody searched for one. The writer of this section recognised film B
by its known values and remembers a value of its Graves tear, so the row of film B is not blind;
it follows the same rule as that of film C. The ± and the ranges are 90 % bands, and most of them
is judgement.""",
    model="""The films are isotropic, with the true stress linear in the true strain between the
points of the sheet ([how](howto/data-sheet.md)). Poisson's ratio is 0.38 where the sheet has
none. Film A yields at 50 MPa and keeps this nominal stress; its cables have 45 MPa. Strips of 25
mm (D1938) and 76 mm (D1922) are torn as trousers. The probe of the snag is a round bar of 3.2 mm
that moves at 3.2 m/s. Films B and C are squares of 25.4 mm between the jaws with a notch of 90°,
half as deep. Film B has G = 2 F/h = 5.6 N/mm. Film C has 6 N/mm, from 3 to 9: this is a guess
from another polyester film ([Millar2016]).""",
    figures=(
        *(
            Figure(f"film A: {what}, {direction} direction [N]", "withheld", waits=BLIND)
            for what in ("Elmendorf force", "snag resistance")
            for direction in SLEEVE_TORN
        ),
        Figure("film A: what the snag leaves", "withheld", waits=BLIND),
        Figure("film B: largest force, Graves [N]", "withheld", waits=KNOWN),
        Figure("film C: largest force, Graves [N]", "withheld", waits=BLIND),
        Figure(slit_of("film B"), "not published", short=(9.5, 12.5)),
        Figure(slit_of("film C"), "not published", short=(5.5, 8.5)),
    ),
    runs=dict(_runs()),
    run=run,
    picture=picture,
    derive=estimates,
    said="""**Film A, Elmendorf force.** The legs of the trouser test yield, because they are
narrower than 3 E G/σ_y², which is 110 mm. So 2 F/h, 68 and 74 N/mm, is no fracture energy. Runs
with 42 and 54 N/mm need 7.45 and 9.14 N on a leg; by a straight line the measured 8.5 and 9.25 N
need 49 and 55 N/mm. With these, legs of 38 mm as in D1922 need 4 % less than those of D1938. The
band, ±35 %, is the root of the sum of the squares of 30 % for the speed, which is some 500 times
higher, 15 % for the jaws and 10 % for the yield stress.

**Film A, snag.** From one cut the probe drives a single crack along its path and needs about
twice G h. The rest of its work is used by yielding film and friction, for which 0.2 is a guess.
From two cuts at its sides, which a V would continue, it needs the same force, and only one of
them becomes longer. So we expect a single slit. Beside the error of the mesh the band has 40 %:
30 % for friction and the shape of the probe, and 25 % for yield stress and speed. The model has
no law for whole film that breaks in front of the probe, so how the probe enters the film is left
out.

**Films B and C, Graves.** The force with a slit of 0.6 mm at the notch is a least one: it is that
of an elastic film which takes G. A die leaves smaller nicks, so 1.15 times it is the most likely
force. The lower end of the range is 0.78 times it, for speed and jaws (15 % each) and modulus (5
%). The upper end is 0.8 times the force at which film without a slit, which yields, has its
elongation at break at the notch: 41.6 N for B and 21.5 N for C. The model cannot say where
between these ends whole film begins to tear. For film C the range contains G from 3 to 9 N/mm.""",
    caption="Forces of the legs of film A and of the notched films B and C",
)


def main():
    """Print what follows from the sheets alone."""
    films = {
        "A, machine": (SLEEVE, SLEEVE_TORN["machine"] * SLEEVE.thickness),
        "A, cross": (SLEEVE, SLEEVE_TORN["cross"] * SLEEVE.thickness),
        "B": (POLYIMIDE, POLYIMIDE_LEG),
    }
    for name, (film, leg) in films.items():
        energy = film.energy(leg)
        print(
            f"film {name}: force on a leg {leg:.3g} N, 2 F/h = {energy:.3g} N/mm, "
            f"legs yield below {film.yielding_leg(energy):.3g} mm"
        )
    for name, film, energies in (
        ("B", POLYIMIDE, [POLYIMIDE.energy(POLYIMIDE_LEG)]),
        ("C", POLYESTER, POLYESTER_ENERGY),
    ):
        for energy in energies:
            zone = film.young * energy / film.curve[0][1] ** 2
            print(f"film {name}: G {energy:.3g} N/mm, process zone E G/σ² {zone:.3g} mm")


if __name__ == "__main__":
    main()
