"""Machine code kept on disk: of these very sources, and whole, or compiled anew."""

import importlib.util
import json
import os
import platform
import shutil
import subprocess
import sys
from pathlib import Path

import numba
import pytest

import shellcut
from shellcut.numerics.source_digest import NOT_STORED

TESTS = Path(__file__).parents[1]

_OF_A_VERSION = """
from typing import NamedTuple

import numpy as np
from shellcut.numerics.jit import bound, kernel


class {name}(NamedTuple):
    length: object


@kernel
def longest(rods):
    return rods.length.max()


@kernel
def longest_of_bound(rods):
    return rods.length.max()


rods = {name}(np.arange(3.0))
found = longest(rods), bound(longest_of_bound, rods)(rods)
misses = len(longest.stats.cache_misses), len(longest_of_bound.stats.cache_misses)
"""


@pytest.fixture
def version(tmp_path, monkeypatch):
    """Return what imports a module with kernels anew, as another process does."""
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.syspath_prepend(tmp_path)

    def imported(name):
        importlib.invalidate_caches()
        for one in ("of_a_version", "called", "sub"):
            sys.modules.pop(one, None)
        return importlib.import_module(name)

    yield imported
    for one in ("of_a_version", "called", "sub"):
        sys.modules.pop(one, None)


def test_a_cache_of_an_older_version_is_written_anew(tmp_path, version):
    """Numba cannot open it where the class of a table has another name by now."""
    misses, source = [], tmp_path / "of_a_version.py"
    for name in ("Bars", "Rods", None):
        if name:
            source.write_text(_OF_A_VERSION.format(name=name))
        module = version(source.stem)
        assert module.found == (2.0, 2.0)
        misses.append(module.misses)
    assert misses == [(1, 1), (1, 1), (0, 0)]


