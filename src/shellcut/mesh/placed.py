"""Where a film lies: :func:`placed` turns and moves it before anything is chosen on it.

A film may be drawn in any plane and anywhere. The ready models have it in z = 0, the tool above it
on the z axis; what a free model says of places is in the same axes. So the film is turned to z
first, then about z, and moved last: the shift is along the axes of the model, those of every
message. Supports, loads, notch and the film's direction come after that and see the film in its
place.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Annotated

import numpy as np

from shellcut.arguments import Option, checked
from shellcut.arrays import product, three, unit
from shellcut.formats.file_axis import turn_to_z

from .mesh import Mesh, MeshError
from .quad_geometry import plane_normal

_FARTHEST = 1e6
"""Largest shift over the size of the film: beyond it, round-off changes the film's shape."""


@checked
def placed(
    mesh: Mesh,
    *,
    axis: Annotated[
        str | Sequence[float],
        Option(
            "",
            "direction in the file that becomes z, by the smallest rotation; normal: of its quads",
            form="direction",
        ),
    ] = "z",
    turn_deg: Annotated[
        float, Option("deg", "then a turn of the film about z, counter-clockwise seen from above")
    ] = 0.0,
    shift: Annotated[
        Sequence[float], Option("mm", "translation of the film, after the turns", form="3 numbers")
    ] = (0.0, 0.0, 0.0),
) -> Mesh:
    """Return the film turned about the origin, then moved; sets keep their ids.

    Raises
    ------
    ValueError
        If a direction is none, or the film is moved so far that round-off changes its shape.
    MeshError
        If the film has no normal because it is not flat.

    Examples
    --------
    >>> upright = Mesh.from_arrays([[0, 3, 0], [1, 3, 0], [1, 3, 1], [0, 3, 1]], [[0, 1, 2, 3]])
    >>> film = placed(upright, axis="-y", turn_deg=90.0, shift=(0.0, 0.0, 3.0))
    >>> (film.nodes.round(12) + 0.0).tolist()
    [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]
    """
    move = three("shift", shift, "mm")
    farthest = _FARTHEST * float(np.ptp(mesh.nodes, axis=0).max())
    if not np.abs(move).max() <= farthest:
        raise ValueError(
            f"shift must be at most {farthest:.3g} mm, {_FARTHEST:.0e} times the size of the film, "
            f"or round-off changes its shape; got {move.tolist()} mm"
        )
    normal = plane_normal(mesh.nodes, mesh.quads) if axis == "normal" else None
    if normal is None and axis == "normal":
        raise MeshError(
            "axis = 'normal' needs a flat film, and this one is not flat: give the direction in "
            "its file that becomes z"
        )
    turn = turn_to_z(axis if normal is None else normal.tolist())
    if turn_deg:
        c, s = math.cos(math.radians(turn_deg)), math.sin(math.radians(turn_deg))
        turn = product(np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]), turn)
    if (turn == np.eye(3)).all():
        return replace(mesh, nodes=mesh.nodes + move) if move.any() else mesh
    directors = unit(product(mesh.directors, turn.T))
    return replace(mesh, nodes=product(mesh.nodes, turn.T) + move, directors=directors)
