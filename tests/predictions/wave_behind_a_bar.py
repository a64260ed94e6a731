"""A blunt bar driven through a film: the wave of its crack is in proportion to the bar."""

import numpy as np

import shellcut as sc
from oscillating_cut import extremes, grown
from prediction import Figure, Prediction, Run
from shellcut.view import Curve, Diagram, draw_curves

DIAMETERS = (6.0, 9.0)
SPEED = 36e3
"""Of the bar times its diameter [mm²/s]: a flap swings in a time that goes with its square."""
LONG = 14.0
"""The film, in diameters."""


def wave(diameter, off):
    """Return wavelength and amplitude [mm], and the path in diameters."""
    d = diameter * (1.0 + 1e-6 * off)
    case = sc.oscillating(diameter=d, length=LONG * d, speed=SPEED / d)
    sim = case.simulation
    while sim.state.time < case.duration and sim.cracks.tips:
        sim.step()
    path = [cut.reference[:2] for cut in sim.state.split_log if cut.kind != "notch"]
    turns = grown(extremes(path, d), path, d)
    way = (np.array(path) / d).round(3).tolist()
    if len(turns) < 3:
        return None, None, way
    half, high = np.diff(turns[:, 0]), 0.5 * np.abs(np.diff(turns[:, 1]))
    return float(2.0 * half.mean()), float(high.mean()), way


def run(off):
    """Run both bars; return the powers of the diameter, and the paths."""
    found = {d: wave(d, off) for d in DIAMETERS}
    given = {f"path {d:g}": way for d, (_, _, way) in found.items()}
    for d, (length, high, _) in found.items():
        if length is not None:
            given |= {f"lambda/d, d = {d:g} mm": length / d, f"A/d, d = {d:g} mm": high / d}
    if all(length is not None for length, _, _ in found.values()):
        (l_1, a_1, _), (l_2, a_2, _) = found.values()
        larger = np.log(DIAMETERS[1] / DIAMETERS[0])
        given["p of wavelength ~ d^p"] = float(np.log(l_2 / l_1) / larger)
        given["p of amplitude ~ d^p"] = float(np.log(a_2 / a_1) / larger)
    return given


def picture(results, path):
    """Draw the paths, in diameters."""
    diagrams = []
    for d in DIAMETERS:
        ways = [np.array(one[f"path {d:g}"]) for one in results.values()]
        curves = [Curve(f"run {k}", w[:, 1], f"c{2 * k}", x=w[:, 0]) for k, w in enumerate(ways)]
        curves += [Curve("sides of the bar", [y, y], "same", x=[0, LONG]) for y in (-0.5, 0.5)]
        names = "x / d", "", "y / d", "", f"d = {d:g} mm"
        diagrams.append(Diagram([0.0, LONG], curves, *names, zero=False))
    draw_curves(path, diagrams, size=(10.0, 5.0))


PREDICTION = Prediction(
    title="The wave behind a blunt bar",
    source="""[Roman2003], [GhatakMahadevan2003]: a blunt bar driven through a clamped brittle
film tears a wavy crack, its amplitude and wavelength in proportion to the bar, whatever speed
and thickness.""",
    sure="""measured over a decade of breadths on films whose bending length h √(E/12 G) is
0.002 to 0.04 of the bar. No coefficient was at hand, so the power p of the diameter is
compared; the band, 0.9 to 1.1, is ours.""",
    known="""All: λ/d of 2.87 and 2.26 in [longer runs](theory/oscillating.md#the-wave).""",
    model="""`shellcut.oscillating` behind bars of 6 and 9 mm at 6 and 4 m/s, film 14 diameters
long, 0.1 mm thick, 2200 MPa, 3 N/mm, quads of 0.5 mm: the bending length is 0.13 and 0.09 of
the bar. Runs differ by a millionth of the diameter.""",
    figures=(
        Figure("p of wavelength ~ d^p", "1", 0.9, 1.1),
        Figure("p of amplitude ~ d^p", "1", 0.9, 1.1),
    ),
    runs={f"{k}": Run({"off": k}, 0.5, short=k == 0) for k in range(1)},
    run=run,
    picture=picture,
    caption="Paths of the cracks, in diameters of the bar",
)
