"""Figures of a comparison against closed forms, and the command around them."""

import json
import re

import numpy as np
import pytest

import shellcut
from run_folder import write_run
from shellcut.command_line import main
from shellcut.formats.errors import FileError
from shellcut.results.measured_curve import MeasuredCurve, read_measured_curve
from steady_cut import edge, edge_columns

ANGLE = np.linspace(0.0, 90.0, 1801)
# Broken lines through a smooth curve of one wave: their error is (step)²/8 of the curvature, for
# the measured 181 points (0.5 deg, 3.5e-2 rad of the wave) 1.5e-4 of the amplitude.
WAVE = 4.0
DISCRETISATION = 2e-4


# Of a history with no more than a torque.
NO_MEAN = (
    "no steady window, so no mean: the history has no cut length, as of a tool without "
    "cutting edges",
)


def sine(angle, shift=0.0):
    return 140.0 * np.sin(WAVE * np.radians(angle - shift))


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    return write_run(tmp_path_factory.mktemp("comparison") / "out", "wave", ANGLE, sine(ANGLE))


def measured(y, x=ANGLE[::10], unit="N*mm"):
    return MeasuredCurve(x, y, "deg", unit)


def test_a_curve_beside_itself_differs_by_nothing_and_a_scaled_one_by_its_scale(run):
    found = shellcut.compare(run, measured(sine(ANGLE[::10])))
    assert found.rms == 0.0
    assert found.peak_error == pytest.approx(0.0, abs=DISCRETISATION)
    assert found.correlation == pytest.approx(1.0, rel=1e-12)
    assert found.range == (0.0, 90.0)
    assert found.notes == NO_MEAN
    found = shellcut.compare(run, measured(0.8e-3 * sine(ANGLE[::10]), unit="N*m"))
    assert (found.y_unit, found.work_unit) == ("N*mm", "N*mm")
    assert found.peak_measured == pytest.approx(0.8 * 140.0, rel=DISCRETISATION)
    assert found.peak_error == pytest.approx(0.25, rel=10 * DISCRETISATION)
    # over whole waves the mean of sin² is a half, of the trapezoidal rule too
    assert found.rms == pytest.approx(0.2 * 140.0 / np.sqrt(2.0), rel=1e-12)
    assert found.rms_relative == pytest.approx(found.rms / (0.8 * 140.0), rel=DISCRETISATION)
    assert found.correlation == pytest.approx(1.0, rel=1e-12)
    # Points that lie close do not count for more.
    x = np.union1d(ANGLE[::10], np.linspace(20.0, 25.0, 5001))
    crowded = shellcut.compare(run, measured(0.8 * sine(x), x))
    assert crowded.rms == pytest.approx(found.rms, rel=10 * DISCRETISATION)


def test_the_work_is_the_integral(run):
    half = ANGLE[ANGLE <= 45.0]
    found = shellcut.compare(run, measured(0.5 * sine(half), half))
    # of half a wave: 2 amplitude / wave number
    assert found.work_simulated == pytest.approx(2.0 * 140.0 / WAVE, rel=DISCRETISATION)
    assert found.work_error == pytest.approx(1.0, rel=DISCRETISATION)
    assert found.notes == (
        "the ranges overlap only partly: measured 0° to 45°, simulated 0° to 90°",
        *NO_MEAN,
    )


