"""What may go wrong around a command: disks, folders, rights, locks, clocks, environments, limits.

The faults are real where a process may make them; of locks and clocks the answers are replaced.
"""

import errno
import locale
import os
import resource
import shutil
import signal
import subprocess
import sys
import time
from contextlib import contextmanager, suppress
from pathlib import Path

import pytest

import shellcut
import shellcut.recording.recorder
from damaged.mutations import mutated
from shellcut.files import file_lock, whole_file
from shellcut.files.folder_lock import LOCK
from shellcut.recording.recorder import Recorder
from small_disk import files_of_at_most, small_disk

from . import tiny
from .kills import continued, often_saved
from .trial import Child, Impossible, Trial, begin, command, fresh

SHARE = 4
KEPT = "ends with its exit code and words, and continues to the undisturbed result"
REFUSED = "is refused in words; what is there stays as it is"
SAME = "gives the undisturbed result"
TEST = "`faults.py`"
ROWS = {
    "disk full": (f"a command on a full disk {KEPT}", f"{TEST}; `tests/small_disk.py`"),
    "folder or file lost": (f"a run whose folder or file is lost {KEPT}, or {REFUSED}", TEST),
    "rights": (f"a run that may not write {KEPT}", TEST),
    "two runs": (f"a second run in a folder {REFUSED}", TEST),
    "clock": (f"a run whose clock jumps {SAME}", TEST),
    "foreign checkpoint": (f"a checkpoint or a table that is not of the run {REFUSED}", TEST),
    "environment": (f"a run with another locale, home, time zone or streams {SAME}", TEST),
    "limits": (f"a run that meets a limit of the system {KEPT}", TEST),
    "paths": (f"a folder with an unusual name {SAME}", TEST),
    "lost process": (f"a study whose process or Dask worker dies {SAME}", TEST),
}
FAULTS = []  # (row, what, do)
STRIP = ("run", "guillotine")


def fault(row, what, *given):
    """Add a function as a fault; what is given goes before the folder."""

    def add(do):
        FAULTS.append((row, what, lambda folder: do(*given, folder)))
        return do

    return add


def trial(number):
    """Return one of the faults."""
    return Trial(*FAULTS[number])


def run_to(out, folder, before=None, **options):
    """Run the strip into a folder."""
    return command([*tiny.words(*STRIP), "-o", str(out)], folder, before, **options)


def run_paused(out, folder, before=None):
    """Run the strip until amid its steps, where the process pauses; return it."""

    def ready():
        often_saved()
        shellcut.recording.recorder._LOOK_EVERY = 0.0
        plain = Recorder.__call__

        def paused(recorder, sim):
            plain(recorder, sim)
            if sim.state.step == 800:
                os.kill(os.getpid(), signal.SIGSTOP)

        Recorder.__call__ = paused
        if before is not None:
            before()

    child = begin([*tiny.words(*STRIP), "-o", str(out)], folder, ready)
    child.paused()
    return child


def part(folder):
    """Leave a run that was killed amid its steps."""
    child = run_paused(folder / "out", folder)
    child.send(signal.SIGKILL)
    child.wait()
    return folder / "out"


def refuses(argv, folder, said):
    """Fail unless a command refuses what is in a folder and leaves it as it is."""

    def there():
        paths = (p for p in folder.rglob("*") if p.name != LOCK)  # of the killed run
        return {p: (p.lstat().st_mtime_ns, p.lstat().st_size) for p in paths}

    log, before = tiny.folder() / "refused", there()
    done = command(argv, log).expect(2)
    assert said in done.error, done.error
    assert there() == before


def goes_on(out, folder):
    """Continue the run of the strip, and compare."""
    tiny.whole(*STRIP)
    continued(out, *STRIP, folder)


# ---------------------------------------------------------------- disks


@contextmanager
def disk(folder, kilobytes=6000):
    """Give a small disk of its own."""
    try:
        with small_disk(folder / "disk", kilobytes):
            yield folder / "disk"
    except pytest.skip.Exception as reason:
        raise Impossible(str(reason)) from None


def fill(place):
    """Fill a disk up to the last byte."""
    file = os.open(place / "filler", os.O_WRONLY | os.O_CREAT | os.O_APPEND)
    for size in (1 << 16, 1):
        with suppress(OSError):
            while True:
                os.write(file, bytes(size))
    os.close(file)


