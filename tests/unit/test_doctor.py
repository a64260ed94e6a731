"""The doctor's report on this machine, and on worse ones."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import h5py
import numba
import pytest

from shellcut import warmup
from shellcut.command_line import doctor, main


@pytest.fixture
def report(capsys):
    """Return a function that runs the doctor and gives its exit code and what it printed."""

    def run():
        code = main(["doctor"])
        return code, capsys.readouterr().out

    return run


def test_what_is_there_and_what_is_not(report, monkeypatch):
    code, said = report()
    assert code == 0
    for what in ("python", "shellcut-fem", "numba", "cores", "compiled code"):
        assert re.search(rf"^{what} +\S", said, re.M)

    def version(package):
        if package in ("matplotlib", "gmsh"):
            raise doctor.PackageNotFoundError(package)
        return "1.0"

    monkeypatch.setattr(doctor, "version", version)
    code, said = report()
    assert code == 0
    assert "matplotlib      not installed: no pictures (pip install 'shellcut-fem[plot]')" in said
    assert "gmsh            not installed: no meshes of outlines" in said


def refuse(*_):
    raise OSError("unable to do it")


@pytest.mark.parametrize(
    ("part", "name", "words"),
    [(h5py, "File", "HDF5 cannot write to .* unable"), (numba, "njit", "Numba fails: unable")],
)
def test_where_no_model_can_run(report, monkeypatch, part, name, words):
    monkeypatch.setattr(part, name, refuse)
    code, said = report()
    assert code == 2
    assert re.search(rf"^PROBLEM +{words}", said, re.M)
    assert "matplotlib" in said


# --- the warm-up compiles what runs of the ready models call, so that nothing is compiled in them


TESTS = Path(__file__).parents[1]

_SHORT_RUN = """
import json, sys
sys.path.insert(0, sys.argv[1])
from record_kernels import called, draw_here, listed
import shellcut

draw_here()

model, settings = json.loads(sys.argv[2])
few = {"n_row": 100, "n_frame": 10, "n_snapshot": 1, "curves": False}
shellcut.read_model(model, settings).build().run(sys.argv[3], progress=False, **few)
entries = {json.dumps(entry) for _, entry in called()}
print(json.dumps(sorted(entries - listed(model))))
"""


def test_what_has_been_compiled_is_not_compiled_again():
    told = []
    for _ in range(2):
        told.append([])
        warmup(["guillotine"], told=lambda *numbers: told[-1].append(numbers))
    first, again = told
    assert all(0 < done <= whole for done, whole in first)
    assert first == sorted(set(first))
    assert again == []


@pytest.mark.parametrize(
    ("model", "settings"),
    [
        ("opening", {"mesh": "quick", "motion.angle_deg": 12.0, "motion.duration": "1 ms"}),
        ("guillotine", {"motion.travel": "2 mm"}),
    ],
)
def test_the_list_holds_what_a_run_calls(model, settings, tmp_path):
    """If not: ``python tests/record_kernels.py`` writes it again."""
    asked = json.dumps([model, settings])
    command = [sys.executable, "-c", _SHORT_RUN, str(TESTS), asked, str(tmp_path / "out")]
    out = subprocess.run(command, stdout=subprocess.PIPE, check=True, text=True, env=os.environ)
    assert json.loads(out.stdout.splitlines()[-1]) == []
