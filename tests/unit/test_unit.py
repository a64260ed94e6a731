"""Units as people write them, against definitions."""

from math import pi

import pytest

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
