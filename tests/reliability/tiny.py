"""Small models of every kind that the package has, and the commands that use them; seconds each.

The undisturbed result of each command is made once in a process.
"""

import atexit
import functools
import shutil
import tempfile
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path

from digest_cases import CASES, FILES
from same_run import assert_same_run
from tiny_study import SETTINGS, in_words

from .trial import command

RECORDS = {"threads": 1, "output.rows": 80, "output.frames": 4}
RECORDS |= {"output.snapshots": 0, "output.curves": False}
STRIP = {**SETTINGS, **RECORDS, "travel": 1.2}
SHORT = {
    "opening": {"motion.angle_deg": 4.0, "duration": "0.25 ms"},
    "guillotine": STRIP,
    "through quads": STRIP | {"fracture.path": "free"},
    "oscillating": {"travel": "1 mm"},
    "trouser": {"travel": "0.6 mm", "output.snapshots": 2, "output.curves": True},
    "disc": {"duration": "0.15 ms"},
}
"""What makes a case of the digests short; all models of the package are among them."""


def model(name):
    """Return the words of a model and its keys."""
    file, keys = CASES[name]
    if file.endswith(".toml"):
        file = str(FILES / file)
    own = {} if name in ("guillotine", "through quads") else keys
    return [file, *in_words(own | RECORDS | SHORT[name])]


@functools.cache
def folder():
    """Return a folder of this process for what is made once."""
    made = Path(tempfile.mkdtemp(prefix="shellcut-reliability-"))
    atexit.register(shutil.rmtree, made, ignore_errors=True)
    return made


def apart():
    """Let this process make all in a folder of its own, within that of its parent."""
    folder().chmod(0o755)  # some trials are those of another user
    tempfile.tempdir = str(folder())
    folder.cache_clear()


def measured():
    """Return a measured curve: that of the strip, a tenth higher."""
    path = folder() / "measured.csv"
    if not path.exists():
        from shellcut.results.history import read_history

        history, _ = read_history(whole("run", "guillotine") / "history.csv")
        rows = zip(history["path"][::3], history["force"][::3], strict=True)
        lines = [f"{x},{1.1 * force}" for x, force in rows]
        path.write_text("\n".join(["path [mm],force [N]", *lines]) + "\n")
    return path


STUDIES = {
    "sweep": "--set=wedge_half_angle_deg=10,14",
    "fit": "--set=strength=15:22 --max-runs=3",
    "optimise": "--set=wedge_half_angle_deg=10,14 --minimise=force_peak_N --confirm=none "
    "--allow-doubts",
    "converge": "",
}


def words(kind, name="guillotine"):
    """Return the words of a command without its folder."""
    if kind == "run":
        return ["run", *model(name)]
    curve = [str(measured())] if kind == "fit" else []
    strip = [*in_words(STRIP), "--jobs=1"]
    return [kind, "guillotine", *curve, *strip, *STUDIES[kind].split()]


def whole(kind, name="guillotine"):
    """Return the folder of an undisturbed command."""
    out = folder() / f"{kind} {name}"
    if not out.exists():
        command([*words(kind, name), "-o", str(out)], folder() / "log").expect(0)
    return out


OF_SEARCHES = ("table.csv", "fit.json", "optimum.json", "error_bars.json", "study.toml")


def assert_same(out, kind, name="guillotine"):
    """Fail unless a folder has what the undisturbed command gives."""
    reference = whole(kind, name)
    if kind == "run":
        assert_same_run(out, reference)
        return
    runs = {p.name for p in (reference / "runs").iterdir()}
    assert {p.name for p in (out / "runs").iterdir()} == runs
    for run in runs:
        assert_same_run(out / "runs" / run, reference / "runs" / run)
    for file in OF_SEARCHES:
        if (reference / file).exists():
            texts = [(of / file).read_text().replace(str(of), "OUT") for of in (out, reference)]
            assert texts[0] == texts[1], file


def warm(names=tuple(SHORT)):
    """Load the kernels of models here, so that forked processes have them: run each once."""
    from shellcut.command_line import main

    with open(folder() / "warm", "w") as log, redirect_stdout(log), redirect_stderr(log):
        for name in names:
            code = main(["run", *model(name), "-o", str(folder() / f"warm {name}")])
            assert code == 0, name
