"""Runs that fail on the way: what they end with, what they leave, how they go on."""

import errno
import json
import os
import shutil
import sys

import pytest

import shellcut
import shellcut.recording.recorder
from notched_strip import cutting
from same_run import assert_same_run
from shellcut.command_line import main
from shellcut.models import Case
from shellcut.recording.recorder import Recorder
from small_disk import REFUSAL, files_of_at_most

MODEL = ["guillotine", "--set", "size=1", "--set", "membrane.length=6", "--set", "travel=0.6"]
MODEL += ["--set", "membrane.width=4", "--set", "output.rows=200", "--frames", "20"]
MODEL += ["--no-pictures"]

RECORDS = {"n_row": 60, "n_frame": 12, "n_snapshot": 0, "progress": False}
END = 2e-5


pytestmark = pytest.mark.usefixtures("no_pictures")


@pytest.fixture(scope="module")
def whole(no_pictures, tmp_path_factory):
    """The run by the command, undisturbed."""
    out = tmp_path_factory.mktemp("whole") / "out"
    assert main(["run", *MODEL, "-o", str(out)]) == 0
    return out


@pytest.fixture(scope="module")
def uninterrupted(no_pictures, tmp_path_factory):
    """A run by Python, undisturbed."""
    out = tmp_path_factory.mktemp("uninterrupted")
    Case("cut", cutting(), END).run(out, **RECORDS)
    return out


@pytest.fixture
def broken_run(tmp_path, capsys, monkeypatch):
    """Return a function that runs the model with a method replaced; it gives what was said."""

    def run(owner, name, method):
        with monkeypatch.context() as patch:
            patch.setattr(owner, name, method)
            assert main(["run", *MODEL, "-o", str(tmp_path / "out")]) == 4
        return capsys.readouterr().err

    return run


def test_a_full_disk_has_its_own_code_and_the_run_goes_on(whole, tmp_path, broken_run):
    go, out = Case.go, tmp_path / "out"

    def limited(case, recorder):
        with files_of_at_most(220_000):
            go(case, recorder)

    said = broken_run(Case, "go", limited)
    assert f"File too large: '{out / 'guillotine.vtkhdf'}'" in said
    assert f"free space, then: shellcut resume {out}" in said
    assert "failed at path " in said
    assert "failed at path " in (out / "run.log").read_text()
    assert "Traceback" not in said
    # What there is can be read, and nothing says that the run had ended.
    results = shellcut.read(out)
    assert results.n_frame >= 1
    assert results.summary == {}
    assert not (out / "run.lock").exists()
    assert main(["resume", str(out)]) == 0
    assert_same_run(out, whole)


def test_a_row_that_does_not_fit_is_written_when_it_goes_on(uninterrupted, tmp_path):
    case = Case("cut", cutting(), END)
    recorder = Recorder(case.simulation, tmp_path, until=END, name="cut", **RECORDS)
    append, refused = recorder._files.history.append, []

    def full(row):
        if case.simulation.state.step > 150 and not refused:
            refused.append(row)
            recorder._files.frames.settle()  # the limit is one of the process
            size = (tmp_path / "history.csv").stat().st_size
            with files_of_at_most(size + 7):
                append(row)
        append(row)

    recorder._files.history.append = full
    with pytest.raises(OSError, match=REFUSAL):
        case.go(recorder)
    assert refused
    # Saved where it failed: nothing is done twice but the row.
    again = Case("cut", cutting(), END)
    gone_on = Recorder(again.simulation, tmp_path, until=END, name="cut", resume=True, **RECORDS)
    assert again.simulation.state.step == case.simulation.state.step
    again.go(gone_on)
    assert_same_run(tmp_path, uninterrupted)


@pytest.mark.parametrize(
    ("error", "said"),
    [
        (KeyError("no such figure"), ["Traceback", "KeyError: 'no such figure'", "remove the"]),
        (OSError(errno.ENOSPC, os.strerror(errno.ENOSPC)), ["No space left", "free space, then:"]),
    ],
)
def test_an_error_on_the_way_is_shown_and_the_run_goes_on(whole, tmp_path, broken_run, error, said):
    out, record = tmp_path / "out", Recorder._record

    def failing(recorder, sim, now, mark):
        record(recorder, sim, now, mark)
        if sim.state.step > 300:
            raise error

    told = broken_run(Recorder, "_record", failing)
    for part in (*said, f"shellcut resume {out}"):
        assert part in told
    assert not (out / "summary.json").exists()
    assert main(["resume", str(out)]) == 0
    assert_same_run(out, whole)


def test_an_error_of_another_hook_leaves_everything_and_goes_on(uninterrupted, tmp_path):
    class Failing:
        def due(self, sim):
            return sim.state.step == 137

        def __call__(self, sim):
            raise ZeroDivisionError

        def close(self):
            pass

    sim = cutting()
    recorder = Recorder(sim, tmp_path, until=END, name="cut", **RECORDS)
    with pytest.raises(ZeroDivisionError):
        sim.run(END, [recorder, Failing()])
    assert json.loads((tmp_path / "summary.json").read_text())["n_step"] == 137
    Case("cut", cutting(), END).run(tmp_path, resume=True, progress=False)
    assert_same_run(tmp_path, uninterrupted)


def moved(folder):
    folder.rename(folder.with_name("elsewhere"))


def emptied(folder):
    for path in folder.iterdir():
        path.unlink()


def replaced(folder):
    shutil.rmtree(folder)
    folder.mkdir()
    (folder / "history.csv").write_text("another's")


@pytest.mark.skipif(sys.platform == "win32", reason="open files cannot be removed there")
@pytest.mark.parametrize("take_away", [shutil.rmtree, moved, emptied, replaced])
def test_a_folder_taken_away_ends_the_run(tmp_path, monkeypatch, broken_run, take_away):
    out, call, steps = tmp_path / "out", Recorder.__call__, []

    def robbed(recorder, sim):
        call(recorder, sim)
        steps.append(sim.state.step)
        if sim.state.step == 100:
            take_away(out)

    monkeypatch.setattr(shellcut.recording.recorder, "_LOOK_EVERY", 0.0)
    said = broken_run(Recorder, "__call__", robbed)
    assert steps[-1] == 100  # the next call has ended it
    assert f"{out} has been removed, moved or emptied while guillotine was written there" in said
    assert "Traceback" not in said
    if take_away is moved:
        assert main(["resume", str(tmp_path / "elsewhere")]) == 0
    elif take_away is replaced:
        assert {p.name for p in out.iterdir()} == {"history.csv"}
