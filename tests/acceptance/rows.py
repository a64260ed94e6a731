"""Rows: README, wheel, installation, doctor; the main job; what a user does after it.

What each command computes and says is tried by the default tests, and every command of the pages by
tests/unit/test_pages.py, licences by tests/reliability. Here it is done by a user, with what the
wheel brings and nothing else.
"""

import csv
import json
import re
import zipfile

from row import assert_said, row
from user import QUICK, ROOT


@row("0", "README: the first screen", seconds=5)
def readme(user):
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    pictures = re.findall(r"!\[[^\]]+\]\(([^)]+)\)", text)
    for path in pictures[:2]:
        assert (ROOT / path).is_file(), f"{path} is not there"
    assert len(pictures) >= 2, "a picture of the cut and a torque curve must be shown"
    script = re.search(r"```python\n(.*?)```", text, re.S)
    assert script, "a script must be shown"
    lines = [line for line in script[1].splitlines() if line.strip()]
    assert len(lines) <= 6, f"the script must have six lines, got {len(lines)}"
    compile(script[1], "README.md", "exec")
    assert_said(text, "pip install", "shellcut run opening --set mesh=quick -o out", "pytest")
    assert_said(text, "it does not", "mm, N, s, tonne, MPa", "docs/limits.md", "CITATION.cff")
    return f"{len(pictures)} pictures, a script of {len(lines)} lines"


@row(
    "0-2",
    "pip install 'shellcut-fem[plot]' in a fresh environment",
    seconds=120,
    limit="wheels only: no compiler; own wheel pure and < 2 MB",
)
def install(user):
    wheel = user.environment.wheel
    size = wheel.stat().st_size / 1e6
    assert size < 2.0, f"the wheel must be under 2 MB, got {size:.2f}"
    assert wheel.name.endswith("py3-none-any.whl"), f"the wheel must be pure, got {wheel.name}"
    with zipfile.ZipFile(wheel) as content:
        native = [n for n in content.namelist() if n.endswith((".so", ".pyd", ".dll", ".dylib"))]
    assert not native, f"no machine code in the wheel, got {native}"
    names = "print(*(p.metadata['Name'].lower() for p in importlib.metadata.distributions()))"
    packages = user.python(f"import importlib.metadata; {names}").said.split()
    for name in ("gmsh", "vtk", "pandas"):
        assert name not in packages, f"{name} is an extra, but was installed"
    return f"{user.environment.seconds:.0f} s of it pip, {len(packages)} packages, {size:.2f} MB"


@row("2", "import shellcut", seconds=60, limit="< 1.0 s", needs=("environment",))
def import_time(user):
    text = (
        "import time; t = time.perf_counter(); import shellcut; "
        "print(time.perf_counter() - t, shellcut.__version__)"
    )
    # The least of five: what else runs on the machine only adds.
    said = [user.python(text).said.split() for _ in range(5)]
    best = min(float(seconds) for seconds, _ in said)
    assert best < 1.0, f"the import must take less than 1.0 s, got {best:.2f}"
    assert re.fullmatch(r"\d+\.\d+\.\d+\S*", said[0][1]), f"no version: {said[0][1]}"
    return f"{best:.2f} s (least of 5), version {said[0][1]}"


@row(
    "2-6",
    "shellcut run opening --set mesh=quick -o out, nothing compiled",
    seconds=240,
    limit="exit code 0; |balance| <= 1 % of the work put in; every file there",
    needs=("environment",),
)
def main_job(user):
    said = user.first_run.said
    assert user.first_run.code == 0, f"exit code {user.first_run.code}:\n{said}"
    # What a user sees: the model, what is compiled, progress; energies every 5 % in run.log.
    for pattern in (
        r"film +649 nodes, 612 quads with sides of .* 0\.074 mm thick",
        r"time +about .* on a free core: about [\d,]+ steps, the first of \S+ s",
        r"compiling \(first run only",
        r"compiled in \d+ s",
        r" %: angle [\d.]+°, torque \S+ N·mm",
        r"The cut took a torque of \S+ ± \S+ N·mm",
    ):
        assert re.search(pattern, said), f"nothing like {pattern!r} was said:\n{said}"
    log = (user.out / "run.log").read_text(encoding="utf-8")
    shares = [int(share) for share in re.findall(r"(\d+) %: .* \| E: .* \| crack", log)]
    assert set(shares) == set(range(5, 101, 5)), f"energies every 5 %, got {shares}"
    with (user.out / "history.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    bare = [name for name in rows[0] if not re.fullmatch(r"\w+ \[[^\]]+\]", name)]
    assert not bare, f"every column must name its unit, got {bare}"
    names = ["opening.vtkhdf", "history.csv", "summary.json", "splits.csv", "torque.png"]
    names += ["energy.png", "run.log", "used.toml", "checkpoint.h5"]
    for name in names:
        assert (user.out / name).stat().st_size > 0, f"{name} is empty"
    snapshots = list(user.out.glob("snapshot_*.png"))
    assert len(snapshots) >= 4, f"4 snapshots or more, got {len(snapshots)}"
    summary = json.loads((user.out / "summary.json").read_text(encoding="utf-8"))
    balance = summary["imbalance_rel"]
    assert balance <= 0.01, f"the balance must close within 1 % of the work, got {balance:.2%}"
    return f"balance {balance:.3%}, {len(rows)} rows, {len(names) + len(snapshots)} files"


