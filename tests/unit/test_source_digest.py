"""Digest of a law's sources, by which Numba's cache tells one version of a law from another."""

import importlib.util
import math

import pytest

from shellcut import Elastic, JohnsonCook, Linear, Swift, Table, Voce
from shellcut.material import PointLaw
from shellcut.material.rate_factor import RateFactor
from shellcut.material.return_mapping import make_flow

FOIL = Elastic(70_000.0, 0.33, 2.7e-9)
LAW = """
from helpers import moduli
import more_helpers
def stress(p, strain, history, dt):
    return moduli(p, strain), 0.0, 0.0, history
def thickness_stretch(p, strain, history):
    return more_helpers.one()
"""
FILES = {
    "helpers": "from deep import scale\ndef moduli(p, strain):\n    return scale(strain)\n",
    "more_helpers": "def one():\n    return 1.0\n",
    "deep": "FACTOR = 2.0\ndef scale(strain):\n    return (FACTOR * strain[0], 0.0, 0.0)\n",
    "aside": "def other():\n    return 0.0\n",
    "law": LAW,
}


def _law_in(folder, monkeypatch):
    """Import the files of a folder anew and make the law."""
    monkeypatch.syspath_prepend(str(folder))
    for name in ("deep", "aside", "helpers", "more_helpers", "law"):
        spec = importlib.util.spec_from_file_location(name, folder / f"{name}.py")
        module = importlib.util.module_from_spec(spec)
        monkeypatch.setitem(__import__("sys").modules, name, module)
        spec.loader.exec_module(module)
    return PointLaw("one of a test", module.stress, module.thickness_stretch)


@pytest.mark.parametrize(
    ("edited", "changes"),
    [("law", True), ("helpers", True), ("more_helpers", True), ("deep", True), ("aside", False)],
)
def test_an_edit_of_any_module_that_a_law_calls_changes_its_digest(
    edited, changes, tmp_path, monkeypatch
):
    first, second = tmp_path / "first", tmp_path / "second"
    for folder in (first, second):
        folder.mkdir()
        for name, text in FILES.items():
            (folder / f"{name}.py").write_text(text)
    with (second / f"{edited}.py").open("a") as file:
        file.write("# another version\n")
    laws = [_law_in(folder, monkeypatch) for folder in (first, second)]
    assert (laws[0].digest != laws[1].digest) == changes


def test_functions_that_kernels_call_have_names_of_their_own_in_each_law():
    # Kernels from Numba's cache are linked by these names.
    rate = RateFactor.function
    made = [
        make_flow(one.function, one.slope, rate, has_rate=False, n_mode=n_mode)
        for one in (Linear, Swift, Voce, Table)
        for n_mode in (2, 3)
    ]
    made.append(make_flow(Linear.function, Linear.slope, JohnsonCook.function, True, 2))
    names = {getattr(one, "py_func", one).__qualname__ for one in made}
    assert len(names) == len(made)


def test_functions_without_a_file_count_by_their_code():
    def made(text):
        space = {"math": math}
        exec(text, space)
        return PointLaw("typed in", space["stress"], space["stress"])

    one = made("def stress(p, strain, history, dt=0.0): return strain, 0.0, 0.0, history")
    same = made("def stress(p, strain, history, dt=0.0): return strain, 0.0, 0.0, history")
    other = made("def stress(p, strain, history, dt=0.0): return strain, 1.0, 0.0, history")
    assert one.digest == same.digest
    assert one.digest != other.digest
