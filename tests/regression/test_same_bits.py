"""The same bits from every process: other instructions, other order of compilation, a restart."""

import functools
import json
import os
import subprocess
import sys
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest

from digest_cases import CASES, OPTIONS, digest_of, digests_of, model_of, published, versions
from shellcut.recording.recorder import Recorder
from shellcut.simulation.hooks import StopWhen

# Tried with other instructions, too.
QUICK = ["laminate", "through quads", "pierced", "crossing", "opening on M1", "disc"]
# With these a mutant is tried first (tests/mutants.py), so the shortest come first.
SHORT = ["laminate", "through quads", "stress", "crossing", "trouser", "pierced"]
SHORT += ["tight", "opening on M1", "moved", "disc"]

OTHER_SUM = """
import builtins, math, os, runpy, sys
plain = builtins.sum
def other(numbers, start=0):
    numbers = list(numbers)
    floats = numbers and all(type(one) is float for one in numbers)
    return math.fsum([start, *numbers]) if floats else plain(numbers, start)
builtins.sum = other
del sys.argv[0]
sys.path.insert(0, os.path.dirname(sys.argv[0]))
runpy.run_path(sys.argv[0], run_name="__main__")
"""
"""Runs a program with another sum of floats in the last digit, as that of Python 3.12 is."""


def elsewhere(names, **environment):
    """Return the digests from a process of its own, with another sum."""
    command = [sys.executable, "-c", OTHER_SUM, str(Path(__file__).parent / "digest_cases.py")]
    command += names
    environment = {**os.environ, **environment}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    return {name: tuple(row) for name, row in json.loads(done.stdout).items()}


def of_level_three():
    """Return the variables by which NumPy uses what every x86-64-v3 processor has."""
    found = np.show_config(mode="dicts")["SIMD Extensions"]["found"]
    beyond = [name for name in found if "512" in name or name == "X86_V4"]
    return {"NPY_DISABLE_CPU_FEATURES": " ".join(beyond)}


@functools.cache
def here(name):
    """Return digest, steps and splits of a case, run in this process once."""
    return digests_of([name])[name]


@pytest.mark.parametrize("name", SHORT)
def test_the_published_digests(name):
    check_published({name: here(name)})


def test_numpy_without_the_instructions_of_newer_processors():
    runs = {name: here(name) for name in QUICK}
    assert all(n_split for _, _, n_split in runs.values())
    assert elsewhere(QUICK, **of_level_three()) == runs


def test_a_run_on_two_threads_that_was_stopped_and_resumed_on_one(tmp_path):
    case = model_of("through quads").with_threads(2).build()
    sim = case.simulation
    made = Recorder(sim, tmp_path / "out", until=case.duration, name=case.name, **OPTIONS)
    with closing(made) as record:
        sim.run(case.duration, [record, StopWhen(lambda: sim.state.step >= 3000)])
    assert digest_of("through quads", tmp_path) == here("through quads")


def check_published(found):
    said, digests = published()
    assert digests.keys() == CASES.keys()
    if said != f"Versions: {versions()}.":
        pytest.skip(f"published for other versions: {said}")
    assert {name: row[0][:16] for name, row in found.items()} == {n: digests[n] for n in found}, (
        "if this is meant, write docs/same-bits.md anew: python tests/regression/digest_cases.py"
    )


@pytest.mark.slow
def test_kernels_of_level_three_and_a_cache_that_is_partly_filled(tmp_path):
    found = digests_of(CASES)
    check_published(found)
    level = {"NUMBA_CPU_NAME": "x86-64-v3", "NUMBA_CPU_FEATURES": ""} | of_level_three()
    level["NUMBA_CACHE_DIR"] = str(tmp_path)
    elsewhere(["trouser"], **level)  # fills a part
    assert elsewhere(CASES, **level) == found


@pytest.mark.slow
def test_compiled_now_or_before(tmp_path):
    cache = {"NUMBA_CACHE_DIR": str(tmp_path)}
    assert elsewhere(["opening"], **cache) == elsewhere(["opening"], **cache)
