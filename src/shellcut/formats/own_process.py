"""Gmsh, which crashes or hangs on some input, takes it in a process of its own."""

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

from shellcut.files.distribution import pip_install

from .errors import FileError

LONGEST = 600.0
"""Time after which the process is ended [s]."""

_SYSTEM = "libglu1-mesa libxcursor1 libxft2 libxinerama1"  # what Gmsh needs of Debian and Ubuntu

# The folder of the script and the working folder do not come on the path of modules: the former
# holds another gmsh.py.
_START = (
    "import runpy, sys; sys.path[:] = filter(None, sys.path); del sys.argv[0]; "
    "runpy.run_path(sys.argv[0], run_name='__main__')"
)


@dataclass(frozen=True)
class GmshProcess:
    """A script that takes a file to Gmsh, an optional extra."""

    script: str
    """Path of the script; it imports nothing of shellcut, so that it starts at once."""
    remedy: str
    """What to do about a file on which Gmsh breaks down or hangs."""
    task: str
    """What cannot be done without Gmsh."""

    def answer(self, path: Path, *arguments: str) -> dict[str, Any]:
        """Run the script with the file, a place for its answer, and further arguments.

        Returns the arrays that it wrote by ``numpy.savez``. Raises FileError if the script refuses
        the file, breaks down or does not end, and ImportError if Gmsh is not installed or cannot be
        loaded.
        """
        if importlib.util.find_spec("gmsh") is None:
            raise ImportError(
                f"{self.task} needs Gmsh, an optional extra under the GPL: {pip_install('mesh')}"
            )
        with tempfile.TemporaryDirectory() as folder:
            out = Path(folder) / "answer.npz"
            self._run(path, str(out), *arguments)
            with np.load(out) as answer:
                return dict(answer)

    def _run(self, path: Path, *arguments: str) -> None:
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
                path, f"Gmsh did not finish within {LONGEST:g} s: {self.remedy}"
            ) from None
        if done.returncode < 0 or (done.returncode and not done.stderr):
            raise FileError(path, f"Gmsh broke down on it (code {done.returncode}): {self.remedy}")
        if done.returncode:
            said = done.stderr.strip().splitlines()[-1]
            if re.match("(OS|Import|ModuleNotFound)Error", said):  # a system library is missing
                raise ImportError(
                    f"Gmsh is installed but cannot be loaded: {said}; on Debian and Ubuntu: "
                    f"apt install {_SYSTEM}"
                )
            raise FileError(path, f"Gmsh cannot read it: {said}")
