"""The film of the step benchmarks: a clamped disc under a steady pressure, of any size."""

from __future__ import annotations

import inspect
from typing import Any

from shellcut import Elastic, Layer, Mesh, Pressure, ShellMaterial, Simulation, Stepping, Support
from shellcut.mesh.structured import disc, opening_disc

RADIUS = 10.2

# Low enough for the safe step of the flat disc to hold through the few hundred steps of a timing.
PRESSURE = 0.005  # MPa

# Two points a layer are the fewest that can bend.
POINTS = 2

SIZES: dict[str, int | str] = {
    "1e3": 28,
    "M1": "M1",
    "M2": "M2",
    "3e4": 153,
    "1e5": 280,
    "3e5": 486,
    "1e6": 886,
}
"""Meshes by name: quads along a side of the core, or a mesh of the opening test."""


def build_mesh(size: int | str) -> Mesh:
    """Return the disc of a size: a value of SIZES, or a number of quads along the core's side."""
    return opening_disc(size) if isinstance(size, str) else disc(RADIUS, n_side=size)  # type: ignore[arg-type]


def materials() -> dict[str, ShellMaterial]:
    """Return the sections that are timed, by name."""
    film, foil = Elastic(1678.0, 0.3, 1.0e-9), Elastic(3000.0, 0.35, 1.2e-9)
    return {
        "linear": ShellMaterial.homogeneous(),
        "points": ShellMaterial.homogeneous(points_per_layer=POINTS),
        "laminate": ShellMaterial([Layer(film, 0.05), Layer(foil, 0.024)]),
    }


def accepts_threads() -> bool:
    """Whether Simulation lets the number of threads be chosen."""
    return "threads" in inspect.signature(Simulation.__init__).parameters


def pressurised_disc(
    mesh: Mesh, material: str, *, threads: int = 1, evaluate_every: int = 10**9
) -> Simulation:
    """Build the disc, damping on; the stable step is evaluated at the start only by default.

    ``material`` is a name of :func:`materials`.

    Raises
    ------
    ValueError
        If two threads are asked of a library that cannot choose them.
    """
    options: dict[str, Any] = {}
    if accepts_threads():
        options["threads"] = threads
    elif threads != 1:
        raise ValueError("Simulation has no option threads: only 1 can be timed")
    return Simulation(
        mesh,
        materials()[material],
        supports=[Support.clamped("rim")],
        loads=[Pressure(PRESSURE)],
        stepping=Stepping(evaluate_every=evaluate_every),
        **options,
    )
