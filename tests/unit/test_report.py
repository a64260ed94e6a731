"""The report of a run: what it says, what it lacks, and that a browser shows it."""

import html
import json
import re
import shutil
import subprocess
import sys
from html import escape
from html.parser import HTMLParser

import numpy as np
import pytest

import shellcut
from browser import opened
from shellcut import MeasuredCurve
from shellcut.command_line import main
from shellcut.report import pictures, report_run
from shellcut.report.chart import Axis, chart, panel
from shellcut.report.gathered import gather
from shellcut.report.page import SCENE
from shellcut.results.run_curves import resistance_diagram
from shellcut.results.summary_figures import key_figures, with_unit
from shellcut.unit import showing
from shellcut.view import Curve, Diagram, title_parts
from shellcut.view.curves import outline

SECTIONS = [
    *("Conclusion", "Answers", "Force", "Measured curve", "Where the work went"),
    *("What may be trusted", "The cut", "In three dimensions", "Crack map", "Quality of the cut"),
    *("Values", "What was run", "Versions"),
]


@pytest.fixture(scope="module")
def out(tmp_path_factory):
    """A short cut of a coarse strip, too fast."""
    folder = tmp_path_factory.mktemp("run") / "a & b"
    strip = {"size": 1.0, "length": 6.0, "width": 4.0, "notch": 1.0, "travel": 3.0}
    law = shellcut.CohesiveLaw(strength=12.0)
    case = shellcut.guillotine(**strip, speed=8000.0, law=law)
    case.run(folder, n_row=150, n_frame=12, n_snapshot=2, progress=False)
    (folder / "used.toml").write_text('[membrane]\nname = "<script>alert(1)</script>"\n')
    return folder


@pytest.fixture(scope="module")
def measured(out):
    """A curve of few points, nine tenths of the simulated one."""
    history = shellcut.read(out).history
    x = np.linspace(0.0, 2.8, 12)
    force = 0.9 * np.interp(x, history["path"], history["force"])
    return MeasuredCurve(x, force, x_unit="mm", y_unit="N")


@pytest.fixture(scope="module")
def page(out, measured):
    return report_run(out, measured=measured).read_text(encoding="utf-8")


class Outline(HTMLParser):
    """Section titles, pictures, links; refuses tags that are not closed in order."""

    VOID = frozenset({"meta", "link", "img", "input", "line", "path", "source"})

    def __init__(self, page):
        super().__init__()
        self.open, self.titles, self.images, self.links = [], [], [], []
        self.feed(page)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        attrs = dict(attrs)
        if tag == "img":
            self.images.append(attrs)
        if tag == "a":
            self.links.append(attrs["href"])
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        if tag not in self.VOID:
            assert self.open.pop() == tag

    def handle_data(self, data):
        if self.open[-1:] == ["h2"]:
            self.titles.append(data)


def without_scripts(page):
    """Return the page without code: the browser tells what that loads."""
    return re.sub(r"<script>.*?</script>", "", page, flags=re.S)


def drawn(html):
    """Return traces and layout of the first chart."""
    return json.loads(re.search(r'<script type="application/json">(.*?)</script>', html)[1])


def sentences(page):
    return re.findall(r'<li class="(\w+)"><b>\w+</b>(.*?)</li>', page)


def section(page, title):
    return page[page.index(f"<h2>{title}</h2>") :].split("</section>")[0]


def report_of(*arguments, **options):
    return report_run(*arguments, **options).read_text(encoding="utf-8")


