"""Pose of the rigid tool: x = R X + r maps a point from the body frame to space.

The functions are for kernels and take one point or direction; the methods of :class:`Pose` do the
same for many points in NumPy.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from shellcut.arrays import Floats, Vec3, product
from shellcut.numerics.jit import inline


class Pose(NamedTuple):
    """Position and orientation of a rigid body; kernels take it as an argument.

    Examples
    --------
    >>> quarter = Pose.of([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], [5.0, 0.0, 0.0])
    >>> quarter.to_space(np.array([[1.0, 0.0, 0.0]])).tolist()
    [[5.0, 1.0, 0.0]]
    """

    rotation: Floats
    """R, shape (3, 3)."""
    translation: Floats
    """r, position of the body's origin [mm], shape (3,)."""

    @classmethod
    def of(cls, rotation: npt.ArrayLike, translation: npt.ArrayLike) -> Pose:
        """Return a pose whose arrays have the layout that kernels expect.

        ``Pose.of(*motion.pose(time))`` is for user-written motions, which may return views.
        """
        return cls(np.ascontiguousarray(rotation, float), np.ascontiguousarray(translation, float))

    @classmethod
    def at_origin(cls) -> Pose:
        """Return the pose at which the body frame coincides with space."""
        return cls(np.eye(3), np.zeros(3))

    def copied(self) -> Pose:
        """Return a copy with its own arrays."""
        return Pose(self.rotation.copy(), self.translation.copy())

    def to_space(self, points: Floats) -> Floats:
        """Return points of the body frame in space, shape (n, 3), [mm]."""
        return np.asarray(product(points, self.rotation.T) + self.translation)

    def to_body(self, points: Floats) -> Floats:
        """Return points of space in the body frame, shape (n, 3), [mm]."""
        return np.asarray(product(points - self.translation, self.rotation))


def small_turn(before: Floats, after: Floats) -> Floats:
    """Return sin(a) n of the turn by a about n from one rotation to another.

    It is the rotation vector to second order [rad].
    """
    turn = product(after, before.T)
    return 0.5 * np.array(
        [turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]
    )


@inline
def to_body(p: Vec3, pose: Pose) -> Vec3:
    """Return Rᵀ (p - r)."""
    r = pose.translation
    return turn_back((p[0] - r[0], p[1] - r[1], p[2] - r[2]), pose)


@inline
def turn_back(d: Vec3, pose: Pose) -> Vec3:
    """Return Rᵀ d."""
    rotation = pose.rotation
    return (
        rotation[0, 0] * d[0] + rotation[1, 0] * d[1] + rotation[2, 0] * d[2],
        rotation[0, 1] * d[0] + rotation[1, 1] * d[1] + rotation[2, 1] * d[2],
        rotation[0, 2] * d[0] + rotation[1, 2] * d[1] + rotation[2, 2] * d[2],
    )


@inline
def turn(d: Vec3, pose: Pose) -> Vec3:
    """Return R d."""
    rotation = pose.rotation
    return (
        rotation[0, 0] * d[0] + rotation[0, 1] * d[1] + rotation[0, 2] * d[2],
        rotation[1, 0] * d[0] + rotation[1, 1] * d[1] + rotation[1, 2] * d[2],
        rotation[2, 0] * d[0] + rotation[2, 1] * d[1] + rotation[2, 2] * d[2],
    )


@inline
def to_space(p: Vec3, pose: Pose) -> Vec3:
    """Return R p + r."""
    q = turn(p, pose)
    r = pose.translation
    return q[0] + r[0], q[1] + r[1], q[2] + r[2]
