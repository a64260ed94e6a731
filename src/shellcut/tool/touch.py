"""What a force term does to the tool and puts into the ledger, as its kernel writes it.

Everything a term has to tell after a step lies in two arrays that stay where they are. Kernels take
them, with other tables, as one address; nothing is made anew in a step.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, NamedTuple

import numpy as np

from shellcut.arrays import Floats, Vec3
from shellcut.numerics.jit import always_inline
from shellcut.numerics.vec3 import cross, sub

from .pose import Pose

ON_TOOL = -1
"""Column of a :class:`Booking` that stands for the work of the wrench on the tool."""


class Touch(NamedTuple):
    """Results of the last evaluation of a term; zeros before the first."""

    wrench: Annotated[Floats, "(n_tooth, 6)"]
    """Force [N] and moment about the body origin [N·mm] on each tooth."""
    sums: Annotated[Floats, "(n_sum,)"]
    """Works since t_{n-1} and energies [N·mm], counts and depths, in the term's own order."""

    @classmethod
    def none(cls, n_tooth: int, n_sum: int) -> Touch:
        """Return one that nothing has been written to."""
        return cls(np.zeros((n_tooth, 6)), np.zeros(n_sum))

    def take(self, saved: Mapping[str, Any]) -> None:
        """Take over ``_asdict()`` of another, in place."""
        self.wrench[:], self.sums[:] = saved["wrench"], saved["sums"]


@always_inline
def react(f: Vec3, x: Vec3, tooth: int, pose: Pose, wrench: Floats) -> None:
    """Add minus a force f on film or cable at x [N, mm] to the wrench on a tooth."""
    r = pose.translation
    moment = cross(sub(x, (r[0], r[1], r[2])), f)
    for c in range(3):
        wrench[tooth, c] -= f[c]
        wrench[tooth, 3 + c] -= moment[c]


class Booking(NamedTuple):
    """A sum that goes into the ledger at every step.

    Examples
    --------
    What a term puts into the film, by its second sum, and what its wrench does on the tool:

    >>> booked = Booking("load_work", 1), Booking("load_work", ON_TOOL)
    """

    entry: str
    """Of the ledger."""
    column: int
    """Of ``sums``, or ``ON_TOOL``: the work of the wrench on the tool."""
    factor: float = 1.0
    """Times which it is added."""