def test_the_mean_is_of_the_steady_window_of_the_run(tmp_path):
    cut = edge_columns([edge(ANGLE)])
    rises = 100.0 + 0.02 * ANGLE
    work = np.radians(100.0 * ANGLE + 0.01 * ANGLE**2)
    run = write_run(tmp_path / "out", "steady", ANGLE, rises, tool_work=work, **cut)
    found = shellcut.compare(run, measured(0.8 * rises[::10]))
    low, high = found.steady_range
    window = shellcut.read(run).steady_window
    assert (low, high) == (window.low, window.high)
    # Of a straight line: its value in the middle.
    assert found.mean_simulated == pytest.approx(100.0 + 0.01 * (low + high), rel=1e-12)
    # Of the rise over the window, by the cosines of a line: sqrt(2) 2/pi² of it, and 1/9.
    of_line = 2.0 * np.sqrt(2.0) / np.pi**2 * np.sqrt((1.0 + 3.0**-4 + 5.0**-4) / 6.0)
    expected = 2.4469 * of_line * 0.02 * (high - low)
    assert found.mean_simulated_half_width == pytest.approx(expected, rel=1e-3)
    assert found.mean_measured_half_width == pytest.approx(0.8 * expected, rel=1e-3)
    assert found.mean_error == pytest.approx(0.25, rel=1e-12)
    assert found.notes == ()
    assert re.search(rf"mean over {low:.3g}-{high:.3g}° +80\.\S* N·mm +10[01]", str(found))
    # Of which there is no difference, nor its unit.
    assert re.search(r"(?m)± of the mean, 95 % +0\.\d+ N·mm +0\.\d+ N·mm *$", str(found))
    content = json.loads(found.to_json(tmp_path / "c.json").read_text())
    assert content["steady_range"] == [low, high]
    assert content["figures"]["mean_simulated"] == {"value": found.mean_simulated, "unit": "N*mm"}
    # Of what was measured of it only; nothing where nothing of it was.
    part = ANGLE[ANGLE >= 40.0]
    assert shellcut.compare(run, measured(part, part)).steady_range == (40.0, high)
    for part, why in (
        (ANGLE[ANGLE >= 60.0], "no mean over the measured part of the steady window: it would"),
        (ANGLE[ANGLE <= 20.0], f"no mean: the steady window, {low:.3g} to {high:.3g} deg, lies"),
    ):
        notes = shellcut.compare(run, measured(part, part)).notes
        assert [note.startswith(why) for note in notes if "no mean" in note] == [True]


@pytest.fixture(scope="module")
def steady(tmp_path_factory):
    cut = edge_columns([edge(ANGLE)])
    folder, torque = tmp_path_factory.mktemp("steady") / "out", 100.0 + 0.0 * ANGLE
    work = np.radians(100.0 * ANGLE)
    return shellcut.read(write_run(folder, "steady", ANGLE, torque, tool_work=work, **cut))


@pytest.mark.parametrize(
    ("n_interval", "scattered"), [(7, False), (10, True), (16, False)], ids=["7", "10", "16"]
)
def test_95_of_100_error_bars_of_few_points_hold_the_mean(steady, n_interval, scattered):
    low, high = steady.steady_window.low, steady.steady_window.high
    apart, n_curve = (high - low) / n_interval, 150
    rng, held, refused = np.random.default_rng(1), 0, 0
    for _ in range(n_curve):
        x = np.arange(low - 1.3 * apart, high + 2.0 * apart, apart)
        if scattered:
            x[1:-1] += rng.uniform(-0.2, 0.2, len(x) - 2) * apart
        y = 80.0 * (1.0 + 0.05 * rng.standard_normal(len(x)))
        found = shellcut.compare(steady, measured(y, x))
        held += abs(found.mean_measured - 80.0) <= found.mean_measured_half_width
        refused += np.isnan(found.mean_measured)
    assert refused <= 0.1 * n_curve
    assert held >= 0.89 * (n_curve - refused)  # 95 % less three standard deviations


def test_too_few_points_have_a_mean_without_error_bar_and_the_reason(steady):
    low, high = steady.steady_window.low, steady.steady_window.high
    for n_interval in (2, 4, 5):
        x = np.linspace(low, high, n_interval + 1)
        found = shellcut.compare(steady, measured(80.0 + np.sin(x), x))
        assert found.mean_measured == pytest.approx(80.0, abs=1.0)
        assert np.isnan(found.mean_measured_half_width)
        (note,) = (note for note in found.notes if "±" in note)
        assert f"up to {(high - low) / n_interval:.4g}° apart" in note
        assert f"a ± takes {(high - low) / 6.0:.4g}° or less" in note
        assert "nan" not in str(found)
    # Many points do not make up for a gap.
    x = np.append(np.linspace(low, 0.5 * (low + high), 100), high)
    assert np.isnan(shellcut.compare(steady, measured(80.0 + 0.0 * x, x)).mean_measured_half_width)


@pytest.mark.parametrize("n_point", [25, 400])
@pytest.mark.parametrize(
    ("curve", "said"),
    [
        (lambda u: 0.5 + u, "the measured torque drifts from"),
        (lambda u: 1.4 - 0.5 * u**2, "the measured torque drifts from"),
        (lambda u: np.where(u < 0.5, 2.0, 3.0), "the measured torque jumps at 4"),
    ],
    ids=["rising", "falling", "jump"],
)
def test_a_measured_curve_that_changes_has_no_mean(steady, n_point, curve, said):
    x = np.linspace(0.0, 90.0, n_point)
    scatter = 0.005 * np.random.default_rng(2).standard_normal(n_point)
    found = shellcut.compare(steady, measured(80.0 * (curve(x / 90.0) + scatter), x))
    assert np.isnan([found.mean_measured, found.mean_measured_half_width, found.mean_error]).all()
    assert [note.startswith(f"no mean: {said}") for note in found.notes] == [True]
    # That of the run is there.
    assert found.mean_simulated == pytest.approx(100.0, rel=1e-12)
    assert "nan" not in str(found)


