"""The pose of a tool by its motion, laid out as kernels take it."""

from __future__ import annotations

from collections.abc import Callable

from .motion import Motion, ScrewMotion, StraightMotion
from .pose import Pose
from .table_motion import TableMotion

_GIVE_ROWS = (ScrewMotion, StraightMotion, TableMotion)
"""Motions whose poses kernels can take as they come."""


def poses_of(motion: Motion) -> Callable[[float], Pose]:
    """Return the pose as a function of time [s].

    A motion written by a user may return views of any kind, and kernels would misread them.
    """
    # Not isinstance: a derived class may move differently.
    if type(motion) in _GIVE_ROWS:
        by_rows: Callable[[float], Pose] = motion.pose  # type: ignore[assignment]
        return by_rows
    return lambda time: Pose.of(*motion.pose(time))
