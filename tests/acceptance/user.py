"""A user with nothing but Python: a folder, a fresh virtual environment, no display."""

import os
import shutil
import signal
import subprocess
import sys
import time
from functools import cached_property
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]

QUICK = ("opening", "--set", "mesh=quick")
"""The main job."""

_LIMIT = 600.0
"""No command takes longer [s]."""
_NOT_SOURCES = shutil.ignore_patterns("__pycache__", "*.egg-info")


class User:
    """Do what a user does, in ``folder``; what was said by each command is kept in its log."""

    def __init__(self, folder):
        self.folder = folder
        self.log = folder / "commands.log"
        self._bin = folder / "venv" / ("Scripts" if os.name == "nt" else "bin")
        hidden = ("DISPLAY", "WAYLAND_DISPLAY", "PYTHONPATH", "VIRTUAL_ENV", "PYTHONHOME")
        self._environ = {k: v for k, v in os.environ.items() if k not in hidden}
        # No cache from before: the first run compiles, as a user's does.
        self._environ["NUMBA_CACHE_DIR"] = str(folder / "numba_cache")
        self._streams = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE}
        self._streams |= {"stderr": subprocess.STDOUT, "encoding": "utf-8", "errors": "replace"}

    @cached_property
    def environment(self):
        """The wheel of this clone, installed with the extra ``plot`` into a fresh environment."""
        _done(self.run(sys.executable, "-m", "venv", str(self._bin.parent)))
        # From a copy: a build leaves files in the folder, and takes up what an older one left.
        source, wheels = self.folder / "source", self.folder / "wheel"
        shutil.copytree(ROOT / "src", source / "src", ignore=_NOT_SOURCES)
        for name in ("pyproject.toml", "README.md", "LICENSE"):
            shutil.copy(ROOT / name, source)
        shutil.copytree(ROOT / ".ci", source / ".ci", ignore=_NOT_SOURCES)
        _done(self.pip("wheel", "--no-deps", "-w", str(wheels), str(source)))
        (wheel,) = wheels.glob("*.whl")
        _done(self.pip("install", "--only-binary", ":all:", f"{wheel}[plot]"))
        return wheel

    @cached_property
    def first_run(self):
        """The main job with nothing compiled, its results in ``out``."""
        _ = self.environment
        return self.shellcut("run", *QUICK, "-o", "out")

    @property
    def out(self):
        """Folder of the main job, done."""
        _done(self.first_run)
        return self.folder / "out"

    @cached_property
    def parts(self):
        """The user's own parts: a cap as STL and a disc as .msh."""
        _ = self.environment
        folder = self.folder / "parts"
        folder.mkdir()
        script = str(HERE / "write_parts.py")  # sees tests/films.py, too
        python = str(self._bin / "python")
        _done(self.run(python, script, str(folder), PYTHONPATH=str(HERE.parent)))
        return folder

    def run(self, *command, **environ):
        """Run a command in the folder to its end."""
        start, environ = time.perf_counter(), {**self._environ, **environ}
        done = subprocess.run(
            command, cwd=self.folder, env=environ, timeout=_LIMIT, check=False, **self._streams
        )
        return self._kept(done, start)

    def pip(self, *arguments):
        quiet = ("-q", "--disable-pip-version-check")
        return self.run(str(self._bin / "python"), "-m", "pip", *arguments, *quiet)

    def shellcut(self, *arguments):
        return self.run(str(self._bin / "shellcut"), *arguments)

    def python(self, text):
        return self.run(str(self._bin / "python"), "-c", text)

    def interrupted(self, *arguments, when):
        """Run the command ``shellcut`` and press Ctrl-C as soon as ``when()``."""
        start = time.perf_counter()
        command = [str(self._bin / "shellcut"), *arguments]
        with subprocess.Popen(
            command,
            cwd=self.folder,
            env=self._environ,
            # A shell may have it ignored in its background jobs, and children inherit that.
            preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
            **self._streams,
        ) as process:
            try:
                while process.poll() is None and not when():
                    time.sleep(0.05)
                process.send_signal(signal.SIGINT)
                said, _ = process.communicate(timeout=_LIMIT)
            except BaseException:
                process.kill()
                raise
        return self._kept(subprocess.CompletedProcess(command, process.returncode, said), start)

    def _kept(self, done, start):
        seconds = time.perf_counter() - start
        with self.log.open("a", encoding="utf-8") as log:
            log.write(f"$ {' '.join(done.args)}\n{done.stdout}\n")
            log.write(f"[{done.returncode}, {seconds:.1f} s]\n\n")
        return done


def _done(finished):
    assert finished.returncode == 0, finished.stdout[-2000:]
