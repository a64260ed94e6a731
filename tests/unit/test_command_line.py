"""The command: exit codes, what it says and leaves, what it refuses."""

import hashlib
import html
import importlib
import io
import json
import logging
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numba as nb
import pytest

import shellcut
from shellcut import read_model, report_run
from shellcut.command_line import main
from shellcut.command_line.shared import MEANINGS
from shellcut.models import Case
from shellcut.numerics.jit import on_compilation
from shellcut.recording.run_log import RunLog
from shellcut.results.verdict import LOGGER, Line
from shellcut.tool.shapes import tooth_ring

# An empty name is not the present folder.
NAMELESS = [
    "run guillotine",
    "sweep guillotine --set size=1,2",
    "tensile a.csv --columns 1 2 --units - MPa",
    "preview guillotine",
]


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ([], "required: COMMAND"),
        (["wramup"], "invalid choice: 'wramup'"),
        (["run", "opening", "mesh=quick"], "keys of the model are set by --set mesh=quick"),
        (["resume", ""], "must have a name"),
        *(([*command.split(), "-o", ""], "must have a name") for command in NAMELESS),
    ],
)
def test_bad_arguments_leave_with_two(wrong, said, capsys):
    with pytest.raises(SystemExit) as left:
        main(wrong)
    assert left.value.code == 2
    assert said in capsys.readouterr().err


def test_help_version_and_warmup(capsys):
    said = {}
    for option in ("--version", "--help"):
        with pytest.raises(SystemExit) as left:
            main([option])
        assert left.value.code == 0
        said[option] = capsys.readouterr().out
    assert said["--version"] == f"shellcut {shellcut.__version__}\n"
    for code, meaning in MEANINGS.items():
        first = re.escape(meaning.split()[0])
        assert re.search(rf"^ +{code}  {first}", said["--help"], re.M)
    assert {0, 1, 2, 3, 4, 130} == set(MEANINGS)
    assert main(["warmup"]) == 0
    said = capsys.readouterr().out
    assert said.startswith("compiling the kernels")
    assert "done in" in said


# --- run, resume, preview ------------------------------------------------------------------------

SHORT = ["--set", "size=1", "--set", "membrane.length=6", "--set", "membrane.width=4"]
SHORT += ["--set", "travel=1.5", "--set", "output.rows=40", "--frames", "4"]
SHORT += ["--no-pictures", "--set", "output.curves=false"]
MEASURED = "path [mm], force [N]\n0, 0\n1, 3\n1.5, 3\n"


@pytest.fixture(scope="module")
def out(tmp_path_factory):
    """A whole short run of the command, in a process of its own."""
    folder = tmp_path_factory.mktemp("run") / "out"
    command = [sys.executable, "-m", "shellcut", "run", "guillotine", "-o", str(folder), *SHORT]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
    (folder.parent / "stdout").write_text(done.stdout)
    (folder.parent / "stderr").write_text(done.stderr)
    return folder


def states(folder):
    """Return the time at which each file of a folder was written."""
    return {path.name: path.stat().st_mtime_ns for path in folder.iterdir()}


def test_a_run_leaves_its_files_and_a_log_of_all_that_was_printed(out):
    left = {path.name for path in out.iterdir()}
    assert {"used.toml", "run.log", "history.csv", "summary.json", "guillotine.vtkhdf"} <= left
    assert not [name for name in left if name.startswith("snapshot")]
    assert read_model(out / "used.toml").sections["output"].frames == 4
    digest = hashlib.sha256((out / "used.toml").read_bytes()).hexdigest()
    log = (out / "run.log").read_text()
    assert f"shellcut {shellcut.__version__}, used.toml with sha256 {digest}\n" in log
    for name in ("stdout", "stderr"):
        for line in (out.parent / name).read_text().splitlines():
            assert "checks passed (" in line or line.removeprefix("guillotine: ") in log


