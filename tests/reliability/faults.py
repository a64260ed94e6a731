"""What may go wrong around a command: disks, folders, rights, locks, clocks, environments, limits.

The faults are real where a process may make them; of locks and clocks the answers are replaced.
"""

import errno
import functools
import os
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from contextlib import suppress
from pathlib import Path

import pytest

import shellcut.recording.recorder
from shellcut.files import file_lock
from shellcut.files.folder_lock import LOCK
from shellcut.recording.recorder import Recorder
from small_disk import small_disk

from . import tiny
from .kills import continued
from .trial import Trial, at_each_write, begin, command, fresh, of_the_suite, often_saved

SHARE = 9
KEPT = "ends with its exit code and words, and continues to the undisturbed result"
REFUSED = "is refused in words; what is there stays as it is"
SAME = "gives the undisturbed result"
PROMISES = {
    "disk full": f"a command on a full disk {KEPT}",
    "folder or file lost": f"a run whose folder or file is lost {KEPT}, or {REFUSED}",
    "rights": f"a run that may not write {KEPT}",
    "two runs": f"a second run in a folder {REFUSED}; without locks a run warns",
    "clock": f"a run whose clock jumps {SAME}",
    "foreign checkpoint": f"a checkpoint or a table that is not of the run {REFUSED}",
    "environment": f"a run with another locale, home, time zone or streams {SAME}",
    "limits": f"a run that meets a limit of the system {KEPT}",
    "paths": f"a folder with an unusual name {SAME}",
    "lost process": f"a study whose process or Dask worker dies {SAME}",
}
ROWS = {row: (promise, "`faults.py`") for row, promise in PROMISES.items()}
FAULTS = []


def fault(row, what, *given, **named):
    """Add a function as a fault; what is given goes before the folder."""

    def add(do):
        FAULTS.append(Trial(row, what, functools.partial(do, *given, **named)))
        return do

    return add


def trials():
    return FAULTS


def strip(folder, *more, name="out"):
    """Return the words that run the strip into a folder."""
    return [*tiny.words("run"), *more, "-o", str(folder / name)]


def undisturbed(folder, before=None, **options):
    """Run the strip, and fail unless it is the undisturbed run."""
    command(strip(folder, **options), folder, before).expect(0)
    tiny.assert_same(folder / options.get("name", "out"), "run")


def goes_on(out, folder):
    """Continue the run of the strip, and compare."""
    continued(out, "run", "guillotine", folder)


def paused(folder, before=None):
    """Run the strip until amid its steps, where its process stops; return it."""

    def ready():
        often_saved()
        shellcut.recording.recorder._LOOK_EVERY = 0.0
        plain = Recorder.__call__

        def stopped(recorder, sim):
            plain(recorder, sim)
            if sim.state.step == 800:
                os.kill(os.getpid(), signal.SIGSTOP)

        Recorder.__call__ = stopped
        if before is not None:
            before()

    child = begin(strip(folder), folder, ready)
    child.paused()
    return child


def part(folder):
    """Leave a run that was killed amid its steps."""
    child = paused(folder)
    child.send(signal.SIGKILL)
    child.wait()
    return folder / "out"


def refuses(argv, folder, said):
    """Fail unless a command refuses what is in a folder and leaves it as it is."""

    def there():
        paths = (p for p in folder.rglob("*") if p.name != LOCK)  # of the killed run
        return {p: p.read_bytes() if p.is_file() else p.lstat().st_mode for p in paths}

    before = there()
    done = command(argv, tiny.folder() / "refused").expect(2)
    assert said in done.error, done.error
    after = there()
    changed = {p.name for p in after.keys() | before if after.get(p) != before.get(p)}
    assert not changed, f"changed: {changed}"


def fill(place):
    """Fill a disk up to the last byte."""
    file = os.open(place / "filler", os.O_WRONLY | os.O_CREAT | os.O_APPEND)
    for size in (1 << 16, 1):
        with suppress(OSError):
            while True:
                os.write(file, bytes(size))
    os.close(file)


def full_at(place, name, n):
    """Fill the disk at the n-th time that a file of a name is opened or written."""
    left = [n]

    def meets(path):
        if name in os.path.basename(str(path)) and left[0]:
            left[0] -= 1
            if not left[0]:
                fill(place)

    often_saved()
    at_each_write(lambda file, _: meets(file.name))
    sys.addaudithook(lambda event, given: meets(given[0]) if event == "open" else None)


