"""Every example is run as a script, and one figure of it is checked."""

import json
import re
import runpy
import subprocess
import sys
from math import radians, sin
from pathlib import Path

import pytest

from page_tables import numbers_of, table
from shellcut.models import Case
from shellcut.models.opening import steady_work_per_radian

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"


@pytest.fixture
def run_example(monkeypatch, capsys, tmp_path):
    """Run an example as a script and return what it printed.

    In this process, where the kernels and Matplotlib are loaded once for all of them; the laminate
    runs in a process of its own. The hundred frames of a run would take half of the time.
    """
    import matplotlib.pyplot as plt

    whole = Case.run
    few = {"n_frame": 10}
    monkeypatch.setattr(Case, "run", lambda case, out, **asked: whole(case, out, **few | asked))

    def run(name, *options, picture=None):
        monkeypatch.setattr(sys, "argv", [name, "--out", str(tmp_path), *options])
        runpy.run_path(str(EXAMPLES / name), run_name="__main__")
        if picture:
            assert (tmp_path / picture).stat().st_size > 10_000
        return capsys.readouterr().out

    yield run
    plt.close("all")


def figures(path):
    return json.loads(path.read_text())


def test_opening_test(run_example, tmp_path):
    # To a half of the way: two process zones of steady cut, and the pictures are there.
    quick = "--mesh", "quick", "--angle", "56", "--duration", "3.5e-3"
    run_example("opening_test.py", *quick)
    summary = figures(tmp_path / "summary.json")
    assert summary["n_cable_broken"] > 8
    assert summary["imbalance_rel"] < 5e-3
    left = {path.name for path in tmp_path.iterdir()}
    assert {"history.csv", "summary.json", "torque.png", "energy.png", "opening.vtkhdf"} <= left
    assert len([name for name in left if name.startswith("snapshot_")]) >= 6


def test_guillotine(run_example, tmp_path):
    run_example("guillotine.py", "--size", "0.8", "--length", "14", picture="force.png")
    summary = figures(tmp_path / "summary.json")
    # The plateau of so short a cut: within 10 % of G h.
    assert summary["force_plateau_N"] == pytest.approx(3.219, rel=0.10)


def test_in_a_notebook(run_example):
    told = run_example("in_a_notebook.py")
    # G h of a short cut, with the peak where the blade meets the notch.
    assert float(re.search(r"largest force ([\d.]+) N", told)[1]) == pytest.approx(3.22, rel=0.25)
    assert "cut.html" in told


def test_trouser(run_example, tmp_path):
    run_example("trouser.py", "--size", "0.75", "--length", "24", picture="force.png")
    summary = figures(tmp_path / "summary.json")
    # G h / 2 on each leg within 5 %: discretisation, a crack of eight edges; measured 1.174.
    assert summary["force_plateau_N"] == pytest.approx(0.5 * 2.296, rel=0.05)


def test_own_tooth(run_example):
    told = run_example("own_tooth.py", picture="torque.png")
    means = dict(re.findall(r"(four|three) teeth: (\d+) N\*mm", told))
    # Over the steady windows of the quick mesh.
    theory = steady_work_per_radian(n_teeth=3, edge_inclination_deg=40.0) / steady_work_per_radian()
    assert float(means["three"]) / float(means["four"]) == pytest.approx(theory, rel=0.05)


def test_cut_quality(run_example):
    told = run_example("cut_quality.py", "--duration", "2.4e-3", picture="quality.png")
    # 72 chords of 5° on the circle of 9.4 mm, all cut.
    assert f"crack {72 * 2 * 9.4 * sin(radians(2.5)):.1f} mm, 0 bridges left" in told


def test_compare_with_measured(run_example, tmp_path):
    told = run_example("compare_with_measured.py", picture="comparison.png")
    assert re.search(r"peak torque +147\.1 N·mm", told)  # 14.71 N*cm of the table
    found = figures(tmp_path / "comparison.json")["figures"]
    # The table was made up to lie near the run; far off, columns or units are wrong.
    assert abs(found["peak_error"]["value"]) < 0.1
    assert "made up" in (tmp_path / "made_up.csv").read_text(encoding="utf-8")


def test_reading_hook(run_example):
    told = run_example("reading_hook.py", picture="force.png")
    steady, place, theory = map(float, re.findall(r"[\d.]+(?= N| mm)", told))
    assert place == pytest.approx(7.0, abs=0.02)  # where the hook ends the run
    # Over two and a half edges of a coarse strip: within 10 % of G h.
    assert steady == pytest.approx(theory, rel=0.10)


def test_laminate(tmp_path):
    command = [sys.executable, str(EXAMPLES / "laminate.py"), "--out", str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=600, check=False)
    assert done.returncode == 0, done.stderr
    pairs = re.findall(r"(-?[\d.]+) (?:mm|MPa), composite beam (-?[\d.]+)", done.stdout)
    (tip, beam), *stresses = [tuple(map(float, pair)) for pair in pairs]
    # The clamp keeps the strip from curving across, which beams know nothing of: 1.1 %.
    assert tip == pytest.approx(beam, rel=0.02)
    assert len(stresses) == 2
    for stress, of_beam in stresses:
        assert stress == pytest.approx(of_beam, rel=5e-3)  # four digits are printed
    assert (tmp_path / "stress.png").stat().st_size > 10_000


def test_vibration_modes(run_example):
    told = run_example("vibration_modes.py", picture="modes.png")
    pairs = re.findall(r"([\d.]+) Hz, thin plate ([\d.]+) Hz", told)
    assert len(pairs) == 4
    for frequency, plate in pairs:
        assert float(frequency) == pytest.approx(float(plate), rel=5e-3)  # of the mesh


