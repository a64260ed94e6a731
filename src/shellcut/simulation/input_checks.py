"""What a Simulation refuses before it is built: sentences, all of them at once."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from shellcut.arrays import Floats
from shellcut.cables.cohesive_law import CohesiveLaw
from shellcut.contact.settings import Contact
from shellcut.fracture.criterion import Fracture
from shellcut.tool.motion import Motion
from shellcut.tool.tool import Tool


def negative(**numbers: float) -> Iterator[str]:
    """Yield which of some numbers are negative, or none at all."""
    for name, value in numbers.items():
        if not value >= 0:
            yield f"{name} must be a number that is not negative, got {value!r}"


def without_partner(
    tool: Tool | None,
    motion: Motion | None,
    law: CohesiveLaw | None,
    contact: Contact | None,
    fracture: Fracture | None,
) -> Iterator[str]:
    """Yield what is given without what it needs."""
    if (tool is None) != (motion is None):
        yield "tool and motion go together: give both or none"
    if law is None and fracture is not None:
        yield "fracture needs a law for the cables: give law=CohesiveLaw() too"
    if tool is None and contact is not None:
        yield "contact needs a tool to be in contact with: give tool and motion too"


def not_with_free_path(fracture: Fracture | None, tool: Tool | None) -> Iterator[str]:
    """Yield what cracks through quads cannot do yet."""
    if fracture is None or fracture.path != "free":
        return
    if tool is not None and fracture.anisotropy is not None:
        yield (
            "Fracture.anisotropy is of cracks that no blade drives, got a tool: leave out one of "
            "them"
        )


def ends_of_notch(start: npt.ArrayLike, end: npt.ArrayLike) -> tuple[Floats, Floats]:
    """Return the ends of a notch as points, shape (3,) each [mm]; refuse those that are none."""
    a, b = np.asarray(start, float), np.asarray(end, float)
    if a.shape != (3,) or b.shape != (3,) or not np.isfinite([a, b]).all() or (a == b).all():
        raise ValueError(f"a notch needs two different points in mm, got {start!r} and {end!r}")
    return a, b
