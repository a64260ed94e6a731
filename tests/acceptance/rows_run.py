"""Rows of the main job: the run and its files, Ctrl-C, blow-up, threads, provenance."""

from __future__ import annotations

import csv
import hashlib
import json
import re
from pathlib import Path

from row import Rows, expect, expect_words
from user import QUICK, SHORT, User

ROWS = Rows()

_COLD = 240.0


@ROWS.add(
    "2-6",
    "shellcut run opening --set mesh=quick -o out, nothing compiled",
    seconds=_COLD,
    limit="exit code 0; |balance| <= 1 % of the work put in; kinetic/internal <= 5 % after 10 %",
    needs=("environment",),
)
def main_job(user: User) -> str:
    said = user.first_run.said
    expect(user.first_run.code == 0, f"exit code {user.first_run.code}:\n{said}")
    out = user.out
    # What a user sees: the model, the step, what is compiled, an account every 5 %.
    for pattern in (
        r"film +612 quads, .* 0\.074 mm thick",
        r"step +\S+ s at first, so about [\d,]+ steps .* about .* on a free core",
        r"compiling \(first run only",
        r"compiled in \d+ s",
        r"angle [\d.]+ deg, torque \S+ N\*mm.* steps/s, .* left",
    ):
        expect(re.search(pattern, said), f"nothing like {pattern!r} was said:\n{said}")
    account = (
        r"(\d+) %: .*E: kin \S+ int \S+ cohesive \S+ contact \S+ damping \S+ ext \S+ N\*mm \| "
        r"balance [+-][\d.]+ % \| crack [\d.]+ mm, cables \d+ made"
    )
    shares = [int(share) for share in re.findall(account, said)]
    expect(set(shares) == set(range(5, 101, 5)), f"an account every 5 %, got {shares}")
    with (out / "history.csv").open(encoding="utf-8") as file:
        history = [
            {name.split(" [")[0]: float(value) for name, value in line.items()}
            for line in csv.DictReader(file)
        ]
    work = history[-1]["tool_work"]
    balance = max(abs(line["imbalance"]) for line in history) / work
    expect(balance <= 0.01, f"the balance must close within 1 % of the work, got {balance:.2%}")
    # The history books as internal what the film and the cables hold or have used up.
    ratios = [
        (line["kinetic_translation"] + line["kinetic_rotation"])
        / (line["strain"] + line["cohesive_work"])
        for line in history
        if line["angle"] > 0.1 * history[-1]["angle"]
    ]
    expect(max(ratios) <= 0.05, f"kinetic over internal energy is {max(ratios):.2%}")
    return f"balance {balance:.3%}, kinetic/internal {max(ratios):.2%}, {len(history)} rows"


@ROWS.add("6", "ls out", seconds=5, limit="every file there and not empty", needs=("out",))
def files(user: User) -> str:
    names = ["opening.vtkhdf", "history.csv", "summary.json", "splits.csv", "torque.png"]
    names += ["energy.png", "run.log", "used.toml", "checkpoint.h5"]
    for name in names:
        path = user.out / name
        expect(path.is_file() and path.stat().st_size > 0, f"{name} is missing or empty")
    snapshots = list(user.out.glob("snapshot_*.png"))
    expect(len(snapshots) >= 4, f"4 snapshots or more, got {len(snapshots)}")
    header = (user.out / "history.csv").read_text(encoding="utf-8").splitlines()[0].split(",")
    bare = [name for name in header if not re.fullmatch(r"\w+ \[[^\]]+\]", name)]
    expect(not bare, f"every column must name its unit, got {bare}")
    size = sum(path.stat().st_size for path in user.out.rglob("*") if path.is_file()) / 1e6
    return f"{len(names) + len(snapshots)} files, {size:.1f} MB"


@ROWS.add(
    "6",
    "what was run: used.toml with every default, its digest, the version",
    seconds=5,
    needs=("out",),
)
def provenance(user: User) -> str:
    first, rest = (user.out / "used.toml").read_text(encoding="utf-8").split("\n", 1)
    digest = hashlib.sha256(rest.encode()).hexdigest()
    expect(first.endswith(digest), "the digest in used.toml is not that of what follows")
    version = user.python("import shellcut; print(shellcut.__version__)").said.strip()
    expect(f"shellcut {version}" in rest, "used.toml must name the version")
    for name in ("strength", "teeth", "safety", "rows", "alpha"):
        expect(re.search(rf"^{name} = ", rest, re.M), f"used.toml must hold {name}")
    # The log tells the file as it lies there, so that sha256sum says the same.
    whole = hashlib.sha256((user.out / "used.toml").read_bytes()).hexdigest()
    log = (user.out / "run.log").read_text(encoding="utf-8")
    expect_words(log, f"shellcut {version}, used.toml with sha256 {whole}")
    versions = user.inside("provenance.py", str(user.out))
    wrong = {name: found for name, found in versions.items() if found != version}
    expect(not wrong, f"version {version} expected, got {wrong}")
    return f"digest in used.toml and run.log, version {version} also in {', '.join(versions)}"