def test_a_run_says_what_it_starts_from_and_what_came_of_it(out):
    said = (out.parent / "stdout").read_text().splitlines()
    patterns = [
        r"film .* 24 quads with sides of 1 to 1 mm.*",
        r"crack length +[\d.]+ mm",
        r"force to cut +at most [\d.]+ N, at [\d.]+ mm; no mean: .*",
    ]
    for pattern in patterns:
        assert sum(bool(re.fullmatch(pattern, line)) for line in said) == 1, pattern
    (found,) = [line for line in said if "but no steady value exists: no cable was bent" in line]
    assert said[said.index(found) + 1].startswith("distrust: Before the run: there must be film")
    assert "history.csv" in said[-1]
    assert not any(line.startswith("ok: ") for line in said)
    assert max(map(len, (out.parent / "stderr").read_text().splitlines()[1:])) <= 100


def test_the_verdict_is_the_same_everywhere(out, tmp_path, capsys):
    summary = json.loads((out / "summary.json").read_text())
    lines = [str(Line(**line)) for line in summary["verdict"]]
    # The blade comes no farther than its notch: doubted before, and shown after.
    assert lines[0].startswith("distrust: Before the run: there must be film to cut")
    kinds = [line.split(":")[0] for line in lines]
    assert kinds == sorted(kinds, key=["distrust", "ok", "note"].index)
    assert set(lines) < {*(out / "run.log").read_text().splitlines()}
    assert main(["resume", str(out), "--verbose"]) == 0
    said = capsys.readouterr().out
    assert set(lines) < {*said.splitlines()}
    assert f"{summary['tool_work_Nmm']:.4g} N·mm  100.0 %" in said
    assert "distrust: there must be film to cut" in (out.parent / "stderr").read_text()
    page = html.unescape(report_run(out, tmp_path / "r.html").read_text(encoding="utf-8"))
    assert all(line["text"] in page for line in summary["verdict"])


def test_what_is_refused_touches_nothing_and_can_be_forced_where_that_makes_sense(
    out, tmp_path, capsys
):
    before, command = states(out), ["run", "guillotine", *SHORT]
    soft = ["--set", "young=10"]
    never = ["--overwrite", "--force", "--set", "thickness=74"]
    for more, *said in (
        (never, "theory is not valid, got thickness 74 mm"),
        (["--overwrite", *soft], "--force"),
        ([], "--overwrite", f"shellcut resume {out}"),
    ):
        assert main([*command, *more, "-o", str(out)]) == 2
        error = capsys.readouterr().err
        assert [one for one in said if one not in error] == []
        assert more is not never or "--force" not in error
        assert states(out) == before
    assert main([*command, *soft, "-o", str(tmp_path), "--force"]) == 0
    doubt = "distrust: Before the run: strength 18 MPa is 1.8 times the film's modulus"
    assert doubt in capsys.readouterr().out


