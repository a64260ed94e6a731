"""What a force term does to the tool and to the energy balance, as its kernel writes it.

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
"""Column of a :class:`Booking` for the work of the wrench on the tool."""


class Touch(NamedTuple):
    """Results of the last evaluation of a term; zeros before the first.

    Examples
    --------
    For a term that touches a tool of one tooth and counts two sums:

    >>> touch = Touch.none(n_tooth=1, n_sum=2)
    >>> touch.wrench.shape, touch.sums.shape
    ((1, 6), (2,))
    """

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
    """A sum that the energy balance gets at every step.

    Examples
    --------
    The energy stored by a spring between film and tool is minus its work on the film, which is the
    second of its sums, and on the tool, by its wrench:

    >>> entries = Booking("contact_work", 1, -1.0), Booking.of_wrench("contact_work", -1.0)
    """

    entry: str
    """Entry of the energy balance."""
    column: int
    """Column of ``sums``, or ``ON_TOOL``."""
    factor: float = 1.0
    """Factor on the sum that is added."""

    @classmethod
    def of_wrench(cls, entry: str, factor: float = 1.0) -> Booking:
        """Return that of the work of the wrench on the tool."""
        return cls(entry, ON_TOOL, factor)
