"""Units and numbers with units as people write them, against definitions."""

import json
import re
from math import pi

import matplotlib
import numpy as np
import pytest

import shellcut
from shellcut import ErrorBars, Optimum, preview, report_run, showing, view_html
from shellcut.command_line import main
from shellcut.model_file.quantity import quantity
from shellcut.model_file.section_table import LISTS, SECTIONS
from shellcut.results.error_bars import Run, error_bar
from shellcut.study.optimise import Trial
from shellcut.unit import (
    DIMENSIONS,
    LIBRARY_UNITS,
    canonical,
    conversion,
    dimension,
    shown,
    with_unit,
)
from shellcut.view import Look, draw_crack_map
from shellcut.view.snapshot import SnapshotSeries


@pytest.mark.parametrize(
    ("unit", "to", "factor"),
    [
        ("N*m", "N*mm", 1000.0),
        ("N cm", "N*mm", 10.0),
        ("mNm", "N*mm", 1.0),
        ("in-lb", "N*mm", 112.9848290276167),
        ("ozf*in", "N*mm", 7.061551814226043),
        ("kgf*cm", "N*mm", 98.0665),
        ("MilliMeter", "mm", 1.0),
        ("Ell", "mm", None),
        ("Grad", "rad", pi / 180.0),
        ("°", "deg", 1.0),
        ("N/m²", "MPa", 1e-6),
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
        ("psi", "MPa", 0.006894757293168361),
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


def test_units_have_one_name_and_one_dimension_and_factors_are_the_nearest_doubles():
    for what, sizes in DIMENSIONS.items():
        for unit in sizes:
            assert (canonical(unit), dimension(unit)) == (unit, what)
        assert LIBRARY_UNITS[what] in sizes
    with pytest.raises(ValueError, match=r"unit of force .*got 'Nmm', one of torque"):
        conversion("Nmm", "N")
    # Angles of motions in a table are multiplied by them: pi is a double, the rest is exact.
    assert conversion("deg", "rad") == pi / 180.0
    assert conversion("turn", "rad") == 2.0 * pi
    assert conversion("rad", "deg") == 180.0 / pi
    assert conversion("mil", "um") == 25.4
    assert with_unit(12345.6, "N*mm") == "12,346 N·mm"  # four digits or all before the point
    assert with_unit(-0.0, "deg") == "0°"


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("43.5 kJ/m²", "N/mm", 43.5),
        ("0.92 g/cm3", "t/mm^3", 9.2e-10),
        ("12µm", "mm", 0.012),
        ("1.678 GPa", "MPa", 1678.0),
        ("6 m/s", "mm/s", 6000.0),
        ("9.81 m/s^2", "mm/s^2", 9810.0),
        ("0.25 turn", "deg", 90.0),
        ("-.5", "mm", -0.5),
        ("2 inch", "mm", 50.8),
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
        ("3 m/s^2", "", "must be a number without a unit, got '3 m/s^2', which is in mm/s^2"),
        ("62 lb/ft3", "t/mm^3", "lb and kp are forces here, give the mass in t, kg or g"),
        ("3 furlong", "mm", "must have a unit made of um, mm, cm"),
        ("twelve", "mm", "must be a number in mm, got 'twelve'"),
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


# --- figures in a user's units: on the terminal, in pictures and in pages; files stay in mm and N


MM, N = 1.0 / 25.4, 1.0 / 4.4482216152605
SHORT = ["--set", "size=1", "--set", "membrane.length=6", "--set", "membrane.width=4"]
SHORT += ["--set", "travel=3", "--set", "output.rows=40", "--frames", "4", "--no-pictures"]


@pytest.fixture(scope="module")
def out(tmp_path_factory):
    """A run in inches; beside it the same in the units of the library."""
    folder = tmp_path_factory.mktemp("runs")
    for name, asked in (("us", ["--shown-in", "in, lbf, psi"]), ("si", [])):
        assert main(["run", "guillotine", "-o", str(folder / name), *SHORT, *asked]) == 0
    return folder / "us"


@pytest.mark.parametrize(
    ("unit", "wanted", "other", "factor"),
    [
        ("mm", "", "mm", 1.0),
        ("mm", "in, lbf", "in", MM),
        ("N*mm", "in, lbf", "lbf*in", N * MM),
        ("N·mm", "lbf", "lbf*mm", N),
        ("N/mm", "in, lbf", "lbf/in", N / MM),
        ("mm/s", "in", "in/s", MM),
        ("MPa", "in, lbf", "lbf/in^2", N / MM**2),
        ("MPa", "in, lbf, psi", "psi", N / MM**2),
        ("in", "in", "in", 1.0),
        ("deg", "in, lbf", "deg", 1.0),
        ("", "in, lbf", "", 1.0),
    ],
)
def test_what_is_made_of_lengths_and_forces_follows(unit, wanted, other, factor):
    with showing(wanted):
        assert shown(unit) == (other, pytest.approx(factor, rel=1e-12))
    assert shown(unit) == (unit, 1.0)


def test_only_units_are_taken(capsys):
    with pytest.raises(ValueError, match="must have a unit made of"), showing("in, furlong"):
        pass
    with pytest.raises(SystemExit) as left:
        main(["report", "out", "--shown-in", "furlong"])
    assert left.value.code == 2
    assert "--shown-in: must have a unit made of" in capsys.readouterr().err


def test_files_are_the_same(out):
    folders = out, out.with_name("si")
    for name in ("history.csv", "splits.csv", "used.toml"):
        one, other = ((folder / name).read_bytes() for folder in folders)
        assert one == other
    of_the_machine = {"wall_s", "ns_per_quad_step", "digest"}
    summaries = [json.loads((folder / "summary.json").read_text()) for folder in folders]
    one, other = ({k: v for k, v in s.items() if k not in of_the_machine} for s in summaries)
    assert one == other


MEASURED = "path [in],force [lbf]\n0.01,0.1\n0.03,0.4\n0.05,0.5\n"
INCH = r"[\d.]+ in"


@pytest.mark.parametrize(
    ("command", "said"),
    [
        (
            "resume OUT",
            [rf"^crack length +{INCH}$", r"^force to cut +at most [\d.]+ lbf, at [\d.]+ in; "],
        ),
        (
            f"preview guillotine -o OUT/../model.png {' '.join(SHORT[:8])}",
            [r"quads with sides of [\d.]+ to [\d.]+ in, 0\.0\d+ in², "],
        ),
        (
            "compare OUT OUT/../measured.csv",
            [rf"path [\d.]+ to {INCH}, ", r"^peak force +0\.5 lbf +[\d.]+ lbf"],
        ),
    ],
)
def test_the_terminal(command, said, out, capsys):
    (out.parent / "measured.csv").write_text(MEASURED)
    words = [word.replace("OUT", str(out)) for word in command.split()]
    assert main([*words, "--shown-in", "in, lbf"]) == 0
    printed = capsys.readouterr().out
    for pattern in said:
        assert re.search(pattern, printed, re.M), printed


def test_a_run_says_so_from_its_start_to_its_end(out):
    log = (out / "run.log").read_text()
    for pattern in (
        rf"sides of 0\.0394 to {INCH}, ",
        r"motion to path 0\.1181 in",
        r"100 %: path 0\.118\d in, force \S+ lbf \| E: .* lbf·in \| .* crack [\d.]+ in, \d+ cables",
    ):
        assert re.search(pattern, log), log


def test_the_axes_of_pictures(out, tmp_path):
    results, model = shellcut.read(out), shellcut.guillotine(1.0, length=6.0).simulation
    with matplotlib.rc_context({"svg.fonttype": "none"}), showing("in, lbf"):
        results.plot_torque(tmp_path / "resistance.svg")
        results.plot_energy(tmp_path / "energies.svg")
        draw_crack_map(tmp_path / "cracks.svg", list(results.frames()))
        preview(model, tmp_path / "model.svg", time=1e-3)
    for name, words in (
        ("resistance", ["path [in]", "force [lbf]"]),
        ("energies", ["energy [lbf·in]"]),
        ("cracks", ["x [in]", "opened at path [in]"]),
        ("model", ["x [in]", "z [in]"]),
    ):
        picture = (tmp_path / f"{name}.svg").read_text(encoding="utf-8")
        assert [word in picture for word in words] == [True] * len(words), name
        assert "[mm]" not in picture


def test_a_snapshot_has_its_scale_and_its_bar_in_them(out):
    frame = shellcut.read(out).frame(-1)
    ends = []
    for units in ("in, lbf, psi", ""):
        with showing(units):
            figure = SnapshotSeries([frame], look=Look(), size=(640, 400)).figure(frame)
            texts = {text.get_text() for text in figure.findobj(matplotlib.text.Text)}
            ends.append(Look().limits_for([Look().field_of(frame).values(frame)], 1)[1])
        if units:
            assert "largest principal stress [psi]" in texts
            assert any(re.fullmatch(INCH, text) for text in texts), texts
            assert any(re.match(r"path 0\.118\d in", text) for text in texts)
    assert ends[0] == pytest.approx(145.04 * ends[1], rel=0.5)  # both round


def test_pages(out, tmp_path):
    summary = json.loads((out / "summary.json").read_text())
    with showing("in, lbf"):
        report = report_run(out, tmp_path / "r.html").read_text(encoding="utf-8")
        page = view_html(out, tmp_path / "v.html").path.read_text(encoding="utf-8")
    assert f"{summary['crack_length_mm'] * MM:.4g} in" in report
    assert f"{summary['tool_work_Nmm'] * N * MM:.4g} lbf·in" in report
    assert "force [lbf]" in report
    assert "slit, mean width [in]" in report
    for text in (report, page):
        assert '"length":["in",' in text
        assert '"unit":"lbf/in^2"' in text
        assert re.search(r'"caption":\["path 0\.118\d in",', text)


def test_error_bars_and_a_search():
    runs = Run("as given", "", 1.0), Run("finer mesh", "mesh", 0.5)
    bar = error_bar("force_peak_N", runs, [3.2, 3.1])
    best = Trial({"tool.half_thickness": 0.2}, "b", 180.0)
    found = Optimum("torque_peak_Nmm", 1, (), (Trial({}, "a", 202.3), best))
    with showing("in, lbf"):
        bars = str(ErrorBars("1f3c", runs, (bar,), {})).splitlines()
        assert bars[1].split()[:5] == ["force,", "peak", "[lbf]", "0.697", "0.022"]
        assert "would leave ± 0.011 lbf" in bars[2]
        assert "1.791 lbf·in as given, 1.593 lbf·in at best (-11.0 %)" in str(found)
        assert found.diagram().shown().unit == "lbf*in"
        assert np.nanmin(found.diagram().shown().curves[1].values) == pytest.approx(1.593, rel=1e-3)
