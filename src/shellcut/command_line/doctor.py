"""``doctor``: check this machine.

Say what is installed, and whether the compiler and result files work. Exit code 2 if no model can
be run.
"""

from __future__ import annotations

import os
import platform
import sys
import tempfile
from collections.abc import Iterator
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import h5py
import numba
import numpy as np

from shellcut.files.distribution import DISTRIBUTION, pip_install
from shellcut.numerics.kernel_cache import KernelCache
from shellcut.numerics.threads import available_cores

from .shared import BAD_INPUT, DONE, Arguments, Parser

_REQUIRED = (DISTRIBUTION, "numpy", "scipy", "numba", "h5py", "meshio")
# What an optional package is for, and the extra that installs it.
_EXTRAS = {
    "matplotlib": ("pictures", "plot"),
    "imageio-ffmpeg": ("movies as mp4", "movie"),
    "gmsh": ("meshes of outlines, tools from STEP and IGES", "mesh"),
    "ezdxf": ("outlines from DXF", "outline"),
    "shapely": ("outlines", "outline"),
    "optuna": ("search for the best values", "optimise"),
    "distributed": ("studies on Dask", "sweep"),
}


def add_to(_: Parser) -> None:
    """Add nothing: the command has no arguments."""


def run(_: Arguments) -> int:
    """Print what there is, and what works."""
    print(f"python          {platform.python_version()}, {platform.platform(terse=True)}")
    print(f"cores           {available_cores()}")
    for package, (purpose, extra) in {**dict.fromkeys(_REQUIRED, ("", "")), **_EXTRAS}.items():
        try:
            print(f"{package:<15} {version(package)}")
        except PackageNotFoundError:
            print(f"{package:<15} not installed: no {purpose} ({pip_install(extra)})")
    problems = list(_problems())
    for problem in problems:
        print(f"PROBLEM         {problem}")
    return BAD_INPUT if problems else DONE


def _problems() -> Iterator[str]:
    """Yield what keeps models from running; print where compiled code is kept."""
    try:
        if numba.njit(lambda x: 2.0 * x)(21.0) != 42.0:
            yield "Numba computes wrongly: reinstall numba"
    except Exception as reason:  # any failure of the compiler
        yield f"Numba fails: {reason}; pip install -U numba"
    modules = [module for name, module in sys.modules.items() if name.startswith("shellcut.")]
    kernels = [kernel for module in modules for kernel in vars(module).values()]
    caches = [getattr(kernel, "_cache", None) for kernel in kernels]
    kept = {Path(c.cache_path) for c in caches if isinstance(c, KernelCache) and c.can_store}
    place = os.path.commonpath(kept) if kept else "nowhere: set NUMBA_CACHE_DIR to a folder"
    print(f"compiled code   {place}")
    try:
        with tempfile.TemporaryDirectory() as folder, h5py.File(f"{folder}/doctor.h5", "w") as file:
            file["numbers"] = np.arange(8.0)
    except OSError as reason:
        yield f"HDF5 cannot write to {tempfile.gettempdir()}: {reason}; set TMPDIR"