def test_stretched_cut(run_example):
    told = run_example("stretched_cut.py", picture="work.png")
    work = dict(re.findall(r"(loose|stretched): work of the tool ([\d.]+)", told))
    # Where the cut lets the strip go slack it gives its energy, E/(1-nu²) e² / 2 times thickness,
    # width and 6.9 mm of way: 0.48 of 15 N*mm, but for its ends and vibration. Flaps that buckle
    # otherwise store up to 0.2 N*mm more or less.
    given = 0.5 * 1678.0 / (1.0 - 0.3**2) * 0.008**2 * 0.074 * 16.0 * 6.9
    assert 0.2 * given < float(work["loose"]) - float(work["stretched"]) < 1.2 * given


def test_tool_of_triangles(run_example, tmp_path):
    told = run_example("tool_of_triangles.py")
    assert "12 segments, 4.04" in told  # 2 R asin(H / 2R), as chords
    crack = float(re.search(r"crack ([\d.]+) mm", told)[1])
    # The edge is 6.9 mm on its way, the crack begins at the notch of 1.6 mm; the film parts up to
    # two quads of 0.8 mm before the edge.
    assert -0.8 < crack - (6.9 - 1.6) < 1.6
    assert figures(tmp_path / "summary.json")["n_cable_jointed"] > 4


def test_every_example_has_a_test():
    tested = {name.removeprefix("test_") for name in globals() if name.startswith("test_")}
    assert {path.stem for path in EXAMPLES.glob("*.py")} <= tested


def test_torque_of_teeth(run_example, tmp_path):
    options = "--inclinations", "60", "--pitches", "20", "--angle", "56", "--jobs", "1"
    said = run_example("torque_of_teeth.py", *options, picture="torque_of_teeth.png")
    rows = [line.split() for line in said.splitlines()[1:]]
    assert [float(row[1]) for row in rows] == [20.0]
    for row in rows:  # damping and the film that is bent take 4 to 12 % of so fast a cut
        assert 1.0 < float(row[2]) / float(row[3]) < 1.14
    assert (tmp_path / "table.csv").exists()


@pytest.mark.slow  # eight cuts
def test_response_surface(run_example):
    pytest.importorskip("sklearn", reason="needs scikit-learn")
    said = run_example("response_surface.py", "--runs", "8", "--jobs", "1", picture="surface.png")
    error, spread = map(float, re.findall(r"([\d.]+) N", said)[:2])
    assert error < 0.3 * spread


@pytest.mark.slow  # compiles the kernels of a film that yields, and runs four cuts
def test_yielding_film(run_example, tmp_path):
    asked = "--size", "0.4", "--length", "16", "--angle", "60"
    said = run_example("yielding_film.py", *asked, picture="edge.png")
    runs = re.findall(r"(elastic|yielding): ([\d.]+) N\*mm; (.*)", said)
    _, rows = table("docs/theory/yielding-cut.md", "test | film | work of the tool")
    for (kind, work, shares), (_, film, *told) in zip(runs, rows, strict=True):
        assert kind == film
        by_part = {}
        for share in shares.split(", "):
            part, percent, _ = share.rsplit(" ", 2)
            by_part[part] = float(percent)
        parts = "cables", "yielding or damage of the material", "stored in the film", "damping"
        found = [float(work), *(by_part.get(part, 0.0) for part in parts)]
        # Chance in the last digit; in films that yield folds multiply it.
        close = {"rel": 0.002, "abs": 0.11} if kind == "elastic" else {"rel": 0.02, "abs": 0.5}
        assert [float(numbers_of(cell)[0]) for cell in told] == pytest.approx(found, **close)
    for name in ("guillotine", "opening"):
        for kind in ("elastic", "yielding"):
            summary = figures(tmp_path / name / kind / "summary.json")
            assert summary["imbalance_rel"] < 5e-3


@pytest.mark.slow
def test_shape_of_the_law(run_example):
    said = run_example(
        "shape_of_the_law.py", "--angle", "56", "--laws", "2", picture="shape_of_the_law.png"
    )
    most = re.search(r"differ from the first by ([\d.]+) %", said)
    assert float(most[1]) < 2.0


@pytest.mark.slow
def test_fit_a_curve(run_example):
    said = run_example("fit_a_curve.py", "--travel", "2", "--jobs", "1", picture="fit.png")
    fitted = re.search(r"cohesive.plateau +12 +([\d.]+) ", said)
    assert float(fitted[1]) == pytest.approx(9.5, rel=0.03)  # the noise is 3 % at a point


@pytest.mark.slow  # ten minutes on two cores
def test_which_tooth(run_example, tmp_path):
    pytest.importorskip("gmsh", exc_type=ImportError)
    pytest.importorskip("optuna")
    said = run_example("which_tooth.py", picture="which_tooth.png")
    found = figures(tmp_path / "search" / "optimum.json")
    assert "cap_70.step" in said.splitlines()[0]
    for given, best in (found["compared"], found["confirmed"]):
        # In theory the cables of the steeper edge take 4.4 % less, and film and damping as much:
        # 4.1 % of the torque. Ours agree with it within their ±, and differ by more than that.
        spread = (best["half_width"] ** 2 + given["half_width"] ** 2) ** 0.5
        assert spread < 0.025 * given["figure"]
        assert abs(best["figure"] - 0.959 * given["figure"]) < spread
        assert given["figure"] - best["figure"] > spread
    assert "no difference" not in said


def test_glued_opening(run_example, tmp_path):
    said = run_example("glued_opening.py", "--angle", "30", picture="glued_opening.png")
    assert "strong: it holds: no part is damaged" in said
    assert re.search(r"weak: it holds, but [\d.]+ % of its area is damaged", said)
    assert figures(tmp_path / "weak" / "summary.json")["seal_damaged_rel"] > 0.0
