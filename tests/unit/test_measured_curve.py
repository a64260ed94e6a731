"""Curves as test machines write them, and what is said of those that cannot be read."""

import numpy as np
import pytest

from shellcut.formats.errors import FileError
from shellcut.results.measured_curve import MeasuredCurve, read_measured_curve

ANGLE = [0.0, 0.5, 1.0, 1.5]
TORQUE = [0.0, 13.2, 26.0, 25.5]  # N*mm


def curve(tmp_path, text, *columns, encoding="utf-8", **options):
    path = tmp_path / "measured.csv"
    path.write_bytes(text.encode(encoding))
    return read_measured_curve(path, *columns, **options)


@pytest.mark.parametrize(
    ("text", "encoding"),
    [
        ("Winkel [Grad];Drehmoment [Ncm]\n0,0;0,00\n0,5;1,32\n1,0;2,6\n1,5;2,55\n", "utf-8"),
        ("angle (deg),torque (N*mm)\n0,0\n0.5,13.2\n1,26\n1.5,25.5\n", "utf-8-sig"),
        (
            "Prüfung 3;12.05.2024\r\nTempo;10;mm/s\r\n\r\nWinkel;Moment\r\n[°];[N·cm]\r\n"
            "0;0\r\n0,5;1,32\r\n1;2,6\r\n1,5;2,55\r\n",
            "latin-1",
        ),
        ("angle\ttorque\ndeg\tN*m\n0\t0\n0,5\t0,0132\n1\t0,026\n1,5\t0,0255\n", "utf-16"),
        (
            "# made by hand\nangle [deg]  torque [Nmm]\n  0,0  0\n 0,5 1,32e1\n"
            "% pause\n\n 1,0 26 # end of ramp\n 1,5 25,5\n",
            "utf-8",
        ),
        (
            '"angle / deg","torque / mN*m"\n"0,0","0"\n"0,5","13,2"\n"1","26"\n"1,5","25,5"\n',
            "ascii",
        ),
        ("angle [deg];torque [N*cm];\n0;0;\n0.5;1.32;\n1;2.6;\n1.5;2.55;\n", "ascii"),
    ],
    ids=["semicolons", "commas", "units line", "utf-16 tabs", "blanks", "quoted", "closed rows"],
)
def test_the_same_curve_in_many_writings(tmp_path, text, encoding):
    found = curve(tmp_path, text, encoding=encoding)
    np.testing.assert_array_equal(found.x, ANGLE)
    np.testing.assert_allclose(found.y, TORQUE, rtol=1e-14)  # one rounding of the factor
    assert (found.x_unit, found.y_unit) == ("deg", "N*mm")
    assert found.notes == ()


WIDE = (
    "Zeit [s];Winkel [deg];Kraft [N];Drehmoment [Ncm];Status\n"
    "0;0;1;0;ok\n1;0,5;;1,32;ok\n2;1;3;2,6;ok\n3;1,5;4;2,55;stop\n"
)


@pytest.mark.parametrize(
    "columns", [("Winkel", "Drehmoment"), ("winkel", "drehmoment [ncm]"), (2, 4), ("2", "4")]
)
def test_columns_by_name_or_number_others_may_hold_anything(tmp_path, columns):
    found = curve(tmp_path, WIDE, *columns)
    np.testing.assert_array_equal(found.x, ANGLE)
    np.testing.assert_allclose(found.y, TORQUE, rtol=1e-14)
    assert (found.x_name, found.y_name) == ("Winkel", "Drehmoment")


def test_units_given_are_taken_and_said_where_others_are_written(tmp_path):
    text = "Weg [mm];Kraft [N]\n0;0\n1;2\n"
    found = curve(tmp_path, text, units="in, N")
    np.testing.assert_allclose(found.x, [0.0, 25.4], rtol=1e-15)
    assert found.notes == ("Weg has the heading unit mm, but is read as in as given",)
    found = curve(tmp_path, "0 0\n1 2\n2 4\n", units=("rad", "lbf*in"))
    np.testing.assert_allclose(found.x, np.degrees([0.0, 1.0, 2.0]), rtol=1e-14)
    np.testing.assert_allclose(found.y, np.array([0.0, 2.0, 4.0]) * 112.984829, rtol=1e-8)
    assert found.x_name == "column 1"
    with pytest.raises(ValueError, match="units must be two"):
        curve(tmp_path, "0 0\n1 1\n", units="deg")


