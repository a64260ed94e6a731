"""The opening test, killed twenty times and resumed, is the uninterrupted run."""

import random
import subprocess
import sys
import time

import pytest

from same_run import assert_same_run
from shellcut.files.run_folder import CHECKPOINT
from shellcut.models.opening import opening_test

KILLS = 20
WAIT = 600.0  # s: for a checkpoint, on a machine with much else to do

OPTIONS = {"n_row": 200, "n_frame": 20, "n_snapshot": 0, "progress": False}

RESUMED = """
from pathlib import Path
from shellcut.models.opening import opening_test
folder = Path({folder!r})
opening_test("quick").run(
    folder, checkpoint_every=0.05, resume=(folder / {checkpoint!r}).exists(), **{options!r}
)
"""


def written(checkpoint):
    return checkpoint.stat().st_mtime_ns if checkpoint.exists() else 0


@pytest.mark.slow
def test_twenty_kills(tmp_path):
    whole, part = tmp_path / "whole", tmp_path / "part"
    opening_test("quick").run(whole, **OPTIONS)
    script = RESUMED.format(folder=str(part), checkpoint=CHECKPOINT, options=OPTIONS)
    chance = random.Random(1)
    for _ in range(KILLS):
        before = written(part / CHECKPOINT)
        run = subprocess.Popen([sys.executable, "-c", script], stderr=subprocess.PIPE)
        end = time.monotonic() + WAIT
        while written(part / CHECKPOINT) == before:
            assert run.poll() is None, run.stderr.read().decode()
            assert time.monotonic() < end
            time.sleep(0.01)
        time.sleep(chance.uniform(0.0, 0.1))
        run.kill()
        run.communicate()
        assert run.returncode < 0, "it had ended before it was killed"
    subprocess.run([sys.executable, "-c", script], check=True)
    assert_same_run(part, whole)