def _cut_short(file):
    file.write_bytes(file.read_bytes()[: file.stat().st_size // 2])


def _a_bit_turned(file):
    content = bytearray(file.read_bytes())
    content[-len(content) // 3] ^= 1
    file.write_bytes(content)


@pytest.mark.parametrize("damage", [_cut_short, _a_bit_turned])
@pytest.mark.parametrize("kind", ["nbc", "nbi"])
def test_a_damaged_file_is_compiled_anew(tmp_path, version, damage, kind):
    (tmp_path / "of_a_version.py").write_text(_OF_A_VERSION.format(name="Bars"))
    version("of_a_version")
    files = list((tmp_path / "cache").rglob(f"*.{kind}"))
    assert len(files) == 2
    for file in files:
        damage(file)
    assert [version("of_a_version").found for _ in range(2)] == [(2.0, 2.0)] * 2
    if (damage, kind) != (_a_bit_turned, "nbi"):  # which may stand in what tells nothing
        assert version("of_a_version").misses == (0, 0)


READ = {
    "another module": "import called\ndef scaled(x): return called.K * x",
    "a name of another module": "from called import K\ndef scaled(x): return K * x",
    "a module of a module": "import sub\ndef scaled(x): return sub.called.K * x",
    "a closure": (
        "import called\ndef made(k):\n    def scaled(x): return k * x\n    return scaled\n"
        "scaled = made(called.K)"
    ),
    "a closure that a function calls": (
        "import called\nfrom shellcut.numerics.jit import inline\n"
        "def made(k):\n    @inline\n    def times(x): return k * x\n    return times\n"
        "times = made(called.K)\ndef scaled(x): return times(x)"
    ),
    "a default": (
        "import called\nfrom shellcut.numerics.jit import inline\n"
        "@inline\ndef times(x, k=called.K): return k * x\ndef scaled(x): return times(x)"
    ),
    "a choice of functions": (
        "import called\nif called.K > 10.0:\n    def scaled(x): return 30.0 * x\n"
        "else:\n    def scaled(x): return 2.0 * x"
    ),
}
"""Where a function takes a factor from, besides its own file. Kinds of values:
test_same_sources.py."""


@pytest.mark.parametrize("source", READ)
def test_another_value_that_a_function_reads_changes_the_result_of_its_kernel(
    tmp_path, version, source
):
    (tmp_path / "sub.py").write_text("import called\n")
    (tmp_path / "of_a_version.py").write_text(
        "from shellcut.numerics.jit import kernel\nfrom shellcut.material import PointLaw\n"
        f"{READ[source]}\nscaling = kernel(scaled)\nlaw = PointLaw('of a test', scaled, scaled)\n"
    )
    digests = []
    for factor, hits in ((2.0, 0), (2.0, 1), (30.0, 0), (30.0, 1)):  # of another length
        (tmp_path / "called.py").write_text(f"K = {factor}\n")
        module = version("of_a_version")
        assert module.scaling(1.0) == factor
        assert sum(module.scaling.stats.cache_hits.values()) == hits
        digests.append(module.law.digest)
    assert digests[0] == digests[1] != digests[2] == digests[3]


_WITHOUT_A_DIGEST = """
from numba.extending import overload
from shellcut.material import PointLaw
from shellcut.numerics.jit import kernel

class Factor:
    def __init__(self, k): self.k = k

FACTOR = Factor(2.0)

def times(x): return x

@overload(times)
def _times(x):
    k = FACTOR.k
    return lambda x: k * x

@kernel
def scaling(x, factor=FACTOR):
    return times(x)

law = PointLaw('of a test', scaling, scaling)
found = scaling(1.0, None)
"""


def test_what_reads_a_value_without_a_digest_is_not_stored(tmp_path, version):
    """Numba takes such a value where a function of a user's own tells it the type."""
    (tmp_path / "of_a_version.py").write_text(_WITHOUT_A_DIGEST)
    for _ in range(2):
        module = version("of_a_version")
        assert module.found == 2.0
        assert not sum(module.scaling.stats.cache_hits.values())
    assert not list((tmp_path / "cache").rglob("*.nb?"))
    assert NOT_STORED in module.law.digest


_PRESSED_SQUARE = """
import json
import numpy as np
from shellcut.loads.pressure import pressure_rows

x = np.array([[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]])
corners, film, rows = np.arange(4)[None], np.zeros((1, 4, 3)), np.zeros((1, 4, 3))
film[..., 0] = 1.0  # the integral of each shape function
pressure_rows(x, corners, film, 0.5, rows)
hits = sum(pressure_rows.stats.cache_hits.values())
print(json.dumps({"force": rows[..., 2].sum(), "loaded": hits}))
"""


FORCE = 0.5 * 4.0
"""Pressure times area, N."""


@pytest.fixture
def site(tmp_path):
    """Return a folder with a copy of the package."""
    return _copy(Path(shellcut.__file__).parent, tmp_path / "site")


def _copy(package, site):
    """Copy the package; its parts are imported one by one, or each process would take a second."""
    shutil.copytree(package, site / "shellcut", ignore=shutil.ignore_patterns("__pycache__"))
    (site / "shellcut" / "__init__.py").write_text("")
    return site


def pressed(site, **more):
    """Return the force on a square, and how many kernels were loaded, of a new process."""
    given = {key: value for key, value in os.environ.items() if not key.startswith("NUMBA_C")}
    environment = given | {"PYTHONPATH": str(site), "PYTHONDONTWRITEBYTECODE": "1"} | more
    command = [sys.executable, "-c", _PRESSED_SQUARE]
    done = subprocess.run(command, env=environment, check=True, capture_output=True, text=True)
    said = json.loads(done.stdout)
    return said["force"], said["loaded"]


def edited(site):
    """Double the third component of products of vectors, of which the kernel holds a copy."""
    vec3, third = site / "shellcut" / "numerics" / "vec3.py", "a[0] * b[1] - a[1] * b[0]"
    text = vec3.read_text()
    assert text.count(third) == 1
    vec3.write_text(text.replace(third, f"2.0 * ({third})"))


def test_an_upgraded_package_computes_by_its_own_sources(site):
    """The kernel stands in another file than the products of which it holds a copy."""
    cache = str(site / "cache")
    assert pressed(site, NUMBA_CACHE_DIR=cache) == (pytest.approx(FORCE), 0)
    edited(site)
    doubled = pytest.approx(2.0 * FORCE)
    assert pressed(site, NUMBA_CACHE_DIR=cache) == (doubled, 0)
    assert pressed(site, NUMBA_CACHE_DIR=cache) == (doubled, 1)


# ---------------------------------------------------------------- what a release brings


def _release():
    """Return the module that builds releases."""
    spec = importlib.util.spec_from_file_location("release", TESTS.parent / ".ci" / "release.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def release(tmp_path_factory):
    """Return a package with machine code for all processors of a level."""
    level = "x86-64-v3"
    if platform.machine() not in ("x86_64", "AMD64"):
        pytest.skip("releases bring machine code for x86-64 only")
    site = _copy(Path(shellcut.__file__).parent, tmp_path_factory.mktemp("release"))
    pressed(site, NUMBA_CPU_NAME=level, NUMBA_CPU_FEATURES="")
    assert _release().gathered(site / "shellcut", level) > 0
    return site / "shellcut"


@pytest.fixture
def released(release, tmp_path):
    """Return a folder with a copy of it."""
    return _copy(release, tmp_path / "site")


def _closed(site):
    """Return an environment without a folder for machine code."""
    for room in {path.parent for path in (site / "shellcut").rglob("*.py")}:
        (room / "__pycache__").write_text("a file where the folder should be")
    return {"HOME": os.devnull, "XDG_CACHE_HOME": os.devnull}


def test_a_release_is_not_compiled(released, tmp_path):
    cache = tmp_path / "cache"
    assert pressed(released, NUMBA_CACHE_DIR=str(cache)) == (pytest.approx(FORCE), 1)
    assert not list(cache.rglob("*.nb?"))
    assert pressed(released, **_closed(released)) == (pytest.approx(FORCE), 1)


def test_a_kernel_runs_where_nothing_can_be_stored(site):
    assert pressed(site, **_closed(site)) == (pytest.approx(FORCE), 0)
    assert not list(site.rglob("*.nb?"))


def test_a_release_of_other_sources_or_processors_is_compiled_anew(released):
    cache = {"NUMBA_CACHE_DIR": str(released / "cache")}
    older = {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": "", **cache}
    assert pressed(released, **older) == (pytest.approx(FORCE), 0)
    edited(released)
    assert pressed(released, **cache) == (pytest.approx(2.0 * FORCE), 0)


@pytest.mark.parametrize("kind", ["nbc", "nbi"])
def test_a_damaged_release_is_compiled_anew(released, kind):
    (file,) = released.rglob(f"pressure.pressure_rows*.{kind}")
    _cut_short(file)
    cache = str(released / "cache")
    assert pressed(released, NUMBA_CACHE_DIR=cache) == (pytest.approx(FORCE), 0)
