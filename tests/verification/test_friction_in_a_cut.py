"""Friction on the flanks of the guillotine's blade: F v = G h v + what friction dissipates."""

import pytest

from courses import steady_works
from shellcut import Contact, guillotine

SIZE, GH = 0.8, 43.5 * 0.074


def test_the_blade_does_the_work_of_the_cut_and_of_friction():
    case = guillotine(SIZE, length=32.0, contact=Contact(friction=0.2))
    names = "tool_work", "friction_work", "friction_dissipated", "damping"
    (tool, friction, dissipated, damping), worst, _ = steady_works(case, SIZE, 10.0, *names)
    # Measured 0.79 N, 0.58 N with imperfections by which the film buckles in another mode: the
    # flanks press on the blade as it pushes them apart.
    assert friction > 0.15 * GH
    # 1 % as asked; measured 0.4 %. On a shorter way it is more: at first friction draws the film
    # along.
    assert tool - damping - friction == pytest.approx(GH, rel=0.01)
    # All of it is dissipated, but for what the springs hold now.
    assert dissipated == pytest.approx(friction, rel=5e-3)
    assert worst < 2e-3