def test_the_account_is_balanced_and_comes_every_five_per_cent(out):
    lines = [line for line in (out / "run.log").read_text().splitlines() if "| E:" in line]
    shares = [int(line.split(" %")[0]) for line in lines]
    assert (shares[:3], shares[-1], len(shares)) == ([5, 10, 15], 100, 20)
    told = re.fullmatch(
        r"100 %: path [\d.]+ mm, force \S+ N \| E: (.*) N·mm \| (?:imbalance (\S+) % \| )?"
        r"crack (\S+) mm, (\d+) cables, (\d+) met by the blade, (\d+) broken",
        lines[-1],
    )
    energies = dict(part.rsplit(" ", 1) for part in told[1].split(", "))
    work = float(energies.pop("work of the tool"))
    assert energies.keys() >= {"stored in the film", "kinetic energy", "damping"}
    # Four figures of each are shown; what is left over is the imbalance, in per cent.
    missing = 0.01 * float(told[2] or 0.0) * work
    assert work - sum(map(float, energies.values())) == pytest.approx(missing, abs=2e-3 * work)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["run"], "give a MODEL: a file, or one of free, guillotine, opening"),
        (["run", "opening"], "-o OUT"),
        (["run", "opening", "-o", "out", "--set", "teeth"], "--set teeth: must be KEY=VALUE"),
        (["run", "opening", "-o", "out", "--frames", "0"], "[output].frames must be 1 or more"),
        (["run", "opening", "-o", "file"], "-o must name a folder"),
        (["run", "opening", "--write-model", "file"], "already exists"),
        (["run", "opening", "--write-model", "none/model.toml"], "model.toml: No such file or dir"),
        (["run", "openign"], "did you mean opening?\ngive a folder for the results: -o OUT"),
        (["run", "opening", "-o", "file/out"], "file/out: Not a directory"),
        (["warmup", "openign"], "openign: the models are opening, guillotine"),
        (["view", "out", "-o", "a.xyz"], "must end with one of .html, .mp4"),
        (["converge", "opening", "-o", "o", "--figures", "torqe_peak"], "did you mean torque_peak"),
        (["sweep", "opening", "-o", "o", "--design", "lhs"], "such as --n 16"),
        (["run", "file", "-o", "out", "--no-pictures"], "refused: file: model must be given"),
        (["resume", "nowhere"], "nowhere: there is no such folder"),
        (["report", "nowhere"], "nowhere must be the folder of a run"),
        (["resume", "."], "holds no used.toml"),
        (["preview", "openign"], "did you mean opening?"),
        (
            ["preview", "opening", "--set", "mesh=quick", "-o", "gone/x.png"],
            "gone: there is no such folder",
        ),
    ],
)
def test_bad_input_is_told_without_a_traceback(tmp_path, monkeypatch, capsys, arguments, said):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").write_text("")
    assert main(arguments) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.startswith("refused:")
    assert "Traceback" not in error
    assert {path.name for path in tmp_path.iterdir()} == {"file"}


def test_a_run_that_blows_up_ends_with_three(tmp_path, capsys):
    command = ["run", "guillotine", "-o", str(tmp_path), *SHORT, "--set", "fixed=1e-6", "--force"]
    assert main(command) == 3
    said = capsys.readouterr().err
    told = re.search(r"stopped: .* at step \d+, t = (\S+) s, worst in quad \d+ at \(", said)
    # The frame of the end is there: it was stopped while its numbers were still numbers.
    assert shellcut.read(tmp_path).times[-1] == pytest.approx(float(told[1]), rel=1e-5)
    assert re.search(r"The step of 1e-06 s is longer than the safe one, \S+ s: leave out", said)
    assert "imbalance -" not in said  # that of a step not taken to its end
    # What there is of it is judged, after the message.
    told, verdict = (tmp_path / "run.log").read_text().split("Up to ")
    assert "stopped: " in told
    assert "distrust: The run failed within a step, at " in verdict
    assert "distrust: Before the run: a fixed step must not exceed the safe one" in verdict
    assert (tmp_path / "history.csv").exists()


def test_the_end_is_said_last_or_when_the_process_may_end(capsys, tmp_path):
    (tmp_path / "summary.json").write_text('{"verdict": [{"kind": "doubt", "text": "it"}]}')
    log = RunLog()
    log.open(tmp_path / "run.log")
    with log.library_said():
        LOGGER.warning("distrust: it")
        logging.getLogger("shellcut.recording.recorder").warning("stopped")
        assert capsys.readouterr() == ("", "stopped\n")
        for handler in logging.getLogger("shellcut").handlers:
            handler.flush()
        assert "distrust: it" in capsys.readouterr().out
    log.close()
    assert capsys.readouterr().out == ""


def test_ctrl_c_ends_with_130_and_says_how_to_go_on(tmp_path, capsys, monkeypatch):
    def interrupted(self, recorder):
        recorder.close()
        raise KeyboardInterrupt

    monkeypatch.setattr(Case, "go", interrupted)
    assert main(["run", "guillotine", "-o", str(tmp_path), *SHORT]) == 130
    assert f"to continue: shellcut resume {tmp_path}" in capsys.readouterr().err
    assert "shellcut resume" in (tmp_path / "run.log").read_text()


