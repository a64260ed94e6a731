"""Tables of poses as text."""

import numpy as np
import pytest

from shellcut.formats.errors import FileError
from shellcut.tool.table_motion import TableMotion


def table(tmp_path, text, encoding="utf-8"):
    path = tmp_path / "motion.csv"
    path.write_bytes(text.encode(encoding))
    return TableMotion.read_csv(path)


def refusal(tmp_path, text):
    with pytest.raises(FileError) as caught:
        table(tmp_path, text)
    return str(caught.value)


@pytest.mark.parametrize(
    "text",
    [
        "time [s],z [mm],angle [deg]\n0,0,0\n0.001,-0.5,90\n0.002,-1,180\n",
        "# a press\ntime [ms]; angle [deg]; z [um]\n0,0; 0; 0\n1,0; 90; -500,0\n2; 180; -1e3\n",
        "Time (ms)\tAngle (turn)\tZ (cm)\n0\t0\t0\n1\t0,25\t-0,05\n2\t0,5\t-0,1\n",
        "\ufefftime / us,rz / rad,z / m\r\n\r\n0,0,0\r\n1000,1.5707963267948966,-5e-4\r\n"
        "2000,3.141592653589793,-1e-3\r\n",
        '"time [s]","z [mm]","rz [deg]"\n"0","0","0"\n"0.001","-0.5","90"\n"0.002","-1","180"\n',
    ],
)
def test_headings_units_separators_and_decimal_commas(tmp_path, text):
    motion = table(tmp_path, text)
    np.testing.assert_allclose(motion.times, [0.0, 1e-3, 2e-3], rtol=1e-15)
    np.testing.assert_allclose(motion.translations, [[0, 0, z] for z in (0.0, -0.5, -1.0)])
    np.testing.assert_allclose(
        motion.rotation_vectors, [[0, 0, a] for a in (0.0, np.pi / 2, np.pi)], rtol=1e-15
    )
    assert motion.coordinate_unit == "rad"


def test_without_turn_the_coordinate_is_the_path(tmp_path):
    motion = table(tmp_path, "x [mm],time [s]\n0,0\n3,1\n")
    assert motion.coordinate_unit == "mm"
    assert motion.coordinate(1.0) == pytest.approx(3.0, rel=1e-12)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("# nothing\n", "a line of headings"),
        ("time,z [mm]\n0,0\n", "a heading must be 'name [unit]' of time, x, y, z"),
        ("time [s],w [mm]\n0,0\n", "got 'w [mm]'"),
        ("time [h]\n0\n", "time must be a unit of time (us, ms, s, min), got 'h'"),
        ("time [s],time [ms]\n0,0\n", "each column must occur once, got time again"),
        ("x [mm]\n0\n", "there must be a column time"),
        ("time [s],angle [deg],rz [deg]\n0,0,0\n", "as angle or as rx, ry, rz, got both"),
        ("time [s],z [mm]\n0,0\n", "two lines of numbers or more, got 1"),
        ("time [s],z [mm]\n0,0\n1\n", "line 3: there must be 2 numbers, got 1"),
        ("time [s],z [mm]\n0,0\n1,x\n", "line 3: must be a number, got 'x'"),
        ("time [s],z [mm]\n0,0\n0,1\n", "times must increase"),
        ("time [s],angle [deg]\n0,0\n1,170\n", "must turn by less than 135 degrees"),
        ("time [s],z [mm]\n0,0\n1,nan\n", "translations must be finite"),
    ],
)
def test_refusals(tmp_path, text, words):
    assert words in refusal(tmp_path, text)
