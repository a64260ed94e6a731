"""Units that CAD files state, and what is said of them; no Gmsh is needed."""

import sys
from pathlib import Path

import pytest

from shellcut import read_tool
from shellcut.formats import cad_unit
from shellcut.formats.length_unit import unit_in_mm

DATA = Path(__file__).parent / "data"


@pytest.mark.parametrize(
    ("flag", "length"), [("2,2HMM", 1.0), ("6,1HM", 1e3), ("3,4HINCH", 25.4), ("10,2HCM", 10.0)]
)
def test_flags_of_iges(flag, length):
    text = f"1H,,1H;,5Hmodel,8Ha,b.iges,,6Htester,32,308,15,308,15,,1.,{flag},1,0.01;"
    lines = [f"{text[k : k + 72]:72}G{k // 72 + 1:7}" for k in range(0, len(text), 72)]
    content = "\n".join([f"{'':72}S      1", *lines]).encode()
    assert cad_unit.stated_unit(Path("a.igs"), content) == [length]


def test_a_stated_unit_is_in_the_note():
    assert unit_in_mm(None, 2.0, "the tool", stated=10.0) == (
        10.0,
        "the file states the unit cm, converted to mm: the tool is 20 mm across",
    )


def test_a_missing_gmsh_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "gmsh", None)
    with pytest.raises(ImportError, match=r"needs Gmsh.* pip install 'shellcut\[mesh\]'"):
        read_tool(DATA / "two_teeth_inch.step")


@pytest.mark.parametrize("name", ["two_teeth_inch.step", "two_teeth_inch.iges"])
def test_another_program_states_inches(name):
    path = DATA / name
    assert cad_unit.stated_unit(path, path.read_bytes()) == [25.4]


def test_a_unit_that_only_defines_another_is_none_of_the_file():
    content = b"""ISO-10303-21;
#1=(CONVERSION_BASED_UNIT('INCH',#3)LENGTH_UNIT()NAMED_UNIT(#9));
#2=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));
#4=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));
#5=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#1,#4))REPRESENTATION(''));
"""
    assert cad_unit.stated_unit(Path("a.stp"), content) == [25.4]
    both = content.replace(b"(#1,#4)", b"(#1,#2)")
    assert cad_unit.stated_unit(Path("a.stp"), both) == [1.0, 25.4]
    assert cad_unit.stated_unit(Path("a.stp"), b"ISO-10303-21;") == []