@pytest.mark.parametrize(
    ("module", "command", "said"),
    [
        ("run_model", ["run", "guillotine", "-o", "out", *SHORT], "interrupted; nothing was run"),
        ("warmup", ["warmup"], "interrupted"),
    ],
)
def test_ctrl_c_before_a_run_ends_any_command_with_130_and_leaves_nothing(
    tmp_path, capsys, monkeypatch, module, command, said
):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.chdir(tmp_path)
    module = importlib.import_module(f"shellcut.command_line.{module}")
    monkeypatch.setattr(module, "warmup", interrupted)
    assert main(command) == 130
    assert said in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_a_pipe_that_is_closed_stops_no_command(out, tmp_path, monkeypatch):
    def closed():
        reading, writing = os.pipe()
        os.close(reading)
        return open(writing, "wb", buffering=0)

    with closed() as pipe:
        command = [sys.executable, "-m", "shellcut", "keys"]
        done = subprocess.run(command, stdout=pipe, stderr=subprocess.PIPE, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    # What the command writes is written.
    run, measured = shutil.copytree(out, tmp_path / "run"), tmp_path / "measured.csv"
    measured.write_text(MEASURED)
    with closed() as pipe:
        monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(pipe, write_through=True))
        assert main(["compare", str(run), str(measured)]) == 0
    assert (run / "comparison.json").exists()


@pytest.mark.skipif(sys.platform == "win32", reason="needs preexec_fn")
@pytest.mark.parametrize("number", [1, 2])
def test_a_stream_that_is_closed_from_the_start_stops_no_command(number):
    command = [sys.executable, "-m", "shellcut", "keys", "angle"]
    done = subprocess.run(
        command, capture_output=True, preexec_fn=lambda: os.close(number), check=False
    )
    assert (done.returncode, b"Traceback" in done.stderr) == (0, False)


@pytest.mark.parametrize(
    ("command", "mine"),
    [
        ("sweep study.toml -o . --jobs 1", "study.toml"),
        ("sweep guillotine -o . --jobs 1 --set size=1,2", "stop"),
        ("preview opening --set mesh=quick", "model.png"),
        ("preview model.toml -o model.toml", "model.toml"),
        ("run guillotine -o . " + " ".join(SHORT), "run.lock"),
        ("run guillotine --write-model link.toml", "link.toml"),
        ("compare run measured.csv", "run/comparison.json"),
        ("compare run measured.csv --json measured.csv", "measured.csv"),
        ("report run", "run/report.html"),
        ("report run -o run/history.csv", "run/history.csv"),
        ("view run --frame 0", "run/frame_0000.png"),
        ("view run", "run/view.html"),
        ("view run -o run/summary.json", "run/summary.json"),
        ("run run/used.toml -o run --overwrite", "run/used.toml"),
    ],
)
@pytest.mark.parametrize("linked", [False, True])
def test_a_file_of_ones_own_is_not_replaced(
    out, tmp_path, monkeypatch, capsys, command, mine, linked
):
    monkeypatch.chdir(tmp_path)
    shutil.copytree(out, "run")
    Path("measured.csv").write_text(MEASURED)
    study = 'model = "guillotine"\n[set]\n"membrane.size" = 1\n[factors]\nspeed = [1e3, 2e3]\n'
    Path("study.toml").write_text(study)
    Path("model.toml").write_text('model = "guillotine"\n')
    path = Path(mine)
    if not path.exists():
        path.write_text("mine")
    if linked:
        path.rename("elsewhere")
        path.symlink_to(Path("elsewhere").resolve())
    before = path.read_bytes()
    assert main(command.split()) == 2
    assert path.name in capsys.readouterr().err
    assert path.read_bytes() == before
    assert path.is_symlink() == linked


LONG, NO_TEXT = "x" * 300, os.fsdecode(b"x\xff")


