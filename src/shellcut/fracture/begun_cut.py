"""Where a cut begins in film that no crack has reached."""

from __future__ import annotations

from typing import NamedTuple

from .quad_polygon import Point


class Pierced(NamedTuple):
    """How a tool pierces the face of whole film."""

    measure: float
    """Force or stress over that which the film carries."""
    force: float
    """On the cutting edge [N]."""
    delay: float
    """Of the mean force on a tip, see :mod:`.pressing_tips`."""
    depth: float
    """By which the film has been pushed out of its reference shape there [mm]."""


class Begun(NamedTuple):
    """A place where an edge cuts whole film."""

    row: int
    place: Point
    segment: int
    """Of the cutting edge."""
    pierced: Pierced | None = None
    """None where nothing supports the film against the edge."""
