"""Units of length: given, guessed, and stated by CAD files; no Gmsh is needed."""

import sys
from pathlib import Path

import pytest

from shellcut import read_tool
from shellcut.formats import cad_surface
from shellcut.formats.errors import FileError
from shellcut.formats.length_unit import MILLIMETRES, unit_in_mm

DATA = Path(__file__).parent / "data"


@pytest.mark.parametrize(
    ("flag", "length"),
    [
        ("3,5HSMOOT", "got '3' and 'SMOOT': OpenCASCADE reads others as mm"),
        ("2,2HMM", 1.0),
        ("6,1HM", 1e3),
        ("3,4HINCH", 25.4),
        ("10,2HCM", 10.0),
        (",", 25.4),
        ("7,", 1e6),
    ],
)
def test_flags_of_iges(flag, length):
    text = f"1H,,1H;,5Hmodel,8Ha,b.iges,,6Htester,32,308,15,308,15,,1.,{flag},1,0.01;"
    lines = [f"{text[k : k + 72]:72}G{k // 72 + 1:7}" for k in range(0, len(text), 72)]
    content = "\n".join([f"{'':72}S      1", *lines]).encode()
    if isinstance(length, float):
        assert cad_surface.stated_unit(Path("a.igs"), content) == [length]
    else:
        with pytest.raises(FileError, match=length):
            cad_surface.stated_unit(Path("a.igs"), content)


def test_a_unit_is_given_stated_or_safely_guessed():
    for unit, factor in MILLIMETRES.items():
        assert unit_in_mm(unit, 1e9, "the film") == (factor, "")
    note = "the file states the unit cm, converted to mm: the tool is 20 mm across"
    assert unit_in_mm(None, 2.0, "the tool", stated=10.0) == (10.0, note)
    assert unit_in_mm(None, 20.4, "the film")[0] == 1.0
    factor, note = unit_in_mm(None, 0.0204, "the film")
    assert factor == 1000.0
    assert "taken as m, the film is 20.4 mm" in note


@pytest.mark.parametrize("extent", [0.803, 20400.0, 1e-5, 0.0])
def test_what_may_be_several_units_must_be_given(extent):
    with pytest.raises(ValueError, match="the unit must be given, because the film is"):
        unit_in_mm(None, extent, "the film")
    with pytest.raises(ValueError, match=r"unit must be a unit of length \(um, .*\), got 'feet'"):
        unit_in_mm("feet", 1.0, "the film")


def test_a_missing_gmsh_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "gmsh", None)
    with pytest.raises(ImportError, match=r"needs Gmsh.* pip install 'shellcut-fem\[mesh\]'"):
        read_tool(DATA / "two_teeth_inch.step")


def step(*units, used="#1"):
    return f"""ISO-10303-21;
{";".join(units)};
#4=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));
#5=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT(({used},#4))REPRESENTATION(''));
""".encode()


def by_name(name, number, base="#1"):
    return (
        f"#2=(CONVERSION_BASED_UNIT('{name}',#3)LENGTH_UNIT()NAMED_UNIT(#9))",
        f"#3=LENGTH_MEASURE_WITH_UNIT({number},{base})",
    )


MM = "#1=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))"


def test_a_unit_is_what_defines_it_whatever_its_name():
    """As the kernel converts: test_cad_tool compares with it."""

    def stated(*units, used="#2"):
        return cad_surface.stated_unit(Path("a.stp"), step(*units, used=used))

    for name, number, length in (
        ("INCH", "LENGTH_MEASURE(25.4)", 25.4),
        ("CENTIMETRE", "LENGTH_MEASURE(10.)", 10.0),
        ("a span", "228.6", 228.6),
    ):
        # millimetres only define the other unit
        assert stated(MM, *by_name(name, number)) == [length]
        metre = MM.replace(".MILLI.", "$")
        assert stated(metre, *by_name(name, number)) == [1e3 * length]
    assert stated(MM, *by_name("INCH", "25.4"), used="#1,#2") == [1.0, 25.4]
    assert stated(MM.replace("MILLI", "MICRO"), used="#1") == [1e-3]
    assert cad_surface.stated_unit(Path("a.stp"), b"ISO-10303-21;") == []


@pytest.mark.parametrize(
    "units",
    [
        (MM, *by_name("HAND", "4.", base="#2")),  # by a unit that is none of SI
        (MM, *by_name("HAND", "0.")),
        (MM, by_name("HAND", "4.")[0]),
        (
            MM,
            by_name("HAND", "4.")[0].replace("LENGTH_UNIT()", "") + "LENGTH_UNIT()",
            by_name("", 4.0)[1],
        ),
        (MM.replace("MILLI", "PICO").replace("#1", "#2"),),
    ],
)
def test_a_unit_that_the_kernel_passes_over_is_refused(units):
    with pytest.raises(FileError, match=r"unit of length.* #2, must be a metre .* as mm"):
        cad_surface.stated_unit(Path("a.stp"), step(*units, used="#2"))