def full_at(place, name, n=1):
    """Fill the disk at the n-th time that a file of a name is opened or written, and for good."""
    left, plain = [n], whole_file.write_all

    def meets(path):
        if name in os.path.basename(str(path)) and left[0]:
            left[0] -= 1
            if not left[0]:
                fill(place)

    def write_all(file, data):
        meets(file.name)
        plain(file, data)

    for module in [m for key, m in sys.modules.items() if key.startswith("shellcut.")]:
        if getattr(module, "write_all", None) is plain:
            module.write_all = write_all
    sys.addaudithook(lambda event, given: meets(given[0]) if event == "open" else None)


for _name, _n in (("used", 1), ("run.log", 1), ("run.files", 1), ("history", 40)):
    FAULTS.append(("disk full", f"{_name}, time {_n}", lambda f, a=_name, n=_n: full_run(a, n, f)))
for _name, _n in (("vtkhdf", 30), ("checkpoint", 4), ("splits", 1), ("summary", 1)):
    FAULTS.append(("disk full", f"{_name}, time {_n}", lambda f, a=_name, n=_n: full_run(a, n, f)))


def full_run(name, n, folder):
    """A run whose disk is full at a write of a file, and has space again later."""
    with disk(folder) as place:
        out = place / "out"

        def before():
            often_saved()
            full_at(place, name, n)

        run_to(out, folder, before).expect(2, 4)
        (place / "filler").unlink()
        goes_on(out, folder)


@fault("disk full", "table of a study")
def full_study(folder):
    with disk(folder) as place:
        argv = [*tiny.words("sweep"), "-o", str(place / "out")]
        command(argv, folder, lambda: full_at(place, "table")).expect(2, 4)
        (place / "filler").unlink()
        tiny.whole("sweep")
        continued(place / "out", "sweep", "guillotine", folder)


@fault("disk full", "report")
def full_report(folder):
    with disk(folder) as place:
        out = shutil.copytree(tiny.whole(*STRIP), place / "out")
        fill(place)
        command(["report", str(out)], folder).expect(2, 4)
        assert not (out / "report.html").exists()
        (place / "filler").unlink()
        command(["report", str(out)], folder).expect(0)


@fault("disk full", "temporary folder of verify")
def full_verify(folder):
    import tempfile

    out = shutil.copytree(tiny.whole(*STRIP), folder / "out")
    with disk(folder, 100) as place:
        command(
            ["verify", str(out)], folder, lambda: setattr(tempfile, "tempdir", str(place))
        ).expect(2, 4)
    command(["verify", str(out)], folder).expect(0)


@fault("disk full", "standard output")
def full_output(folder):
    with open("/dev/full", "w") as full:
        fresh([*tiny.words(*STRIP), "-o", "out"], folder, stdout=full, stderr=full)
    tiny.assert_same(folder / "out", *STRIP)


# ---------------------------------------------------------------- folders and files


@fault("folder or file lost", "folder removed", shutil.rmtree)
@fault("folder or file lost", "folder moved", lambda out: out.rename(out.with_name("moved")))
@fault("folder or file lost", "folder emptied", lambda out: [p.unlink() for p in out.iterdir()])
def folder_lost(lose, folder):
    out = folder / "out"
    child = run_paused(out, folder)
    lose(out)
    child.send(signal.SIGCONT)
    assert "removed, moved or emptied" in child.wait().expect(4).error
    if (folder / "moved").exists():
        out = (folder / "moved").rename(out)
    elif out.exists():
        shutil.rmtree(out)
    goes_on(out, folder)


@fault("folder or file lost", "history.csv", "history.csv", "history.csv")
@fault("folder or file lost", "frames", "guillotine.vtkhdf", "guillotine.vtkhdf")
@fault("folder or file lost", "checkpoint", "checkpoint.h5", "run it from the beginning")
@fault("folder or file lost", "model", "used.toml", "it is not a folder of shellcut run")
def file_lost(name, said, folder):
    out = part(folder)
    (out / name).rename(folder / name)
    refuses(["resume", str(out)], out, said)
    (folder / name).rename(out / name)
    goes_on(out, folder)


