"""Machine code kept on disk: of these very sources, and whole, or compiled anew."""

import importlib
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numba
import pytest

import shellcut

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
        for one in ("of_a_version", "called"):
            sys.modules.pop(one, None)
        return importlib.import_module(name)

    yield imported
    for one in ("of_a_version", "called"):
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


def _of_other_content(file):
    file.write_bytes(b"\x80\x05not what was stored here")


def _a_bit_turned(file):
    content = bytearray(file.read_bytes())
    content[-len(content) // 3] ^= 1
    file.write_bytes(content)


def _emptied(file):
    file.write_bytes(b"")


@pytest.mark.parametrize("damage", [_cut_short, _of_other_content, _a_bit_turned, _emptied])
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


def test_a_kernel_runs_where_nothing_can_be_stored(tmp_path, version, monkeypatch):
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path / "file" / "cache"))
    (tmp_path / "file").write_text("a file where the folder should be")
    locators = numba.core.caching.CacheImpl._locator_classes
    told = [
        one for one in locators if "UserProvided" in one.__name__
    ]  # _UserProvided in Numba 0.61
    monkeypatch.setattr("numba.core.caching.CacheImpl._locator_classes", told)
    (tmp_path / "of_a_version.py").write_text(_OF_A_VERSION.format(name="Bars"))
    assert version("of_a_version").found == (2.0, 2.0)


def test_an_edit_of_what_a_kernel_calls_changes_its_result(tmp_path, version):
    (tmp_path / "of_a_version.py").write_text(
        "from shellcut.numerics.jit import kernel\n"
        "from called import scale\n"
        "@kernel\n"
        "def scaled(number):\n"
        "    return scale(number)\n"
    )
    for factor in (2.0, 30.0):  # of another length: Python compares size and second
        (tmp_path / "called.py").write_text(
            "from shellcut.numerics.jit import inline\n"
            "@inline\n"
            f"def scale(number): return {factor} * number\n"
        )
        assert version("of_a_version").scaled(1.0) == factor


_PULLED_CABLE = """
import json
import numpy as np
from shellcut import CohesiveLaw
from shellcut.cables.directional_cable import _energies

law = CohesiveLaw(
    strength=18.0, plateau=12.0, opening_a=0.5, opening_p=3.0, opening_u=4.0
).parameters()
stored, dissipated = np.zeros(1), np.zeros(1)
_energies(np.zeros(1, np.int8), np.ones(1), np.ones(1), law, 45.0, stored, dissipated)
hits = sum(_energies.stats.cache_hits.values())
print(json.dumps({"energy": stored[0] + dissipated[0], "loaded": hits}))
"""


def test_an_upgraded_package_computes_by_its_own_sources(tmp_path):
    """The cable's kernel stands in another file than the law of which it holds a copy."""
    site = tmp_path / "site"
    shutil.copytree(Path(shellcut.__file__).parent, site / "shellcut")
    environment = {
        **os.environ,
        "PYTHONPATH": str(site),
        "NUMBA_CACHE_DIR": str(tmp_path / "cache"),
    }

    def run():
        command = [sys.executable, "-c", _PULLED_CABLE]
        out = subprocess.run(
            command, cwd=tmp_path, env=environment, check=True, capture_output=True, text=True
        )
        return json.loads(out.stdout)

    assert run() == {"energy": pytest.approx(0.5 * (18.0 + 12.0) * 0.5 + 12.0 * 0.5), "loaded": 0}
    law = site / "shellcut" / "cables" / "cohesive_law.py"
    text = law.read_text()
    assert text.count("area += law[1] *") == 1
    law.write_text(text.replace("area += law[1] *", "area += 2.0 * law[1] *"))
    doubled = pytest.approx(0.5 * (18.0 + 12.0) * 0.5 + 2.0 * 12.0 * 0.5)
    assert run() == {"energy": doubled, "loaded": 0}
    assert run() == {"energy": doubled, "loaded": 1}
