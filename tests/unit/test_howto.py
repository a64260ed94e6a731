"""The code of the how-to pages on films, tools and restart runs as it stands."""

import logging
import re
import shutil
from pathlib import Path

import pytest

import shellcut
from shellcut.models import guillotine
from shellcut.tool_shapes import tooth_ring

HOWTO = Path(__file__).resolve().parents[2] / "docs" / "howto"
DATA = Path(__file__).parent / "data"


def blocks(page, language):
    return re.findall(rf"```{language}\n(.*?)```", (HOWTO / page).read_text(), re.S)


def test_own_film(tmp_path, monkeypatch, capsys):
    pytest.importorskip("gmsh", exc_type=ImportError)
    monkeypatch.chdir(tmp_path)
    shutil.copy(DATA / "gmsh_4.1.msh", "disc.msh")
    for code in blocks("own-film.md", "python"):
        exec(compile(code, "own-film.md", "exec"), {})
    told = capsys.readouterr().out
    assert "Mesh(18 nodes, 10 quads" in told
    assert "the 10 quads of the shortest step" in told
    assert "['hole_1', 'outline']" in told


def test_own_tool(tmp_path, monkeypatch, capsys, caplog):
    monkeypatch.chdir(tmp_path)
    tooth_ring().write("cap.stl")
    (text,) = blocks("own-tool.md", "text")
    Path("motion.csv").write_text(text)
    names = {}
    with caplog.at_level(logging.ERROR):
        for code in blocks("own-tool.md", "python"):
            exec(compile(code, "own-tool.md", "exec"), names)
    assert names["cap"].n_chain == 3
    assert names["motion"].times[-1] == 1e-3
    assert capsys.readouterr().out.count("15 segments, 5.773 mm, open") == 4


def test_resume(tmp_path, monkeypatch):
    # As it stands, on a smaller model.
    def small(name):
        assert name == "quick"
        return guillotine(1.0, length=6.0, width=4.0, notch=1.0, travel=1.5)

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(shellcut, "opening_test", small)
    names = {"opening_test": small}
    for code in blocks("resume.md", "python"):
        exec(compile(code, "resume.md", "exec"), names)
    assert names["extra"] == {"note": "before the teeth touch"}
    assert names["again"].state.time >= 2e-4
    assert names["case"].simulation.state.time >= names["case"].duration