def test_falling_standing_and_jittering_coordinates():
    found = MeasuredCurve([2.0, 1.0, 1.0, 0.0], [8.0, 3.0, 5.0, 1.0], "mm", "N")
    np.testing.assert_array_equal(found.x, [0.0, 1.0, 2.0])
    np.testing.assert_array_equal(found.y, [1.0, 4.0, 8.0])
    assert [note.split()[0] for note in found.notes] == ["the", "1"]
    noisy = MeasuredCurve([0.0, 50.0, 49.9, 100.0], [0.0, 2.0, 1.0, 3.0], "deg", "N*mm")
    np.testing.assert_array_equal(noisy.y, [0.0, 1.0, 2.0, 3.0])
    assert noisy.notes == ("1 points ran back by up to 0.1",)


@pytest.mark.parametrize(
    ("text", "columns", "words"),
    [
        ("", (), ["the file is empty"]),
        ("# nothing\n", (), ["a line of headings and lines of numbers"]),
        (
            "a [deg];b [N]\n0;0\n1;x\n2\n3;1.234,5\n4;\n",
            (),
            [
                "line 3: must be a number, got 'x'",
                "line 4: there must be 2 numbers, got 1",
                "line 5: thousands separators are not read, got '1.234,5'",
                "line 6: a number is missing",
            ],
        ),
        (
            "a [deg];b [N]\n0;0.5\n1;1,234\n",
            (),
            ["got '0.5' in line 2 and '1,234' in line 3", "thousands separators are not read"],
        ),
        (
            "a [deg],b [N]\n0,0,1,5\n0,5,1,5\n",
            (),
            ["4 columns without headings; if these are decimal commas"],
        ),
        (WIDE, (), ["a table of 5 columns", "2: 'Winkel [deg]'"]),
        (WIDE, ("Winkl", "Moment"), ["did you mean 'Winkel'?", "no column 'Moment'"]),
        (WIDE, (0, 6), ["from 1 to 5, got 0", "from 1 to 5, got 6"]),
        (WIDE, (2, 3), ["line 3: a number is missing"]),
        (WIDE, (2, 5), ["the unit of Status must be given"]),
        ("a;b [furlong]\n0;0\n1;1\n", (), ["unit of a must", "force: mN, cN, N,", "got 'furlong'"]),
        ("a [mm];b [N]\na;b\n", (), ["line 2"]),
        ("a [mm];a [N]\n0;0\n1;1\n", ("a", "a"), ["'a' is the heading of columns 1 and 2"]),
        ("a [mm];b [N]\n0;0\n5;1\n9;2\n4;1\n0;0\n10;1\n", (), ["reverses at 4", "in line 5"]),
        ("a [mm];b [N]\n10;1\n0;0\n4;1\n3;0\n", (), ["reverses at 0: in this row", "line 3"]),
        ("a [mm];b [N]\n0;0\n1;1\n2;2\n3;3\n-5;4\n", (), ["at -5: in this row", "line 6"]),
        ("a [mm];b [N]\n9;0\n8;1\n7;2\n6;3\n90;4\n", (), ["at 90: in this row", "line 6"]),
        ("a [mm];b [N]\n0;0\n1;1\n99;2\n3;3\n4;4\n", (), ["at 99: in this row", "line 4"]),
        ("a [mm];b [N]\n0;0\n5;1\n9;2\n5;1\n1;0\n", (), ["at 5: keep one stroke", "line 5"]),
        ("a [mm];b [N]\n1;0\n1;1\n", (), ["all 2 points are at 1"]),
        ("a [mm];b [N]\n1;0\n", (), ["same length of two or more"]),
        (f"{'a' * 200_000} [mm];b [N]\n1;0\n2;0\n", ("c",), ["2 columns without headings"]),
        ("a [mm];b [N]\n1;0\n2;nan\n", (), ["must be finite, they are not in lines 3"]),
    ],
)
def test_refusals(tmp_path, text, columns, words):
    with pytest.raises(FileError) as caught:
        curve(tmp_path, text, *columns)
    for word in words:
        assert word in str(caught.value)


def test_arrays_are_checked():
    with pytest.raises(ValueError, match=r"finite, .* rows 1; x_unit: unit must .* got 'ell'"):
        MeasuredCurve([0.0, np.nan], [0.0, 1.0], "ell", "N")
    with pytest.raises(ValueError, match=r"got shapes \(2,\) and \(3,\)"):
        MeasuredCurve([0.0, 1.0], [0.0, 1.0, 2.0], "mm", "N")
