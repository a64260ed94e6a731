"""The command: exit codes, what it says and leaves, what it refuses."""

import hashlib
import importlib
import re
import subprocess
import sys
from pathlib import Path

import numba as nb
import pytest

import shellcut
from shellcut import read_model
from shellcut._jit import on_compilation
from shellcut.command_line import main
from shellcut.models import Case
from shellcut.tool_shapes import tooth_ring


def test_warmup_says_where_the_cache_is(capsys):
    assert main(["warmup"]) == 0
    said = capsys.readouterr().out
    assert said.startswith("compiling the kernels")
    assert "done in" in said


@pytest.mark.parametrize(
    ("options", "wanted"), [([], ("double",)), (["--single"], ("double", "single"))]
)
def test_warmup_compiles_for_the_precisions_asked_for(monkeypatch, options, wanted):
    module = importlib.import_module("shellcut.command_line.warmup")
    asked = []
    monkeypatch.setattr(module, "warmup", lambda precisions: asked.append(precisions))
    assert main(["warmup", *options]) == 0
    assert asked == [wanted]


@pytest.mark.parametrize("wrong", [[], ["wramup"]])
def test_bad_arguments_leave_with_two(wrong):
    with pytest.raises(SystemExit) as left:
        main(wrong)
    assert left.value.code == 2


def test_the_module_is_the_command():
    done = subprocess.run(
        [sys.executable, "-m", "shellcut", "--help"], check=True, capture_output=True, text=True
    )
    assert "warmup" in done.stdout


# --- run, resume, preview ------------------------------------------------------------------------

SHORT = ["--set", "size=1", "--set", "membrane.length=6", "--set", "membrane.width=4"]
SHORT += ["--set", "travel=1.5", "--set", "output.rows=40", "--frames", "4", "--no-pictures"]


@pytest.fixture(scope="module")
def out(tmp_path_factory):
    """A whole short run of the command, in a process of its own."""
    folder = tmp_path_factory.mktemp("run") / "out"
    done = subprocess.run(
        [sys.executable, "-m", "shellcut", "run", "guillotine", "-o", str(folder), *SHORT],
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    (folder.parent / "stdout").write_text(done.stdout)
    (folder.parent / "stderr").write_text(done.stderr)
    return folder


def test_a_run_leaves_its_files(out):
    left = {path.name for path in out.iterdir()}
    assert {"used.toml", "run.log", "history.csv", "summary.json", "guillotine.vtkhdf"} <= left
    assert not [name for name in left if name.startswith("snapshot")]
    assert read_model(out / "used.toml").sections["output"].frames == 4


def test_the_log_tells_version_and_model(out):
    digest = hashlib.sha256((out / "used.toml").read_bytes()).hexdigest()
    said = (out / "run.log").read_text()
    assert f"shellcut {shellcut.__version__}, used.toml with sha256 {digest}\n" in said


def test_a_run_says_what_it_starts_from_and_what_came_of_it(out):
    said = (out.parent / "stdout").read_text().splitlines()
    film = next(line for line in said if line.startswith("film"))
    assert "24 quads" in film
    assert "edges 1 to 1 mm" in film
    assert any(line.startswith("tool   1 body") for line in said)
    step = next(line for line in said if line.startswith("step"))
    assert "steps to path 1.5 mm" in step
    assert any(line.startswith("crack length [mm]") for line in said)
    assert "history.csv" in said[-1]


def test_the_account_is_balanced_and_comes_every_five_per_cent(out):
    lines = [line for line in (out / "run.log").read_text().splitlines() if "| E:" in line]
    shares = [int(line.split(" %")[0]) for line in lines]
    assert shares[:3] == [5, 10, 15]
    assert shares[-1] == 100
    assert len(shares) in (20, 21)  # the last step may end the run and stand for 100 % once more
    figures = re.fullmatch(
        r"100 %: path [\d.]+ mm, force \S+ N \| E: kin (\S+) int (\S+) cohesive (\S+) "
        r"contact (\S+) damping (\S+) ext (\S+) N\*mm \| balance ([+-][\d.]+) % \| "
        r"crack (\S+) mm, cables (\d+) made (\d+) jointed (\d+) broken",
        lines[-1],
    )
    *parts, ext, balance = map(float, figures.groups()[:7])
    # Four figures of each are shown; what is left over is what the balance says, in per cent.
    assert ext - sum(parts) == pytest.approx(0.01 * balance * ext, abs=2e-3 * ext)


def test_the_log_has_all_that_was_printed(out):
    log = (out / "run.log").read_text()
    for line in (out.parent / "stdout").read_text().splitlines():
        assert line in log
    for line in (out.parent / "stderr").read_text().splitlines():
        assert line.removeprefix("guillotine: ") in log


def test_a_folder_with_a_run_is_not_overwritten_silently(out, capsys):
    before = {path.name: path.stat().st_mtime_ns for path in out.iterdir()}
    assert main(["run", "guillotine", "-o", str(out)]) == 2
    said = capsys.readouterr().err
    assert "--overwrite" in said
    assert f"shellcut resume {out}" in said
    assert {path.name: path.stat().st_mtime_ns for path in out.iterdir()} == before


def test_overwrite_leaves_nothing_of_the_run_before(tmp_path, capsys):
    for name in ("history.csv", "snapshot_07.png", "old.vtkhdf", "run.log", "notes.txt"):
        (tmp_path / name).write_text("old")
    assert main(["run", "guillotine", "-o", str(tmp_path), "--overwrite", *SHORT]) == 0
    left = {path.name for path in tmp_path.iterdir()}
    assert "notes.txt" in left
    assert not left & {"snapshot_07.png", "old.vtkhdf"}
    assert not (tmp_path / "run.log").read_text().startswith("old")
    capsys.readouterr()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["run"], "name a MODEL: a file, or one of guillotine, opening"),
        (["run", "opening"], "-o OUT"),
        (["run", "openign", "-o", "out"], "did you mean opening?"),
        (["run", "opening", "-o", "out", "--set", "tool.teehs=3"], "did you mean teeth?"),
        (["run", "opening", "-o", "out", "--set", "teeth"], "--set teeth: must be KEY=VALUE"),
        (["run", "opening", "-o", "out", "--set", "file=3"], "one of membrane.file, tool.file"),
        (["run", "opening", "-o", "out", "--frames", "0"], "[output].frames must be 1 or more"),
        (["run", "opening", "-o", "file"], "-o must name a folder"),
        (["run", "opening", "--write-model", "file"], "is there already"),
        (["run", "opening", "--write-model", "none/model.toml"], "No such file or directory"),
        (["resume", "nowhere"], "holds no used.toml"),
        (["preview", "openign"], "did you mean opening?"),
        (["preview", "opening", "--set", "mesh=quick", "-o", "gone/x.png"], "gone"),
        (["preview", "opening", "--set", "tip_clearance=-1", "--set", "mesh=quick"], "tool"),
    ],
)
def test_bad_input_is_told_without_a_traceback(tmp_path, monkeypatch, capsys, arguments, said):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").write_text("")
    assert main(arguments) == 2
    error = capsys.readouterr().err
    assert said in error
    assert "Traceback" not in error
    assert {path.name for path in tmp_path.iterdir()} == {"file"}