@fault("disk full", "at the model", "run", "used", 1)
@fault("disk full", "at the log", "run", "run.log", 1)
@fault("disk full", "at the list of files", "run", ".files", 1)
@fault("disk full", "at a row", "run", "history", 40)
@fault("disk full", "at a frame", "run", "vtkhdf", 30)
@fault("disk full", "at a checkpoint", "run", "checkpoint", 4)
@fault("disk full", "at the splits", "run", "splits", 1)
@fault("disk full", "at the summary", "run", "summary", 1)
@fault("disk full", "at the table of a study", "sweep", "table", 1)
def full_disk(kind, name, n, folder):
    with small_disk(folder / "disk") as place:
        out = place / "out"
        argv = [*tiny.words(kind), "-o", str(out)]
        command(argv, folder, lambda: full_at(place, name, n)).expect(2, 4)
        (place / "filler").unlink()
        continued(out, kind, "guillotine", folder)


@fault("disk full", "at the report", "report", "report.html")
@fault("disk full", "at the page to turn", "view", "view.html")
def full_page(word, name, folder):
    with small_disk(folder / "disk") as place:
        out = shutil.copytree(tiny.whole("run"), place / "out")
        fill(place)
        command([word, str(out)], folder).expect(2, 4)
        assert not (out / name).exists()
        (place / "filler").unlink()
        command([word, str(out)], folder).expect(0)


@fault("disk full", "at the temporary folder of verify")
def full_verify(folder):
    argv = ["verify", str(tiny.whole("run"))]
    with small_disk(folder / "disk", 100) as place:
        command(argv, folder, lambda: setattr(tempfile, "tempdir", str(place))).expect(2, 4)


@fault("disk full", "at standard output")
def full_output(folder):
    with open("/dev/full", "w") as full:
        fresh(strip(folder), folder, stdout=full, stderr=full)
    tiny.assert_same(folder / "out", "run")


@fault("folder or file lost", "folder removed", shutil.rmtree)
@fault("folder or file lost", "folder moved", lambda out: out.rename(out.with_name("moved")))
@fault("folder or file lost", "folder emptied", lambda out: [p.unlink() for p in out.iterdir()])
def folder_lost(lose, folder):
    out, child = folder / "out", paused(folder)
    lose(out)
    time.sleep(0.05)  # a checkpoint is due when it goes on
    child.send(signal.SIGCONT)
    assert "removed, moved or emptied" in child.wait().expect(4).error
    if (folder / "moved").exists():
        (folder / "moved").rename(out)
    goes_on(out, folder)


def edited(path):
    path.write_text(path.read_text().replace("travel = 1.2", "travel = 1.3"))


def piped(path):
    path.unlink()
    os.mkfifo(path)


def a_row_changed(path):
    path.write_bytes(path.read_bytes().replace(b"\n0.0,", b"\n1.0,", 1))


@fault("folder or file lost", "history.csv", "history.csv", Path.unlink, "history.csv")
@fault("folder or file lost", "frames", "guillotine.vtkhdf", Path.unlink, "guillotine.vtkhdf")
@fault("folder or file lost", "checkpoint", "checkpoint.h5", Path.unlink, "from the beginning")
@fault("folder or file lost", "model", "used.toml", Path.unlink, "not a folder of shellcut run")
@fault("folder or file lost", "model edited", "used.toml", edited, "has been changed since")
@fault("folder or file lost", "a pipe as history.csv", "history.csv", piped, "history.csv")
@fault(
    "foreign checkpoint", "another history.csv", "history.csv", a_row_changed, "must be as it was"
)
def file_lost(name, lose, said, folder):
    out = part(folder)
    content = (out / name).read_bytes()
    lose(out / name)
    refuses(["resume", str(out)], out, said)
    (out / name).unlink(missing_ok=True)
    (out / name).write_bytes(content)
    goes_on(out, folder)


def as_nobody():
    """Give up the rights of root, which may write everywhere."""
    if os.getuid() == 0:
        os.setgid(65534)
        os.setuid(65534)


