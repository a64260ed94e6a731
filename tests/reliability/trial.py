"""A trial of a promise, and the process of its own in which it is made."""

import os
import select
import signal
import subprocess
import sys
import time
import traceback
import warnings
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import pytest

TESTS = Path(__file__).parents[1]
TRACEBACK = "Traceback (most recent call last)"


@dataclass(frozen=True)
class Trial:
    """What is tried, so that its number alone gives it again."""

    row: str
    """Of the table."""
    what: str
    """In words, for a report of its failure."""
    do: Callable[[Path], None]
    """Makes it in an empty folder. An exception is a failure; where it cannot be made, it skips."""


@dataclass
class Done:
    """How a process has ended."""

    code: int
    """Exit code; minus the number of a signal that ended it."""
    out: str
    error: str

    def expect(self, *codes):
        """Fail unless it ended with one of these codes, and without a traceback."""
        said = f"exit code {self.code}, {self.out[-300:]}{self.error[-900:]}"
        assert self.code in codes, said
        assert TRACEBACK not in self.error, said
        return self


class Child:
    """A process forked from this one, which has the package imported and its kernels loaded.

    It does what is given, with its output in files; what is returned is its exit code.
    """

    def __init__(self, do, folder):
        folder.mkdir(parents=True, exist_ok=True)
        self._files = [folder / f"{name}-{time.monotonic_ns()}" for name in ("out", "error")]
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of threads, none of which is in the kernels
            self.pid = os.fork()
        if self.pid == 0:
            self._be(do)

    def _be(self, do):
        code = 1
        try:
            for number, file in enumerate(self._files, start=1):
                os.dup2(os.open(file, os.O_WRONLY | os.O_CREAT), number)
            sys.stdout, sys.stderr = (os.fdopen(n, "w", encoding="utf-8") for n in (1, 2))
            signal.signal(signal.SIGINT, signal.default_int_handler)
            signal.signal(signal.SIGTERM, signal.SIG_DFL)
            sys.argv = ["shellcut"]
            code = do() or 0
        except SystemExit as left:
            code = left.code if isinstance(left.code, int) else 2
        except BaseException:
            traceback.print_exc()
        finally:
            for stream in (sys.stdout, sys.stderr):
                with suppress(OSError, ValueError):
                    stream.flush()
            os._exit(code)

    def send(self, number):
        """Send a signal; none is sent to a process that has ended."""
        os.kill(self.pid, number)

    def paused(self):
        """Wait until it has stopped itself."""
        _, status = os.waitpid(self.pid, os.WUNTRACED)
        assert os.WIFSTOPPED(status), "it has ended before it was paused"

    def wait(self, seconds=120.0):
        """Wait for its end; a child that needs longer is ended, which is a failure."""
        pidfd = os.pidfd_open(self.pid)
        ended, _, _ = select.select([pidfd], [], [], seconds)
        os.close(pidfd)
        if not ended:
            self.send(signal.SIGKILL)
        _, status = os.waitpid(self.pid, 0)
        if not ended:
            raise TimeoutError(f"no end within {seconds:.0f} s")
        texts = [f.read_text(errors="replace") if f.exists() else "" for f in self._files]
        return Done(os.waitstatus_to_exitcode(status), *texts)


def fresh(argv, folder, environment=(), options=(), **streams):
    """Do a command in a process that begins anew, with another environment."""
    own = {**os.environ, **dict(environment)}
    words = [sys.executable, *options, "-m", "shellcut", *argv]
    streams = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **streams}
    environment = {name: value for name, value in own.items() if value is not None}
    done = subprocess.run(words, cwd=folder, env=environment, timeout=300, **streams)
    texts = [(text or b"").decode(errors="replace") for text in (done.stdout, done.stderr)]
    return Done(done.returncode, *texts)


def of_the_suite(test, folder):
    """Let pytest carry out a test of the suite."""
    words = ["-m", "pytest", "-rs", "-n0", "-m", "slow or not slow", f"--basetemp={folder / 'of'}"]
    asked = [sys.executable, *words, str(TESTS / test)]
    done = subprocess.run(asked, cwd=TESTS.parent, capture_output=True, text=True, check=False)
    if " passed" not in done.stdout and " skipped" in done.stdout:
        pytest.skip(done.stdout[-300:])
    assert done.returncode == 0, done.stdout[-1500:]


def command(argv, folder, before=None):
    """Do a command in a child, and wait for it; ``before`` changes the process first."""
    return begin(argv, folder, before).wait()


def begin(argv, folder, before=None):
    """Begin a command in a child."""
    from shellcut.command_line import main

    def do():
        if before is not None:
            before()
        return main(argv)

    return Child(do, folder / "said")


def at_each_write(meets):
    """Call ``meets(file, data)`` in this process before each write of a file that grows."""
    from shellcut.files import whole_file

    plain = whole_file.write_all

    def write_all(file, data):
        meets(file, data)
        plain(file, data)

    for module in [m for name, m in sys.modules.items() if name.startswith("shellcut.")]:
        if getattr(module, "write_all", None) is plain:
            module.write_all = write_all


def often_saved():
    """Let the runs of this process save a checkpoint many times a second."""
    from shellcut.models.case import Case

    made = Case.recorder
    often = {"checkpoint_every": 0.02}
    Case.recorder = lambda case, folder, **options: made(case, folder, **{**options, **often})
