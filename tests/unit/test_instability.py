"""When a run is given up because its energies do not add up any more."""

import json
from collections import deque

import numpy as np
import pytest

from notched_strip import cutting
from shellcut import Recorder, load_checkpoint, read
from shellcut.simulation.instability import CHECK_EVERY, BalanceGuard, BalanceLost, UnstableStep
from shellcut.simulation.ledger import Ledger


def guard(**options):
    """Whose least energy is 1e-4 N·mm: 100 N/mm times 0.01 mm² times a strain of 1 % squared."""
    return BalanceGuard(stretching=100.0, quad_area=0.01, **options)


@pytest.mark.parametrize(
    ("entries", "lost"),
    [
        # A few per cent are for the verdict.
        ({"tool_work": 1.0, "strain": 0.6}, False),
        ({"tool_work": 1.0, "strain": 0.4}, True),
        ({"tool_work": 1.0, "kinetic_translation": 3.0}, True),
        ({"tool_work": np.nan}, True),
        ({"tool_work": 1.0, "kinetic_translation": np.inf}, True),
        # Next to no energy is not compared.
        ({"tool_work": 4e-5}, False),
        ({"tool_work": 6e-5, "contact_work": -6e-5}, True),
        ({"initial": 10.0, "damping_mass": 9.9}, False),
    ],
    ids=str,
)
def test_most_of_the_energy_must_be_accounted_for(entries, lost):
    assert guard().lost(Ledger(**entries)) == lost


def test_what_a_split_leaves_open_or_was_there_before_is_not_compared():
    # 0.1 of what tears an edge of 0.1 mm at 2 N: 0.02 N·mm.
    watch = guard(tearing=2.0)
    assert not watch.lost(Ledger(tool_work=0.009))
    assert watch.lost(Ledger(tool_work=0.011))
    # What is missing is compared with the largest energy there was: a film has sprung back.
    watch = guard()
    assert not watch.lost(Ledger(tool_work=10.0, strain=9.9))
    assert not watch.lost(Ledger(tool_work=0.1, strain=0.0))
    # The ledger does not know where the energy of a film comes from that is strained before a run.
    watch = guard()
    watch.begin(Ledger(strain=1.0))
    assert not watch.lost(Ledger(strain=0.3, kinetic_translation=0.65))
    assert watch.lost(Ledger(strain=1.0, kinetic_translation=3.0))
    again = guard()
    again.restore(watch.saved())
    assert again.missing(Ledger(strain=1.5)) == -0.5
    assert not again.lost(Ledger(strain=2.4))  # of the 3 N·mm there were


def test_strength_in_pascal_stops_within_a_hundred_steps_of_the_first_split(no_pictures, tmp_path):
    sim = cutting(strength=18e6)
    records = {"n_row": 40, "n_frame": 4, "n_snapshot": 0, "progress": False}
    # A check refuses it before the run, which somebody may force.
    recorder = Recorder(sim, tmp_path, until=8e-5, name="cut", force=True, **records)
    first = cutting(strength=18e6)
    while not first.state.split_log:
        first.step()
    # By its strains or by its balance, which is looked at every 50 steps.
    with pytest.raises(UnstableStep, match=r"(blew up|balance is lost) at step \d+") as failure:
        sim.run(8e-5, [recorder])
    assert 0 < sim.state.step - first.state.step <= 100
    text = str(failure.value)
    assert f"t = {sim.state.time:.6g} s" in text
    assert "1.8e+07 MPa, is above Young's modulus of the film, 1678 MPa: is it in Pa?" in text
    # What there was can be read, the frame of the end too.
    results = read(tmp_path)
    assert results.history["time"].size > 2
    assert np.isfinite(results.frame(-1).points).all()
    assert json.loads((tmp_path / "summary.json").read_text())["n_step"] == sim.state.step
    assert any("failed within a step" in line.text for line in recorder.verdict)
    # What there is to go on from is not the lost state.
    again = cutting(strength=18e6)
    load_checkpoint(again, tmp_path / "checkpoint.h5")
    assert again.state.step < first.state.step


def test_a_user_who_steps_by_hand_is_told_too():
    sim = cutting()
    sim.step()
    sim.state.node.velocity_half[: sim.mesh.n_node, 2] += 1e5  # 100 m/s from nowhere
    with pytest.raises(BalanceLost, match="changed by hand"):
        deque((sim.step() for _ in range(CHECK_EVERY)), maxlen=0)
    assert not sim.between_steps
