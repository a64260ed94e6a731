"""Units and numbers with units as people write them, against definitions."""

import re
from math import pi

import pytest

from shellcut.model_file.quantity import quantity
from shellcut.model_file.section_table import LISTS, SECTIONS
from shellcut.unit import DIMENSIONS, LIBRARY_UNITS, canonical, conversion, dimension


@pytest.mark.parametrize(
    ("unit", "to", "factor"),
    [
        ("N*m", "N*mm", 1000.0),
        ("N·m", "N*mm", 1000.0),
        ("Nm", "N*mm", 1000.0),
        ("N cm", "N*mm", 10.0),
        ("mNm", "N*mm", 1.0),
        ("lbf*in", "N*mm", 112.9848290276167),
        ("in-lb", "N*mm", 112.9848290276167),
        ("ozf*in", "N*mm", 7.061551814226043),
        ("kgf*cm", "N*mm", 98.0665),
        ("lb", "N", 4.4482216152605),
        ("MilliMeter", "mm", 1.0),
        ("Ell", "mm", None),
        ("Grad", "rad", pi / 180.0),
        ("°", "deg", 1.0),
        ("gon", "deg", 0.9),
        ("rad", "deg", 180.0 / pi),
        ("INCH", "mm", 25.4),
        ("µm", "mm", 1e-3),
        ("ms", "s", 1e-3),
        ("N/mm²", "MPa", 1.0),
        ("N/m²", "MPa", 1e-6),
        ("kgf/mm²", "MPa", 9.80665),
        ("kgf / cm^2", "MPa", 0.0980665),
        ("lbf/in2", "psi", 1.0),
        ("kg/mm²", "MPa", None),  # of mass
        ("N/mm", "N", None),
        ("%/min", "%", None),
        ("lbF", "N", 4.4482216152605),
        ("KN", "N", 1000.0),
        ("cN·m", "N*mm", 10.0),
        ("in/in", "-", 1.0),
        ("mm/m", "-", 1e-3),
        ("µm/m", "%", 1e-4),
        ("kN/mm^2", "MPa", 1000.0),
        ("psi", "MPa", 0.006894757293168361),
        ("mm/mm", "-", 1.0),
        ("nm", "N*mm", None),
        ("MN", "N", None),
    ],
)
def test_factors(unit, to, factor):
    if factor is None:
        with pytest.raises(ValueError, match=f"got '{unit}'"):
            conversion(unit, to)
    else:
        assert conversion(unit, to) == pytest.approx(factor, rel=1e-12)


def test_every_unit_is_its_own_name_in_one_dimension():
    for what, sizes in DIMENSIONS.items():
        for unit in sizes:
            assert (canonical(unit), dimension(unit)) == (unit, what)
        assert LIBRARY_UNITS[what] in sizes


def test_factors_are_the_nearest_doubles():
    # Angles of motions in a table are multiplied by them: pi is a double, the rest is exact.
    assert conversion("deg", "rad") == pi / 180.0
    assert conversion("turn", "rad") == 2.0 * pi
    assert conversion("rad", "deg") == 180.0 / pi
    assert conversion("mil", "um") == 25.4


def test_the_wrong_dimension_is_said():
    with pytest.raises(ValueError, match=r"unit of force .*got 'Nmm', one of torque"):
        conversion("Nmm", "N")


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("43.5 kJ/m^2", "N/mm", 43.5),
        ("43.5 kJ/m²", "N/mm", 43.5),
        ("0.92 g/cm3", "t/mm^3", 9.2e-10),
        ("920 kg/m^3", "t/mm^3", 9.2e-10),
        ("12 um", "mm", 0.012),
        ("12µm", "mm", 0.012),
        ("1.678 GPa", "MPa", 1678.0),
        ("1678 N/mm^2", "MPa", 1678.0),
        ("6 m/s", "mm/s", 6000.0),
        ("9.81 m/s^2", "mm/s^2", 9810.0),
        ("1e-3 N*m", "N*mm", 1.0),
        ("0.25 turn", "deg", 90.0),
        ("-.5", "mm", -0.5),
        ("2 inch", "mm", 50.8),
        ("1 in", "mm", 25.4),
        ("100 gon", "deg", 90.0),
        ("1 kgf*m", "N*mm", 9806.65),
        ("180 degrees/s", "deg/s", 180.0),
        ("3", "", 3.0),
    ],
)
def test_the_very_double_of_the_decimal(text, unit, value):
    assert quantity(text, unit) == value


@pytest.mark.parametrize(
    ("text", "unit", "said"),
    [
        ("43.5 kJ/m^2", "MPa", "must be a number in MPa, got '43.5 kJ/m^2', which is in N/mm"),
        ("3 mm", "", "must be a number without a unit, got '3 mm', which is in mm"),
        ("3 s", "mm/s", "must be a number in mm/s, got '3 s', which is in s"),
        ("3 furlong", "mm", "must have a unit made of um, mm, cm"),
        ("twelve", "mm", "must be a number in mm, got 'twelve'"),
        ("", "mm", "must be a number in mm, got ''"),
        ("1,5 mm", "mm", "got '1,5 mm'"),
    ],
)
def test_what_is_no_such_number(text, unit, said):
    with pytest.raises(ValueError, match=re.escape(said)):
        quantity(text, unit)


def test_the_units_of_all_keys_are_those_of_the_library():
    # One of each unit is one: mm, N, s, tonne, MPa, and angles as the key's name says.
    units = {
        key.option.unit
        for layout in (SECTIONS, LISTS)
        for sections in layout.values()
        for kinds in sections.values()
        for kind in kinds
        for key in kind.keys.values()
    }
    assert {"mm", "MPa", "t/mm^3", "deg", "s"} <= units
    for unit in units - {""}:
        assert quantity(f"1 {unit}", unit) == 1.0
        if unit != "rad/s":
            assert quantity(f"1 {unit}", unit.replace("MPa", "N/mm^2")) == 1.0