def test_sections_pictures_and_what_the_user_wrote_are_in_it_and_nothing_is_loaded(out, page):
    outline = Outline(page)
    assert outline.titles == SECTIONS
    assert len(outline.images) == 3 + 1  # snapshots, map
    for image in outline.images:
        assert image["src"].startswith("data:image/png;base64,iVBOR")
        assert len(image["alt"]) > 20
    assert re.findall(r"(?:src|href|url)\W{0,2}\s*https?:", without_scripts(page)) == []
    assert "default-src 'none'" in page
    assert "alert(1)</script>" not in page
    assert "&lt;script&gt;alert(1)" in page
    summary = json.loads((out / "summary.json").read_text())
    assert f"{summary['crack_length_mm']:.4g} mm" in page
    assert f"{summary['tool_work_Nmm']:.4g} N·mm" in page
    kinds = [kind for kind, _ in sentences(page[page.index("What may be trusted") :])]
    assert kinds.count("good") >= 3
    assert kinds.count("doubt") == 1
    assert "; there is 1 doubt.</p>" in page
    assert kinds == sorted(kinds, key=["doubt", "good", "note"].index)
    # Only where there is no JavaScript the scene asks for it.
    assert page.count("needs JavaScript") == 1
    assert re.search("<noscript>[^/]*needs JavaScript", page)


@pytest.fixture
def undrawn(monkeypatch, out):
    """Pictures that take no time, for tests of the words around them."""
    picture = (out / "snapshot_00.png").read_bytes()

    def draw(path, *_, **__):
        path.write_bytes(picture)

    monkeypatch.setattr(pictures, "draw_crack_map", draw)


@pytest.mark.usefixtures("undrawn")
@pytest.mark.parametrize(("units", "size", "unit"), [("", 1.0, "mm"), ("in, lbf", 25.4, "in")])
def test_the_lead_says_where_the_run_ended_and_what_keeps_its_units(
    out, tmp_path, units, size, unit
):
    end = json.loads((out / "summary.json").read_text())["path_end_mm"]
    with showing(units):
        page = report_of(out, tmp_path / "r.html")
    lead = re.search(r'<p class="lead">(.*?)</p>', page)[1]
    assert f"up to path {end / size:.4g} {unit}, " in lead
    assert ("keep mm, N and s" in lead) == (unit != "mm")


def without(*names):
    def change(folder):
        for name in names:
            (folder / name).unlink()

    return change


def broken(folder):
    (folder / "guillotine.vtkhdf").write_text("no HDF5")
    (folder / "summary.json").write_text("{")
    (folder / "history.csv").write_text("time [s],path [mm]\n0.0,0.0\n")


def without_column(folder):
    path = folder / "history.csv"
    path.write_text(path.read_text().replace("imbalance [N*mm]", "other [N*mm]", 1))


