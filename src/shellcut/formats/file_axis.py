"""The direction in a file that becomes z, the normal of the film and the axis of the tool."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, TypeAlias

import numpy as np

from shellcut.arguments import Option
from shellcut.arrays import Floats, product, unit

_AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}

FileAxis: TypeAlias = Annotated[
    str | Sequence[float],
    Option("", "direction in the file that becomes z, by the smallest rotation", form="direction"),
]


def turn_to_z(axis: str | Sequence[float]) -> Floats:
    """Return the shortest rotation that turns a direction to z, shape (3, 3).

    It has exact zeros and ones for the axes by name. ValueError if there is no such direction.

    Examples
    --------
    >>> product(turn_to_z("x"), np.array([2.0, 0.0, 0.0])).tolist()
    [0.0, 0.0, 2.0]
    """
    if isinstance(axis, str):
        sign = -1.0 if axis.startswith("-") else 1.0
        if axis.lstrip("+-") not in _AXES:
            raise ValueError(f"axis must be x, y, z, -x, -y, -z or a direction, got {axis!r}")
        direction = sign * np.array(_AXES[axis.lstrip("+-")])
    else:
        direction = np.asarray(axis, dtype=np.float64)
        if direction.shape != (3,) or not np.isfinite(direction).all() or not direction.any():
            raise ValueError(f"axis must be a direction of three numbers, got {axis!r}")
        direction = unit(direction)
    x, y, cosine = direction.tolist()
    if cosine < -1.0 + 1e-12:  # the opposite: half a turn about x
        return np.diag([1.0, -1.0, -1.0])
    w = np.array([[0.0, 0.0, -x], [0.0, 0.0, -y], [x, y, 0.0]])  # of direction x z
    return np.asarray(np.eye(3) + w + product(w, w) / (1.0 + cosine))
