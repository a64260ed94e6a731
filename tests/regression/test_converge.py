"""Error bars of a real model through the command line, ended and called again."""

import os
import signal
import subprocess
import sys

import pytest

import shellcut as sc
from gmsh_films import gmsh_with
from shellcut.command_line import main
from shellcut.results.error_bars import read_error_bars
from tiny_study import SETTINGS, done_at, in_words

LONG = SETTINGS | {"membrane.length": 9}
"""So long that its nodes can be moved along it only."""


def test_companions_that_are_killed_go_on_and_give_error_bars(tmp_path, capsys):
    pytest.importorskip("matplotlib", reason="needs shellcut-fem[plot]")
    run = tmp_path / "run"
    assert main(["run", "guillotine", *in_words(LONG), f"-o={run}"]) == 0
    assert main(["converge", "guillotine"]) == 2
    assert "give a folder" in capsys.readouterr().err
    wanted = ["converge", str(run), "--figures=force_peak_N,crack_length_mm", "--jobs=1"]
    command = [sys.executable, "-m", "shellcut", *wanted]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
        for line in process.stderr:
            if line.startswith("[2/"):
                os.kill(process.pid, signal.SIGKILL)
                break
    out = run / "converge"
    before = done_at(out)
    assert 2 <= len(before) < 7
    assert not (out / "error_bars.json").exists()

    assert main(wanted) == 0
    said, told = capsys.readouterr()
    assert f"7 runs, {len(before)} of them done before" in told
    assert {path: time for path, time in done_at(out).items() if path in before} == before

    found = read_error_bars(out / "error_bars.json")
    assert str(found) in said
    peak, crack = found.bars
    # Its runs are too fast: each says so with its part of the error bar.
    assert found.missing["doubts"][0].startswith("as given is distrusted: The motion is too fast")
    assert any("mesh is distrusted: The motion" in one for one in found.missing["mesh"])
    assert set(peak.parts) == {"mesh", "speed", "chance"}
    assert all(width > 0.0 for width in peak.parts.values())
    assert 0.0 < peak.half_width < peak.value
    assert crack.parts["mesh"] >= 0.33  # the finest edge
    assert (out / "error_bars.png").stat().st_size > 10_000

    given, *others = sorted((out / "runs").iterdir(), key=lambda path: path.name != found.key)
    for folder, shown in ((run, True), (given, True), (others[0], False)):
        assert ("<h2>Error bars</h2>" in sc.report_run(folder).read_text()) is shown
    page = sc.report_study(out).read_text()
    assert "<h2>Error bars</h2>" in page
    assert "<h2>Response surfaces</h2>" not in page

    again = sc.converge(run / "used.toml", out, executor=1, say=str)
    assert {bar.figure for bar in again.bars} > {"force_peak_N", "crack_length_mm"}
    assert main(["converge", str(run), "--jobs=1", "--figures=n_bolt"]) == 2
    assert "there is no value" in capsys.readouterr().err
    before = done_at(out)
    assert main(["converge", str(run), "--jobs=1", "--set=motion.speed=3000"]) == 2
    assert "another model than that of" in capsys.readouterr().err
    assert done_at(out) == before


def test_a_film_from_gmsh_gets_its_error_bars(tmp_path):
    pytest.importorskip("gmsh", exc_type=ImportError)
    path = tmp_path / "strip.msh"
    with gmsh_with(RecombineAll=1, MeshSizeMin=1.0, MeshSizeMax=1.0) as gmsh:
        gmsh.model.occ.addRectangle(0.0, -2.0, 0.0, 6.0, 4.0)
        gmsh.model.occ.synchronize()
        for tag, name in enumerate(("bottom", "right", "top", "left"), 1):
            gmsh.model.addPhysicalGroup(1, [tag], name=name)
        gmsh.model.addPhysicalGroup(2, [1], name="film")
        gmsh.model.mesh.generate(2)
        gmsh.write(str(path))
    film = {"membrane.file": str(path), "membrane.unit": "mm", "membrane.triangles": "split"}
    rest = {k: v for k, v in SETTINGS.items() if "membrane." not in k} | {"fracture.path": "free"}
    given = {**rest, **film, "membrane.clamp": ["bottom", "top"]}
    found = sc.converge("guillotine", tmp_path / "bars", figures=["force_peak_N"], settings=given)
    (bar,) = found.bars
    assert {run.name: run.size for run in found.runs}["finer mesh"] == 0.5
    assert set(bar.parts) == {"mesh", "speed", "chance"}
    assert 0.0 < bar.half_width < bar.value
