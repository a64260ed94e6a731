"""Factors and designs of a study, and what its report says of good, poor and lost runs."""

import csv
import re
from pathlib import Path

import numpy as np
import pytest
import scipy

import shellcut as sc
from browser import opened
from shellcut import Design, ModelFileError, report_study
from shellcut.command_line import main
from shellcut.study.factors import factor, factors_of
from shellcut.study.one_run import Outcome
from shellcut.study.plan import Definition, read_study, write_study
from shellcut.study.report.studied import read_folder
from shellcut.study.table import write_table
from test_report import LISTEN, Outline, drawn, sentences, without_scripts
from tiny_study import SETTINGS

ROOT = Path(__file__).resolve().parents[2]
SECTIONS = [
    *("Study", "Runs", "Curves", "Values over factors", "What was run", "Versions"),
]
STUDY = """model = "opening"
{figures}
[factors]
"tool.edge_inclination_deg" = "40 : 80"
"motion.pitch" = "8 mm : 24 mm"
"tool.file" = ["caps/a.stl", "caps/<b>.stl"]
[design]
kind = "sobol"
n = 24
"""


CAPS = ("caps/a.stl", "caps/<b>.stl")
KEYS = ("tool.edge_inclination_deg", "motion.pitch", "tool.file")


def made(folder, figures, *, n=24, failed=(), chosen="", waiting=0, doubted=()):
    """Write the files of a study whose figures are functions of its factors."""
    folder.mkdir()
    (folder / "study.toml").write_text(STUDY.format(figures=chosen), encoding="utf-8")
    shares = scipy.stats.qmc.LatinHypercube(3, seed=0).random(n)
    eta, pitch = 40.0 + 40.0 * shares[:, 0], 8.0 + 16.0 * shares[:, 1]
    other = shares[:, 2] >= 0.5
    values = [of(eta, pitch, other) for of in figures.values()]
    with (folder / "table.csv").open("w", encoding="utf-8-sig", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(["run", *KEYS, "status", *figures, "folder", "reason"])
        for k in range(n):
            status, found, reason = "done", [float(v[k]) for v in values], ""
            if k in failed or k >= n - waiting:
                status, found = "failed" if k in failed else "waits", [""] * len(values)
            if k in failed:
                reason = f"runs/{k:016x}: <script>no row</script>"
            elif k in doubted:
                reason = "distrust: The motion is too <fast>"
            inputs = [k, eta[k], f"{float(pitch[k])!r} mm", CAPS[int(other[k])]]
            rows.writerow([*inputs, status, *found, f"{k:016x}", reason])
    return folder


def plateau(eta, pitch, other):
    return 128.0 + pitch / np.tan(np.radians(eta)) + 20.0 * other


def noise(eta, pitch, other):
    return np.random.default_rng(1).standard_normal(len(eta))


def crack(eta, pitch, other):
    return np.full(len(eta), 59.04)


THREE = {"torque_plateau_Nmm": plateau, "torque_peak_Nmm": noise, "crack_length_mm": crack}


def page_of(folder):
    return report_study(folder).read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    """Of a study with two figures that vary, one of them noise, and two runs that failed."""
    return page_of(made(tmp_path_factory.mktemp("s") / "a & b", THREE, failed=(3, 7), waiting=1))


def test_every_section_is_there_with_its_inputs_figures_and_constants(page):
    assert Outline(page).titles == SECTIONS
    assert re.findall(r"(?:src|href|url)\W{0,2}\s*https?:", without_scripts(page)) == []
    assert "default-src 'none'" in page
    for head in ("edge inclination [°]", "pitch [mm]", "torque, peak [N·mm]"):
        assert f">{head}</th>" in page
    assert page.count('"circle-open"') == 0
    described = re.findall(r"([^\"<>]+ over [^\"<>]+), 21 points", page)
    assert len(set(described)) == 9  # three figures over three factors
    # Runs that failed have their reason once for all.
    said = [text for kind, text in sentences(page) if kind == "doubt"]
    assert said[0].startswith("2 of 24 runs failed: runs/...: &lt;script&gt;no row")
    assert "other reasons" not in said[0]
    assert "<script>no row" not in page
    assert page.count('<td class="status bad">') == 2


def test_runs_that_their_verdict_distrusts_are_marked_wherever_they_are(tmp_path):
    doubts = {"doubts": lambda eta, pitch, other: np.isin(np.arange(len(eta)), (2, 5))}
    page = page_of(made(tmp_path / "s", doubts | THREE, doubted=(2, 5)))
    said = [text for kind, text in sentences(page) if kind == "doubt"]
    assert said[0].startswith("2 of 24 done runs are distrusted by their own verdict")
    assert "The first: distrust: The motion is too &lt;fast&gt;." in said[0]
    assert page.count('<td class="status doubted">done<small>distrust: The motion is') == 2
    hollow = [found.count("circle-open") for found in re.findall(r'"symbol":\[(.*?)\]', page)]
    assert set(hollow) == {2}
    assert "run 5, distrusted: " in page
    assert "run 6: " in page


class TestWhatIsMissing:
    def test_all_failed(self, tmp_path):
        page = page_of(made(tmp_path / "s", {}, n=4, failed=range(4)))
        assert "No run is done, so there are no values" in page
        assert {"Study", "Runs", "What was run"} <= set(Outline(page).titles)

    def test_a_figure_that_no_run_has_and_a_section_that_fails_cost_no_other(self, tmp_path):
        chosen = 'figures = ["torque_peak_Nmm", "force_peak_N"]'
        folder = made(tmp_path / "s", THREE, n=4, chosen=chosen)
        assert [one.key for one in read_folder(folder).figures] == ["torque_peak_Nmm"]
        (folder / "error_bars.json").write_text("{")
        page = page_of(folder)
        assert "asks for the value force_peak_N, which no run has" in page
        assert "The section &quot;Error bars&quot; cannot be shown: " in page
        lost = "Values over factors"
        assert Outline(page).titles == [title for title in SECTIONS if title != lost]

    def test_no_table_yet_and_a_measured_curve_which_is_for_runs(self, tmp_path, capsys):
        folder = made(tmp_path / "s", THREE, n=1)
        assert main(["report", str(folder), "--measured", "cap.csv"]) == 2
        assert "give the folder of a run" in capsys.readouterr().err
        (folder / "table.csv").unlink()
        assert main(["report", str(folder)]) == 2
        assert "must have table.csv, and has none yet" in capsys.readouterr().err


def planned_folder(folder, given):
    """Write a study of openings, as if done."""
    folder.mkdir()
    planned = Definition("opening", given, {"mesh": "quick"}).plan()
    write_study(folder / "study.toml", planned)
    torques = {run.number: 130.0 + run.number**2 for run in planned.runs}
    outcomes = {
        number: Outcome("done", figures={"torque_plateau_Nmm": torque})
        for number, torque in torques.items()
    }
    write_table(folder, planned, outcomes)
    return folder


def test_inputs_and_figures_come_in_the_units_asked_for(tmp_path):
    folder = planned_folder(tmp_path / "s", {"motion.pitch": "12.7, 25.4"})
    with sc.showing("in, lbf"):
        study = read_folder(folder)
        page = report_study(folder).read_text(encoding="utf-8")
    (pitch,), (torque,) = study.factors, study.figures
    assert pitch.unit == "in"
    assert [*pitch.ends, *pitch.values] == pytest.approx([0.5, 1.0, 0.5, 1.0])
    assert torque.unit == "lbf*in"
    assert torque.values == pytest.approx(np.array([130.0, 131.0]) / 112.984829)
    assert "pitch [in]" in page
    assert "[lbf·in]" in page
    assert "131.0" in (folder / "table.csv").read_text(encoding="utf-8-sig")


def test_numbers_of_the_first_key_stand_for_values_that_go_together(tmp_path):
    linked = {
        "tool.edge_inclination_deg, motion.pitch": "40:12, 60:20, 80:20",
        "tool.wedge_half_angle_deg": "6, 16",
    }
    folder = planned_folder(tmp_path / "s", linked)
    both, wedge = read_folder(folder).factors
    assert (both.name, wedge.name) == ("edge inclination and pitch", "wedge half angle")
    assert both.values.tolist() == [40.0, 40.0, 60.0, 60.0, 80.0, 80.0]
    assert (both.unit, both.ends) == ("deg", (40.0, 80.0))
    page = page_of(folder)
    for head in ("edge inclination [°]", "pitch [mm]", "wedge half angle [°]"):
        assert f">{head}</th>" in page  # the table has every key
    assert "edge inclination and pitch [°]" in page  # the axis of an effect
    assert "run 2: edge inclination 60°, pitch 20 mm, wedge half angle 6°" in page
    # Values that the first does not tell apart are names.
    linked = {"tool.edge_inclination_deg, motion.pitch": [[40, 12], [40, 20], [60, 20]]}
    (one,) = read_folder(planned_folder(tmp_path / "names", linked)).factors
    assert one.names == ("40°, 12 mm", "40°, 20 mm", "60°, 20 mm")
    assert one.values.tolist() == [0.0, 1.0, 2.0]


@pytest.fixture(scope="module")
def real(tmp_path_factory):
    """Three cuts of a tiny strip."""
    out = tmp_path_factory.mktemp("study")
    return sc.sweep("guillotine", {WEDGE: [10, 20, 30]}, out, settings=SETTINGS, executor=1).folder


WEDGE, ANGLE, SPEED = "tool.wedge_half_angle_deg", "tool.edge_angle_deg", "motion.speed"
LINKED = f"{WEDGE}, {SPEED}"
GIVEN = {LINKED: "10:500, 14:800", ANGLE: [50, 70]}


def test_the_shipped_study_is_planned_and_its_figures_go_with_it(tmp_path):
    planned = read_study(ROOT / "examples" / "study.toml").plan()
    assert len(planned.runs) == 12
    write_study(tmp_path / "study.toml", planned)
    kept = read_study(tmp_path / "study.toml")
    assert kept.figures == planned.definition.figures
    assert "force_plateau_N" in kept.figures
    assert [run.key for run in kept.plan().runs] == [run.key for run in planned.runs]


def test_curves_and_folders_of_a_real_study_are_there(real, capsys):
    assert main(["report", str(real)]) == 0
    assert "report.html (" in capsys.readouterr().out
    page = (real / "report.html").read_text(encoding="utf-8")
    links = [link for link in Outline(page).links if link.startswith("runs/")]
    assert len(links) == 3
    assert all((real / link).is_dir() for link in links)
    traces, _ = drawn(page)
    names = [trace["name"] for trace in traces]
    assert names == [f"wedge half angle {angle}°" for angle in (10, 20, 30)]
    history = sc.read(real / links[0]).history
    top = max(max(trace["y"]) for trace in traces)
    assert history["force"].max() <= top * (1.0 + 1e-4)


def test_a_reader_sorts_the_table_and_colours_the_curves(tmp_path):
    folder = made(tmp_path / "s", THREE, failed=(3,))
    for k in range(24):
        run = folder / "runs" / f"{k:016x}"
        run.mkdir(parents=True)
        rows = "".join(f"{t},{t * 90},{t * k}\n" for t in np.linspace(0.0, 1.0, 5))
        (run / "history.csv").write_text(f"time [s],angle [deg],torque [N*mm]\n{rows}9.0,1")
    page = page_of(folder).replace("<style>", LISTEN + "<style>", 1)
    (tmp_path / "trial.html").write_text(page, encoding="utf-8")
    with opened(tmp_path / "trial.html", 1200) as report:
        table = report.page.locator("table.sortable")
        head = table.locator("thead button").nth(4)
        columns = []
        for _ in range(2):
            head.click()
            columns.append(table.locator("tbody tr > :nth-child(5)").all_inner_texts())
        box = report.page.locator(".coloured")
        before = box.locator(".legendtext").all_text_contents()
        assert box.locator(".scatterlayer .trace").count() == 23
        box.locator("select").select_option(index=2)
        after = box.locator(".legendtext").all_text_contents()
        colors = {
            line.get_attribute("style") for line in box.locator(".scatterlayer .js-line").all()
        }
        overflow = report.page.evaluate("document.documentElement.scrollWidth - innerWidth")
        assert report.page.evaluate("wrong") == []
        assert report.wrong == []
    up, down = columns
    numbers = [float(cell) for cell in up[:-1]]
    assert numbers == sorted(numbers)
    assert down[:-1] == up[-2::-1]
    assert up[-1] == down[-1] == "–"  # the run without figures comes last
    assert before[0] == "edge inclination 40 to 46.67°"
    assert after == ["caps/a.stl", "caps/<b>.stl"]
    assert len(colors) == 2
    assert overflow <= 0


@pytest.mark.parametrize(
    ("name", "given", "values"),
    [
        ("a", "40,60, 80", (40, 60, 80)),
        ("a", "M1,quick", ("M1", "quick")),
        ("a", "[1, 2], [3, 4]", ([1, 2], [3, 4])),
        ("a", "'x,y', z", ("x,y", "z")),
        ("a", [1.5, "2 mm"], (1.5, "2 mm")),
        ("a", 7, (7,)),
        ("a,b", "40:12,60:20", ((40, 12), (60, 20))),
        (" a ,b", "40 deg : 12 mm, 60 deg : 20 mm", (("40 deg", "12 mm"), ("60 deg", "20 mm"))),
        ("a, b", "[1, 2]:'c:/x, y.stl'", (([1, 2], "c:/x, y.stl"),)),
        ("a, b, c", [[1, 2, "M1"], (3, 4, "M2")], ((1, 2, "M1"), (3, 4, "M2"))),
    ],
)
def test_values(name, given, values):
    found = factor(name, given)
    assert found.values == values
    assert found.ends is None
    assert found.keys == tuple(name.replace(" ", "").split(","))


def test_ranges():
    found = factor("a", "1 mm : 2 mm")
    assert (found.ends, found.unit, found.values) == ((1.0, 2.0), "mm", ())
    assert found.at(0.25) == "1.25 mm"
    assert found.probes() == ("1.0 mm", "2.0 mm")
    assert factor("a", "-1:1e3").ends == (-1.0, 1000.0)


@pytest.mark.parametrize(
    ("name", "given", "said"),
    [
        ("a", "", "at least one value"),
        ("a", "20:10", "must go up"),
        ("a", "1,2,1", "each value once, got 1 twice"),
        ("a", "caps/no*.stl", "there is no file"),
        ("a,", "1:2", "keys that go together must be names"),
        ("a,a", "1:2", "each once"),
        ("a,b", "40:12,60", "a,b must have 2 values together, as 1:2, got (60,)"),
        ("a,b", "40:12:7", "got (40, 12, 7)"),
        ("a,b", "40,60", "got (40,)"),
        ("a,b", ["40", "60"], "got '40'"),
        ("a,b", 3, "got 3"),
        ("a,b", "1:2,1:2", "each value once, got (1, 2) twice"),
    ],
)
def test_values_that_cannot_be_are_refused(name, given, said):
    with pytest.raises(ValueError, match=r".") as refused:
        factor(name, given)
    assert said in str(refused.value)


def test_every_value_of_linked_keys_is_tried_before_any_run():
    study = Definition("guillotine", {LINKED: "10:500, 14:-800, 200:800"})
    with pytest.raises(ModelFileError, match=r"200(.|\n)*-800|-800(.|\n)*200"):
        study.plan()


@pytest.mark.parametrize("kind", ["grid", "sobol", "lhs"])
def test_linked_values_are_one_factor(kind):
    several, _ = factors_of({"a,b": "1:2,3:4,5:6,7:8", "c": "5,6" if kind == "grid" else "0:1"})
    runs = Design().runs(several) if kind == "grid" else Design(kind, 16).runs(several)
    pairs = [(run["a"], run["b"]) for run in runs]
    assert sorted(set(pairs)) == [(1, 2), (3, 4), (5, 6), (7, 8)]
    assert all(pairs.count(pair) == len(runs) / 4 for pair in set(pairs))
    assert len({run["c"] for run in runs}) == (2 if kind == "grid" else 16)
    if kind == "grid":
        assert runs[:2] == [{"a": 1, "b": 2, "c": 5}, {"a": 1, "b": 2, "c": 6}]
        assert len(runs) == 8


def test_several_factors():
    with pytest.raises(ValueError, match="a must be in one factor only") as refused:
        factors_of({"a,b": "1:2,3:4", "a": [1, 2], "c": "2:1"})
    assert "c: a range must go up" in str(refused.value)
    several, settings = factors_of({"a, b": "1:M1", "c": [5], "d": "1,2"})
    assert settings == {"a": 1, "b": "M1", "c": 5}
    assert [one.keys for one in several] == [("d",)]


def test_a_plan_goes_into_its_study_file_and_comes_back(tmp_path):
    planned = Definition("guillotine", GIVEN, {"notch": 1}).plan()
    pairs = [(run.values[WEDGE], run.values[SPEED]) for run in planned.runs[::2]]
    assert pairs == [(10, 500), (14, 800)]
    write_study(tmp_path / "study.toml", planned)
    text = (tmp_path / "study.toml").read_text()
    assert text.startswith("#:schema ./shellcut-study.schema.json\n")
    again = read_study(tmp_path / "study.toml").plan()
    assert [run.key for run in again.runs] == [run.key for run in planned.runs]
    assert len({run.key for run in planned.runs}) == 4
    head = write_table(tmp_path, planned, {}).read_text(encoding="utf-8-sig").splitlines()[0]
    assert head == f"run,{WEDGE},{SPEED},{ANGLE},status,folder,reason"


def test_cores_are_shared_by_runs_that_go_together(monkeypatch):
    monkeypatch.setattr("shellcut.study.plan.available_cores", lambda: 6)
    planned = Definition("guillotine", GIVEN).plan()
    threads = [planned.model_of(planned.runs[0], jobs).head.threads for jobs in (1, 2, 6, 8)]
    assert threads == [None, 3, 1, 1]  # one alone takes what its film can use
    given = Definition("guillotine", GIVEN, {"threads": 4}).plan()
    assert given.model_of(given.runs[0], 6).head.threads == 4


def test_the_command_lists_the_runs(capsys):
    setting = f"--set={WEDGE},{SPEED}=10:500,14:800"
    assert main(["sweep", "guillotine", setting, "--set=notch=1", "--dry-run"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "2 runs, 0 of them done before"
    assert lines[2].endswith(f"{WEDGE} = 14, {SPEED} = 800")
    assert main(["sweep", "guillotine", f"--set={WEDGE},{SPEED}=10:500,14", "--dry-run"]) == 2
    assert "must have 2 values together" in capsys.readouterr().err