@fault("folder or file lost", "file of the film")
def film_lost(folder):
    from damaged.samples import FILMS

    film = folder / "film.inp"
    film.write_bytes(FILMS["Abaqus"][1]())
    keys = [f"membrane.file={film}", "membrane.unit=mm", "membrane.clamp=rim", "duration=1e-4"]
    keys += ["tool.edge_angle_deg=90", "tool.length=8", "tool.shift=[-5.1,0,0]", "speed=6000"]
    keys += ["motion.direction=[1,0,0]", "threads=1", "output.snapshots=0"]
    argv = ["run", "free", *[f"--set={key}" for key in keys], "-o", str(folder / "out")]
    command(argv, folder).expect(0)
    (folder / "out/summary.json").unlink()
    film.write_bytes(FILMS["Abaqus"][1]() + b"\n")
    for word in ("resume", "verify"):
        refuses([word, str(folder / "out")], folder / "out", "is gone or has been changed")


@fault("folder or file lost", "a pipe in the place of history.csv")
def pipe(folder):
    out = part(folder)
    (out / "history.csv").unlink()
    os.mkfifo(out / "history.csv")
    refuses(["resume", str(out)], out, "history.csv")


# ---------------------------------------------------------------- rights


def as_nobody():
    """Give up the rights of root, which may write everywhere."""
    if os.getuid() == 0:
        os.setgid(65534)
        os.setuid(65534)


@fault("rights", "lost amid the run")
def right_lost(folder):
    os.chmod(folder, 0o777)
    out = folder / "out"
    child = run_paused(out, folder, as_nobody)
    os.chmod(out, 0o555)
    child.send(signal.SIGCONT)
    child.wait().expect(4)
    os.chmod(out, 0o755)
    goes_on(out, folder)


@fault("rights", "folder of somebody else")
def of_another(folder):
    folder.chmod(0o755)
    out = shutil.copytree(tiny.whole(*STRIP), folder / "out")
    child = command([*tiny.words(*STRIP), "-o", str(out), "--overwrite"], folder, as_nobody)
    assert "Permission denied" in child.expect(2).error
    tiny.assert_same(out, *STRIP)


@fault("rights", "read-only disk")
def read_only_disk(folder):
    with disk(folder) as place:
        out = place / "out"
        child = run_paused(out, folder)
        child.send(signal.SIGKILL)
        child.wait()
        subprocess.run(["mount", "-o", "remount,ro", str(place)], check=True)
        refuses(["resume", str(out)], out, "Read-only file system")
        subprocess.run(["mount", "-o", "remount,rw", str(place)], check=True)
        goes_on(out, folder)


@fault("rights", "read-only kernels, home and Matplotlib's folder")
def read_only_home(folder):
    kernels = os.environ.get("NUMBA_CACHE_DIR")
    if kernels is None:
        raise Impossible("needs NUMBA_CACHE_DIR, a folder of kernels to copy")
    with disk(folder, 1_000_000) as place:
        shutil.copytree(kernels, place / "kernels")
        subprocess.run(["mount", "-o", "remount,ro", str(place)], check=True)
        words = dict.fromkeys(("HOME", "MPLCONFIGDIR", "XDG_CACHE_HOME"), str(place))
        words["NUMBA_CACHE_DIR"] = str(place / "kernels")
        fresh([*tiny.words(*STRIP), "-o", "out"], folder, words).expect(0)
    tiny.assert_same(folder / "out", *STRIP)


# ---------------------------------------------------------------- two runs, locks, clocks


@fault("two runs", "run", "run")
@fault("two runs", "run --overwrite", "overwrite")
@fault("two runs", "resume", "resume")
@fault("two runs", "verify", "verify")
def two_runs(second, folder):
    out = folder / "out"
    child = run_paused(out, folder)
    argv = {
        "run": [*tiny.words(*STRIP), "-o", str(out)],
        "overwrite": [*tiny.words(*STRIP), "-o", str(out), "--overwrite"],
    }.get(second, [second, str(out)])
    refuses(argv, out, "is being written" if second != "run" else "out")
    child.send(signal.SIGCONT)
    child.wait().expect(0)
    tiny.assert_same(out, *STRIP)


@fault("two runs", "a file system without locks")
def without_locks(folder):
    def before():
        def take(*_, **__):
            raise OSError(errno.ENOLCK, os.strerror(errno.ENOLCK))

        file_lock.take = take

    done = run_to(folder / "out", folder, before).expect(0)
    assert "without locks" in done.error
    tiny.assert_same(folder / "out", *STRIP)