def half_a_row(folder):
    text = (folder / "splits.csv").read_text()
    (folder / "splits.csv").write_text(text[: len(text) // 2].rpartition(",")[0])
    (folder / "summary.json").write_text("[1, 2]")


LOST = {
    "the end": (without("summary.json", "splits.csv"), ["the run has not ended"], set()),
    "all but the end": (
        without("guillotine.vtkhdf", "history.csv", "used.toml"),
        ["history.csv is missing", "NAME.vtkhdf; none there"],
        {"Force"},
    ),
    "broken files": (
        broken,
        ["The frames cannot be shown", "The summary cannot be shown", "fewer than two rows"],
        {"Force", "Conclusion", "Answers", "Values"},
    ),
    "no figures and half a row": (
        half_a_row,
        ["The summary cannot be shown", "The splits cannot be shown"],
        set(),
    ),
    "a column": (
        without_column,
        ["&quot;Where the work went&quot; cannot be shown: the files contain no &#x27;imbalance"],
        {"Where the work went"},
    ),
}
"""What happens to the files of a run, what its report says of it, and which sections it lacks."""


@pytest.mark.usefixtures("undrawn")
class TestWhatIsMissing:
    @pytest.fixture
    def copy(self, out, tmp_path):
        return shutil.copytree(out, tmp_path / "copy")

    @pytest.mark.parametrize("case", LOST)
    def test_is_told_and_costs_no_other_section(self, copy, case):
        change, said, titles = LOST[case]
        change(copy)
        page = report_of(copy)
        told = [text for kind, text in sentences(page) if kind == "doubt"]
        for one in said:
            assert sum(one in text for text in told) == 1, (one, told)
        absent = {"Measured curve", *titles}
        kept = [title for title in SECTIONS if title not in absent]
        assert [title for title in Outline(page).titles if title != "Resistance"] == kept

    def test_a_killed_run_is_judged_by_its_history(self, out, copy):
        without("summary.json")(copy)
        whole, killed = report_of(out), report_of(copy)
        assert "The curve is the force along (1, 0, 0). Positive values resist the tool." in whole
        reason = shellcut.read(out).summary["no_window"]
        assert reason.startswith("cutting edge 1 has cut ")
        closes = []
        for page in (whole, killed):
            closes += [text for _, text in sentences(page) if "the error is at most" in text]
            assert f"There is no steady window, so there is no mean: {reason}." in page
        assert closes == [closes[0]] * 2

    def test_without_frames_the_verdict_is_still_that_of_the_run(self, copy):
        without("guillotine.vtkhdf")(copy)
        told = [text for _, text in sentences(report_of(copy))]
        verdict = json.loads((copy / "summary.json").read_text())["verdict"]
        assert {escape(line["text"]) for line in verdict} <= {*told}

    def test_without_matplotlib_there_are_curves_but_no_map(self, copy, tmp_path):
        without(*(f"snapshot_0{k}.png" for k in range(3)))(copy)
        script = (
            "import sys; sys.modules['matplotlib'] = sys.modules['PIL'] = None\n"
            "from shellcut.report import report_run\n"
            "report_run(sys.argv[1], sys.argv[2])\n"
        )
        path = tmp_path / "r.html"
        subprocess.run([sys.executable, "-c", script, copy, path], check=True)
        page = path.read_text(encoding="utf-8")
        assert html.unescape(page).count("pip install 'shellcut-fem[plot]'") == 1
        assert "the run has drawn none" in page
        assert page.count('<figure class="chart">') == 3


class TestMeasuredCurve:
    def test_is_in_the_chart_and_compared(self, out, measured, page):
        found = shellcut.compare(out, measured)
        traces, _ = drawn(section(page, "Force"))
        (curve,) = (trace for trace in traces if trace["name"] == "measured")
        np.testing.assert_allclose(curve["x"], measured.x, rtol=1e-7)
        np.testing.assert_allclose(curve["y"], measured.y, rtol=1e-4)
        part = section(page, "Measured curve")
        cells = re.findall(r'<th scope="row">(.*?)</th>((?:<td class="n">.*?</td>)+)', part)
        cells = {name: re.findall(r">([^<]*)</td>", row) for name, row in cells}
        peaks = [f"{found.peak_measured:.4g}", f"{found.peak_simulated:.4g}"]
        assert cells["peak force [N]"] == [*peaks, f"{100 * found.peak_error:+.1f} %"]
        assert cells["RMS difference [N]"] == ["", "", f"{found.rms:.4g}"]
        assert cells["correlation"][2] == f"{found.correlation:.4f}"
        assert "path 0 to 2.8 mm, 12 points" in part
        assert f"note</b>{found.notes[0]}" in part

    @pytest.mark.usefixtures("undrawn")
    def test_comes_by_the_command_with_its_columns_and_units(self, out, tmp_path, capsys):
        table, to = tmp_path / "m.csv", tmp_path / "r.html"
        table.write_text("Weg;Kraft\n0,0;0,0\n0,1;0,2\n0,2;0,1\n")
        command = ["report", str(out), "-o", str(to), "--measured", str(table)]
        assert main([*command, "--x", "path=Weg", "--y", "force=Kraft", "--units", "cm, N"]) == 0
        page = to.read_text(encoding="utf-8")
        assert "Measured curve" in Outline(page).titles
        assert "path 0 to 2 mm, 3 points" in page
        assert capsys.readouterr().out.startswith(str(to))
        to.unlink()
        assert main([*command, "--units", "MPa, N"]) == 2
        assert "MPa" in capsys.readouterr().err
        assert not to.exists()

    @pytest.mark.usefixtures("undrawn")
    def test_over_other_columns_has_a_chart_of_its_own_only(self, out, tmp_path):
        history = shellcut.read(out).history
        curve = MeasuredCurve(history["time"][::9], history["force"][::9], x_unit="s", y_unit="N")
        found = shellcut.compare(out, curve, x="time")
        page = report_of(out, tmp_path / "r.html", measured=found)
        assert "measured" not in section(page, "Force")
        assert "time [s]</p>" in page


class TestFigures:
    @pytest.mark.parametrize(
        ("name", "value", "said"),
        [
            ("tool_work_Nmm", 12.3456, "12.35 N·mm"),
            ("angle_end_deg", 95.0008, "95°"),
            ("n_quad", 8649, "8,649"),
            ("version", "1.0", "1.0"),
        ],
    )
    def test_units_come_from_the_names(self, name, value, said):
        assert with_unit(name, value) == said

    def test_the_window_is_said_beside_what_was_taken_over_it(self):
        figures = {"torque_plateau_Nmm": 143.5, "dW_dtheta_Nmm": 141.3, "torque_peak_Nmm": 162.7}
        figures |= {"window_from_deg": 25.92, "window_to_deg": 70.2, "new_thing_mm": 1.5}
        assert key_figures(figures) == [
            ("torque, mean over 25.9-70.2°", "143.5 N·mm"),
            ("torque, peak", "162.7 N·mm"),
            ("tool's work per radian over 25.9-70.2°", "141.3 N·mm"),
            ("new thing", "1.5 mm"),
        ]
        figures = {"force_plateau_N": 3.26, "window_from_mm": 6.46, "window_to_mm": 27.3}
        assert key_figures(figures) == [("force, mean over 6.46-27.3 mm", "3.26 N")]


class TestChart:
    X = np.linspace(0.0, 10.0, 5001)

    def draw(self, *curves):
        return chart(Diagram(self.X, curves, "angle", "deg", "torque", "N*mm"), "a <torque>")

    def test_values_are_those_of_the_curve_and_no_peak_is_lost(self):
        y = np.zeros_like(self.X)
        y[1234], y[4321] = 7.0, -3.0
        rows = outline(self.X, y, 500)
        assert len(rows) <= 1002
        assert {0, 1234, 4321, 5000} <= set(rows.tolist())
        spike = np.where(np.arange(len(self.X)) == 1234, 1e3, self.X**2)
        own = Curve("measured", np.array([1.0, 30.0]), "measured", x=np.array([-2.0, 12.0]))
        (trace, other), _ = drawn(self.draw(Curve("total", spike, "total"), own))
        x, y = np.array(trace["x"]), np.array(trace["y"])
        rows = np.rint(x / 10.0 * 5000).astype(int)
        assert 1234 in rows
        assert 1000 < len(rows) <= 2002
        np.testing.assert_allclose(y, spike[rows], rtol=2e-4, atol=1e-6)  # five figures
        assert (x[0], x[-1]) == (0.0, 10.0)
        assert other["x"] == [-2.0, 12.0]  # it has places of its own

    def test_areas_are_stacked_and_a_crowd_is_switched_together(self):
        layers = [Curve(name, self.X, f"a{k}", True) for k, name in enumerate("ab")]
        crowd = [Curve("each", self.X, "c0")] * 3
        traces, _ = drawn(self.draw(*layers, *crowd))
        assert [trace.get("stackgroup") for trace in traces] == ["areas"] * 2 + [None] * 3
        assert [trace["showlegend"] for trace in traces] == [True] * 3 + [False] * 2
        assert {trace["legendgroup"] for trace in traces[2:]} == {"each"}
        assert [trace.get("hoverinfo") for trace in traces] == [None] * 2 + ["skip"] * 3

    def test_the_teeth_have_names_and_colours_of_their_own_and_are_switched_together(self):
        columns = ("total", "torque_joints", "torque_tooth_1", "torque_tooth_2", "torque_tooth_3")
        history = {"time": self.X, "angle": self.X, "torque": self.X}
        history |= {name: k * self.X for k, name in enumerate(columns)}
        diagram = resistance_diagram(history, {"angle": "deg", "torque": "N*mm"})
        teeth = [trace for trace in drawn(chart(diagram, "a"))[0] if "tooth" in trace["name"]]
        assert [trace["name"] for trace in teeth] == ["tooth 1", "tooth 2", "tooth 3"]
        assert {(trace["legendgroup"], trace["showlegend"]) for trace in teeth} == {("teeth", True)}
        assert len({trace["line"]["color"] for trace in teeth}) == 3
        assert not any("hoverinfo" in trace for trace in teeth)

    def test_names_are_escaped(self):
        html = self.draw(Curve("</script><b>", self.X, "total"))
        assert "<b>" not in html
        assert drawn(html)[0][0]["name"] == "&lt;/script&gt;&lt;b&gt;"  # plotly.js reads entities
        assert "a &lt;torque&gt;" in html

    def test_of_many_points_some_are_drawn_and_names_stand_at_their_axis(self):
        n = 1201
        names = ("caps/<b>.stl", "caps/a_very_long_name_of_a_file.stl")
        file = Axis("file", "", np.arange(n) % 2.0, names)
        html = panel(file, Axis("f", "N", np.ones(n)), ["x"] * n)
        (points,), layout = drawn(html)
        assert len(points["x"]) == len(points["text"]) == 401
        assert layout["xaxis"]["ticktext"] == ["&lt;b&gt;.stl", "a_very_long_name…"]


LISTEN = """<script>
window.wrong = [];
addEventListener("securitypolicyviolation", (e) => wrong.push("loads " + e.blockedURI));
</script>"""
# Numbers and names that are cut off by their chart, and what is wider than its place.
CUT = """() => {
  const inside = (a, b) => a.left >= b.left - 1 && a.right <= b.right + 1;
  const ticks = [...document.querySelectorAll(".chart > div")].flatMap((plot) =>
    [...plot.querySelectorAll(".xtick text, .ytick text, .legendtext")].filter(
      (text) => !inside(text.getBoundingClientRect(), plot.getBoundingClientRect())));
  const wide = [...document.querySelectorAll(".wide, .panel, figcaption, .scale, .legend")].filter(
    (one) => one.scrollWidth > one.clientWidth + 1);
  return [...ticks, ...wide].map((one) => one.textContent.trim().slice(0, 60));
}"""


@pytest.fixture(scope="class", params=[360, 1200])
def tried(request, page, tmp_path_factory):
    """The page on a phone and at a desk."""
    path = tmp_path_factory.mktemp("browser") / "report.html"
    path.write_text(page.replace("<style>", LISTEN + "<style>", 1), encoding="utf-8")
    with opened(path, request.param) as report:
        report.page.wait_for_selector(".chart .legend")
        yield report
        assert report.page.evaluate("wrong") == []
        assert report.wrong == []
        assert len(report.loaded) == 1 + sum(url.startswith("data:") for url in report.loaded)


class TestInABrowser:
    def test_nothing_is_cut_off_and_every_picture_is_there(self, tried):
        page = tried.page
        assert page.evaluate("document.documentElement.scrollWidth - innerWidth") <= 0
        assert page.evaluate(CUT) == []
        widths = page.evaluate("[...document.images].map((image) => image.naturalWidth)")
        assert len(widths) == 4
        assert min(widths) > 400

    def test_values_are_read_by_pointing(self, tried):
        chart = tried.page.locator(".chart").first
        plot = chart.locator(".nsewdrag").first
        plot.scroll_into_view_if_needed()
        plot.hover(position={"x": 150, "y": 40})
        words = " ".join(chart.locator(".hoverlayer .legend text").all_text_contents())
        assert re.search(r"path [\d.]+ mm", words)
        total, measured = (
            float(re.search(rf"{name} : (\S+) N", words)[1]) for name in ("total", "measured")
        )
        # Both are broken lines through other points: nine tenths to within their teeth.
        assert measured == pytest.approx(0.9 * total, abs=0.3 * total + 0.3)

    def test_a_name_in_the_legend_switches_its_curve(self, tried):
        figure = tried.page.locator(".chart").first
        shown = figure.locator(".scatterlayer .trace")
        n = shown.count()
        for left in (n - 1, n):
            figure.locator(".legendtoggle").nth(2).click()
            tried.page.wait_for_timeout(500)  # a double click would do something else
            assert shown.count() == left

    def test_a_range_is_looked_at_closely(self, tried):
        page = tried.page
        plot = page.locator(".chart").first.locator(".nsewdrag").first
        plot.scroll_into_view_if_needed()
        box = plot.bounding_box()
        range_of = "document.querySelector('.chart > div').layout.xaxis.range"
        low, high = page.evaluate(range_of)
        middle = box["y"] + 0.5 * box["height"]
        for share, act in ((0.4, page.mouse.down), (0.6, page.mouse.up)):
            page.mouse.move(box["x"] + share * box["width"], middle, steps=4)
            act()
        page.wait_for_timeout(200)
        wanted = [low + share * (high - low) for share in (0.4, 0.6)]
        assert page.evaluate(range_of) == pytest.approx(wanted, abs=0.01 * (high - low))
        for _ in range(5):  # on a busy machine two clicks may come too far apart to be one
            page.mouse.dblclick(box["x"] + 20, box["y"] + 20)
            page.wait_for_timeout(500)
            if page.evaluate(range_of)[0] == pytest.approx(low):
                break
        assert page.evaluate(range_of) == pytest.approx([low, high])


def test_in_the_dark_and_on_paper_text_stands_out(page, tmp_path):
    (tmp_path / "report.html").write_text(page, encoding="utf-8")
    color = "getComputedStyle(document.querySelector('.chart .xtick text')).fill"
    with opened(tmp_path / "report.html") as report:
        report.page.wait_for_selector(".chart .legend")
        seen = []
        for look in ({"color_scheme": "light"}, {"color_scheme": "dark"}, {"media": "print"}):
            report.page.emulate_media(**look)
            seen.append(report.page.evaluate(color))
    assert seen == ["rgb(27, 31, 36)", "rgb(228, 232, 236)", "rgb(0, 0, 0)"]


def test_the_scene_of_the_report_is_turned_when_it_comes_into_sight(out, page, tmp_path):
    (tmp_path / "report.html").write_text(page, encoding="utf-8")
    with opened(tmp_path / "report.html") as report:
        figure = report.page.locator(".scene3d")
        assert report.page.locator(".scene3d[data-ready]").count() == 0
        figure.scroll_into_view_if_needed()
        report.page.wait_for_selector(".scene3d[data-ready]")
        assert figure.locator(".hint").inner_text() == ""
        figure.locator(".slider").fill("4")
        frame = shellcut.read(out).frame(4)
        assert figure.locator(".caption").inner_text().split("   ") == title_parts(frame)
        assert report.wrong == []
        assert len(report.loaded) == 1  # the report itself


def test_a_large_run_has_fewer_frames_in_the_scene(out, monkeypatch):
    whole = pictures.scene(gather(out))
    assert whole.endswith("</figure>\n")
    monkeypatch.setattr(pictures, "_LARGEST", round(0.6 * len(whole)))
    said = pictures.scene(gather(out))
    assert SCENE in said
    assert said.endswith("a &amp; b&#x27; -o FILE.html</code> writes.</p>")
    monkeypatch.setattr(pictures, "_LARGEST", 3_000)
    said = pictures.scene(gather(out))
    assert SCENE not in said
    assert "No scene: 2 frames must fit" in said
    assert "<code>shellcut view" in said
