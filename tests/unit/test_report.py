"""The report of a run: what it says, what it lacks, and that a browser shows it."""

import json
import re
import shutil
import subprocess
import sys
from html.parser import HTMLParser

import numpy as np
import pytest

import shellcut
from shellcut.command_line import main
from shellcut.report import report, sections
from shellcut.report.chart import Curve, _columns, _ticks, chart
from shellcut.report.figures import key_figures, with_unit
from shellcut.report.verdict import verdict

CHROMIUM = next(
    filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None
)
SECTIONS = ["Verdict", "Key figures", "Force", "The cut", "Snapshots", "Crack map"]
SECTIONS += ["Quality of the cut", "Energy ledger", "Splits", "Tool", "Time step", "What was run"]
SECTIONS += ["Versions", "Files"]


@pytest.fixture(scope="module")
def out(tmp_path_factory):
    """A short cut of a coarse strip."""
    folder = tmp_path_factory.mktemp("run") / "a & b"
    case = shellcut.guillotine(1.0, length=6.0, width=4.0, notch=1.0, travel=3.0)
    case.run(folder, n_row=150, n_frame=12, n_snapshot=2, progress=False)
    (folder / "used.toml").write_text('[membrane]\nname = "<script>alert(1)</script>"\n')
    return folder


@pytest.fixture(scope="module")
def page(out):
    return report(out).read_text(encoding="utf-8")


def copy_without(out, tmp_path, *names):
    folder = tmp_path / "copy"
    shutil.copytree(out, folder)
    for name in names:
        (folder / name).unlink()
    return folder


class Outline(HTMLParser):
    """Section titles, pictures, links; refuses tags that are not closed in order."""

    VOID = frozenset({"meta", "link", "img", "input", "line", "path"})

    def __init__(self, page):
        super().__init__()
        self.open, self.titles, self.images, self.links, self.ids = [], [], [], [], []
        self.feed(page)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        attrs = dict(attrs)
        if tag == "img":
            self.images.append(attrs)
        if tag == "a":
            self.links.append(attrs["href"])
        if "id" in attrs:
            self.ids.append(attrs["id"])
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        if tag not in self.VOID:
            assert self.open.pop() == tag

    def handle_data(self, data):
        if self.open[-1:] == ["h2"]:
            self.titles.append(data)


def sentences(page):
    return re.findall(r'<li class="(\w+)"><b>\w+</b>(.*?)</li>', page)


class TestPage:
    def test_every_section_is_there_in_order(self, page):
        assert Outline(page).titles == SECTIONS

    def test_pictures_are_embedded_and_described(self, page):
        images = Outline(page).images
        assert len(images) == 2 + 3  # strip, map, snapshots
        for image in images:
            assert image["src"].startswith("data:image/png;base64,iVBOR")
            assert len(image["alt"]) > 20

    def test_nothing_is_loaded_from_elsewhere(self, page):
        assert re.findall(r"(?:src|href|url)\W{0,2}\s*https?:", page) == []
        assert "default-src 'none'" in page

    def test_links_lead_to_the_files(self, out, page):
        outline = Outline(page)
        names = {"history.csv", "summary.json", "splits.csv", "guillotine.vtkhdf", "force.png"}
        assert names <= set(outline.links)
        assert all((out / link).is_file() for link in outline.links)
        assert len(set(outline.ids)) == len(outline.ids)

    def test_figures_have_their_units(self, out, page):
        summary = json.loads((out / "summary.json").read_text())
        assert f"{summary['crack_length_mm']:.4g} mm" in page
        assert f"{summary['tool_work_Nmm']:.4g} N·mm" in page

    def test_text_of_the_user_is_escaped(self, page):
        assert "alert(1)</script>" not in page
        assert "&lt;script&gt;alert(1)" in page

    def test_a_good_run_is_told_to_hold(self, page):
        kinds = [kind for kind, _ in sentences(page)]
        assert kinds.count("good") >= 3
        assert kinds == sorted(kinds, key=["doubt", "good", "note"].index)

    @pytest.mark.usefixtures("undrawn")
    def test_it_can_lie_elsewhere(self, out, tmp_path):
        path = report(out, tmp_path / "r.html")
        links = Outline(path.read_text(encoding="utf-8")).links
        assert all(
            (tmp_path / link.replace("%20", " ").replace("%26", "&")).exists() for link in links
        )


