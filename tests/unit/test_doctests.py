"""The examples in the docstrings of the public face give what they say."""

import doctest
import importlib
import inspect

import pytest

import shellcut

# Built by other names, or shown by examples/: of these a docstring's example would be a whole run.
WITHOUT = {"Recorder", "Results"}

MODULES = sorted(
    {inspect.getmodule(getattr(shellcut, name)).__name__ for name in shellcut.__all__}
    | {
        "shellcut.card",
        "shellcut.unit",
        "shellcut.formats.length_unit",
        "shellcut.formats.number_table",
    }
)


@pytest.mark.parametrize("name", MODULES)
def test_examples_hold(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    found = doctest.testmod(importlib.import_module(name), optionflags=doctest.ELLIPSIS)
    assert found.failed == 0


def test_every_public_name_has_an_example():
    told = {name: inspect.getdoc(getattr(shellcut, name)) or "" for name in shellcut.__all__}
    assert {name for name, text in told.items() if ">>>" not in text} <= WITHOUT
