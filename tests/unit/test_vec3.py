"""Three-vectors against NumPy, and the Cayley rotation against the matrix it stands for."""

import numpy as np
import pytest

from from_python import from_python
from shellcut.numerics import vec3

RNG = np.random.default_rng(5)
A, B = RNG.uniform(-1, 1, (2, 3))


def called(name, *arguments):
    return from_python(getattr(vec3, name))(*arguments)


@pytest.mark.parametrize("along", [0.0, 0.7])
def test_rotation_of_the_director_is_cayleys(along):
    t = A / np.linalg.norm(A)
    spin = np.cross(t, B) + along * t
    skew = 0.5 * np.array([[0, -spin[2], spin[1]], [spin[2], 0, -spin[0]], [-spin[1], spin[0], 0]])
    cayley = np.linalg.solve(np.eye(3) - skew, np.eye(3) + skew)
    # Round-off of a 3 x 3 solution.
    np.testing.assert_allclose(
        called("rotate_director", tuple(t), tuple(spin)), cayley @ t, atol=1e-15
    )


def test_rotation_turns_by_the_angle_to_second_order():
    t, angles = np.array([0.0, 0.0, 1.0]), np.array([0.2, 0.1, 0.05])
    turned = [called("rotate_director", tuple(t), (0.0, a, 0.0)) for a in angles]
    error = [abs(np.arctan2(s[0], s[2]) - a) for s, a in zip(turned, angles, strict=True)]
    # Cayley turns by 2 atan(angle / 2) = angle - angle³/12: third order, within 0.05 here.
    order = np.log2(np.array(error[:-1]) / np.array(error[1:]))
    np.testing.assert_allclose(order, 3.0, atol=0.05)
    np.testing.assert_allclose(error[0], 0.2**3 / 12, rtol=0.02)
