"""Find out whether PyVista can draw here, in a separate process that VTK may crash.

On a machine with neither a screen nor EGL nor OSMesa, VTK ends with a segmentation fault instead of
an exception, so it must not be tried in this process.
"""

from __future__ import annotations

import functools
import importlib.util
import logging
import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager

_log = logging.getLogger(__name__)

CHOICE = "SHELLCUT_RENDERER"
"""Environment variable: ``matplotlib`` draws without PyVista, even if this machine has it."""

TIME_LIMIT = 60.0
"""Time limit of the attempt [s]; a cold start of VTK takes about ten."""

_INSTALL = "PyVista is not installed (pip install shellcut[view])"

# Draws a red ball on white and checks the pixels.
_ATTEMPT = """
import sys
import pyvista
plotter = pyvista.Plotter(off_screen=True, window_size=(48, 48))
plotter.background_color = "white"
plotter.add_mesh(pyvista.Sphere(), color="red", lighting=False)
image = plotter.screenshot(return_img=True)
middle, corner = image[24, 24].tolist(), image[0, 0].tolist()
sys.exit(0 if middle == [255, 0, 0] and corner == [255, 255, 255] else 1)
"""

# Without a screen VTK draws to memory, by EGL or OSMesa: a window would never appear.
_ON_SCREEN = """
import sys
import vtkmodules.vtkRenderingOpenGL2
from vtkmodules.vtkRenderingCore import vtkRenderWindow
name = vtkRenderWindow().GetClassName()
sys.exit(0 if name.startswith(("vtkX", "vtkWin32", "vtkCocoa")) else 1)
"""


def why_not_pyvista() -> str | None:
    """Return in one line why PyVista cannot draw in this process; None if it can.

    The first call tries it, which takes a second or two; later calls use its result.

    Returns
    -------
    str or None

    Examples
    --------
    >>> from unittest import mock
    >>> with mock.patch.dict("os.environ", {"SHELLCUT_RENDERER": "matplotlib"}):
    ...     why_not_pyvista()
    'SHELLCUT_RENDERER=matplotlib'
    """
    if os.environ.get(CHOICE, "") == "matplotlib":
        return f"{CHOICE}=matplotlib"
    return _tried()


def why_no_window() -> str | None:
    """Return in one line why no window can be opened here; None if it can.

    The first call tries it in a separate process, which takes a second or two.
    """
    return why_not_pyvista() or _window_tried()


def pyvista_or_say(fallback: str) -> bool:
    """Return whether PyVista can draw; if not, log one line with the reason and the fallback."""
    reason = why_not_pyvista()
    if reason is not None:
        _say_once(f"no 3-D rendering: {reason}; {fallback}")
    return reason is None


@functools.cache
def _tried() -> str | None:
    if importlib.util.find_spec("pyvista") is None:
        return _INSTALL
    code, problem = _ended(_ATTEMPT)
    if code == 0:
        return None
    if code is not None and code < 0:
        return (
            f"VTK crashed (signal {-code}): no screen, EGL or OSMesa "
            "(on Debian: apt-get install libegl1)"
        )
    return problem


@functools.cache
def _window_tried() -> str | None:
    code, problem = _ended(_ON_SCREEN)
    return None if code == 0 else problem if code is None else "no screen that VTK can open"


def _ended(program: str) -> tuple[int | None, str]:
    """Run Python in a process of its own; return its exit code, or None, and the problem."""
    try:
        done = subprocess.run(
            [sys.executable, "-c", program],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            stdin=subprocess.DEVNULL,
            timeout=TIME_LIMIT,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return None, f"PyVista drew nothing within {TIME_LIMIT:g} s"
    except OSError as error:
        return None, f"no process to try PyVista in: {error}"
    return done.returncode, f"PyVista failed (exit code {done.returncode})"


@functools.cache
def _say_once(message: str) -> None:
    _log.warning(message)


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
