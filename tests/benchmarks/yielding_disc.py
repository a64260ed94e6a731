"""A pressurised disc that yields, in statics: shellcut, CalculiX's shells and CalculiX's solids.

    python -m benchmarks.yielding_disc [N_SIDE ...]

Clamped, R = 10 mm, 0.1 mm thick, sigma_y = 15 MPa, H = 60 MPa, dead pressure. Printed are the
deflection of the middle [mm] at six pressures and the CPU seconds of the process, one thread.

CalculiX has the disc twice: as S8R shells on our quads, and as CAX8R solids around an axis, whose
rim is held over the whole thickness. The solids are the reference: they converge. The shells do
not come to them, because CalculiX makes a rigid body of the rim of an expanded shell that is held
against rotation. Its flow curve is of Cauchy's stress, ours of Kirchhoff's: they differ by the
ratio of volumes, 0.9 % of the stress here and a tenth of that with ``YOUNG=16780``.
"""

from __future__ import annotations

import os
import re
import sys
import tempfile
import time
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.calculix_disc import run_deck
from shellcut import Pressure, ShellMaterial, Support
from shellcut.material import Elastic, Layer, Linear, Plastic
from shellcut.mesh.mesh import Mesh
from shellcut.mesh.structured import disc
from shellcut.statics.statics import Statics

Array = np.ndarray[Any, Any]

RADIUS, THICKNESS, POISSON, YIELD, HARDENING, DENSITY = 10.0, 0.1, 0.3, 15.0, 60.0, 1e-9
YOUNG = float(os.environ.get("YOUNG", "1678"))
PRESSURES = (0.01, 0.02, 0.05, 0.1, 0.15, 0.2)  # MPa
STEPS = np.unique(
    np.r_[0.0005, 0.001, 0.002, 0.003, 0.005, 0.0075, np.linspace(0.01, 0.2, 20), PRESSURES]
)


def ours(n_side: int) -> tuple[list[float], float]:
    """Return the deflections and the CPU time of the second of two runs [s]."""
    mesh = disc(RADIUS, n_side=n_side)
    law = Plastic(Elastic(YOUNG, POISSON, DENSITY), Linear(YIELD, HARDENING))
    film = ShellMaterial([Layer(law, THICKNESS)], points_per_layer=5)
    centre = int(mesh.node_set("centre")[0])

    def run(pressures: Iterable[float]) -> dict[float, float]:
        plate = Statics(mesh, film, supports=[Support.clamped("rim")], loads=[Pressure(1.0)])
        return {p: float(plate.load_steps([p])[-1].displacement[centre, 2]) for p in pressures}

    run(STEPS[:2])
    began = time.process_time()
    found = run(STEPS.tolist())
    return [found[p] for p in PRESSURES], time.process_time() - began


def _material() -> list[str]:
    return [
        "*MATERIAL, NAME=FILM",
        "*ELASTIC",
        f"{YOUNG}, {POISSON}",
        "*PLASTIC",
        f"{YIELD}, 0.",
        f"{YIELD + 3.0 * HARDENING}, 3.",
        "*DENSITY",
        f"{DENSITY}",
    ]


def _steps(axis: int, increment: float) -> list[str]:
    way = ", ".join("1" if k == axis else "0" for k in range(3))
    lines = []
    for pressure in PRESSURES:
        lines += [
            "*STEP, NLGEOM, INC=3000",
            "*STATIC",
            f"{min(0.05, increment)}, 1., 1e-6, {increment}",
            "*DLOAD",
            f"FILM, GRAV, {pressure / (DENSITY * THICKNESS):.12g}, {way}",
            "*NODE PRINT, NSET=MIDDLE, FREQUENCY=3000",
            "U",
            "*END STEP",
        ]
    return lines


def _model(nodes: Iterable[Any], quads: Iterable[Any], kind: str) -> list[str]:
    return [
        "*NODE, NSET=ALL",
        *(f"{k}, {x:.12g}, {y:.12g}, {z:.12g}" for k, (x, y, z) in enumerate(nodes, 1)),
        f"*ELEMENT, TYPE={kind}, ELSET=FILM",
        *(", ".join(map(str, [k, *(n + 1 for n in quad)])) for k, quad in enumerate(quads, 1)),
    ]


def _set(name: str, nodes: Iterable[int]) -> list[str]:
    return [f"*NSET, NSET={name}", *(f"{n + 1}," for n in nodes)]


