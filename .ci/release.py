"""Build the wheel of a release: ``python .ci/release.py``, with pip and wheel installed.

pip builds a wheel of the sources alone. Its package, unpacked, compiles its kernels into itself,
once for each kind of processor in ``LEVELS``: those of ``kernels.json``, on all cores, and those of
the runs with options in ``tests/record_kernels.py``. They go into the folder ``compiled`` of the
package (:mod:`shellcut.numerics.kernel_cache`), and the wheel is packed again, for this version of
Python and the platforms of Numba's wheel. A few minutes a level; the processor must be of the
highest.
"""

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from importlib.metadata import distribution
from pathlib import Path

ROOT = Path(__file__).parents[1]
RECORD = ROOT / "tests" / "record_kernels.py"
_LEVELS = "from shellcut.numerics.kernel_cache import LEVELS; print(*LEVELS)"
_FURTHER = f"import sys; sys.path.insert(0, {str(RECORD.parent)!r})\n" + (
    "from record_kernels import WITH_OPTIONS; print(*WITH_OPTIONS, sep='\\n')"
)


def main() -> None:
    """Build the wheel and print where it is and how large a level."""
    parser = argparse.ArgumentParser(description="build a wheel that brings compiled kernels")
    parser.add_argument("-o", "--out", type=Path, default=Path("dist"), help="folder of the wheel")
    out = parser.parse_args().out.resolve()
    out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as scratch:
        python("-m", "pip", "wheel", "-q", "--no-deps", "-w", scratch, ROOT)
        (pure,) = Path(scratch).glob("*.whl")
        python("-m", "wheel", "unpack", pure, "-d", scratch)
        (site,) = (one for one in Path(scratch).iterdir() if one.is_dir())
        for level in said(_LEVELS, site).split():
            compile_into(site, level)
        tag_for_this_platform(site)
        python("-m", "wheel", "pack", site, "-d", out)


def compile_into(site: Path, level: str) -> None:
    """Compile the kernels of a package for a kind of processors, into the package."""
    package = site / "shellcut"
    alone = {"NUMBA_CPU_NAME": level, "NUMBA_CPU_FEATURES": "", "PYTHONPATH": str(site)}
    run = partial(python, **alone)
    run("-m", "shellcut", "warmup")
    with ThreadPoolExecutor(os.cpu_count()) as several:
        record = partial(run, RECORD, stdout=subprocess.DEVNULL)
        list(several.map(record, said(_FURTHER, site).splitlines()))
    print(f"{level}: {gathered(package, level) / 1e6:.1f} MB", flush=True)


def gathered(package: Path, level: str) -> int:
    """Move what a package has compiled to where a release has it; return its size [B]."""
    size = 0
    for cache in list(package.rglob("__pycache__")):
        room = package / "compiled" / level / cache.parent.relative_to(package)
        for file in cache.glob("*.nb[ci]"):
            room.mkdir(parents=True, exist_ok=True)
            size += file.stat().st_size
            file.rename(room / file.name)
        shutil.rmtree(cache)
    return size


def tag_for_this_platform(site: Path) -> None:
    """Write into a wheel's own file that it is for this Python and the platforms of Numba's wheel.

    The kernels are object code that Numba links when it loads them; they name functions of the C
    library without a version of it. So the wheel runs where Numba's own does, on ``manylinux_2_27``
    for example. auditwheel cannot tell: there is no shared library in the wheel.
    """
    (file,) = site.glob("*.dist-info/WHEEL")
    python_ = f"cp{sys.version_info.major}{sys.version_info.minor}"
    lines = [f"Tag: {python_}-{python_}-{platform}" for platform in platforms_of_numba()]
    text = file.read_text().replace("Root-Is-Purelib: true", "Root-Is-Purelib: false")
    file.write_text(text.replace("Tag: py3-none-any", "\n".join(lines)))


def platforms_of_numba() -> list[str]:
    """Return the platforms of the installed wheel of Numba, as in a wheel's name."""
    said = distribution("numba").read_text("WHEEL") or ""
    found = [one.rpartition("-")[2] for one in said.splitlines() if one.startswith("Tag: ")]
    if not found or any(platform.startswith("linux_") for platform in found):
        raise SystemExit(
            f"the installed Numba was built here (its platforms: {found}), and a package index "
            "refuses a wheel for it: install Numba's wheel from the index"
        )
    return found


def said(code: str, site: Path) -> str:
    """Return what a line of Python prints, with the package of the wheel."""
    return python("-c", code, PYTHONPATH=str(site), stdout=subprocess.PIPE).stdout


def python(*arguments: object, stdout: int | None = None, **environ: str):
    """Run Python; the kernels that it compiles stay beside the sources."""
    given = {key: value for key, value in os.environ.items() if key != "NUMBA_CACHE_DIR"}
    command = [sys.executable, *map(str, arguments)]
    return subprocess.run(command, env=given | environ, stdout=stdout, check=True, text=True)


if __name__ == "__main__":
    main()
