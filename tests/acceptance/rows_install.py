"""Rows of the first minutes: README, wheel, installation, import, doctor."""

from __future__ import annotations

import os
import re
import zipfile

from row import Rows, expect, expect_words
from user import ROOT, User

ROWS = Rows()

# Names of the family in a licence: those that bind who links, so not the lesser one, nor the
# compiler's run time, whose exception frees it.
_STRONG_GPL = re.compile(r"(?<!L)GPL(?!.{0,40}exception)|(?<!Lesser )General Public", re.I | re.S)


@ROWS.add("0", "README: the first screen", seconds=5)
def readme(user: User) -> str:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    pictures = re.findall(r"!\[[^\]]+\]\(([^)]+)\)", text)
    for path in pictures[:2]:
        expect((ROOT / path).is_file(), f"{path} is not there")
    expect(len(pictures) >= 2, "a picture of the cut and a torque curve must be shown")
    script = re.search(r"```python\n(.*?)```", text, re.S)
    expect(script, "a script must be shown")
    lines = [line for line in script[1].splitlines() if line.strip()]
    expect(len(lines) <= 6, f"the script must have six lines, got {len(lines)}")
    compile(script[1], "README.md", "exec")
    expect_words(text, "pip install", "shellcut run opening --set mesh=quick -o out", "pytest")
    expect_words(text, "it does not", "mm, N, s, tonne, MPa", "docs/limits.md", "CITATION.cff")
    return f"{len(pictures)} pictures, a script of {len(lines)} lines"


@ROWS.add(
    "0-2",
    "pip install shellcut[plot] in a fresh environment",
    seconds=120,
    limit="wheels only: no compiler; no GPL package; own wheel pure and < 2 MB",
)
def install(user: User) -> str:
    wheel = user.environment.wheel
    size = wheel.stat().st_size / 1e6
    expect(size < 2.0, f"the wheel must be under 2 MB, got {size:.2f}")
    expect(wheel.name.endswith("py3-none-any.whl"), f"the wheel must be pure, got {wheel.name}")
    with zipfile.ZipFile(wheel) as content:
        native = [n for n in content.namelist() if n.endswith((".so", ".pyd", ".dll", ".dylib"))]
    expect(not native, f"no machine code in the wheel, got {native}")
    licences = user.inside("licences.py")
    strong = [name for name, licence in licences.items() if _STRONG_GPL.search(licence)]
    expect(not strong, f"no package under the GPL, got {strong}")
    for name in ("gmsh", "vtk", "pandas"):
        expect(name not in licences, f"{name} is an extra, but was installed")
    return f"{user.environment.seconds:.0f} s of it pip, {len(licences)} packages, {size:.2f} MB"


@ROWS.add("2", "import shellcut", seconds=60, limit="< 1.0 s", needs=("environment",))
def import_time(user: User) -> str:
    text = (
        "import time; t = time.perf_counter(); import shellcut; "
        "print(time.perf_counter() - t, shellcut.__version__)"
    )
    # The least of five: what else runs on the machine only adds.
    said = [user.python(text).said.split() for _ in range(5)]
    best = min(float(seconds) for seconds, _ in said)
    expect(best < 1.0, f"the import must take less than 1.0 s, got {best:.2f}")
    expect(re.fullmatch(r"\d+\.\d+\.\d+\S*", said[0][1]), f"no version: {said[0][1]}")
    return f"{best:.2f} s (least of 5), version {said[0][1]}"


@ROWS.add(
    "2", "shellcut doctor", seconds=30, limit="exit code 0, a line each", needs=("environment",)
)
def doctor(user: User) -> str:
    done = user.shellcut("doctor")
    expect(done.code == 0, f"exit code {done.code}:\n{done.said}")
    expect_words(done.said, "python", "numba", "cores", "compiled code", "result files")
    expect_words(done.said, "rendering", "by Matplotlib", "pip install shellcut[vtk]")
    lines = done.said.strip().splitlines()
    expect(not re.search("Traceback|PROBLEM", done.said), done.said)
    return (
        f"{len(lines)} lines, {sum('(' in line for line in lines if line[:4] == 'note')} remedies"
    )


def hide_rendering(user: User) -> dict[str, str]:
    """Return the environment in which VTK finds no way to draw, and then kills its process."""
    nowhere = user.folder / "no_drivers"
    nowhere.mkdir(exist_ok=True)
    return {
        "__EGL_VENDOR_LIBRARY_FILENAMES": os.devnull,
        "__EGL_VENDOR_LIBRARY_DIRS": str(nowhere),
        "LIBGL_DRIVERS_PATH": str(nowhere),
    }
