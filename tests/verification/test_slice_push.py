"""A blade that slides along its edge while it cuts; case F03 has the forces one by one."""

import pytest

from harness import load_cases

(F03,) = load_cases("F03")


@pytest.mark.parametrize("joint", ["adhesion", "free"])
def test_the_works_of_both_forces_make_up_that_of_fracture(joint):
    push, along, friction, imbalance = F03.forces(size=0.8, slice_ratio=1.0, joint=joint)
    # 2 % was asked for: damping and waves; the ledger closes to the second order of the step.
    assert push + along == pytest.approx(1.0, abs=0.02)
    assert imbalance < 1e-3  # beyond what case F03 asks for
    assert abs(friction) < 1e-9
    if joint == "free":
        assert abs(along) < 1e-9
    else:
        assert along > 0.3  # the flaps give way: less than the half of a film in its plane
