"""Runs that fail on the way, or whose folder another run wants: what they leave, how they go on.

`tests/reliability/faults.py` fills disks, limits files and takes folders away, too.
"""

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
from shellcut import read_model
from shellcut.command_line import main
from shellcut.files.folder_lock import FolderInUse, FolderLock
from shellcut.models import Case
from shellcut.recording.recorder import Recorder

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


@pytest.mark.parametrize(
    ("error", "said"),
    [
        (KeyError("no such figure"), ["Traceback", "KeyError: 'no such figure'", "remove the"]),
        (OSError(errno.ENOSPC, os.strerror(errno.ENOSPC)), ["No space left", "free space, then:"]),
        (OSError(errno.EFBIG, os.strerror(errno.EFBIG)), ["File too large", "free space, then:"]),
    ],
)
def test_an_error_on_the_way_is_shown_and_the_run_goes_on(whole, tmp_path, broken_run, error, said):
    out, record = tmp_path / "out", Recorder._record

    def failing(recorder, sim, now, mark):
        record(recorder, sim, now, mark)
        if sim.state.step > 300:
            raise error

    told = broken_run(Recorder, "_record", failing)
    for part in (*said, "failed at path ", f"shellcut resume {out}"):
        assert part in told
    assert "failed at path " in (out / "run.log").read_text()
    # What there is can be read, and nothing says that the run had ended.
    results = shellcut.read(out)
    assert results.n_frame >= 1
    assert results.summary == {}
    assert not (out / "run.lock").exists()
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


def removed(folder):
    while folder.exists():  # a file may appear or vanish while a frame is written
        shutil.rmtree(folder, ignore_errors=True)


def moved(folder):
    folder.rename(folder.with_name("elsewhere"))


def replaced(folder):
    removed(folder)
    folder.mkdir()
    (folder / "history.csv").write_text("another's")


@pytest.mark.skipif(sys.platform == "win32", reason="open files cannot be removed there")
@pytest.mark.parametrize("take_away", [removed, moved, replaced])
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


# --- a folder that another run is writing; test_taken_folder.py has another process


@pytest.fixture
def in_use(whole, tmp_path):
    """The folder of a run that is being written."""
    out = shutil.copytree(whole, tmp_path / "out")
    lock = FolderLock(out)
    yield out
    lock.close()


RUN = f"run {' '.join(MODEL)} -o OUT"
OVERWRITE = f"{RUN} --overwrite"


@pytest.mark.parametrize(
    ("command", "looked"),
    [("resume OUT", False), (RUN, False), (OVERWRITE, False), (OVERWRITE, True)],
)
def test_a_second_run_in_a_folder_is_refused(in_use, capsys, monkeypatch, command, looked):
    before = {path.name: path.read_bytes() for path in in_use.iterdir()}
    if looked:  # before the first run began: the folder is taken when it comes to writing
        monkeypatch.setattr("shellcut.command_line.run.refuse_if_in_use", lambda _: None)
    assert main([str(in_use) if word == "OUT" else word for word in command.split()]) == 2
    said = capsys.readouterr().err
    assert f"{in_use} is being written by this very process" in said
    assert "Traceback" not in said
    assert {path.name: path.read_bytes() for path in in_use.iterdir()} == before


def test_readers_are_not_disturbed_and_disturb_nobody(in_use):
    lock = (in_use / "run.lock").read_bytes()
    assert shellcut.read(in_use).n_frame >= 1
    assert main(["report", str(in_use)]) == 0
    assert (in_use / "run.lock").read_bytes() == lock
    case = read_model(in_use / "used.toml").build()
    with pytest.raises(FolderInUse):
        case.run(in_use, resume=True, progress=False)
