"""Compile every kernel once, by cutting a tiny film.

Numba keeps the machine code in its cache, so this costs seconds on a machine's first run and a
fraction of a second on later ones. Timings that shall not contain compilation call it first.
"""

from __future__ import annotations

from .criterion import Fracture
from .models.guillotine import guillotine


def warmup() -> None:
    """Run a film of a few quads through every mechanism: shells, contact, cables, splits."""
    for criterion in ("force", "stress"):
        case = guillotine(
            1.0,
            length=6.0,
            width=4.0,
            travel=3.0,
            fracture=Fracture(criterion=criterion),
        )
        case.simulation.run(case.duration)
