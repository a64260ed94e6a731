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
from shellcut.arrays import Floats, norm, product, three, unit
from shellcut.formats.errors import point_text
from shellcut.formats.file_axis import turn_to_z

from .mesh import Mesh, MeshError
from .quad_geometry import plane_normal

_FARTHEST = 1e6
"""Largest shift in sizes of the film: coordinates then keep nine digits of its shape."""


@checked
def placed(
    mesh: Mesh,
    *,
    axis: Annotated[
        str | Sequence[float],
        Option(
            "",
            "direction in the file that becomes z, by the shortest turn; normal: that of its quads",
            form="direction",
        ),
    ] = "z",
    turn_deg: Annotated[
        float, Option("deg", "turns the film about z after that, counter-clockwise from above")
    ] = 0.0,
    shift: Annotated[
        Sequence[float], Option("mm", "moves the film after that", form="3 numbers")
    ] = (0.0, 0.0, 0.0),
) -> Mesh:
    """Return the film turned about the origin, then moved; sets keep their ids.

    Raises
    ------
    ValueError
        If a direction is none, or the shift is too large.
    MeshError
        If the film has no normal of its own because it is not flat.

    Examples
    --------
    >>> upright = Mesh.from_arrays([[0, 3, 0], [1, 3, 0], [1, 3, 1], [0, 3, 1]], [[0, 1, 2, 3]])
    >>> film = placed(upright, axis="-y", turn_deg=90.0, shift=(0.0, 0.0, 3.0))
    >>> (film.nodes.round(12) + 0.0).tolist()
    [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]
    """
    move = three("shift", shift, "mm")
    size = float(norm(np.ptp(mesh.nodes, axis=0)))
    if np.abs(move).max() > _FARTHEST * size:
        raise ValueError(
            f"shift must be within {_FARTHEST:g} times the film's size of {size:.4g} mm, "
            f"got {point_text(move)} mm"
        )
    turn = turn_to_z(_own_normal(mesh).tolist() if axis == "normal" else axis)
    if turn_deg:
        c, s = math.cos(math.radians(turn_deg)), math.sin(math.radians(turn_deg))
        turn = product(np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]), turn)
    if (turn == np.eye(3)).all():
        return replace(mesh, nodes=mesh.nodes + move) if move.any() else mesh
    directors = unit(product(mesh.directors, turn.T))
    return replace(mesh, nodes=product(mesh.nodes, turn.T) + move, directors=directors)


def _own_normal(mesh: Mesh) -> Floats:
    normal = plane_normal(mesh.nodes, mesh.quads)
    if normal is None:
        raise MeshError(
            "axis = 'normal' is of a flat film, and this one is not: give the direction in its "
            "file that becomes z"
        )
    return normal