@ROWS.add(
    "8-9",
    "Ctrl-C in a run, then shellcut resume",
    seconds=180,
    limit="exit code 130, says where it stopped; then the uninterrupted run's bits",
    needs=("out",),
)
def interrupt_and_resume(user: User) -> str:
    again = user.folder / "again"
    half = (user.out / "history.csv").stat().st_size / 2

    def halfway() -> bool:
        history = again / "history.csv"
        return history.exists() and history.stat().st_size > half

    stopped = user.interrupted("run", *QUICK, "-o", "again", when=halfway)
    expect(stopped.code == 130, f"exit code {stopped.code}:\n{stopped.said}")
    expect_words(stopped.said, "shellcut resume again")
    place = re.search(r"stopped at (.+?);", stopped.said)
    expect(place, f"where it stopped was not said:\n{stopped.said[-500:]}")
    resumed = user.shellcut("resume", "again")
    expect(resumed.code == 0, f"exit code {resumed.code}:\n{resumed.said}")
    _same_bits(user, user.out, again)
    return f"stopped at {place[1]}, resumed: history, frames, splits equal bit for bit"


@ROWS.add(
    "15",
    "fail on purpose: steps three times too long",
    seconds=60,
    limit="exit code 3, says where and what to do, last frame written, <= 100 steps late",
    needs=("out",),
)
def blow_up(user: User) -> str:
    safe = json.loads((user.out / "summary.json").read_text(encoding="utf-8"))["dt_s"]
    fixed = f"{3.0 * safe:.3e}"
    done = user.shellcut("run", *QUICK, "--set", f"fixed={fixed}", "-o", "blown")
    expect(done.code == 3, f"exit code {done.code}:\n{done.said}")
    told = re.search(
        r"blew up at step (\d+), t = (\S+) s, dt = (\S+) s: quad \d+ at \(.*\) mm .*"
        r"safe step was \S+ s\. .*lower Stepping.safety",
        done.said,
    )
    expect(told, f"place, steps and remedy expected:\n{done.said[-1000:]}")
    figures = user.inside("last_frame.py", str(user.folder / "blown"))
    step, time, dt = int(told[1]), float(told[2]), float(told[3])
    expect(
        abs(figures["time"] - time) < 1.5 * dt,
        f"last frame at {figures['time']:.6g} s, but it stopped at {time:.6g} s",
    )
    with (user.folder / "blown/history.csv").open(encoding="utf-8") as file:
        lines = list(csv.reader(file))
    column = lines[0].index("imbalance_rel [-]")
    # From the first row whose energies do not close, a row being every few steps.
    began = next((float(x[0]) for x in lines[1:] if not abs(float(x[column])) < 0.01), time)
    late = step - round(began / dt)
    expect(late <= 100, f"stopped {late} steps after the energies stopped closing")
    return f"dt {fixed} s: stopped at step {step}, {late} after the balance broke"


@ROWS.add(
    "extra",
    "one thread and two give the same bits",
    seconds=120,
    needs=("out",),
)
def threads(user: User) -> str:
    for n in ("1", "2"):
        done = user.shellcut("run", *SHORT, "--set", f"threads={n}", "-o", f"threads_{n}")
        expect(done.code == 0, f"exit code {done.code}:\n{done.said}")
    _same_bits(user, user.folder / "threads_1", user.folder / "threads_2")
    return "history, frames, splits equal bit for bit"


@ROWS.add(
    "extra",
    "the torque's sign and parts",
    seconds=10,
    limit="resists; contact + points + joints = teeth = torque within 1e-12 of the peak",
    needs=("out",),
)
def torque_sign(user: User) -> str:
    figures = user.inside("torque.py", str(user.out))
    expect(figures["least"] > 0.0, f"while cutting it falls to {figures['least']:.3g} N*mm")
    expect(figures["parts"] < 1e-12, f"its parts miss it by {figures['parts']:.1e} of the peak")
    # The trapezoidal rule over some 1900 rows of a sawtooth.
    expect(abs(figures["work"]) < 0.01, f"its work misses the tool's by {figures['work']:.2%}")
    return f"parts within {figures['parts']:.0e}, work within {figures['work']:.2%} of the tool's"


def _same_bits(user: User, one: Path, other: Path) -> None:
    for name in ("history.csv", "splits.csv"):
        expect((one / name).read_bytes() == (other / name).read_bytes(), f"{name} differs")
    differing = user.inside("same_bits.py", *(str(d / "opening.vtkhdf") for d in (one, other)))
    expect(not differing["differ"], f"frames differ in {differing['differ']}")
