"""A blade with a blunt edge; case F04 has the whole row of radii."""

import pytest

from blunt_edge import cut, on_the_blade

RADIUS = 0.1


def test_without_friction_a_blunt_edge_takes_no_more():
    force, cables, friction, damping, imbalance = cut(RADIUS)
    # Exact but for damping and waves, which hang on chance: radii that differ by 1e-9 to 1e-6 give
    # 1.005 to 1.049 with 2.1 to 5.7 % damped, and 0.984 to 0.993 without what is damped.
    assert force - damping == pytest.approx(0.99, abs=0.02)
    assert damping < 0.08
    assert cables == pytest.approx(1.0, abs=0.02)
    assert friction == 0.0
    assert imbalance < 1e-3


def test_with_friction_the_force_grows_by_what_friction_takes():
    force, cables, friction, damping, imbalance = cut(RADIUS, joint="slip", joint_friction=0.3)
    assert force == pytest.approx(cables + friction + damping, abs=0.02)
    # The closed form is of ends that lie on the blade: 0.050; measured 0.069 with ends that swing.
    assert friction == pytest.approx(on_the_blade(RADIUS, 0.3), abs=0.04)
    assert friction > 0.03
    assert imbalance < 1e-3


def test_friction_on_the_blade_vanishes_with_the_radius_and_the_friction():
    grown = [on_the_blade(r, 0.3) for r in (0.0, 1e-3, 0.01, 0.1, 1.0)]
    assert grown[0] == 0.0
    assert grown == sorted(grown)
    assert grown[1] < 2e-3
    assert on_the_blade(0.1, 0.0) == 0.0