def test_a_simulated_value_that_changes_has_no_mean_either(tmp_path):
    # The torque is steady, another column is not.
    cut = edge_columns([edge(ANGLE)])
    columns = {"tool_work": np.radians(100.0 * ANGLE), "slide": 1.0 + ANGLE / 90.0}
    run = write_run(tmp_path / "out", "s", ANGLE, 100.0 + 0.0 * ANGLE, **columns, **cut)
    mine = MeasuredCurve(ANGLE, 2.0 + 0.0 * ANGLE, "deg", "mm")
    found = shellcut.compare(run, mine, y="slide")
    assert np.isnan(found.mean_simulated)
    assert found.mean_measured == pytest.approx(2.0, rel=1e-12)
    (note,) = found.notes
    assert note.startswith("no mean: the simulated slide drifts from")


def test_a_shifted_sine(run):
    shift = 6.0
    x = np.linspace(0.0, 90.0, 181)
    found = shellcut.compare(run, measured(sine(x, shift)))
    phase = WAVE * np.radians(shift)
    # sin(a) - sin(a - p) = 2 sin(p/2) cos(a - p/2)
    assert found.rms == pytest.approx(140.0 * np.sqrt(2.0) * np.sin(0.5 * phase), rel=1e-12)
    assert found.correlation == pytest.approx(np.cos(phase), rel=1e-12)
    assert found.peak_at_simulated == pytest.approx(22.5, abs=1e-9)
    assert found.peak_at_measured == pytest.approx(22.5 + shift, abs=0.25)  # half a spacing


def test_the_window_takes_a_sawtooth_away_and_leaves_lines_and_the_work(tmp_path):
    angle = np.linspace(0.0, 90.0, 9001)
    tooth = np.abs((angle % 1.0) - 0.5) - 0.25  # triangles of 1 deg with mean 0, corners in rows
    out = write_run(tmp_path / "out", "saw", angle, 1.5 * angle + 8.0 * tooth)
    line = measured(1.5 * angle[::50], angle[::50])
    raw = shellcut.compare(out, line)
    smooth = shellcut.compare(out, line, window=1.0)
    assert raw.rms == pytest.approx(2.0, rel=1e-12)  # points stand on the tips
    # whole teeth have mean 0, up to half a degree from the ends
    inside = (smooth.x >= 0.5) & (smooth.x <= 89.5)
    np.testing.assert_allclose(smooth.simulated[inside], smooth.measured[inside], atol=1e-9)
    assert smooth.work_simulated == raw.work_simulated
    assert raw.work_simulated == pytest.approx(1.5 * 90.0**2 / 2 * np.pi / 180, rel=1e-12)


@pytest.mark.parametrize(
    ("curve", "options", "said"),
    [
        (([95, 99], [1, 2]), {}, "share a range of angle, measured is 95 to 99 deg"),
        (([0, 1], [0, 1], "mm", "N"), {}, "x is in mm, but the run's angle is in deg; y is in N"),
        (
            ([0, 1], [0, 1]),
            {"x": "way", "y": "power"},
            r"'way' in the history; no 'power'.*there are time, angl",
        ),
        (([0, 1], [0, 1]), {"window": 0.0}, "window must be a width above 0 deg"),
        (([0, 1], [0, 1]), {"window": np.nan}, "window must be a width above 0 deg"),
        (([0, 1], [0, 1]), {"window": 2.0}, "window must be less than the common range, 1 deg"),
    ],
)
def test_refusals(run, curve, options, said):
    x, y, *units = curve
    with pytest.raises(ValueError, match=said):
        shellcut.compare(run, MeasuredCurve(x, y, *(units or ("deg", "N*mm"))), **options)


def test_turned_signs_few_points_and_a_flat_reference_are_said(run, tmp_path):
    found = shellcut.compare(run, measured([0.0, -1.0], [0.0, 30.0]))
    assert any("opposite signs" in note for note in found.notes)
    assert "only 0 measured points lie inside the common range" in found.notes
    found = shellcut.compare(run, measured([0.0, 0.0], [0.0, 90.0]))
    content = json.loads(found.to_json(tmp_path / "c.json").read_text())
    assert content["figures"]["peak_error"] == {"value": None, "unit": "-"}
    assert "nan" not in str(found)