@pytest.mark.parametrize("name", [LONG, NO_TEXT])
@pytest.mark.parametrize(
    "command",
    [
        "run guillotine -o {}/out/of/it",
        "run {} -o out",
        "run guillotine --set tool.file={} -o out",
        "resume {}",
        "view {}",
        "report {}",
        "compare {} {}",
        "tensile {} --columns 1 2 --units - MPa -o out",
        "sweep {} -o out",
        "preview {}",
        "fit guillotine {} --set cohesive.plateau=6:24 -o out",
    ],
)
def test_names_that_cannot_be_are_refused(tmp_path, monkeypatch, name, command):
    monkeypatch.chdir(tmp_path)
    (tmp_path / os.fsdecode(b"x\xff")).write_text("a file")
    said = io.TextIOWrapper(io.BytesIO(), "utf-8")
    monkeypatch.setattr(sys, "stderr", said)
    assert main([part.replace("{}", name) for part in command.split()]) == 2
    said.flush()
    assert b"x" in said.buffer.getvalue()


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


def test_keys_are_found_by_words(capsys):
    assert main(["keys", "TOOL", "angle"]) == 0
    said = capsys.readouterr().out
    assert re.search(
        r'\[tool\] kind = "teeth"  \(model opening, free: A ring of teeth .*\)\n'
        r"  wedge_half_angle_deg +number, .*40 at most \[deg\] += [\d.]+ +of the wedge, .*\n",
        said,
    )
    assert "whole motion" not in said  # that angle is another section's
    for words, *answers in (
        (["neck"], "docs/howto/own-film.md"),
        (["mouth"], "clamp"),
        (["scale"], "unit or scale"),  # the second name of a key
        ([], "[membrane]", "[cohesive]", "[[supports]]"),
    ):
        assert main(["keys", *words]) == 0
        said = capsys.readouterr().out
        assert [answer for answer in answers if answer not in said] == []
    assert main(["keys", "--schema"]) == 0
    assert json.loads(capsys.readouterr().out)["required"] == ["model"]
    assert main(["keys", "--schema", "study"]) == 0
    assert json.loads(capsys.readouterr().out)["properties"]["design"]["properties"]["seed"]
    assert main(["keys", "strenght"]) == 2
    assert "did you mean strength?" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("settings", "said", "drawn"),
    [
        (["tip_clearance=-1"], "the tool must start outside the sheet", "cut    all 4"),  # built
        (["path=imprint"], "set path = 'free', or leave it out", "film   649 nodes"),  # read
        (["thickness=74"], "a shell should be thin", "cut    all 4"),  # checked
        (["mesh=none", "teeth=0"], "[tool].teeth must be 1 or more", None),  # nothing to draw
    ],
)
def test_preview_draws_what_is_refused_too(tmp_path, capsys, settings, said, drawn):
    pytest.importorskip("matplotlib")
    picture = tmp_path / "model.png"
    words = [word for one in ("mesh=quick", *settings) for word in ("--set", one)]
    assert main(["preview", "opening", *words, "-o", str(picture)]) == 2
    out, error = capsys.readouterr()
    assert said in out + error
    assert picture.exists() == bool(drawn)
    if drawn:
        assert drawn in out
        assert "wrote" in out
        assert picture.stat().st_size > 20_000


def test_list_and_a_copy_to_edit(tmp_path, capsys):
    assert main(["run", "--list"]) == 0
    assert "opening      The opening test" in capsys.readouterr().out
    path = tmp_path / "mine.toml"
    for settings in ({}, {"mesh": "quick", "teeth": 5}):
        words = [f"--set={key}={value}" for key, value in settings.items()]
        assert main(["run", "opening", *words, "--write-model", str(path)]) == 0
        assert read_model(path) == read_model("opening", settings)
        # What editors read, and how its file is made.
        assert path.read_text(encoding="utf-8").startswith("#:schema ./shellcut.schema.json\n")
        assert "shellcut keys --schema > shellcut.schema.json" in capsys.readouterr().out
        path.unlink()


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
