"""Acceptance: the first fifteen minutes of a user, in a fresh environment without a display.

    python tests/acceptance/run.py                   # four to six minutes; 1 GB on disk
    python tests/acceptance/run.py -k resume         # some tests, with what they need
    python tests/acceptance/run.py --basetemp DIR    # leave everything in DIR to be looked at

It builds the wheel, installs it with the extra ``plot`` into a virtual environment of its own, and
goes through what a user does, each command against a limit of time. ``commands.log`` in the user's
folder has every command, what it said, its exit code and its time.

What each command computes and says is tried by the default tests, and every command of the pages by
tests/unit/test_pages.py, licences by tests/reliability. Here it is done by a user, with what the
wheel brings and nothing else.
"""

import csv
import functools
import json
import re
import sys
import time
import zipfile

import pytest
from user import QUICK, ROOT, User


@pytest.fixture(scope="module")
def user(tmp_path_factory):
    return User(tmp_path_factory.mktemp("user"))


def within(seconds, *needs):
    """Give a test a limit of time, which begins when the user has what it needs."""

    def limited(test):
        @functools.wraps(test)
        def timed(user, **given):
            for need in needs:
                getattr(user, need)
            began = time.perf_counter()
            test(user, **given)
            assert time.perf_counter() - began < seconds

        return timed

    return limited


def assert_said(said, *words):
    """Fail unless all the words were said."""
    for word in words:
        assert word in said


def test_the_first_screen_of_the_readme():
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    pictures = re.findall(r"!\[[^\]]+\]\(([^)]+)\)", text)
    for path in pictures[:2]:
        assert (ROOT / path).is_file()
    assert len(pictures) >= 2  # of the cut, and a torque curve
    script = re.search(r"```python\n(.*?)```", text, re.S)
    assert script
    lines = [line for line in script[1].splitlines() if line.strip()]
    assert len(lines) <= 6
    compile(script[1], "README.md", "exec")
    assert_said(text, "pip install", "shellcut run opening --set mesh=quick -o out", "pytest")
    assert_said(text, "it does not", "mm, N, s, tonne, MPa", "docs/limits.md", "CITATION.cff")


@within(120)
def test_the_wheel_is_small_and_pure_and_all_that_it_needs_is_wheels(user):
    wheel = user.environment
    assert wheel.stat().st_size < 2e6
    assert wheel.name.endswith("py3-none-any.whl")
    with zipfile.ZipFile(wheel) as content:
        native = [n for n in content.namelist() if n.endswith((".so", ".pyd", ".dll", ".dylib"))]
    assert not native
    names = "print(*(p.metadata['Name'].lower() for p in importlib.metadata.distributions()))"
    packages = user.python(f"import importlib.metadata; {names}").stdout.split()
    for name in ("gmsh", "vtk", "pandas"):
        assert name not in packages


@within(60, "environment")
def test_the_import_takes_less_than_a_second(user):
    text = (
        "import time; t = time.perf_counter(); import shellcut; "
        "print(time.perf_counter() - t, shellcut.__version__)"
    )
    # The least of five: what else runs on the machine only adds.
    said = [user.python(text).stdout.split() for _ in range(5)]
    best = min(float(seconds) for seconds, _ in said)
    assert best < 1.0
    assert re.fullmatch(r"\d+\.\d+\.\d+\S*", said[0][1])


@within(240, "environment")
def test_the_main_job_with_nothing_compiled(user):
    said = user.first_run.stdout
    assert user.first_run.returncode == 0, said
    # What a user sees: the model, what is compiled, progress; energies every 5 % in run.log.
    for pattern in (
        r"film +649 nodes, 612 quads with sides of .* 0\.074 mm thick",
        r"time +about .* on a free core: about [\d,]+ steps, the first of \S+ s",
        r"compiling \(first run only",
        r"compiled in \d+ s",
        r" %: angle [\d.]+°, torque \S+ N·mm",
        r"The cut took a torque of \S+ ± \S+ N·mm",
    ):
        assert re.search(pattern, said)
    log = (user.out / "run.log").read_text(encoding="utf-8")
    shares = [int(share) for share in re.findall(r"(\d+) %: .* \| E: .* \| crack", log)]
    assert set(shares) == set(range(5, 101, 5))
    with (user.out / "history.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    bare = [name for name in rows[0] if not re.fullmatch(r"\w+ \[[^\]]+\]", name)]
    assert not bare
    names = ["opening.vtkhdf", "history.csv", "summary.json", "splits.csv", "torque.png"]
    names += ["energy.png", "run.log", "used.toml", "checkpoint.h5"]
    for name in names:
        assert (user.out / name).stat().st_size > 0
    assert len(list(user.out.glob("snapshot_*.png"))) >= 4
    summary = json.loads((user.out / "summary.json").read_text(encoding="utf-8"))
    assert summary["imbalance_rel"] <= 0.01


