"""The look before the run: a picture with both poses, and nothing in the model changes."""

import re

import numpy as np
import pytest

from naive import cases
from shellcut.models import opening_test
from shellcut.preview import preview
from shellcut.simulation import Simulation
from shellcut.support import Support


def test_a_picture_of_both_poses_and_a_report(tmp_path):
    case = opening_test("quick")
    sim = case.simulation
    before = sim.state.node.x.copy()
    report = preview(sim, tmp_path / "model.png", time=case.duration)
    assert (tmp_path / "model.png").stat().st_size > 20_000
    assert "612 quads" in report
    assert "4 bodies" in report
    assert f"{sim.dt:.4g} s" in report
    np.testing.assert_array_equal(sim.state.node.x, before)
    # The quads of the shortest steps, shortest first, and what the first costs.
    worst = re.findall(
        r"quad (\d+) at \(\S+, \S+, 0\) mm: step \S+ s, ([\d.]+) of the median", report
    )
    assert len(worst) == 10
    squared = sim.shell.frequencies.squared
    assert squared[int(worst[0][0])] == squared.max()
    assert [share for _, share in worst] == sorted(share for _, share in worst)
    assert f"shortens the step to {worst[0][1]} of the median quad's" in report


def test_a_film_without_a_tool_is_drawn_once(tmp_path):
    mesh = cases.curved(4, 3)
    sim = Simulation(mesh, cases.FILM, supports=[Support.clamped([0, 1])])
    report = preview(sim, tmp_path / "film.svg", time=1.0)
    assert "2 nodes held" in report
    assert "tool" not in report
    assert (tmp_path / "film.svg").read_text().count("t = ") <= 1


@pytest.mark.parametrize("time", [-1.0, float("nan"), float("inf")])
def test_impossible_times_are_refused(tmp_path, time):
    sim = opening_test("quick").simulation
    with pytest.raises(ValueError, match="time must be finite and not negative"):
        preview(sim, tmp_path / "never.png", time=time)
    assert not (tmp_path / "never.png").exists()
