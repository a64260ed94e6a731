"""The lines that tell of a run say its numbers."""

import re

import pytest

from notched_strip import cutting
from shellcut.recording.resistance import Resistance
from shellcut.recording.status_line import start_lines, status_line


@pytest.fixture(scope="module")
def sim():
    sim = cutting()
    sim.run(4e-5)
    return sim


def test_the_status_line_agrees_with_the_ledger(sim):
    ledger, s = sim.ledger, sim.state
    # Bring entries to where each of them shows in four figures.
    ledger.cohesive_start_work = 3.0 * ledger.cohesive_work
    line = status_line(sim, Resistance(sim.motion, 8e-5), 0.5)
    told = line.replace(f"cables {s.n_cable} made", "")
    numbers = {name: float(x) for name, x in re.findall(r"(\w+) ([-+]?[\d.]+(?:e[-+]\d+)?)", told)}
    assert line.startswith("50 %: path ")
    assert numbers["path"] == pytest.approx(sim.motion.coordinate(s.time), rel=1e-3)
    assert numbers["energy"] == pytest.approx(ledger.kinetic, rel=1e-3)
    assert numbers["film"] == pytest.approx(ledger.strain, rel=1e-3)
    assert numbers["cables"] == pytest.approx(4.0 * ledger.cohesive_work, rel=1e-3)
    assert numbers["tool"] == pytest.approx(ledger.tool_work, rel=1e-3)
    balance = 100.0 * ledger.relative(ledger.imbalance)
    assert abs(balance) > 1.0
    assert numbers["balance"] == pytest.approx(balance, abs=0.006)
    assert numbers["crack"] == pytest.approx(s.crack_length, rel=1e-3)
    assert f"cables {s.n_cable} made {sim.cables.n_joint_made} jointed" in line


def test_a_start_says_film_tool_and_steps(sim):
    film, tool, cracks, shown, step = start_lines(sim, Resistance(sim.motion, 8e-5), 8e-5)
    assert film.startswith(f"film   {sim.mesh.n_quad} quads, {sim.mesh.n_node} nodes, ")
    assert "1 body" in tool
    assert cracks == 'cracks along edges of the mesh only (fracture.path = "edges")'
    assert shown == "shown  force along (1, 0, 0), over the path"
    assert f"about {round(8e-5 / sim.dt, -2):,.0f} steps to path" in step
    assert "0.08 ms" in step