@within(180, "out")
def test_a_run_after_ctrl_c_and_resume_has_the_bits_of_the_uninterrupted_one(user):
    again = user.folder / "again"
    half = (user.out / "history.csv").stat().st_size / 2

    def halfway():
        history = again / "history.csv"
        return history.exists() and history.stat().st_size > half

    stopped = user.interrupted("run", *QUICK, "-o", "again", when=halfway)
    assert stopped.returncode == 130, stopped.stdout
    assert_said(stopped.stdout, "shellcut resume again")
    assert re.search(r"stopped at (.+?);", stopped.stdout)
    resumed = user.shellcut("resume", "again")
    assert resumed.returncode == 0, resumed.stdout
    for name in ("history.csv", "splits.csv"):
        assert (user.out / name).read_bytes() == (again / name).read_bytes()
    runs = (user.out, again)
    digests = {json.loads((run / "summary.json").read_text())["digest"] for run in runs}
    assert len(digests) == 1


_OWN = "--set membrane.file=parts/disc.msh --set membrane.clamp=clamped --set tool.file="

COMMANDS = (
    # Command, exit code, what is said, what is left; limit [s].
    ("doctor", 0, ("compiled code", "matplotlib", "pip install 'shellcut-fem[mesh]'"), (), 30),
    ("report out", 0, (), ("out/report.html",), 30),
    ("view out", 0, (), ("out/view.html",), 30),
    ("run opening --write-model tooth.toml", 0, (), ("tooth.toml",), 10),
    (
        "preview tooth.toml --set mesh=quick --set teeth=6 -o tooth.png",
        *(0, ("612 quads", "6 cutting edges", "72 nodes supported"), ("tooth.png",), 30),
    ),
    ("run tooth.toml --set tool.teehs=6 -o wrong", 2, ("did you mean teeth?",), (), 10),
    (
        f"preview opening {_OWN}parts/cap.stl -o own.png",
        0,
        (
            "disc.msh: no unit given: taken as mm, the film is 20.4 mm across",
            "4 of 4 bodies were inside out and are turned",
            "4 cutting edges found by angle, 23.09 mm in all",
        ),
        ("own.png",),
        60,
    ),
    (
        f"run opening {_OWN}parts/cap.stl --set motion.angle_deg=10 --set duration=0.7e-3 -o own",
        *(0, ("4 of 4 bodies were inside out",), ("own/summary.json", "own/torque.png"), 60),
    ),
    (f"run opening {_OWN}cup.stl -o refused", 2, ("cup.stl",), (), 30),
    (
        "sweep opening --set mesh=quick --set motion.angle_deg=30 --set duration=2e-3 "
        "--set cohesive.plateau=14,18 -o study",
        *(0, (), ("study/table.csv",), 120),
    ),
    ("report study", 0, (), ("study/report.html",), 30),
)


@pytest.mark.parametrize(("text", "code", "words", "left", "seconds"), COMMANDS)
def test_a_command(user, text, code, words, left, seconds):
    parts = ("out",) if "out" in text.split() else ("parts",) if "parts/" in text else ()

    @within(seconds, "environment", *parts)
    def command(user):
        done = user.shellcut(*text.split())
        assert done.returncode == code, done.stdout
        assert_said(done.stdout, *words)
        assert not re.search("Traceback|PROBLEM", done.stdout), done.stdout
        sizes = [(user.folder / name).stat().st_size for name in left]
        assert all(size > 1000 for size in sizes)

    command(user)


if __name__ == "__main__":
    asked = ["-n0", "-v", "--noconftest", "--durations=0", *sys.argv[1:]]
    sys.exit(pytest.main([__file__, *asked]))