@pytest.fixture
def german(tmp_path):
    path = tmp_path / "cap.csv"
    rows = [f"{k};{a:g};{sine(a) / 10:.6f}" for k, a in enumerate(ANGLE[::10])]
    text = "Nr;Winkel [Grad];Drehmoment [Ncm]\n" + "\n".join(rows).replace(".", ",")
    path.write_text(text, encoding="latin-1")
    return path


def test_the_command_writes_table_json_and_picture(run, german, tmp_path, capsys):
    pytest.importorskip("matplotlib", reason="needs shellcut-fem[plot]")
    command = ["compare", str(run), str(german)]
    assert main([*command, "--x", "angle=Winkel", "--y", "torque=Drehmoment"]) == 0
    said = capsys.readouterr().out
    for part in ("wave: angle 0 to 90°, 181 points", "peak torque", "140 N·mm"):
        assert part in said
    assert json.loads((run / "comparison.json").read_text())["figures"]["rms"]["unit"] == "N*mm"
    assert (run / "comparison.png").stat().st_size > 1000
    elsewhere = ["--json", str(tmp_path / "a.json"), "--picture", str(tmp_path / "a.png")]
    columns = ["--x", "=2", "--y", "=3", "--units", "deg, N*cm", "--window", "2"]
    assert main([*command, *columns, *elsewhere]) == 0
    assert json.loads((tmp_path / "a.json").read_text())["window"] == 2.0
    assert (tmp_path / "a.png").exists()


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ("--x angle=Winkl --y torque=3", "did you mean 'Winkel'?"),
        ("--x =2 --y =3 --units mm,N", "Winkel is in mm, but the run's angle is in deg"),
        ("--x =2 --y =3 --json /no/such/folder/a.json", "there is no such folder; make it"),
    ],
)
def test_bad_input_leaves_with_two(run, german, capsys, more, words):
    assert main(["compare", str(run), str(german), *more.split()]) == 2
    assert words in capsys.readouterr().err


# --- curves as test machines write them, and what is said of those that cannot be read


PLACES = [0.0, 0.5, 1.0, 1.5]
TORQUE = [0.0, 13.2, 26.0, 25.5]  # N*mm
HEAD = "Prüfung 3;12.05.2024\r\nTempo;10;mm/s\r\n\r\nWinkel;Moment"
BY_HAND = "# made by hand\nangle [deg]  torque [Nmm]\n"
QUOTED = '"angle / deg","torque / mN*m"'


def curve(tmp_path, text, *columns, encoding="utf-8", **options):
    path = tmp_path / "measured.csv"
    path.write_bytes(text.encode(encoding))
    return read_measured_curve(path, *columns, **options)


@pytest.mark.parametrize(
    ("encoding", "text"),
    [
        ("utf-8", "Winkel [Grad];Drehmoment [Ncm]\n0,0;0,00\n0,5;1,32\n1,0;2,6\n1,5;2,55\n"),
        ("utf-8-sig", "angle (deg),torque (N*mm)\n0,0\n0.5,13.2\n1,26\n1.5,25.5\n"),
        ("latin-1", f"{HEAD}\r\n[°];[N·cm]\r\n0;0\r\n0,5;1,32\r\n1;2,6\r\n1,5;2,55\r\n"),
        ("utf-16", "angle\ttorque\ndeg\tN*m\n0\t0\n0,5\t0,0132\n1\t0,026\n1,5\t0,0255\n"),
        ("utf-8", f"{BY_HAND}  0,0  0\n 0,5 1,32e1\n% pause\n\n 1,0 26 # ramp\n 1,5 25,5\n"),
        ("ascii", f'{QUOTED}\n"0,0","0"\n"0,5","13,2"\n"1","26"\n"1,5","25,5"\n'),
        ("ascii", "angle [deg];torque [N*cm];\n0;0;\n0.5;1.32;\n1;2.6;\n1.5;2.55;\n"),
    ],
    ids=["semicolons", "commas", "units line", "utf-16 tabs", "blanks", "quoted", "closed rows"],
)
def test_the_same_curve_in_many_writings(tmp_path, encoding, text):
    found = curve(tmp_path, text, encoding=encoding)
    np.testing.assert_array_equal(found.x, PLACES)
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
    np.testing.assert_array_equal(found.x, PLACES)
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


