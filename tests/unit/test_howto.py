"""The code of the pages runs as it stands."""

import logging
import re
import shutil
from pathlib import Path

import numpy as np
import pytest

import shellcut
import shellcut.recording.recorder
from run_folder import write_run
from shellcut import guillotine, opening_test
from shellcut.tool.shapes import tooth_ring
from test_tensile import bilinear
from test_tensile import write as write_film

HOWTO = Path(__file__).resolve().parents[2] / "docs" / "howto"
DATA = Path(__file__).parent / "data"


@pytest.fixture(autouse=True)
def _without_doubts(caplog):
    """What the pages run is in order."""
    yield
    doubts = [
        r.getMessage() for r in caplog.get_records("call") if r.name.startswith("shellcut.checks")
    ]
    assert [text for text in doubts if text.startswith("distrust")] == []


def blocks(page, language):
    return re.findall(rf"```{language}\n(.*?)```", (HOWTO / page).read_text(), re.S)


@pytest.fixture
def page(tmp_path, monkeypatch, capsys):
    """Return what runs the code of a page in a new folder: its names, and what it printed."""
    monkeypatch.chdir(tmp_path)

    def run(name, **names):
        for code in blocks(name, "python"):
            exec(compile(code, name, "exec"), names)
        return names, capsys.readouterr().out

    return run


def test_own_film(page):
    pytest.importorskip("gmsh", exc_type=ImportError)
    shutil.copy(DATA / "gmsh_4.1.msh", "disc.msh")
    _, told = page("own-film.md")
    assert "Mesh(18 nodes, 10 quads" in told
    assert "the 10 quads of the shortest step" in told
    assert "['hole_1', 'outline']" in told


def test_own_tool(page, caplog):
    tooth_ring().write("cap.stl")
    (text,) = blocks("own-tool.md", "text")
    Path("motion.csv").write_text(text)
    with caplog.at_level(logging.ERROR):
        names, told = page("own-tool.md")
    assert names["cap"].n_chain == 3
    assert names["motion"].times[-1] == 1e-3
    assert told.count("15 segments, 5.773 mm, open") == 4


def test_trust(page):
    (said,) = page("trust.md")[1].splitlines()
    assert "stays=True" in said


@pytest.mark.usefixtures("no_pictures")
def test_first_cut(page):
    told = page("../first-cut.md")[1].splitlines()[-2:]
    # the quick opening test to 40 degrees, measured 169 N*mm; a band for another step
    largest = float(told[0].split()[2])
    assert 150.0 < largest < 190.0
    assert told[0].endswith(" N*mm")
    assert told[1].startswith("crack ")


def test_hand_built(page):
    names, told = page("hand-built.md")
    assert 0.5 < names["sim"].pose.translation[0] < 0.6  # the hook ended the run
    assert max(names["hook"].force) > 0.0
    told = told.splitlines()
    assert float(told[0].split()[-3]) == pytest.approx(1.36, abs=0.1)  # N mm, of 3.0 of the tool
    assert told[1].startswith("Results of 'cut' in out")
    # between a beam (lateral strain free, 0.2193 mm) and a plate (1 - nu² of it, 0.1996 mm)
    assert 0.1996 < float(told[-1].split()[1]) < 0.2193


def test_compare(page):
    angle = np.linspace(0.0, 40.0, 401)
    write_run(Path("out"), "cap", angle, 140.0 * np.clip(angle / 15.0, 0.0, 1.0))
    (text,) = blocks("compare.md", "text")
    Path("cap.csv").write_text(text)
    _, told = page("compare.md")
    # the peaks of the page: 13.71 N*cm against the 140 N*mm made here
    assert "peak torque" in told
    assert "+2.1 %" in told


def test_tensile(page):
    for k, name in enumerate(("md_1", "md_2", "cd")):
        write_film(Path(f"{name}.csv"), bilinear(noise=0.05, seed=k))
    names, told = page("tensile.md")
    assert names["law"].fracture_energy > 50.0
    assert "tensile strength" in told
    assert Path("film/law_CD.toml").exists()
    (text,) = blocks("tensile.md", "text")
    rows = [
        f"{0.05 * k:.2f};{k:.2f};{0.05 * k:.2f};{0.9 * k:.2f}".replace(".", ",")
        for k in range(3, 9)
    ]
    Path("two.csv").write_text(text + "\n".join(rows) + "\n")
    assert len(shellcut.evaluate_tensile("two.csv").directions["MD"].figures) == 2


def test_read_results(page):
    pytest.importorskip("matplotlib", reason="needs shellcut[plot]")
    case = opening_test("quick", angle_deg=6.0, duration=4e-4)
    case.run("out", n_row=50, n_frame=4, n_snapshot=0, curves=False, progress=False)
    names, told = page("read-results.md")
    assert "Results of 'opening' in out" in told
    assert "N*mm" in told
    assert Path("torque.png").exists()
    results, tool = names["results"], case.simulation.tool
    assert results.frame(0).tool_tooth.tolist() == (tool.triangle_body + 1).tolist()
    assert results.frame(0).edge_tooth.tolist() == (tool.edge_body + 1).tolist()
    rotation, translation = results.tool_pose(-1)
    wanted = case.simulation.motion.pose(results.times[-1])
    assert (rotation == wanted[0]).all()
    assert (translation == wanted[1]).all()


def test_pierce(page):
    told = page("pierce.md")[1].splitlines()
    assert float(told[0]) == pytest.approx(0.391, abs=5e-4)
    assert float(told[1]) == pytest.approx(0.216, abs=5e-4)
    (figures,) = [line for line in told if line.startswith("{'piercing")]
    assert figures.count("piercing_force_") == 4


def test_pictures(page):
    pytest.importorskip("matplotlib", reason="needs shellcut[plot]")
    case = guillotine(1.0, length=6.0, width=4.0, notch=1.0, travel=1.5)
    case.run("out", n_row=50, n_frame=2, n_snapshot=0, curves=False, progress=False)
    Path("cap.csv").write_text("path [mm],force [N]\n0.0,0.0\n0.5,0.2\n1.0,0.3\n")
    page("pictures.md")
    for name in ("crack.png", "scene.png", "cut.webp", "report.html"):
        assert Path(name).stat().st_size > 1000
    assert "<h2>Measured curve</h2>" in Path("out/report.html").read_text(encoding="utf-8")


@pytest.mark.usefixtures("no_pictures")
def test_resume(page, monkeypatch):
    # As it stands, on a smaller model.
    def small(name):
        assert name == "quick"
        return guillotine(1.0, length=6.0, width=4.0, notch=1.0, travel=1.5)

    monkeypatch.setattr(shellcut, "opening_test", small)
    names, _ = page("resume.md", opening_test=small)
    assert names["extra"] == {"note": "before the teeth touch"}
    assert names["again"].state.time >= 2e-4
    assert names["case"].simulation.state.time >= names["case"].duration