@fault("rights", "lost amid the run")
def right_lost(folder):
    folder.chmod(0o777)
    out, child = folder / "out", paused(folder, as_nobody)
    out.chmod(0o555)
    child.send(signal.SIGCONT)
    child.wait().expect(4)
    out.chmod(0o755)
    goes_on(out, folder)


@fault("rights", "folder of somebody else")
def of_another(folder):
    folder.chmod(0o755)
    out = shutil.copytree(tiny.whole("run"), folder / "out")
    done = command(strip(folder, "--overwrite"), folder, as_nobody).expect(2)
    assert "Permission denied" in done.error
    tiny.assert_same(out, "run")


@fault("rights", "read-only disk")
def read_only_disk(folder):
    with small_disk(folder / "disk") as place:
        out = part(place)
        subprocess.run(["mount", "-o", "remount,ro", str(place)], check=True)
        refuses(["resume", str(out)], out, "Read-only file system")
        subprocess.run(["mount", "-o", "remount,rw", str(place)], check=True)
        goes_on(out, folder)


@fault("rights", "read-only kernels, home and folder of Matplotlib")
def read_only_home(folder):
    if (kernels := os.environ.get("NUMBA_CACHE_DIR")) is None:
        pytest.skip("needs NUMBA_CACHE_DIR, a folder of kernels to copy")
    with small_disk(folder / "disk", 1_000_000) as place:
        shutil.copytree(kernels, place / "kernels")
        subprocess.run(["mount", "-o", "remount,ro", str(place)], check=True)
        words = dict.fromkeys(("HOME", "MPLCONFIGDIR", "XDG_CACHE_HOME"), str(place))
        environment(folder, **words, NUMBA_CACHE_DIR=str(place / "kernels"))


@fault("two runs", "run", "run")
@fault("two runs", "run --overwrite", "overwrite")
@fault("two runs", "resume", "resume")
@fault("two runs", "verify", "verify")
def two_runs(second, folder):
    out, child = folder / "out", paused(folder)
    argv = {"run": strip(folder), "overwrite": strip(folder, "--overwrite")}
    refuses(argv.get(second, [second, str(out)]), out, "out")
    child.send(signal.SIGCONT)
    child.wait().expect(0)
    tiny.assert_same(out, "run")


@fault("two runs", "a file system without locks")
def without_locks(folder):
    def take(*_, **__):
        raise OSError(errno.ENOLCK, os.strerror(errno.ENOLCK))

    done = command(strip(folder), folder, lambda: setattr(file_lock, "take", take)).expect(0)
    assert "without locks" in done.error
    tiny.assert_same(folder / "out", "run")


@fault("clock", "a day on", 86400.0)
@fault("clock", "back to 1970", -1.7e9)
def clock(jump, folder):
    def before():
        now, began = time.time, time.time()
        time.time = lambda: now() + (jump if now() > began + 0.2 else 0.0)

    undisturbed(folder, before)


@fault("clock", "files of the year 2100")
def files_of_the_future(folder):
    out = part(folder)
    for path in out.iterdir():
        os.utime(path, (4.1e9, 4.1e9))
    goes_on(out, folder)


def of_another_model(_):
    return (tiny.whole("run", "disc") / "checkpoint.h5").read_bytes()


FOREIGN = "foreign checkpoint"


