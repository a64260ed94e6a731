"""The examples in the docstrings of the public face give what they say."""

import doctest
import importlib
import inspect
import os

import pytest

import shellcut

WITHOUT = {
    # what only a run can show: the pages and examples/ do
}

MODULES = sorted(
    {module.__name__ for n in shellcut.__all__ if (module := inspect.getmodule(getattr(shellcut, n)))}
    | {"shellcut.unit", "shellcut.history", "shellcut.length_unit", "shellcut.formats.number_table"}
)


@pytest.mark.parametrize("name", MODULES)
def test_examples_hold(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert doctest.testmod(importlib.import_module(name)).failed == 0


def test_every_public_name_has_an_example():
    without = {n for n in shellcut.__all__ if ">>>" not in (inspect.getdoc(getattr(shellcut, n)) or "")}
    assert without == set(WITHOUT)
