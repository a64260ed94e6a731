"""Options are declared once: what is out of bounds, not finite or no choice is refused by name."""

import inspect
import re
from dataclasses import FrozenInstanceError, fields, is_dataclass
from typing import Literal, get_args, get_origin

import numpy as np
import pytest

import shellcut
from shellcut import Anisotropy, meshing, tool_shapes
from shellcut.arguments import declared
from shellcut.model_file.section_table import LISTS, SECTIONS
from shellcut.recording.run_options import RunOptions
from shellcut.tool.shapes import round_bar

KINDS = {k for of in (SECTIONS, LISTS) for s in of.values() for kinds in s.values() for k in kinds}
OWNERS = {key.owner for kind in KINDS for key in kind.keys.values()} - {None}
OWNERS |= {getattr(shellcut, name) for name in shellcut.__all__}
OWNERS |= {meshing.annulus, meshing.cylinder, tool_shapes.tooth_ring, round_bar}
OWNERS = sorted(
    (o for o in OWNERS if inspect.isroutine(o) or is_dataclass(o)), key=lambda o: o.__qualname__
)


def wrong_values(kind, option):
    first = next(iter(get_args(kind)), kind)
    if get_origin(first) is Literal or isinstance(first, str):
        return ["nonsense"]
    if first not in (float, int):
        return []
    beyond = [(option.above, 0), (option.least, -1), (option.below, 0), (option.most, 1)]
    bad = [type(bound)(bound + away) for bound, away in beyond if bound is not None]
    return [*bad, np.nan, np.inf] if first is float else bad


NO_NUMBERS = (True, "1678", 1.0 + 0.0j, [1.0], np.ones(2), np.ma.masked)


def cases():
    for owner in OWNERS:
        for name, (kind, option, _) in declared(owner).items():
            for value in wrong_values(kind, option):
                yield pytest.param(owner, name, value, id=f"{owner.__qualname__}-{name}-{value}")


def needed(owner):
    """Something for every argument that must be given; nothing is made of it."""
    given = {}
    for name, parameter in inspect.signature(owner).parameters.items():
        if parameter.default is parameter.empty and parameter.kind is not parameter.VAR_KEYWORD:
            kind = declared(owner)[name].kind if name in declared(owner) else None
            given[name] = {float: 1.0, int: 12, str: "x"}.get(kind, (1.0, 0.0, 0.0))
    return given


@pytest.mark.parametrize(("owner", "name", "value"), list(cases()))
def test_what_cannot_be_is_refused_by_name(owner, name, value):
    kind, option, _ = declared(owner)[name]
    unit = re.escape(option.unit) if kind is float else ""
    with pytest.raises(ValueError, match=rf"\b{name} must be .*got .*{value}.*{unit}"):
        owner(**{**needed(owner), name: value})


@pytest.mark.parametrize("owner", OWNERS, ids=lambda owner: owner.__qualname__)
def test_what_is_no_number_is_refused_by_name(owner):
    for name, (kind, _, _) in declared(owner).items():
        more = {float: (), float | None: (), int: (2.5,), int | None: (2.5,)}.get(kind)
        for given in () if more is None else (*NO_NUMBERS, *more):
            with pytest.raises(ValueError, match=rf"\b{name}\b"):
                owner(**{**needed(owner), name: given})


@pytest.mark.parametrize("owner", OWNERS, ids=lambda owner: owner.__qualname__)
def test_its_docstring_tells_them(owner):
    if owner is not shellcut.Simulation:  # whose docstring is that of the class
        for name, (_, option, _) in declared(owner).items():
            assert f"\n{name} : " in inspect.getdoc(owner)
            assert option.text in inspect.getdoc(owner)


def test_all_that_is_wrong_is_told_at_once():
    with pytest.raises(ValueError, match=r"along must be a number.*; across must be positive"):
        Anisotropy(direction=(1.0, 0.0, 0.0), along="x", across=-1.0)


def test_an_argument_that_there_is_not_is_told_with_those_that_are():
    with pytest.raises(TypeError, match="no argument safty; did you mean safety"):
        shellcut.Stepping(safty=0.5)
    with pytest.raises(ValueError, match=r"no argument overwrite; there are n_row, .*replace"):
        RunOptions(overwrite=True)


@pytest.mark.parametrize(
    "name", [n for n in shellcut.__all__ if is_dataclass(getattr(shellcut, n))]
)
def test_what_a_model_is_built_of_cannot_be_changed(name):
    """A checkpoint compares it, and what is derived from it is computed once."""
    public = getattr(shellcut, name)
    one = object.__new__(public)
    with pytest.raises(FrozenInstanceError):
        setattr(one, fields(public)[0].name, 1.0)