BAD_LINES = [
    "line 3: must be a number, got 'x'",
    "line 4: there must be 2 numbers, got 1",
    "line 5: thousands separators are not read, got '1.234,5'",
    "line 6: a number is missing",
]


@pytest.mark.parametrize(
    ("text", "columns", "words"),
    [
        ("", (), ["the file is empty"]),
        ("# nothing\n", (), ["a line of headings and lines of numbers"]),
        ("a [mm];b [N]\n0;0\n1;x\n2\n3;1.234,5\n4;\n", (), BAD_LINES),
        ("a [mm];b [N]\n0;0.5\n1;1,234\n", (), ["got '0.5' in line 2 and '1,234' in line 3"]),
        ("a [mm],b [N]\n0,0,1,5\n0,5,1,5\n", (), ["4 columns without headings; if these are dec"]),
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
        ("a [mm];b [N]\n9;0\n8;1\n7;2\n6;3\n90;4\n", (), ["at 90: in this row", "line 6"]),
        ("a [mm];b [N]\n0;0\n1;1\n99;2\n3;3\n4;4\n", (), ["at 99: in this row", "line 4"]),
        ("a [mm];b [N]\n0;0\n5;1\n9;2\n5;1\n1;0\n", (), ["at 5: keep one stroke", "line 5"]),
        ("a [mm];b [N]\n1;0\n1;1\n", (), ["all 2 points are at 1"]),
        ("a [mm];b [N]\n1;0\n", (), ["same length of two or more"]),
        (f"{'a' * 200_000} [mm];b [N]\n1;0\n2;0\n", ("c",), ["2 columns without headings"]),
        ("a [mm];b [N]\n1;0\n2;nan\n", (), ["must be finite, they are not in lines 3"]),
    ],
)
def test_curves_that_cannot_be_read(tmp_path, text, columns, words):
    with pytest.raises(FileError) as caught:
        curve(tmp_path, text, *columns)
    for word in words:
        assert word in str(caught.value)


def table_of(numbers, separator=";"):
    quoted = [f'"{one}"' if "," in one else one for one in numbers]
    cells = quoted if separator == "," else numbers
    rows = [f"{10 * k}{separator}{cell}" for k, cell in enumerate(cells)]
    return "\n".join([f"angle [deg]{separator}torque [N*mm]", *rows, ""])


@pytest.mark.parametrize("separator", [";", "\t", ","])
@pytest.mark.parametrize(
    "numbers",
    [
        "0 950 1,020 1,150 980",
        "0 950 1.020 1.150 980",
        "999 1,000",
        "-1,020 -5 0",
        "12 250 102,500 99,000",
    ],
)
def test_numbers_that_may_have_thousands_separators_are_refused(tmp_path, numbers, separator):
    with pytest.raises(
        FileError, match=r"torque is ambiguous: .* write -?\d+, or decimals in"
    ) as e:
        curve(tmp_path, table_of(numbers.split(), separator))
    assert "line" in str(e.value)


@pytest.mark.parametrize(
    "numbers",
    [
        "1.000 2.000 3.000",  # of as many decimals
        "0 1.234 2.345",  # but for the zero
        "0 0.987 1.234 2",  # a number below 1 has decimals
        "1 1,25 1,375 2",
        "1 1.005 1.010e0",
        "950 1020 1150 1.125",  # a thousand is written without
        "950,0 1020 1,150",
        "1 2 3 1200",
    ],
)
def test_decimal_numbers_are_read(tmp_path, numbers):
    found = curve(tmp_path, table_of(numbers.split()))
    expected = [float(one.replace(",", ".")) for one in numbers.split()]
    np.testing.assert_array_equal(found.y, expected)
    assert found.notes == ()


def test_decimals_in_one_column_say_what_the_sign_is_in_another(tmp_path):
    text = "Nr;angle [deg];torque [N*mm]\n0,5;1;950\n1,5;2;1,020\n2,5;3;1,150\n"
    np.testing.assert_array_equal(curve(tmp_path, text, 2, 3).y, [950.0, 1.02, 1.15])


def test_arrays_are_checked():
    with pytest.raises(ValueError, match=r"finite, .* rows 1; x_unit: unit must .* got 'ell'"):
        MeasuredCurve([0.0, np.nan], [0.0, 1.0], "ell", "N")
    with pytest.raises(ValueError, match=r"got shapes \(2,\) and \(3,\)"):
        MeasuredCurve([0.0, 1.0], [0.0, 1.0, 2.0], "mm", "N")