def test_a_run_that_blows_up_ends_with_three(tmp_path, capsys):
    code = main(["run", "guillotine", "-o", str(tmp_path), *SHORT, "--set", "fixed=1e-6"])
    assert code == 3
    said = capsys.readouterr().err
    told = re.search(r"stopped: .* at step \d+, t = (\S+) s, dt = 1e-06 s: quad \d+ at \(", said)
    # The frame of the end is there: it was stopped while its numbers were still numbers.
    assert shellcut.read(tmp_path).times[-1] == pytest.approx(float(told[1]), rel=1e-5)
    assert "lower Stepping.safety, or leave Stepping.fixed unset" in said
    assert "stopped: " in (tmp_path / "run.log").read_text()
    assert (tmp_path / "history.csv").exists()


def test_ctrl_c_ends_with_130_and_says_how_to_go_on(tmp_path, capsys, monkeypatch):
    def interrupted(self, folder, **options):
        raise KeyboardInterrupt

    monkeypatch.setattr(Case, "run", interrupted)
    assert main(["run", "guillotine", "-o", str(tmp_path), *SHORT]) == 130
    assert f"to go on: shellcut resume {tmp_path}" in capsys.readouterr().err
    assert "shellcut resume" in (tmp_path / "run.log").read_text()


def test_resume_builds_the_same_model_and_asks_to_go_on(out, monkeypatch, capsys):
    asked = {}
    log = (out / "run.log").read_text()
    monkeypatch.setattr(Case, "run", lambda self, folder, **options: asked.update(options))
    assert main(["resume", str(out)]) == 0
    assert asked["resume"] is True
    assert asked["n_frame"] == 4
    assert (out / "run.log").read_text().startswith(log + f"resuming {out}\n")
    capsys.readouterr()


def test_resume_refuses_what_has_changed(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    tooth_ring().write("cap.stl")
    read_model("opening", {"tool.file": "cap.stl"}).write("used.toml")
    tooth_ring(n_teeth=2).write("cap.stl")
    used = Path("used.toml").read_text()
    Path("used.toml").write_text(used.replace("young = 1678.0", "young = 1700.0"))
    assert main(["resume", "."]) == 2
    said = capsys.readouterr().err
    assert "cap.stl is gone or has been changed since the run began" in said
    assert "used.toml has been changed since the run began" in said


def test_preview_draws_and_runs_nothing(tmp_path, capsys):
    pytest.importorskip("matplotlib")
    picture = tmp_path / "model.png"
    assert main(["preview", "opening", "--set", "mesh=quick", "-o", str(picture)]) == 0
    said = capsys.readouterr().out
    assert "612 quads" in said
    assert "4 cutting edges" in said
    assert picture.stat().st_size > 20_000


def test_list_and_a_copy_to_edit(tmp_path, capsys):
    assert main(["run", "--list"]) == 0
    assert "opening      The opening test" in capsys.readouterr().out
    path = tmp_path / "mine.toml"
    assert main(["run", "opening", "--write-model", str(path)]) == 0
    assert read_model(path) == read_model("opening")


def test_compiling_is_said_when_kernels_are_compiled_only():
    @nb.njit
    def once(x):
        return x + 1.0

    said = []
    with on_compilation(lambda: said.append("compiling")):
        once(1.0)
        once(1)
        assert said == ["compiling"]
    with on_compilation(lambda: said.append("again")):
        once(2.0)
    assert said == ["compiling"]
