"""Two runs in one folder: the second is refused, by whatever way it comes, the first goes on."""

import subprocess
import sys

import pytest

import shellcut
import shellcut.recording.recorder
from shellcut import read_model
from shellcut.command_line import main
from shellcut.files.folder_lock import FolderInUse

SHORT = ["--set", "size=1", "--set", "membrane.length=6", "--set", "membrane.width=4"]
SHORT += ["--set", "travel=0.6", "--set", "output.rows=40", "--frames", "4", "--no-pictures"]

# A run that says when it is well on its way, and then waits to be killed.
GOING = """
import sys, time
import shellcut.recording.recorder
from shellcut.command_line import main

real = shellcut.recording.recorder.Recorder.__call__

shellcut.recording.recorder.can_draw = lambda: False

def slow(recorder, sim):
    real(recorder, sim)
    if sim.state.step >= 300:
        print("going", flush=True)
        time.sleep(600)

shellcut.recording.recorder.Recorder.__call__ = slow
main(sys.argv[1:])
"""


pytestmark = pytest.mark.usefixtures("no_pictures")


@pytest.fixture(scope="module")
def going(tmp_path_factory):
    """A folder that a process of its own is writing a run into, and the process."""
    out = tmp_path_factory.mktemp("going") / "out"
    command = [sys.executable, "-c", GOING, "run", "guillotine", "-o", str(out), *SHORT]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        for line in process.stdout:
            if line == "going\n":
                break
        assert process.poll() is None
        yield out, process
        process.kill()


RUN = "run guillotine -o OUT"
OVERWRITE = f"{RUN} --overwrite"


@pytest.mark.parametrize(
    ("command", "looked"),
    [
        ("resume OUT", False),
        (RUN, False),
        (OVERWRITE, False),
        (OVERWRITE, True),
    ],
)
def test_the_command_refuses(going, capsys, monkeypatch, command, looked):
    out, process = going
    before = {path.name: path.read_bytes() for path in out.iterdir()}
    if looked:  # before the first run began: the folder is taken when it comes to writing
        monkeypatch.setattr("shellcut.command_line.run.refuse_if_in_use", lambda _: None)
    words = [str(out) if word == "OUT" else word for word in command.split()]
    assert main([*words, *(SHORT if words[0] == "run" else [])]) == 2
    said = capsys.readouterr().err
    assert f"{out} is being written by process {process.pid} on " in said
    assert " since 20" in said
    assert "Traceback" not in said
    assert {path.name: path.read_bytes() for path in out.iterdir()} == before


def test_readers_are_not_disturbed_and_disturb_nobody(going):
    out, _ = going
    lock = (out / "run.lock").read_bytes()
    results = shellcut.read(out)
    assert results.n_frame >= 1
    assert len(results.history["time"]) >= 2
    assert results.summary == {}
    assert main(["report", str(out)]) == 0
    for name in ("report.html", "shellcut.files"):
        (out / name).unlink()
    assert (out / "run.lock").read_bytes() == lock
    case = read_model(out / "used.toml").build()
    with pytest.raises(FolderInUse):
        case.run(out, resume=True, progress=False)
