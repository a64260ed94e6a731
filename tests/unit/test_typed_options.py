"""Options that models and runs hand on are known by name and type, to mypy and to an editor."""

import inspect
import re
import subprocess
import sys
from pathlib import Path
from typing import get_type_hints

import pytest

import shellcut
from shellcut.models.case import CutOptions, ModelOptions
from shellcut.recording.run_options import RunArguments, RunOptions

ROOT = Path(__file__).resolve().parents[2]

SCRIPT = """
import shellcut
from shellcut.models import Case, free_cut

shellcut.opening_test("quick", damping_beta=5e-8, supports=[], threads=2, quasi_static=0.004)
case: Case = shellcut.guillotine(travel=3.0, fracture=shellcut.Fracture(path="free"))
case.run("out", n_frame=10, progress=False, resume=True, log=print, checkpoint_every=None)
shellcut.Recorder(case.simulation, "out", until=1.0, name="cut", n_row=3, also=["x.txt"])

shellcut.opening_test("quick", damping_betta=5e-8)  # wrong
shellcut.guillotine(fractures=None)  # wrong
shellcut.trouser(supports=[])  # wrong
shellcut.oscillating(mesh_size=0.3)  # wrong
free_cut(case.simulation.mesh, damping="much")  # wrong
case.run("out", n_frames=10)  # wrong
case.run("out", progress="no")  # wrong
case.recorder("out", n_pictures=3)  # wrong
shellcut.Recorder(case.simulation, "out", until=1.0, name="cut", n_rows=3)  # wrong
"""


def test_a_wrong_name_is_an_error_for_mypy(tmp_path):
    pytest.importorskip("mypy")
    file = tmp_path / "script.py"
    file.write_text(SCRIPT)
    cache = ROOT / ".mypy_cache" / "options"  # 15 s without it
    command = [sys.executable, "-m", "mypy", "--follow-imports=silent", f"--cache-dir={cache}"]
    done = subprocess.run([*command, str(file)], capture_output=True, text=True, cwd=tmp_path)
    wrong = {int(n) for n in re.findall(r"script\.py:(\d+): error", done.stdout)}
    marked = {n for n, line in enumerate(SCRIPT.splitlines(), 1) if line.endswith("# wrong")}
    assert wrong == marked, done.stdout + done.stderr
    assert 'Unexpected keyword argument "damping_betta"' in done.stdout


def test_the_names_are_those_of_the_simulation_and_of_the_run():
    simulation = inspect.signature(shellcut.Simulation).parameters
    set_by_models = {"mesh", "material", "tool", "motion", "law", "supports"}
    assert set(get_type_hints(ModelOptions)) == set(simulation) - set_by_models
    assert set(get_type_hints(CutOptions)) - set(get_type_hints(ModelOptions)) == {"supports"}
    assert get_type_hints(RunArguments) == get_type_hints(RunOptions)
    for name, hint in get_type_hints(shellcut.Simulation.__init__).items():
        assert get_type_hints(CutOptions).get(name, hint) == hint, name
