"""A library that crashes or hangs on damaged input takes it in a process of its own."""

from __future__ import annotations

import importlib.util
import re
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from .errors import FileError

LONGEST = 600.0
"""Time after which a reader is ended [s]."""

# The folder of the script and the working folder do not come on the path of modules: the former
# holds another gmsh.py.
_START = (
    "import runpy, sys; sys.path[:] = filter(None, sys.path); del sys.argv[0]; "
    "runpy.run_path(sys.argv[0], run_name='__main__')"
)


@dataclass(frozen=True)
class OwnProcess:
    """A script that takes a file to a library."""

    library: str
    """Its name in messages."""
    module: str
    """What the script imports of it."""
    script: str
    """Path of the script; it imports nothing of shellcut, so that it starts at once."""
    remedy: str
    """What to do about a file on which the library breaks down or hangs."""
    system: str
    """Packages of Debian and Ubuntu that the library needs."""
    missing: str = ""
    """What to say where the library is not installed."""

    @property
    def installed(self) -> bool:
        """Whether the library is installed."""
        return importlib.util.find_spec(self.module) is not None

    def answer(self, path: Path, *arguments: str) -> dict[str, Any]:
        """Run the script with the file, a place for its answer, and further arguments.

        Returns the arrays that it wrote by ``numpy.savez``; raises as :meth:`run`, and ImportError
        if the library is not installed.
        """
        if not self.installed:
            raise ImportError(self.missing)
        with tempfile.TemporaryDirectory() as folder:
            out = Path(folder) / "answer.npz"
            self.run(path, str(out), *arguments)
            with np.load(out) as held:
                return dict(held)

    def run(self, path: Path, *arguments: str) -> str:
        """Run the script with the file and further arguments; return its standard output.

        Raises FileError if it refuses the file, breaks down or does not end.
        """
        command = [sys.executable, "-X", "utf8", "-c", _START, self.script, str(path.resolve())]
        try:
            done = subprocess.run(
                [*command, *arguments],
                capture_output=True,
                encoding="utf-8",
                errors="replace",
                timeout=LONGEST,
            )
        except subprocess.TimeoutExpired:
            raise FileError(
                path, f"{self.library} did not finish within {LONGEST:g} s: {self.remedy}"
            ) from None
        if done.returncode < 0 or (done.returncode and not done.stderr):
            raise FileError(
                path, f"{self.library} broke down on it (code {done.returncode}): {self.remedy}"
            )
        if done.returncode:
            said = done.stderr.strip().splitlines()[-1]
            if re.match("(OS|Import|ModuleNotFound)Error", said):  # a system library is missing
                raise ImportError(
                    f"{self.library} is installed but cannot be loaded: {said}; on Debian and "
                    f"Ubuntu: apt install {self.system}"
                )
            raise FileError(path, f"{self.library} cannot read it: {said}")
        return done.stdout


def gmsh(script: str, remedy: str, task: str) -> OwnProcess:
    """Return a script that uses Gmsh, an optional extra; ``task`` is what cannot do without it."""
    return OwnProcess(
        "Gmsh",
        "gmsh",
        script,
        remedy,
        "libglu1-mesa libxcursor1 libxft2 libxinerama1",
        f"{task} needs Gmsh, an optional extra under the GPL: pip install 'shellcut[mesh]'",
    )
