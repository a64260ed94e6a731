"""``doctor``: check this machine.

Check this machine, one line per finding, with a remedy where there is one. Exit code 2 only if no
model can be run.
"""

from __future__ import annotations

import argparse
import importlib
import os
import platform
import shutil
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Literal

import h5py
import llvmlite.binding
import numba
import numpy as np

from shellcut.numerics.kernel_cache import LEVELS, KernelCache
from shellcut.numerics.source_digest import PACKAGE
from shellcut.numerics.threads import Workers, available_cores

from .exit_code import BAD_INPUT, DONE

_LARGE_FILM = 10**6
"""Number of quads from which all threads are used."""
_LITTLE_SPACE = 1e9
"""Bytes; a run on the finest shipped mesh writes some hundred megabytes."""
_FIRST_RIGHT_VTK = (9, 3)
"""Older versions silently show all frames of a temporal VTKHDF file at once."""

# Purpose of the optional packages, and the extra that installs them.
_EXTRAS = {
    "matplotlib": ("pictures", "pip install shellcut[plot]"),
    "vtk": ("VTK files beyond those of meshio", "pip install shellcut[vtk]"),
    "imageio-ffmpeg": ("movies as mp4", "pip install shellcut[movie]"),
    "gmsh": ("meshes of outlines, no tools from STEP and IGES", "pip install shellcut[mesh]"),
    "ezdxf": ("outlines from DXF", "pip install shellcut[outline]"),
    "svgpathtools": ("outlines from SVG", "pip install shellcut[outline]"),
    "scikit-learn": ("response surfaces of studies", "pip install shellcut[study]"),
    "optuna": ("search for the best values", "pip install shellcut[optimise]"),
    "distributed": ("studies on Dask", "pip install shellcut[sweep]"),
}


@dataclass(frozen=True)
class Finding:
    """One line of the report."""

    status: Literal["ok", "note", "PROBLEM"]
    what: str
    value: str
    remedy: str = ""
    stops: bool = False
    """Whether no model can be run."""

    def __str__(self) -> str:
        """Return the line."""
        remedy = f"  ({self.remedy})" if self.remedy else ""
        return f"{self.status:<7}  {self.what:<14}  {self.value}{remedy}"


def add_to(_: argparse.ArgumentParser) -> None:
    """Add nothing: the command has no arguments."""


def run(_: argparse.Namespace) -> int:
    """Print the findings one by one."""
    stopped = False
    for check in CHECKS:
        for finding in check():
            print(finding, flush=True)
            stopped = stopped or finding.stops
    return BAD_INPUT if stopped else DONE


def _versions() -> Iterator[Finding]:
    yield Finding("ok", "python", f"{platform.python_version()}, {platform.platform(terse=True)}")
    for package in ("shellcut", "numpy", "scipy", "h5py", "meshio"):
        yield Finding("ok", package, version(package))
    llvm = ".".join(map(str, llvmlite.binding.llvm_version_info))
    yield Finding("ok", "numba", f"{numba.__version__}, LLVM {llvm}")


def _cores() -> Iterator[Finding]:
    cores = available_cores()
    most = Workers(_LARGE_FILM).count
    yield Finding("ok", "cores", f"{cores}; 1 thread for small films, {most} for large ones")
    features = llvmlite.binding.get_host_cpu_features()
    # widest first: number of doubles per instruction
    for feature, lanes in (("avx512f", 8), ("avx", 4), ("sse2", 2), ("neon", 2)):
        if features.get(feature):
            yield Finding("ok", "SIMD", f"{lanes} numbers per instruction ({feature})")
            return
    yield Finding("note", "SIMD", "LLVM knows no vector instructions here", "runs are slow")


