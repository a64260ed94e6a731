"""What the drive of the tool has to overcome: torque and axial force, or a cutting force.

Signs: positive resists the motion, so that resistance x rate is the power that the tool puts in. On
a screw of pitch p this is T dtheta + F p/(2 pi) dtheta.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ._jit import Floats
from .motion import Motion, ScrewMotion, StraightMotion


class Resistance:
    """Read the resistance from the wrench on the tool.

    Attributes
    ----------
    columns : list of (name, unit)
        Names and units of the figures; the first is the one to plot.
    coordinate_name, coordinate_unit : str
        What the figures are plotted over, in the unit shown to users.
    coordinate_scale : float
        From the motion's own coordinate to that unit.
    """

    def __init__(self, motion: Motion) -> None:
        self._motion = motion
        if isinstance(motion, ScrewMotion):
            self.columns = [("torque", "N*mm"), ("axial_force", "N")]
            axis = np.array(motion.axis, float)
            self._axis = _unit(axis)
            self._advance = _unit(-axis if motion.advance is None else np.array(motion.advance))
            self._point = [float(c) for c in motion.axis_point]
        elif isinstance(motion, StraightMotion):
            self.columns = [("force", "N")]
            self._direction = _unit(np.array(motion.direction, float))
        else:
            self.columns = [(f"force_{c}", "N") for c in "xyz"]
            self.columns += [(f"moment_{c}", "N*mm") for c in "xyz"]
        turns = motion.coordinate_unit == "rad"
        self.coordinate_name, self.coordinate_unit = ("angle", "deg") if turns else ("path", "mm")
        self.coordinate_scale = float(np.degrees(1.0)) if turns else 1.0

    def coordinate(self, time: float) -> float:
        """Return the coordinate at a time in the unit shown to users."""
        return self._motion.coordinate(time) * self.coordinate_scale

    def of(self, wrench: Floats, origin: Floats) -> list[float]:
        """Return the figures of one wrench.

        Parameters
        ----------
        wrench : ndarray, shape (6,)
            Force [N] and moment about ``origin`` [N·mm] on the tool.
        origin : ndarray, shape (3,)
            Where the moment is taken: the present place of the body's origin [mm].
        """
        # Plain numbers: six of them in NumPy cost ten times as much. Taken from zero rather than
        # negated: nothing shall read 0, not -0.
        *force, mx, my, mz = wrench.tolist()
        if isinstance(self._motion, ScrewMotion):
            x, y, z = origin.tolist()
            px, py, pz = self._point
            fx, fy, fz = force
            x, y, z = x - px, y - py, z - pz
            moment = (mx + y * fz - z * fy, my + z * fx - x * fz, mz + x * fy - y * fx)
            return [0.0 - _along(self._axis, moment), 0.0 - _along(self._advance, force)]
        if isinstance(self._motion, StraightMotion):
            return [0.0 - _along(self._direction, force)]
        return [0.0 - f for f in (*force, mx, my, mz)]


def _unit(v: Floats) -> list[float]:
    unit: list[float] = (v / np.linalg.norm(v)).tolist()
    return unit


def _along(unit: Sequence[float], v: Sequence[float]) -> float:
    return unit[0] * v[0] + unit[1] * v[1] + unit[2] * v[2]
