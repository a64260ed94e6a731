"""Compile every kernel once, by cutting a tiny film.

Numba keeps the machine code in its cache, so this costs seconds on a machine's first run and a
fraction of a second on later ones. Timings that shall not contain compilation call it first.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import numpy as np

from shellcut.fracture.criterion import Fracture, Measure
from shellcut.imprinting import PathCurve, imprint
from shellcut.mesh.structured import rectangle
from shellcut.view._raster import Canvas

from .guillotine import guillotine


def warmup(
    criteria: Sequence[Measure] = ("force", "stress"), precisions: Sequence[str] = ("double",)
) -> None:
    """Run a film of a few quads through every mechanism: shells, contact, cables, splits, imprint.

    Pictures of the film are compiled for too.

    Parameters
    ----------
    criteria : sequence of str
        Which criteria of :class:`Fracture` to compile for.
    precisions : sequence of str
        Which precisions of :class:`Simulation`.

    Examples
    --------
    >>> import shellcut
    >>> shellcut.warmup()  # doctest: +SKIP
    """
    for criterion, precision in product(criteria, precisions):
        case = guillotine(
            1.0,
            length=6.0,
            width=4.0,
            notch=1.0,
            travel=1.5,
            fracture=Fracture(criterion=criterion),
            precision=precision,
        )
        case.simulation.run(case.duration)
    imprint(rectangle(6.0, 4.0, size=1.0), PathCurve.line((0.0, 0.3), (6.0, 0.3)))
    Canvas((1, 1)).draw(np.zeros((0, 3, 3)), np.ones(3))
