"""The doctor's report on this machine, and on worse ones."""

import json
import os
import subprocess
import sys
from pathlib import Path

import h5py
import pytest

from shellcut import warmup
from shellcut.command_line import doctor, main
from shellcut.numerics.kernel_cache import KernelCache


@pytest.fixture
def lines(capsys):
    """Return a function that runs the doctor and gives exit code and lines by what they are on."""

    def report():
        code = main(["doctor"])
        said = capsys.readouterr().out.splitlines()
        return code, {line[9:23].strip(): line for line in said}

    return report


def test_a_line_each(lines):
    code, said = lines()
    assert code == 0
    for what in ("python", "shellcut", "numba", "cores", "SIMD", "compiled code", "disk"):
        assert said[what].split()[0] in ("ok", "note")
    assert "HDF5" in said["result files"]


def test_what_is_not_installed_comes_with_its_remedy(lines, monkeypatch):
    extras = ("matplotlib", "vtk", "imageio-ffmpeg", "gmsh", "ezdxf", "svgpathtools")

    def version(package):
        if package in extras:
            raise doctor.PackageNotFoundError(package)
        return "1.0"

    monkeypatch.setattr(doctor, "version", version)
    code, said = lines()
    assert code == 0
    assert all(
        "not installed" in said[one] and "pip install shellcut[" in said[one] for one in extras
    )
    assert said["matplotlib"].endswith("no pictures  (pip install shellcut[plot])")


@pytest.mark.parametrize(("vtk", "status"), [("9.2.6", "PROBLEM"), ("9.3.1", "ok"), ("10.0", "ok")])
def test_old_vtk_is_a_problem_but_stops_no_run(lines, monkeypatch, vtk, status):
    really = doctor.version
    monkeypatch.setattr(doctor, "version", lambda p: vtk if p == "vtk" else really(p))
    code, said = lines()
    assert code == 0
    assert said["vtk"].split()[0] == status


def test_without_result_files_no_model_can_run(lines, monkeypatch):
    def refuse(*_):
        raise OSError("unable to lock file")

    monkeypatch.setattr(h5py, "File", refuse)
    code, said = lines()
    assert code == 2
    assert said["result files"].startswith("PROBLEM")
    assert "unable to lock file" in said["result files"]
    assert "matplotlib" in said  # the report goes on


def test_a_compiler_that_fails(lines, monkeypatch):
    def refuse(_):
        raise RuntimeError("no LLVM")

    monkeypatch.setattr(doctor.numba, "njit", refuse)
    code, said = lines()
    assert code == 2
    assert "no LLVM" in said["compiler"]


def test_the_cache_is_empty_or_closed(lines, monkeypatch, tmp_path):
    (tmp_path / "file").write_text("")
    monkeypatch.setattr(KernelCache, "can_store", True)
    monkeypatch.setattr(KernelCache, "cache_path", str(tmp_path / "cache"))
    _, said = lines()
    assert "none yet" in said["compiled code"]
    for name, value, words in (
        ("cache_path", str(tmp_path / "file" / "cache"), "cache cannot be written (Not a"),
        ("can_store", False, "no folder can be written"),
    ):
        monkeypatch.setattr(KernelCache, name, value)
        code, said = lines()
        assert words in said["compiled code"]
        assert code == 0
        assert "NUMBA_CACHE_DIR" in said["compiled code"]


# --- the warm-up compiles what runs of the ready models call, so that nothing is compiled in them


TESTS = Path(__file__).parents[1]

_SHORT_RUN = """
import json, sys
sys.path.insert(0, sys.argv[1])
from record_kernels import called, listed
import shellcut

model, settings = json.loads(sys.argv[2])
few = {"n_row": 100, "n_frame": 10, "n_snapshot": 1, "curves": False}
shellcut.read_model(model, settings).build().run(sys.argv[3], progress=False, **few)
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


def test_what_is_no_model_is_refused():
    with pytest.raises(ValueError, match="tensile: the models are opening, guillotine"):
        warmup(["tensile"])


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
