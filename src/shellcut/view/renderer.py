"""Find out whether a window can be opened, in a separate process that VTK may crash.

On a machine with neither a screen nor EGL nor OSMesa, VTK ends with a segmentation fault instead of
an exception, so it must not be tried in this process.
"""

from __future__ import annotations

import functools
import importlib.util
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager

TIME_LIMIT = 60.0
"""Time limit of the attempt [s]; a cold start of VTK takes about ten."""

# Without a screen VTK draws to memory, by EGL or OSMesa: a window would never appear.
_ATTEMPT = """
import sys
import vtkmodules.vtkRenderingOpenGL2
from vtkmodules.vtkRenderingCore import vtkRenderWindow
name = vtkRenderWindow().GetClassName()
sys.exit(0 if name.startswith(("vtkX", "vtkWin32", "vtkCocoa")) else 1)
"""


@functools.cache
def why_no_window() -> str | None:
    """Return in one line why no window can be opened here; None if it can.

    The first call tries it, which takes a second or two; later calls use its result.
    """
    if importlib.util.find_spec("pyvista") is None:
        return "PyVista is not installed (pip install shellcut[view])"
    try:
        done = subprocess.run(
            [sys.executable, "-c", _ATTEMPT],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            stdin=subprocess.DEVNULL,
            timeout=TIME_LIMIT,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return f"VTK opened nothing within {TIME_LIMIT:g} s"
    except OSError as error:
        return f"no process to try VTK in: {error}"
    return None if done.returncode == 0 else "no screen that VTK can open"


@contextmanager
def quiet_vtk() -> Iterator[None]:
    """Keep VTK's own log off standard error, where it lists every screen it did not find."""
    from vtkmodules.vtkCommonCore import vtkLogger

    before = vtkLogger.GetCurrentVerbosityCutoff()
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
    try:
        yield
    finally:
        vtkLogger.SetStderrVerbosity(vtkLogger.ConvertToVerbosity(before))