def _compiler() -> Iterator[Finding]:
    try:
        right = numba.njit(lambda x: 2.0 * x)(21.0) == 42.0
    except Exception as reason:  # any failure of the compiler
        yield Finding(
            "PROBLEM", "compiler", f"Numba fails: {reason}", "pip install -U numba", stops=True
        )
        return
    if not right:
        yield Finding("PROBLEM", "compiler", "Numba computes wrongly", "reinstall numba", True)
    if brought := [level for level in LEVELS if (PACKAGE / "compiled" / level).is_dir()]:
        yield Finding("ok", "release", f"brings compiled code for {', '.join(brought)}")
    yield _cache()


def _cache() -> Finding:
    """Report where Numba stores machine code, from the imported kernels."""
    # The kernels of one package folder share one folder of machine code.
    rooms = [module for name, module in sys.modules.items() if name.startswith("shellcut.")]
    caches = [getattr(kernel, "_cache", None) for room in rooms for kernel in vars(room).values()]
    stored = [one for one in caches if isinstance(one, KernelCache) and one.can_store]
    folders = sorted({Path(one.cache_path) for one in stored})
    remedy = "set NUMBA_CACHE_DIR to a folder you can write to"
    if not folders:
        value = "no folder can be written: every run compiles what no release brings"
        return Finding("note", "compiled code", value, remedy)
    for folder in folders:
        try:
            folder.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryFile(dir=folder):
                pass
        except OSError as reason:
            value = f"{folder} cannot be written ({reason.strerror}): every run compiles again"
            return Finding("note", "compiled code", value, remedy)
    entries = (entry for folder in folders for entry in folder.iterdir())
    held = [entry.stat() for entry in entries if entry.suffix in (".nbi", ".nbc")]
    common = os.path.commonpath(folders)
    if not held:
        remedy = "shellcut warmup compiles, half a minute"
        return Finding("note", "compiled code", f"none yet in {common}", remedy)
    size = sum(entry.st_size for entry in held) / 1e6
    return Finding("ok", "compiled code", f"{size:.1f} MB in {common}")


def _files() -> Iterator[Finding]:
    try:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "doctor.h5"
            with h5py.File(path, "w") as file:
                file["numbers"] = np.arange(8.0)
            with h5py.File(path) as file:
                right = file["numbers"][()].sum() == 28.0
    except OSError as reason:
        yield Finding(
            "PROBLEM",
            "result files",
            f"HDF5 cannot write to {tempfile.gettempdir()}: {reason}",
            "set TMPDIR; on a network disk HDF5_USE_FILE_LOCKING=FALSE",
            stops=True,
        )
        return
    if right:
        yield Finding("ok", "result files", f"HDF5 {h5py.version.hdf5_version} writes and reads")
    else:
        yield Finding("PROBLEM", "result files", "HDF5 reads wrongly", "reinstall h5py", True)
    free = shutil.disk_usage(os.getcwd()).free
    value = f"{free / 1e9:.1f} GB free in {os.getcwd()}"
    little = "a fine run writes some hundred megabytes" if free < _LITTLE_SPACE else ""
    yield Finding("note" if little else "ok", "disk", value, little)


def _extras() -> Iterator[Finding]:
    for package, (purpose, remedy) in _EXTRAS.items():
        status: Literal["ok", "note", "PROBLEM"] = "ok"
        try:
            found = version(package)
            numbers = tuple(int(part) for part in found.split(".") if part.isdecimal())
            if package == "vtk" and numbers[:2] < _FIRST_RIGHT_VTK:
                status, remedy = "PROBLEM", 'pip install "vtk>=9.3"'
                found = f"{found} silently misreads shellcut's files"
            elif package == "gmsh":  # may be installed without the system libraries it needs
                importlib.import_module("gmsh")
        except PackageNotFoundError:
            status, found = "note", f"not installed: no {purpose}"
        except (ImportError, OSError) as reason:
            remedy = "on Debian: apt-get install libglu1-mesa libxcursor1 libxinerama1 libxft2"
            status, found = "note", f"{found} does not load: {reason}"
        yield Finding(status, package, found, remedy * (status != "ok"))


CHECKS = (_versions, _cores, _compiler, _files, _extras)
"""In the order of the report."""