@pytest.fixture
def undrawn(monkeypatch, out):
    """Pictures that take no time, for tests of the words around them."""
    picture = (out / "snapshot_00.png").read_bytes()
    for name in ("draw_film_strip", "draw_crack_map"):
        monkeypatch.setattr(sections, name, lambda path, *_, **__: path.write_bytes(picture))


@pytest.mark.usefixtures("undrawn")
class TestWhatIsMissing:
    @pytest.mark.parametrize(
        ("lost", "said"),
        [
            (["summary.json", "splits.csv"], "the run has not ended"),
            (["history.csv"], "history.csv is missing"),
            (["guillotine.vtkhdf"], "NAME.vtkhdf; none there"),
            (["guillotine.vtkhdf", "history.csv", "used.toml"], "history.csv is missing"),
        ],
    )
    def test_is_told_and_the_rest_is_there(self, out, tmp_path, lost, said):
        page = report(copy_without(out, tmp_path, *lost)).read_text(encoding="utf-8")
        assert any(said in text for kind, text in sentences(page) if kind == "doubt")
        titles = Outline(page).titles
        assert {"Verdict", "Versions", "Files", "Energy ledger"} <= set(titles)

    def test_a_killed_run_is_judged_by_its_history(self, out, tmp_path):
        whole = report(out).read_text(encoding="utf-8")
        page = report(copy_without(out, tmp_path, "summary.json")).read_text(encoding="utf-8")
        closes = [text for _, text in sentences(whole) if "ledger closes within" in text]
        assert closes == [text for _, text in sentences(page) if "ledger closes within" in text]
        assert len(closes) == 1

    def test_a_broken_file_is_no_end(self, out, tmp_path):
        folder = copy_without(out, tmp_path)
        (folder / "guillotine.vtkhdf").write_bytes(b"no HDF5")
        (folder / "summary.json").write_text("{")
        (folder / "history.csv").write_text("time [s],path [mm]\n0.0,0.0\n")
        page = report(folder).read_text(encoding="utf-8")
        said = " ".join(text for kind, text in sentences(page) if kind == "doubt")
        assert "The frames cannot be shown" in said
        assert "fewer than two rows" in said

    def test_a_section_that_fails_costs_no_other(self, out, tmp_path):
        folder = copy_without(out, tmp_path)
        text = (folder / "history.csv").read_text()
        (folder / "history.csv").write_text(text.replace("force_contact [N]", "other [N]", 1))
        page = report(folder).read_text(encoding="utf-8")
        said = [text for _, text in sentences(page) if "cannot be shown" in text]
        assert len(said) == 1
        assert said[0].startswith("The force cannot be shown: there is no &#x27;force_contact")
        assert Outline(page).titles == [title for title in SECTIONS if title != "Force"]

    def test_without_matplotlib_there_are_curves_but_no_pictures(self, out, tmp_path):
        script = (
            "import sys; sys.modules['matplotlib'] = None\n"
            "from shellcut.report import report\n"
            "report(sys.argv[1], sys.argv[2])\n"
        )
        path = tmp_path / "r.html"
        subprocess.run([sys.executable, "-c", script, out, path], check=True)
        page = path.read_text(encoding="utf-8")
        assert page.count("pip install shellcut[plot]") == 2
        assert page.count('<figure class="chart">') == 4