@row(
    "8-9",
    "Ctrl-C in a run, then shellcut resume",
    seconds=180,
    limit="exit code 130, says where it stopped; then the uninterrupted run's bits",
    needs=("out",),
)
def interrupt_and_resume(user):
    again = user.folder / "again"
    half = (user.out / "history.csv").stat().st_size / 2

    def halfway():
        history = again / "history.csv"
        return history.exists() and history.stat().st_size > half

    stopped = user.interrupted("run", *QUICK, "-o", "again", when=halfway)
    assert stopped.code == 130, f"exit code {stopped.code}:\n{stopped.said}"
    assert_said(stopped.said, "shellcut resume again")
    place = re.search(r"stopped at (.+?);", stopped.said)
    assert place, f"where it stopped was not said:\n{stopped.said[-500:]}"
    resumed = user.shellcut("resume", "again")
    assert resumed.code == 0, f"exit code {resumed.code}:\n{resumed.said}"
    for name in ("history.csv", "splits.csv"):
        same = (user.out / name).read_bytes() == (again / name).read_bytes()
        assert same, f"{name} differs"
    runs = (user.out, again)
    digests = {json.loads((run / "summary.json").read_text())["digest"] for run in runs}
    assert len(digests) == 1, f"the digests of the state differ: {digests}"
    return f"stopped at {place[1]}, resumed: history, splits and state equal bit for bit"


_OWN = "--set membrane.file=parts/disc.msh --set membrane.clamp=clamped --set tool.file="

COMMANDS = (
    # Minute, command, exit code, what is said, what is left; limit [s].
    ("2", "doctor", 0, ("compiled code", "matplotlib", "pip install 'shellcut-fem[mesh]'"), (), 30),
    ("7", "report out", 0, (), ("out/report.html",), 30),
    ("7", "view out", 0, (), ("out/view.html",), 30),
    ("9-10", "run opening --write-model tooth.toml", 0, (), ("tooth.toml",), 10),
    (
        "9-10",
        "preview tooth.toml --set mesh=quick --set teeth=6 -o tooth.png",
        *(0, ("612 quads", "6 cutting edges", "72 nodes supported"), ("tooth.png",), 30),
    ),
    ("9-10", "run tooth.toml --set tool.teehs=6 -o wrong", 2, ("did you mean teeth?",), (), 10),
    (
        "10-12",
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
        "10-12",
        f"run opening {_OWN}parts/cap.stl --set motion.angle_deg=10 --set duration=0.7e-3 -o own",
        *(0, ("4 of 4 bodies were inside out",), ("own/summary.json", "own/torque.png"), 60),
    ),
    ("10-12", f"run opening {_OWN}cup.stl -o refused", 2, ("cup.stl",), (), 30),
    (
        "13-14",
        "sweep opening --set mesh=quick --set motion.angle_deg=30 --set duration=2e-3 "
        "--set cohesive.plateau=14,18 -o study",
        *(0, (), ("study/table.csv",), 120),
    ),
    ("13-14", "report study", 0, (), ("study/report.html",), 30),
)


def _command(minute, text, code, words, left, seconds):
    needs = ("out",) if "out" in text.split() else ("parts",) if "parts/" in text else ()

    @row(minute, f"shellcut {text}", seconds=seconds, needs=("environment", *needs))
    def command(user):
        done = user.shellcut(*text.split())
        assert done.code == code, f"exit code {done.code}:\n{done.said}"
        assert_said(done.said, *words)
        assert not re.search("Traceback|PROBLEM", done.said), done.said
        sizes = [(user.folder / name).stat().st_size for name in left]
        assert all(size > 1000 for size in sizes), f"{left} must not be empty, got {sizes}"
        return f"exit code {code}"


for _row in COMMANDS:
    _command(*_row)
