"""The warm-up compiles what runs of the ready models call, so that nothing is compiled in them."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from shellcut import warmup
from shellcut.models.warmup import MODELS

TESTS = Path(__file__).parents[1]

_SHORT_RUN = """
import json, sys
sys.path.insert(0, sys.argv[1])
from record_kernels import called, listed
import shellcut

model, settings = json.loads(sys.argv[2])
shellcut.read_model(model, settings).build().run(sys.argv[3], progress=False)
entries = {json.dumps(entry) for _, entry in called()}
print(json.dumps(sorted(entries - listed(model))))
"""


def test_what_has_been_compiled_is_not_compiled_again():
    told = []
    warmup(["guillotine"], told=lambda *numbers: told.append(numbers))
    assert all(0 < done <= whole for done, whole in told)
    assert told == sorted(set(told))
    told.clear()
    warmup(["guillotine"], told=lambda *numbers: told.append(numbers))
    assert told == []


def test_of_other_models_nothing_is_listed():
    assert "tensile" not in MODELS
    warmup(["tensile"], told=lambda *_: pytest.fail("it has no kernels"))


@pytest.mark.parametrize(
    ("model", "settings"),
    [
        (
            "opening",
            {"membrane.mesh": "quick", "motion.angle_deg": 12.0, "motion.duration": "1 ms"},
        ),
        ("guillotine", {"motion.travel": "2 mm"}),
    ],
)
def test_the_list_holds_what_a_run_calls(model, settings, tmp_path):
    """If not: ``python tests/record_kernels.py`` writes it again."""
    asked = json.dumps([model, settings])
    command = [sys.executable, "-c", _SHORT_RUN, str(TESTS), asked, str(tmp_path / "out")]
    out = subprocess.run(command, stdout=subprocess.PIPE, check=True, text=True, env=os.environ)
    assert json.loads(out.stdout.splitlines()[-1]) == []