class TestVerdict:
    def test_figures_out_of_their_bands_are_doubted(self):
        summary = {
            "tool_work_Nmm": 100.0,
            "imbalance_rel": 0.02,
            "kinetic_rel": 0.08,
            "damping_Nmm": 12.0,
            "contact_Nmm": -6.0,
            "unfelt_penetration_mm": 0.4,
            "n_cable_created": 0,
        }
        lines = [line.text for line in verdict(summary, 0.7) if line.kind == "doubt"]
        assert len(lines) == 6
        for said in ("misses up to 2 %", "reaches 8 %", "takes 12 %", "-6 %", "0.4 mm", "Nothing"):
            assert sum(said in line for line in lines) == 1, said

    def test_figures_at_their_limits_hold(self):
        summary = {"imbalance_rel": 0.01, "kinetic_rel": 0.05, "unfelt_penetration_mm": 0.35}
        assert [line.kind for line in verdict(summary, 0.7)] == ["good"] * 3 + ["note"]

    def test_nothing_known_is_nothing_said(self):
        assert verdict({}, None) == []


class TestFigures:
    def test_units_come_from_the_names(self):
        assert with_unit("tool_work_Nmm", 12.3456) == "12.35 N·mm"
        assert with_unit("angle_end_deg", 95.0008) == "95°"
        assert with_unit("unfelt_penetration_mm", 0.1254) == "0.1254 mm"
        assert with_unit("n_quad", 8649) == "8,649"
        assert with_unit("version", "1.0") == "1.0"

    def test_unknown_figures_are_shown_too(self):
        assert key_figures({"new_thing_mm": 1.5}) == [("new thing", "1.5 mm")]


class TestChart:
    X = np.linspace(0.0, 10.0, 5001)

    def draw(self, *curves):
        words = {"x_name": "angle", "x_unit": "°", "name": "torque", "unit": "N·mm"}
        return chart(self.X, curves, **words, described="a <torque>")

    def test_no_peak_is_lost(self):
        y = np.zeros_like(self.X)
        y[1234], y[4321] = 7.0, -3.0
        rows = _columns(self.X, y)
        assert len(rows) <= 1002
        assert {0, 1234, 4321, 5000} <= set(rows.tolist())

    def test_ticks_are_round_and_hold_the_curve(self):
        assert _ticks(-58.7, 208.2, 6) == [-100.0, -50.0, 0.0, 50.0, 100.0, 150.0, 200.0, 250.0]
        assert _ticks(0.0, 0.0, 6)[0] == 0.0
        assert len(_ticks(0.0, 0.0461, 6)) <= 7

    def test_areas_are_stacked(self):
        one, two = (
            Curve("a", 0 * self.X + 1.0, "a0", True),
            Curve("b", 0 * self.X + 2.0, "a1", True),
        )
        html = self.draw(one, two)
        heights = [
            {float(y) for y in re.findall(r",([\d.]+)", path)}
            for path in re.findall(r'class="area a\d" d="M(6[^"]+)"', html)
        ]
        assert len(heights) == 2
        assert max(heights[1]) == min(heights[0])  # the second lies on the first
        assert max(heights[0]) > max(heights[1]) > min(heights[1])

    def test_values_that_can_be_read_are_those_of_the_curve(self):
        html = self.draw(Curve("total", self.X**2, "total"))
        data = json.loads(re.search(r"json\">(.*?)</script>", html)[1])
        x, y = np.array(data["x"]), np.array(data["curves"][0]["values"])
        np.testing.assert_allclose(y, x**2, rtol=2e-4, atol=1e-6)  # five figures
        assert (data["x"][0], data["x"][-1]) == (0.0, 10.0)

    def test_names_are_escaped(self):
        html = self.draw(Curve("</script><b>", self.X, "total"))
        assert "<b>" not in html
        assert "a &lt;torque&gt;" in html


