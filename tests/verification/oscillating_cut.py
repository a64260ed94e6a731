"""Measure the wave of an oscillating cut: ``python tests/verification/oscillating_cut.py --help``.

Runs the model ``oscillating`` on a film long enough for some periods, in minutes, and prints the
extremes of the crack's path, wavelength and amplitude over the bar's diameter once the wave has
grown, and where the work went from there on.
"""

import argparse
import time
from dataclasses import replace

import numpy as np

import shellcut as sc
from shellcut.models.oscillating import (
    BAR_FILM,
    BAR_FRACTURE,
    BAR_LAW,
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


def from_gmsh(length, width, size):
    """Return a strip of Gmsh's quads."""
    corners = [[0.0, y] for y in (-0.5 * width, 0.5 * width)]
    corners = [*corners[:1], [length, -0.5 * width], [length, 0.5 * width], corners[1]]
    film = sc.mesh_from_outline(corners, size=size)
    y = film.nodes[:, 1]
    sides = {"bottom": y < -0.5 * width + 1e-6, "top": y > 0.5 * width - 1e-6}
    return film.with_sets(node_sets={name: np.flatnonzero(on) for name, on in sides.items()})


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


def run(case, until):
    """Run to the end; return rows of travel, crack and works: tool, cables, damping, imbalance."""
    sim, rows, began = case.simulation, [], time.time()
    while sim.state.time < case.duration and sim.cracks.tips:
        sim.step()
        if sim.state.step % 200 == 0:
            book = sim.ledger
            works = book.tool_work, book.cohesive_work, book.damping, book.imbalance, book.kinetic
            way = sim.motion.coordinate(sim.state.time)
            rows.append((way, sim.state.crack_length, *works))
        if time.time() - began > until:
            break
    return np.array(rows)


def arguments():
    """Return what the command line says."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    number = parser.add_argument
    number("--diameter", type=float, default=6.0, help="of the bar [mm]")
    number("--size", type=float, default=0.5, help="of the quads [mm]")
    number("--thickness", type=float, default=0.1, help="of the film [mm]")
    number("--speed", type=float, default=3000.0, help="of the bar [mm/s]")
    number("--length", type=float, default=22.0, help="of the film [diameters]")
    number("--width", type=float, default=6.0, help="of the film [diameters]")
    number("--band", type=float, default=1.2, help="half that of the fine quads [diameters]")
    number("--damping", type=float, default=STIFFNESS_DAMPING, help="of the stiffness [s]")
    number("--fibres", type=int, default=BAR_FRACTURE.fibres, help="of a segment")
    number("--notch", type=float, default=1.5, help="its length [diameters]")
    number("--offset", type=float, default=0.35, help="of the notch from the bar [diameters]")
    number(
        "--strength", type=float, default=BAR_LAW.strength, help="at the same fracture energy [MPa]"
    )
    number("--until", type=float, default=3600.0, help="wall time at most [s]")
    parser.add_argument("--mesh", choices=("moved", "turned", "gmsh"), default="moved")
    return parser.parse_args()


def weaker(strength):
    """Return the default law with another strength and the same fracture energy."""
    longer = BAR_LAW.strength / strength
    lengths = {
        name: longer * getattr(BAR_LAW, name)
        for name in ("opening_a", "opening_p", "opening_u", "onset")
    }
    return sc.CohesiveLaw(strength=strength, plateau=BAR_LAW.plateau / longer, **lengths)


def case_of(chosen):
    """Return the case to run."""
    d, size = chosen.diameter, chosen.size
    length, width, band = (d * n for n in (chosen.length, chosen.width, chosen.band))
    film = film_before(d, size=size, length=length, width=width, band=band)
    if chosen.mesh == "turned":
        film = turned(film, band)
    elif chosen.mesh == "gmsh":
        film = from_gmsh(length, width, size)
    return sc.oscillating(
        mesh=film,
        diameter=d,
        speed=chosen.speed,
        notch=chosen.notch * d,
        offset=chosen.offset * d,
        law=weaker(chosen.strength),
        material=sc.ShellMaterial.homogeneous(**{**BAR_FILM, "thickness": chosen.thickness}),
        fracture=replace(BAR_FRACTURE, fibres=chosen.fibres),
        damping_beta=chosen.damping,
    )


def main():
    chosen = arguments()
    d, case = chosen.diameter, case_of(chosen)
    rows = run(case, chosen.until)
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
