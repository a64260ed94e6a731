"""A straight cut takes G h per length whatever the shape of the law, as in case F02."""

import pytest

from courses import steady_works
from runs import broken_ratio
from shellcut import CohesiveTable, guillotine

SIZE = 0.8  # mm
THICKNESS = 0.074
LAWS = {
    "linear": CohesiveTable.linear(strength=18.0, opening_u=4.0),
    "bilinear": CohesiveTable.bilinear(
        strength=18.0, knee_opening=0.6, knee_traction=6.0, opening_u=4.0
    ),
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