class TestCommand:
    @pytest.mark.usefixtures("undrawn")
    def test_it_says_where_the_report_is(self, out, tmp_path, capsys):
        assert main(["report", str(out), "-o", str(tmp_path / "r.html")]) == 0
        assert capsys.readouterr().out.startswith(str(tmp_path / "r.html"))
        assert (tmp_path / "r.html").exists()

    @pytest.mark.parametrize(("made", "said"), [(True, "none of them"), (False, "no such folder")])
    def test_no_run_ends_with_two(self, tmp_path, capsys, made, said):
        folder = tmp_path / "empty"
        if made:
            folder.mkdir()
        assert main(["report", str(folder)]) == 2
        error = capsys.readouterr().err
        assert said in error
        assert str(folder) in error
        assert "Traceback" not in error


# Put at the page's start: what goes wrong. At its end: what a reader would do, and what is there.
LISTEN = """<script>
window.wrong = [];
addEventListener("error", (e) => wrong.push(String(e.message || e.target.src).slice(0, 200)), true);
addEventListener("securitypolicyviolation", (e) => wrong.push("loads " + e.blockedURI));
</script>"""
TRY = """<script>
addEventListener("load", () => {
  const svg = document.querySelector(".chart > svg");
  const box = svg.getBoundingClientRect();
  const before = document.querySelector(".read").textContent;
  const point = { clientX: box.left + 0.6 * box.width, clientY: box.top + 9, bubbles: true };
  svg.dispatchEvent(new PointerEvent("pointermove", point));
  const read = document.querySelector(".read").textContent;
  svg.dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowRight", bubbles: true }));
  const next = document.querySelector(".read").textContent;
  const slider = document.querySelector(".slides input");
  const shown = () => [...document.querySelectorAll(".slides img")].map((i) => i.offsetHeight > 0);
  slider.value = 0;
  slider.dispatchEvent(new Event("input"));
  const first = shown();
  slider.value = 2;
  slider.dispatchEvent(new Event("input"));
  const found = {
    wrong, before, read, next, first, last: shown(),
    images: [...document.images].map((i) => (i.complete ? i.naturalWidth : -1)),
    loaded: performance.getEntriesByType("resource").map((e) => e.name)
      .filter((name) => !name.startsWith("data:")),
    overflow: document.documentElement.scrollWidth - innerWidth,
  };
  const told = document.createElement("pre");
  told.id = "found";
  told.textContent = JSON.stringify(found);
  document.body.append(told);
});
</script>"""


@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here (apt-get install chromium)")
@pytest.mark.parametrize("width", [500, 1200])
def test_a_browser_shows_it_without_complaint(page, tmp_path, width):
    trial = page.replace("<style>", LISTEN + "<style>", 1).replace("</body>", TRY + "</body>")
    (tmp_path / "trial.html").write_text(trial, encoding="utf-8")
    done = subprocess.run(
        [
            CHROMIUM,
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--enable-logging=stderr",
            f"--user-data-dir={tmp_path / 'profile'}",
            f"--window-size={width},900",
            "--virtual-time-budget=5000",
            "--dump-dom",
            (tmp_path / "trial.html").as_uri(),
        ],
        capture_output=True,
        text=True,
        timeout=120,
        check=True,
    )
    assert "CONSOLE" not in done.stderr, done.stderr
    found = re.search(r'<pre id="found">(.*?)</pre>', done.stdout)
    assert found, done.stdout[-2000:]
    found = json.loads(found[1].replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&"))
    assert found["wrong"] == []
    assert found["loaded"] == []
    assert found["overflow"] <= 0
    assert len(found["images"]) == 5
    assert min(found["images"]) > 400
    assert found["before"].startswith("Point at the curve")
    assert re.match(r"path [\d.]+ mm; from contact -?[\d.]+ N; .*total -?[\d.]+ N$", found["read"])
    assert found["next"] != found["read"]
    assert found["first"] == [True, False, False]
    assert found["last"] == [False, False, True]