def solids(n_radius: int, n_thick: int = 2) -> list[str]:
    """Return the deck of CAX8R solids, finer towards the rim."""
    r = RADIUS * (1.0 - (1.0 - np.linspace(0.0, 1.0, 2 * n_radius + 1)) ** 1.5)
    r[1::2] = 0.5 * (r[:-1:2] + r[2::2])
    z = np.linspace(-0.5 * THICKNESS, 0.5 * THICKNESS, 2 * n_thick + 1)
    around = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1)]
    used: dict[tuple[int, int], int] = {}
    quads = [
        [used.setdefault((2 * i + a, 2 * j + b), len(used)) for a, b in around]
        for i in range(n_radius)
        for j in range(n_thick)
    ]
    nodes = [(r[i], z[j], 0.0) for i, j in used]
    return [
        *_model(nodes, quads, "CAX8R"),
        *_set("RIM", (n for (i, _), n in used.items() if i == 2 * n_radius)),
        *_set("AXIS", (n for (i, _), n in used.items() if i == 0)),
        *_set("MIDDLE", [used[0, n_thick]]),
        *_material(),
        "*SOLID SECTION, ELSET=FILM, MATERIAL=FILM",
        "*BOUNDARY",
        "RIM, 1, 2",
        "AXIS, 1, 1",
        *_steps(1, 0.1),
    ]


def shells(n_side: int, held: str = "1, 6") -> list[str]:
    """Return the deck of S8R shells on the quads of :func:`ours`."""
    mesh = disc(RADIUS, n_side=n_side)
    nodes, quads, rim = _with_midsides(mesh)
    return [
        *_model(nodes, quads, "S8R"),
        *_set("RIM", sorted(rim)),
        *_set("MIDDLE", mesh.node_set("centre")[:1]),
        *_material(),
        "*SHELL SECTION, ELSET=FILM, MATERIAL=FILM",
        f"{THICKNESS}",
        "*BOUNDARY",
        f"RIM, {held}",
        *_steps(2, 0.25),
    ]


def _with_midsides(mesh: Mesh) -> tuple[list[Array], list[list[int]], set[int]]:
    nodes, rim = list(mesh.nodes), set(mesh.node_set("rim").tolist())
    middles: dict[tuple[int, int], int] = {}
    quads = []
    for quad in mesh.quads.tolist():
        sides = zip(quad, [*quad[1:], quad[0]], strict=True)
        for a, b in (pair := [(min(s), max(s)) for s in sides]):
            if (a, b) not in middles:
                middle = 0.5 * (mesh.nodes[a] + mesh.nodes[b])
                if a in rim and b in rim:
                    middle *= RADIUS / np.hypot(*middle[:2])
                    rim.add(len(nodes))
                middles[a, b] = len(nodes)
                nodes.append(middle)
        quads.append([*quad, *(middles[side] for side in pair)])
    return nodes, quads, rim


def calculix(lines: list[str], axis: int) -> tuple[list[float], float]:
    """Run a deck; return the deflections and the CPU time [s]."""
    with tempfile.TemporaryDirectory() as folder:
        _, cpu = run_deck(Path(folder), "\n".join(lines) + "\n")
        said = (Path(folder) / "disc.dat").read_text()
    rows = re.findall(r"and time\s+\S+\s+\d+\s+(\S+)\s+(\S+)\s+(\S+)", said)
    return [float(row[axis]) for row in rows], cpu


def main(sides: list[int]) -> None:
    """Print a row for each program and mesh."""

    def say(name: str, found: tuple[list[float], float]) -> None:
        print(f"{name:<28}", *(f"{w:8.4f}" for w in found[0]), f"{found[1]:8.1f} s", flush=True)

    print(f"{'MPa':<28}", *(f"{p:>8}" for p in PRESSURES))
    for n in sides:
        say(f"shellcut, {disc(RADIUS, n_side=n).n_quad} quads", ours(n))
    for n in (30, 60):
        say(f"CalculiX CAX8R, {n} x 2", calculix(solids(n), 1))
    for held in ("1, 6", "1, 3"):
        name = f"CalculiX S8R, {disc(RADIUS, n_side=sides[0]).n_quad}, held {held}"
        say(name, calculix(shells(sides[0], held), 2))


if __name__ == "__main__":
    main([int(n) for n in sys.argv[1:]] or [10, 20])