@fault(FOREIGN, "of another format", lambda content: content.replace(b"format ", b"format 9", 1))
@fault(FOREIGN, "of half its length", lambda content: content[: len(content) // 2])
@fault(FOREIGN, "empty", lambda _: b"")
@fault(FOREIGN, "of another model", of_another_model)
def foreign_checkpoint(change, folder):
    out = part(folder)
    checkpoint = out / "checkpoint.h5"
    good = checkpoint.read_bytes()
    checkpoint.write_bytes(change(good))
    refuses(["resume", str(out)], out, "checkpoint")
    checkpoint.write_bytes(good)
    goes_on(out, folder)


@fault("environment", "locale C", LC_ALL="C", PYTHONUTF8="0", PYTHONCOERCECLOCALE="0")
@fault("environment", "no HOME", HOME=None, MPLCONFIGDIR=None, XDG_CACHE_HOME=None)
@fault("environment", "no TZ", TZ=None)
@fault("environment", "a TZ that is none", TZ="Nowhere/Land")
@fault("environment", "warnings are errors", PYTHONWARNINGS="error")
@fault("environment", "no such backend of Matplotlib", MPLBACKEND="nonsense")
@fault("environment", "no such folder for temporary files", TMPDIR="/nowhere")
@fault("environment", "four threads of libraries", OMP_NUM_THREADS="4", OPENBLAS_NUM_THREADS="4")
def environment(folder, **variables):
    """Run the strip in a process that begins anew."""
    another_process(folder, environment=variables)


@fault("environment", "no docstrings (-OO)", options=["-OO"])
@fault("environment", "umask 077", umask=0o077)
@fault("environment", "closed standard input", preexec_fn=functools.partial(os.close, 0))
@fault("environment", "closed standard output", preexec_fn=functools.partial(os.close, 1))
@fault("environment", "closed standard error", preexec_fn=functools.partial(os.close, 2))
def another_process(folder, **options):
    done = fresh(strip(folder), folder, **options)
    assert done.code == 0, done
    tiny.assert_same(folder / "out", "run")


@fault("environment", "decimal comma")
def decimal_comma(folder):
    import locale

    made = ["localedef", "-i", "de_DE", "-f", "UTF-8", str(folder / "de_DE.UTF-8")]
    if not shutil.which("localedef") or subprocess.run(made, capture_output=True).returncode:
        pytest.skip("localedef cannot make de_DE here")

    def before():
        os.environ["LOCPATH"] = str(folder)
        locale.setlocale(locale.LC_ALL, "de_DE.UTF-8")
        assert locale.localeconv()["decimal_point"] == ","

    undisturbed(folder, before)


@fault("limits", "size of files")
def file_size(folder):
    largest = (tiny.whole("run") / "guillotine.vtkhdf").stat().st_size

    def before():
        often_saved()
        limited(resource.RLIMIT_FSIZE, int(0.6 * largest))

    command(strip(folder), folder, before).expect(4)
    goes_on(folder / "out", folder)


def limited(kind, amount):
    resource.setrlimit(kind, (amount, amount))


@fault("limits", "memory")
def memory(folder):
    def before():
        used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        limited(resource.RLIMIT_AS, used + (40 << 20))

    argv = strip(folder, "--set=membrane.size=0.008")
    assert "memory" in command(argv, folder, before).expect(2).error
    undisturbed(folder)


@fault("limits", "open files")
def open_files(folder):
    done = command(strip(folder), folder, lambda: limited(resource.RLIMIT_NOFILE, 6))
    assert "Too many open files" in done.expect(2, 4).error, done.error
    goes_on(folder / "out", folder)


@fault("limits", "time of the processor")
def processor_time(folder):
    def before():
        often_saved()
        used = resource.getrusage(resource.RUSAGE_SELF)
        limited(resource.RLIMIT_CPU, int(used.ru_utime + used.ru_stime) + 1)

    argv = strip(folder, "--set=travel=4", "--set=membrane.length=12")
    assert command(argv, folder, before).code in (-signal.SIGXCPU, -signal.SIGKILL)
    for word in ("resume", "verify"):
        command([word, str(folder / "out")], folder).expect(0)


@fault("paths", "spaces", "my film, the 2nd try")
@fault("paths", "umlauts", "Öffnungsversuch für Käse/日本")
@fault("paths", "200 characters", "x" * 200)
@fault("paths", "patterns", "[a]*?{b}%s$HOME")
@fault("paths", "a line break", "two\nlines")
@fault("paths", "a leading dash", "-film")
@fault("paths", "bytes that are no text", os.fsdecode(b"film\xff\xfe"))
def path(name, folder):
    (folder / name).parent.mkdir(exist_ok=True)
    out = part(folder).rename(folder / name)
    goes_on(out, folder)
    for word in ("report", "verify"):
        command([word, str(out)], folder).expect(0)
    undisturbed(folder, name=f"{name} again")


@fault("paths", "a link to a folder")
def link(folder):
    (folder / "real").mkdir()
    (folder / "out").symlink_to(folder / "real")
    undisturbed(folder)


KILLED = "test_study.py::test_processes_give_the_same_table_though_one_is_killed"
fault("lost process", "a process of a study", f"regression/{KILLED}")(of_the_suite)
DASK = "a Dask worker, and then the scheduler"
fault("lost process", DASK, "regression/test_study_on_dask.py")(of_the_suite)
