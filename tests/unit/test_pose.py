"""From the body frame to space and back, one point at a time and many at once."""

import numpy as np

from far_pose import FAR
from shellcut.tool.motion import ScrewMotion, StraightMotion
from shellcut.tool.pose import Pose, to_body, to_space, turn, turn_back
from shellcut.tool.table_motion import TableMotion

P = (1.0, -2.0, 0.5)


def test_body_and_space_are_inverse():
    rotation, translation = FAR
    space = to_space(P, FAR)
    np.testing.assert_allclose(space, rotation @ P + translation, atol=1e-14)
    np.testing.assert_allclose(to_body(space, FAR), P, atol=1e-14)
    np.testing.assert_allclose(turn(P, FAR), rotation @ P, atol=1e-15)
    np.testing.assert_allclose(turn_back(turn(P, FAR), FAR), P, atol=1e-15)


def test_many_points_go_as_one_does():
    points = np.random.default_rng(1).normal(size=(5, 3))
    space = FAR.to_space(points)
    np.testing.assert_allclose(space, [to_space(tuple(p), FAR) for p in points], atol=1e-14)
    np.testing.assert_allclose(FAR.to_body(space), points, atol=1e-14)
    np.testing.assert_array_equal(Pose.at_origin().to_body(points), points)


def test_motions_give_poses():
    table = TableMotion([0.0, 1.0], [[0.0, 0.0, 0.0], [1.0, 2.0, 3.0]])
    for motion in (table, ScrewMotion(1.0), StraightMotion((1, 0, 0), speed=1.0)):
        assert isinstance(motion.pose(0.5), Pose)


def test_what_a_motion_of_ones_own_gives_is_laid_out_for_kernels():
    rotation, translation = np.eye(3).T[::-1], np.arange(6)[::2]
    pose = Pose.of(rotation, translation)
    for part, given in zip(pose, (rotation, translation), strict=True):
        assert part.flags.c_contiguous
        assert part.dtype == np.float64
        np.testing.assert_array_equal(part, given)


def test_a_copy_has_arrays_of_its_own():
    copy = FAR.copied()
    copy.translation[0] += 1.0
    assert FAR.translation[0] != copy.translation[0]
