"""The doctor's report on this machine, and on worse ones."""

import h5py
import pytest

from shellcut.command_line import doctor, main


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
    def version(package):
        if package in doctor._EXTRAS:
            raise doctor.PackageNotFoundError(package)
        return "1.0"

    monkeypatch.setattr(doctor, "version", version)
    code, said = lines()
    assert code == 0
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
    monkeypatch.setattr(doctor, "_cache_folders", lambda: [tmp_path / "cache"])
    _, said = lines()
    assert "none yet" in said["compiled code"]
    (tmp_path / "file").write_text("")
    for folders in ([tmp_path / "file" / "cache"], []):
        monkeypatch.setattr(doctor, "_cache_folders", lambda found=folders: found)
        code, said = lines()
        assert code == 0
        assert "NUMBA_CACHE_DIR" in said["compiled code"]
