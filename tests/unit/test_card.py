"""Cards of notebooks: figures with units, the picture, the verdict."""

import re
from xml.etree import ElementTree

import numpy as np
import pytest

import shellcut as sc
from run_folder import write_run
from shellcut.card import card, drawing
from shellcut.meshing import rectangle
from shellcut.tool_shapes import straight_blade

MESH = rectangle(4.0, 2.0, size=0.5)
BLADE = straight_blade(length=4.0, height=3.0)
FOIL = sc.Plastic(sc.Elastic(70_000.0, 0.33, 2.7e-9), sc.Voce(50.0, 20.0, 0.1))
LAMINATE = sc.ShellMaterial(
    [sc.Layer(sc.Elastic(200.0, 0.42, 0.92e-9), 0.065), sc.Layer(FOIL, 0.009)]
)
VOCE = "Voce, 50 MPa + 20 MPa (1 - exp(-p/0.1)) + 0 MPa p"


def simulation():
    gravity = [sc.Gravity((0.0, 0.0, -9810.0))]
    sim = sc.Simulation(MESH, sc.ShellMaterial.homogeneous(), loads=gravity)
    sim.run(1e-5)
    return sim


def test_a_notch_is_drawn_in_the_card_of_its_mesh():
    def strokes(shown):
        lines = ElementTree.fromstring(shown._repr_html_()).iter("polyline")
        return [line.get("stroke") for line in lines]

    x, y, _ = MESH.nodes.T
    assert strokes(MESH) == []
    assert strokes(MESH.cut(np.flatnonzero((y == 0.0) & (x < 1.2))[:3])) == ["#000000"] * 2
    assert strokes(BLADE)[0] == "#e6001a"


def test_layers_are_drawn_to_scale_with_their_names():
    page = ElementTree.fromstring(LAMINATE._repr_html_())
    ends = [[float(y) for y in one.get("points").split()[1::2]] for one in page.iter("polygon")]
    heights = [max(y) - min(y) for y in ends]
    assert heights[0] / heights[1] == pytest.approx(0.065 / 0.009, rel=0.01)
    assert min(ends[0]) == max(ends[1])  # the second layer lies on the first
    assert [text.text for text in page.iter("text")] == ["layer 1: Elastic", "layer 2: Plastic"]


@pytest.mark.parametrize(
    ("shown", "rows", "faces"),
    [
        (lambda: MESH, {"quads": "32", "extent": "4 × 2 × 0 mm"}, 32),
        (lambda: BLADE, {"cutting edges": "1", "their length": "3 mm"}, BLADE.n_triangle),
        (lambda: LAMINATE, {"thickness": "0.074 mm", "law": VOCE}, 2),
        (lambda: FOIL, {"young": "70,000 MPa", "density": "2.7e-09 t/mm³", "law": VOCE}, 0),
        (simulation, {"quads": "32", "work of the tool": "0 N·mm"}, 32),
    ],
    ids=["mesh", "tool", "film", "material", "simulation"],
)
def test_a_card_has_figures_with_units_and_a_picture(shown, rows, faces):
    page = ElementTree.fromstring(shown()._repr_html_())
    told = {row[0].text: row[1].text for row in page.iter("tr")}
    assert rows.items() <= told.items()
    assert len(list(page.iter("polygon"))) == faces


def test_results_show_their_last_frame_and_what_of_them_holds(tmp_path):
    pytest.importorskip("PIL", reason="needs shellcut-fem[plot]")
    results = sc.read(write_run(tmp_path / "run", "a & b", [0.0, 1.0], [0.0, 5.0]))
    verdict = [("good", "a"), ("doubt", "too <fast>"), ("note", "Waves are slow. Refine.")]
    lines = [{"kind": kind, "text": text} for kind, text in verdict]
    results.summary = {"crack_length_mm": 2.5, "verdict": lines}
    html = results._repr_html_()
    assert "Results of a &amp; b" in html
    assert re.search(r"crack length</th><td[^>]*>2.5 mm", html)
    assert "distrust: too &lt;fast&gt;</p>" in html
    assert "note: Waves are slow</p>" in html
    assert "1 checks hold" not in html
    assert "1 check holds" in html
    assert "data:image/png;base64," in html


def test_near_faces_hide_far_ones_and_many_are_thinned():
    square = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    face = np.arange(4)[None]
    svg = drawing([(square + np.array([0, 0, 1.0]), face, "#near"), (square, face, "#far")])
    assert re.findall("#near|#far", svg) == ["#far", "#near"]
    assert drawing([(np.zeros((0, 3)), np.zeros((0, 4), int), "#none")]) == ""
    fine = rectangle(60.0, 60.0, size=1.0)
    assert drawing([(fine.nodes, fine.quads, "#film")]).count("<polygon") == 4 * 60  # the rim
    many = np.repeat(np.array([[0, 1, 2], [0, 2, 1]]), 3001, axis=0)  # closed: every side twice
    assert drawing([(square, many, "#tool")]).count("<polygon") == 3000
    assert card("a & b", []).count("a &amp; b") == 1
