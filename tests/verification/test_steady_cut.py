"""The steady cut of the guillotine: any law, a blunt edge, friction, a blade that slides.

Cases F02 to F04 have the whole rows.
"""

import pytest

from blunt_edge import cut, on_the_blade
from cases.f03_slice_and_push import forces
from courses import steady_works
from runs import broken_ratio
from shellcut import CohesiveTable, Contact, guillotine

SIZE, THICKNESS = 0.8, 0.074  # mm
G_H = 43.5 * THICKNESS
KNEE = {"knee_opening": 0.6, "knee_traction": 6.0}
LAWS = {
    "linear": CohesiveTable.linear(strength=18.0, opening_u=4.0),
    "bilinear": CohesiveTable.bilinear(strength=18.0, opening_u=4.0, **KNEE),
    "exponential": CohesiveTable.exponential(strength=18.0, fracture_energy=20.0),
    "table": CohesiveTable(
        openings=[0.0, 0.8, 1.0, 2.4, 2.6, 4.0], tractions=[18.0, 17.0, 11.0, 10.0, 3.0, 0.0]
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", LAWS)
def test_a_cut_takes_the_area_below_the_law(name):
    law = LAWS[name]
    case = guillotine(SIZE, length=10.0 + 2.5 * law.opening_u, law=law)
    begin, names = 1.5 * law.opening_u, ("tool_work", "cohesive_work")
    (force, of_cables), worst, (path, *_) = steady_works(case, SIZE, begin, *names)
    assert path[-1] - begin > 10.0 * SIZE
    # The bands of F02: mesh, damping and waves; mesh; time step.
    theory = law.fracture_energy * THICKNESS
    assert force == pytest.approx(theory, rel=0.02)
    assert of_cables == pytest.approx(theory, rel=0.02)
    assert worst < 1e-3
    ratio = broken_ratio(case)
    assert len(ratio) > 10
    assert abs(ratio - 1.0).max() < 0.01  # as in tests/regression/test_guillotine.py


def test_the_blade_does_the_work_of_the_cut_and_of_friction():
    case = guillotine(SIZE, length=32.0, contact=Contact(friction=0.2))
    names = "tool_work", "friction_work", "friction_dissipated", "damping"
    (tool, friction, dissipated, damping), worst, _ = steady_works(case, SIZE, 10.0, *names)
    # Measured 0.79 N, 0.58 N with imperfections by which the film buckles in another mode: the
    # flanks press on the blade as it pushes them apart.
    assert friction > 0.15 * G_H
    # 1 % as asked; measured 0.4 %. On a shorter way it is more: at first friction draws the film
    # along.
    assert tool - damping - friction == pytest.approx(G_H, rel=0.01)
    # All of it is dissipated, but for what the springs hold now.
    assert dissipated == pytest.approx(friction, rel=5e-3)
    assert worst < 2e-3


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


@pytest.mark.parametrize("joint", ["adhesion", "free"])
def test_the_works_of_both_forces_make_up_that_of_fracture(joint):
    push, along, friction, imbalance = forces(size=SIZE, slice_ratio=1.0, joint=joint)
    # 2 % was asked for: damping and waves; the ledger closes to the second order of the step.
    assert push + along == pytest.approx(1.0, abs=0.02)
    assert imbalance < 1e-3
    assert abs(friction) < 1e-9
    if joint == "free":
        assert abs(along) < 1e-9
    else:
        assert along > 0.3  # the flaps give way: less than the half of a film in its plane
