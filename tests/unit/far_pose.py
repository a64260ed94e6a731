"""A tool's pose far from the start of its motion, made without a kernel.

That of ``ScrewMotion(300.0, pitch=7.0, axis=(1, 2, 3), axis_point=(0.3, -1, 0.2))`` at 4 ms.
"""

import numpy as np
from scipy.spatial.transform import Rotation

from shellcut.tool.pose import Pose

_AXIS, _POINT, _ANGLE = np.array([1.0, 2.0, 3.0]) / np.sqrt(14.0), np.array([0.3, -1.0, 0.2]), 1.2
_TURN = np.ascontiguousarray(Rotation.from_rotvec(_ANGLE * _AXIS).as_matrix())

FAR = Pose(_TURN, _POINT - _TURN @ _POINT - 7.0 * _ANGLE / (2.0 * np.pi) * _AXIS)
