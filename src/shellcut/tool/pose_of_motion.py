"""The pose of a tool by its motion, laid out as kernels take it."""

from __future__ import annotations

from math import isfinite

import numpy as np

from shellcut.arrays import Floats

from .motion import Motion, ScrewMotion, StraightMotion
from .pose import Pose, small_turn
from .table_motion import TableMotion

_LEFT_OVER = 1e-3
"""Deviation of R : R from 3: the tool would be larger or smaller by a sixth of it."""

KNOWN_MOTIONS = (ScrewMotion, StraightMotion, TableMotion)
"""Motions whose poses kernels can evaluate directly. A class derived from one of them is none: it
may move differently."""


def pose_at(motion: Motion, time: float) -> Pose:
    """Return the pose of any motion at a time [s].

    A motion written by a user may return views of any kind, and kernels would misread them.
    ValueError if it is no pose: R no rotation, or a number that is not finite.
    """
    if type(motion) in KNOWN_MOTIONS:
        return motion.pose(time)  # type: ignore[return-value]
    R, r = pose = Pose.of(*motion.pose(time))
    # Of a rotation R : R = 3; nan and infinity fail here too.
    is_pose = R.shape == (3, 3) and r.shape == (3,) and isfinite(r.sum())
    if not (is_pose and abs((R * R).sum() - 3.0) < _LEFT_OVER):
        raise ValueError(
            f"the pose of {type(motion).__name__} at {time:.6g} s must be a rotation, shape "
            f"(3, 3), and a position in mm, shape (3,), all finite, got R = {R.tolist()} and "
            f"r = {r.tolist()}: check its method pose"
        )
    return pose


def rate_of_pose(motion: Motion, time: float, interval: float) -> Floats:
    """Return spin [rad/s] and velocity [mm/s] of the pose, shape (6,), by central differences.

    interval : half the time between the two poses [s].
    """
    (R0, r0), (R1, r1) = (pose_at(motion, time + d) for d in (-interval, interval))
    return np.concatenate([small_turn(R0, R1), r1 - r0]) / (2.0 * interval)
