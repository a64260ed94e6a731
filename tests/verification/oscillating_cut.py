"""Measure the wave of an oscillating cut: ``python tests/verification/oscillating_cut.py --help``.

Runs the model ``oscillating`` on a film long enough for some periods, in minutes, and prints the
extremes of the crack's path, wavelength and amplitude over the bar's diameter once the wave has
grown, and where the work went from there on.
"""

import argparse
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

import shellcut as sc
from courses import recorded
from gmsh_films import gmsh_strip
from shellcut.models.oscillating import (
    BAR_FILM,
    BAR_FRACTURE,
    STIFFNESS_DAMPING,
    film_before,
)

GROWN = 0.5
"""Of the diameter: the wave has grown when an extreme lies beyond the bar's side."""

LEAST = 0.08
"""Of the diameter: a crack that moves no farther to the other side is not yet there."""


def turned(film, half, degrees=20.0):
    """Return a film with its columns of quads turned in the band |y| < half, not at its ends."""
    X, L = film.nodes.copy(), float(np.ptp(film.nodes[:, 0]))
    ends = np.clip(np.minimum(X[:, 0], L - X[:, 0]) / 4.0, 0.0, 1.0)
    X[:, 0] += np.tan(np.radians(degrees)) * np.clip(X[:, 1], -half, half) * ends
    return sc.Mesh.from_arrays(X, film.quads, node_sets=film.node_sets)


def extremes(path, diameter):
    """Return where a path turns back from either side of the bar's line, shape (n, 2) [mm]."""
    found, side, here = [], 0, []
    for x, y in path:
        now = int(np.sign(y)) if abs(y) > LEAST * diameter else 0
        if now and now != side:
            if side:
                found.append(max(here, key=lambda place: abs(place[1])))
            side, here = now, []
        here.append((x, y))
    return np.array(found).reshape(-1, 2)


def grown(turns, path, diameter):
    """Return the extremes, shape (n, 2), from the first beyond the bar's side on that is no notch.

    Without the last one, if the path has not yet turned back from it.
    """
    far = np.flatnonzero(np.abs(turns[1:, 1]) > GROWN * diameter)
    if not len(far):
        return turns[:0]
    back = abs(turns[-1, 1]) - np.sign(turns[-1, 1]) * path[-1][1]
    return turns[1 + far[0] : None if back > 0.1 * diameter else -1]


def run(case):
    """Run to the end; return rows of travel, crack and works: tool, cables, damping, imbalance."""

    def ended(sim):
        return sim.state.time >= case.duration or not sim.cracks.tips

    def read(sim):
        book, way = sim.ledger, sim.motion.coordinate(sim.state.time)
        works = book.tool_work, book.cohesive_work, book.damping, book.imbalance, book.kinetic
        return way, sim.state.crack_length, *works

    return recorded(case.simulation, ended, read, every=200).T


NUMBERS = {
    "diameter": (6.0, "of the bar [mm]"),
    "size": (0.5, "of the quads [mm]"),
    "thickness": (0.1, "of the film [mm]"),
    "speed": (3000.0, "of the bar [mm/s]"),
    "length": (22.0, "of the film [diameters]"),
    "width": (6.0, "of the film [diameters]"),
    "band": (1.2, "half that of the fine quads [diameters]"),
    "damping": (STIFFNESS_DAMPING, "of the stiffness [s]"),
    "fibres": (BAR_FRACTURE.fibres, "of a segment"),
    "notch": (1.5, "its length [diameters]"),
    "offset": (0.35, "of the notch from the bar [diameters]"),
}
"""Options of the command line, with their defaults."""


def arguments():
    """Return what the command line says."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    for name, (default, words) in NUMBERS.items():
        parser.add_argument(f"--{name}", type=type(default), default=default, help=words)
    parser.add_argument("--mesh", choices=("moved", "turned", "gmsh"), default="moved")
    return parser.parse_args()


def case_of(chosen):
    """Return the case to run."""
    d, size = chosen.diameter, chosen.size
    length, width, band = (d * n for n in (chosen.length, chosen.width, chosen.band))
    film = film_before(d, size=size, length=length, width=width, band=band)
    if chosen.mesh == "turned":
        film = turned(film, band)
    elif chosen.mesh == "gmsh":
        film = gmsh_strip(length, width, size)
    return sc.oscillating(
        mesh=film,
        diameter=d,
        speed=chosen.speed,
        notch=chosen.notch * d,
        offset=chosen.offset * d,
        material=sc.ShellMaterial.homogeneous(**{**BAR_FILM, "thickness": chosen.thickness}),
        fracture=replace(BAR_FRACTURE, fibres=chosen.fibres),
        damping_beta=chosen.damping,
    )


def main():
    chosen = arguments()
    d, case = chosen.diameter, case_of(chosen)
    rows = run(case)
    cuts = [cut for cut in case.simulation.state.split_log if cut.kind != "notch"]
    path = [cut.reference[:2] for cut in cuts]
    turns = extremes(path, d)
    print("extremes [mm]:", ", ".join(f"({x:.1f}, {y:+.2f})" for x, y in turns))
    wave = grown(turns, path, d)
    if len(wave) < 3:
        print(f"too short: fewer than three extremes beyond {GROWN * d:g} mm")
        return
    half, high = np.diff(wave[:, 0]), 0.5 * np.abs(np.diff(wave[:, 1]))
    error = 2.0 * half.std(ddof=1) / len(half) ** 0.5 / d
    print(f"grown from {wave[0, 0]:.0f} mm on, {len(half) / 2:g} periods")
    print(f"wavelength / diameter {2.0 * half.mean() / d:.2f} ± {error:.2f}")
    print(f"amplitude / diameter {high.mean() / d:.2f}, scatter {high.std() / d:.2f}")
    late = rows[rows[:, 0] > wave[0, 0]]
    way, crack, work, cables, damping, *_ = late[-1] - late[0]
    G_h = case.simulation.law.fracture_energy * chosen.thickness
    print(f"force / (G h) {work / way / G_h:.2f}, crack / way {crack / way:.2f}")
    print(f"cables / (G h crack) {cables / (G_h * crack):.3f}, damped {damping / work:.2f}")
    print(f"damped in the whole run {rows[-1, 4] / rows[-1, 2]:.2f}")
    print(f"imbalance / work {np.abs(rows[:, 5]).max() / rows[-1, 2]:.5f}")
    print(f"kinetic / work at most {(late[:, 6] / late[:, 2]).max():.2f}")


if __name__ == "__main__":
    main()
