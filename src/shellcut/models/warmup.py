"""Compile every kernel once, by cutting a tiny film.

Numba stores the machine code in its cache, so this takes half a minute on a machine's first run and
a fraction of a second later. Call it before timing anything.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from shellcut.fracture.criterion import Fracture, Measure, Path
from shellcut.mesh.structured import rectangle
from shellcut.view._raster import Canvas

from .guillotine import guillotine


def warmup(
    criteria: Sequence[Measure] = ("force", "stress"),
    paths: Sequence[Path] = ("edges", "free"),
) -> None:
    """Run a film of a few quads through every mechanism: shells, contact, cables, cuts.

    Also compile the kernels for pictures of the film.

    Parameters
    ----------
    criteria : sequence of str
        Criteria of :class:`Fracture` to compile for, of cracks along edges.
    paths : sequence of str
        Paths of :class:`Fracture` to compile for.

    Examples
    --------
    >>> import shellcut
    >>> shellcut.warmup()  # doctest: +SKIP
    """
    along_edges = [Fracture(criterion=name, path="edges") for name in criteria]
    ways = {"edges": along_edges, "free": [Fracture(path="free")]}
    between_lines = rectangle(6.0, 4.0, n_x=6, n_y=5)
    for path in paths:
        film = {"mesh": between_lines, "notch": 0.0} if path == "free" else {"notch": 1.0}
        for fracture in ways[path]:
            case = guillotine(1.0, length=6.0, width=4.0, travel=1.5, fracture=fracture, **film)
            case.simulation.run(case.duration)
    canvas = Canvas((1, 1))
    canvas.draw(np.zeros((0, 3, 3)), np.ones(3))
    canvas.blend(canvas, 0.5)
