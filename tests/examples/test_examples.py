"""Every example is run as a user would, and one figure of it is checked."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"


def run_example(name, out, *options):
    command = [sys.executable, str(EXAMPLES / name), "--out", str(out), *options]
    done = subprocess.run(command, capture_output=True, text=True, timeout=600, check=False)
    assert done.returncode == 0, done.stderr
    return json.loads((out / "summary.json").read_text())


def test_opening(tmp_path):
    # To a third of the way: the torque has reached its plateau and the pictures are there.
    summary = run_example("opening_test.py", tmp_path, "--mesh", "quick", "--angle", "40")
    assert summary["n_cable_broken"] > 8
    assert summary["imbalance_rel"] < 5e-3
    left = {path.name for path in tmp_path.iterdir()}
    assert {"history.csv", "summary.json", "torque.png", "energy.png", "opening.vtkhdf"} <= left
    assert len([name for name in left if name.startswith("snapshot_")]) >= 6


def test_guillotine(tmp_path):
    summary = run_example("guillotine.py", tmp_path, "--size", "0.8", "--length", "14")
    # The plateau of so short a cut: within 10 % of G h.
    assert summary["force_plateau_N"] == pytest.approx(3.219, rel=0.10)
    assert (tmp_path / "force.png").stat().st_size > 10_000


def test_every_example_has_a_test():
    tested = {"opening_test.py", "guillotine.py"}
    assert {path.name for path in EXAMPLES.glob("*.py")} == tested