@fault("clock", "a day on", 86400.0)
@fault("clock", "back to 1970", -1.7e9)
def clock(jump, folder):
    def before():
        now, began = time.time, time.time()
        time.time = lambda: now() + (jump if now() > began + 0.2 else 0.0)

    run_to(folder / "out", folder, before).expect(0)
    tiny.assert_same(folder / "out", *STRIP)


@fault("clock", "files of the year 2100")
def files_of_the_future(folder):
    out = part(folder)
    for path in out.iterdir():
        os.utime(path, (4.1e9, 4.1e9))
    goes_on(out, folder)


# ---------------------------------------------------------------- checkpoints of elsewhere


def of_another_format(content):
    return content.replace(b"format ", b"format 9", 1)


def half(content):
    return content[: len(content) // 2]


def a_byte_changed(content):
    import numpy as np

    return mutated(np.random.default_rng(1), content, text=False)[0]


@fault("foreign checkpoint", "of another format", of_another_format)
@fault("foreign checkpoint", "of half its length", half)
@fault("foreign checkpoint", "damaged", a_byte_changed)
@fault("foreign checkpoint", "empty", lambda content: b"")
@fault("foreign checkpoint", "of another model", None)
def foreign_checkpoint(change, folder):
    out = part(folder)
    checkpoint = out / "checkpoint.h5"
    good = checkpoint.read_bytes()
    other = tiny.whole("run", "through quads") / "checkpoint.h5"
    checkpoint.write_bytes(change(good) if change else other.read_bytes())
    refuses(["resume", str(out)], out, "checkpoint")
    checkpoint.write_bytes(good)
    goes_on(out, folder)


@fault("foreign checkpoint", "another history.csv")
def other_history(folder):
    out = part(folder)
    rows = (out / "history.csv").read_bytes().split(b"\n")
    rows[3] = b"1" + rows[3]
    (out / "history.csv").write_bytes(b"\n".join(rows))
    refuses(["resume", str(out)], out, "must be as it was at the checkpoint")


# ---------------------------------------------------------------- environments

ENVIRONMENTS = {
    "locale C, ASCII": {"LC_ALL": "C", "LANG": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"},
    "no HOME": {"HOME": None, "MPLCONFIGDIR": None, "XDG_CACHE_HOME": None},
    "no TZ": {"TZ": None},
    "a TZ that is none": {"TZ": "Nowhere/Land"},
    "another order of sets": {"PYTHONHASHSEED": "12345"},
    "warnings are errors": {"PYTHONWARNINGS": "error"},
    "no such backend of Matplotlib": {"MPLBACKEND": "nonsense"},
    "no such folder for temporary files": {"TMPDIR": "/nowhere"},
    "four threads of every library": {"OMP_NUM_THREADS": "4", "OPENBLAS_NUM_THREADS": "4"},
}


def environment(words, folder, **more):
    fresh([*tiny.words(*STRIP), "-o", "out"], folder, words, **more).expect(0)
    tiny.assert_same(folder / "out", *STRIP)


for _what, _words in ENVIRONMENTS.items():
    FAULTS.append(("environment", _what, lambda folder, words=_words: environment(words, folder)))
FAULTS.append(("environment", "no docstrings (-OO)", lambda f: environment({}, f, options=["-OO"])))
FAULTS.append(("environment", "umask 077", lambda f: environment({}, f, umask=0o077)))


@fault("environment", "decimal comma")
def decimal_comma(folder):
    made = ["localedef", "-i", "de_DE", "-f", "UTF-8", str(folder / "de_DE.UTF-8")]
    if not shutil.which("localedef") or subprocess.run(made, capture_output=True).returncode:
        raise Impossible("localedef cannot make de_DE here")

    def before():
        os.environ["LOCPATH"] = str(folder)
        locale.setlocale(locale.LC_ALL, "de_DE.UTF-8")
        assert locale.localeconv()["decimal_point"] == ","

    run_to(folder / "out", folder, before).expect(0)
    tiny.assert_same(folder / "out", *STRIP)


@fault("environment", "closed standard streams", (0, 1, 2))
@fault("environment", "closed standard output", (1,))
@fault("environment", "closed standard error", (2,))
def closed(numbers, folder):
    done = fresh(
        [*tiny.words(*STRIP), "-o", "out"],
        folder,
        preexec_fn=lambda: [os.close(number) for number in numbers],
    )
    assert done.code == 0, done
    tiny.assert_same(folder / "out", *STRIP)


# ---------------------------------------------------------------- limits


@fault("limits", "size of files")
def file_size(folder):
    largest = max(p.stat().st_size for p in tiny.whole(*STRIP).glob("*.vtkhdf"))

    def do():
        from shellcut.command_line import main

        often_saved()
        with files_of_at_most(int(0.6 * largest)):
            return main([*tiny.words(*STRIP), "-o", str(folder / "out")])

    Child(do, folder).wait().expect(4)
    goes_on(folder / "out", folder)


def limited(kind, amount):
    return lambda: resource.setrlimit(kind, (amount, amount))


@fault("limits", "memory")
def memory(folder):
    def before():
        used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        limited(resource.RLIMIT_AS, used + (40 << 20))()

    argv = [*tiny.words(*STRIP), "--set=membrane.size=0.008", "-o", str(folder / "out")]
    assert "memory" in command(argv, folder, before).expect(2).error
    run_to(folder / "out", folder).expect(0)
    tiny.assert_same(folder / "out", *STRIP)


@fault("limits", "open files")
def open_files(folder):
    done = run_to(folder / "out", folder, limited(resource.RLIMIT_NOFILE, 6)).expect(0, 2, 4)
    assert done.code == 0 or "Too many open files" in done.error, done.error
    goes_on(folder / "out", folder)


@fault("limits", "time of the processor")
def processor_time(folder):
    def before():
        often_saved()
        used = resource.getrusage(resource.RUSAGE_SELF)
        limited(resource.RLIMIT_CPU, int(used.ru_utime + used.ru_stime) + 1)()

    argv = [*tiny.words(*STRIP), "--set=travel=4", "--set=membrane.length=12"]
    argv += ["-o", str(folder / "out")]
    assert command(argv, folder, before).code in (-signal.SIGXCPU, -signal.SIGKILL)
    command(["resume", str(folder / "out")], folder).expect(0)
    command(["verify", str(folder / "out")], folder).expect(0)


# ---------------------------------------------------------------- paths

PATHS = {
    "spaces": "my film, the 2nd try",
    "umlauts": "Öffnungsversuch für Käse/日本",
    "200 characters": "x" * 200,
    "patterns": "[a]*?{b}%s$HOME",
    "a line break": "two\nlines",
    "a leading dash": "-film",
    "bytes that are no text": os.fsdecode(b"film\xff\xfe"),
}


def path(name, folder):
    out = folder / name
    child = begin([*tiny.words(*STRIP), "-o", str(out)], folder, often_saved)
    time.sleep(0.3)
    child.send(signal.SIGKILL)
    child.wait()
    goes_on(out, folder)
    command(["report", str(out)], folder).expect(0)
    command(["verify", str(out)], folder).expect(0)


for _what, _name in PATHS.items():
    FAULTS.append(("paths", _what, lambda folder, name=_name: path(name, folder)))


@fault("paths", "a link to a folder")
def link(folder):
    (folder / "real").mkdir()
    (folder / "out").symlink_to(folder / "real")
    run_to(folder / "out", folder).expect(0)
    tiny.assert_same(folder / "real", *STRIP)


# ---------------------------------------------------------------- processes of a study


@fault("lost process", "a process of a study")
def study_process(folder):
    argv = [word.replace("--jobs=1", "--jobs=2") for word in tiny.words("sweep")]
    child = begin([*argv, "-o", str(folder / "out")], folder)
    end, killed = time.monotonic() + 60, 0
    while not killed and time.monotonic() < end:
        if any((folder / "out").rglob("history.csv")):
            for file in Path(f"/proc/{child.pid}/task").glob("*/children"):
                for one in file.read_text().split():
                    os.kill(int(one), signal.SIGKILL)
                    killed += 1
        time.sleep(0.01)
    child.wait().expect(0)
    assert killed
    tiny.assert_same(folder / "out", "sweep")


@fault("lost process", "a Dask worker, and then the scheduler")
def dask_worker(folder):
    try:
        import distributed  # noqa: F401
    except ImportError as missing:
        raise Impossible(str(missing)) from None
    from test_study_on_dask import (
        test_a_study_outlives_a_worker_and_goes_on_after_its_scheduler as outlives,
    )

    Child(lambda: outlives(folder), folder / "said").wait(240).expect(0)


COUNT = len(FAULTS)
