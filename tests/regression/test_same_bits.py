"""The same bits from a process that compiles the kernels and from one that finds them compiled."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

_RUN = """
import hashlib, sys
sys.path.insert(0, {unit!r})
import test_checkpoint
from shellcut import opening_test

case = opening_test("quick", angle_deg=20.0, duration=1.3e-3)
case.simulation.run(case.duration)
cut = test_checkpoint.cutting()
cut.run(test_checkpoint.END)
for sim in (case.simulation, cut):
    digest = hashlib.sha256(repr(sim.ledger).encode())
    for array in (sim.state.node.x, sim.state.node.velocity_half, sim.state.cable.work):
        digest.update(array.tobytes())
    print(sim.state.step, len(sim.state.split_log), digest.hexdigest())
"""


@pytest.mark.slow
def test_compiled_now_or_before(tmp_path):
    unit = str(Path(__file__).parents[1] / "unit")
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    told = [
        subprocess.run(
            [sys.executable, "-c", _RUN.format(unit=unit)],
            env=environment,
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for _ in range(2)
    ]
    assert told[0] == told[1]
    assert all(int(line.split()[1]) > 0 for line in told[0].splitlines())  # splits happened
