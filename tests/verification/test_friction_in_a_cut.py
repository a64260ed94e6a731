"""Friction on the flanks of the guillotine's blade: F v = G h v + what friction dissipates."""

import numpy as np
import pytest

from shellcut import Contact, guillotine

SIZE, GH = 0.8, 43.5 * 0.074


def works(friction: float) -> dict[str, np.ndarray]:
    case = guillotine(SIZE, length=32.0, contact=Contact(friction=friction))
    sim, rows = case.simulation, []
    while sim.state.time < case.duration:
        sim.step()
        if sim.state.step % 20 == 0:
            b = sim.ledger
            path = sim.motion.coordinate(sim.state.time)
            rubbed = b.friction_work, b.friction_dissipated
            rows.append((path, b.tool_work, *rubbed, b.damping, b.imbalance))
    names = ("path", "tool", "friction", "dissipated", "damping", "imbalance")
    return dict(zip(names, np.array(rows).T, strict=True))


def test_the_blade_does_the_work_of_the_cut_and_of_friction() -> None:
    run = works(0.2)
    n = int((run["path"][-1] - 10.0) / SIZE)
    ends = np.array([10.0, 10.0 + n * SIZE])

    def mean(entry: str) -> float:
        return float(np.diff(np.interp(ends, run["path"], run[entry]))[0] / (n * SIZE))

    # Measured 0.79 N, 0.58 N with imperfections by which the film buckles in another mode: the
    # flanks press on the blade as it pushes them apart.
    assert mean("friction") > 0.15 * GH
    # 1 % as asked; measured 0.4 %. On a shorter way it is more: friction draws the film along, at
    # first, so that the blade cuts a little less or more of it than it goes.
    left = mean("tool") - mean("damping") - mean("friction")
    assert left == pytest.approx(GH, rel=0.01)
    # All of it is dissipated, but for what the springs hold now.
    assert mean("dissipated") == pytest.approx(mean("friction"), rel=5e-3)
    assert np.abs(run["imbalance"]).max() < 2e-3 * run["tool"].max()
