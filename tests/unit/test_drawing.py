"""Outlines from DXF, written by ezdxf."""

import re
import sys
from math import pi
from pathlib import Path

import numpy as np
import pytest

from shellcut import mesh_from_drawing, read_drawing, read_model
from shellcut.formats.budget import LIMITS
from shellcut.formats.errors import FileError

ezdxf = pytest.importorskip("ezdxf", reason="needs shellcut-fem[outline]")
pytest.importorskip("shapely", reason="needs shellcut-fem[outline]")

CUT = {"layer": "cut"}
# A plate of 20 x 12 mm with a round end, a round and an elliptic hole.
AREA = 20 * 12 + 18 * pi - 4 * pi - 3 * 1.5 * pi


def plate(units=4, scale=1.0):
    """The document, with a dimension line on a layer of its own."""
    document = ezdxf.new(units=units)
    for name in ("cut", "dim"):
        document.layers.add(name)
    space = document.modelspace()
    for start, end in (((20, 12), (0, 12)), ((0, 0), (0, 12)), ((0, 0), (20, 0))):
        space.add_line(np.multiply(scale, start), np.multiply(scale, end), dxfattribs=CUT)
    space.add_arc((20 * scale, 6 * scale), 6 * scale, -90, 90, dxfattribs=CUT)
    space.add_circle((6 * scale, 6 * scale), 2 * scale, dxfattribs=CUT)
    space.add_ellipse((14 * scale, 6 * scale), (3 * scale, 0), 0.5, dxfattribs=CUT)
    space.add_text("plate", dxfattribs={"layer": "dim"})
    space.add_line((-5 * scale, 0), (-5 * scale, 12 * scale), dxfattribs={"layer": "dim"})
    return document


def saved(path, document):
    document.saveas(path)
    return path


class TestDxf:
    def test_lines_arcs_and_ellipses_make_an_outline_with_holes(self, tmp_path, caplog):
        found = read_drawing(saved(tmp_path / "plate.dxf", plate()), layers=["CUT"])
        assert len(found.holes) == 2
        assert found.area == pytest.approx(AREA, rel=1e-3)
        np.testing.assert_allclose(found.outline.min(axis=0), [0, 0], atol=1e-12)
        np.testing.assert_allclose(found.outline.max(axis=0), [26, 12], atol=1e-12)
        assert "left out: 2 entities on layer 'dim'" in caplog.text
        assert "the file states the unit mm: the drawing is 26 mm across" in caplog.text
        with pytest.raises(FileError, match="nothing on the layers fim; layers in use: cut, dim"):
            read_drawing(tmp_path / "plate.dxf", layers=["fim"])

    def test_an_unknown_entity_without_a_layer_is_left_out(self, tmp_path, caplog):
        path = saved(tmp_path / "plate.dxf", plate())
        text = path.read_bytes().replace(b"\r\n", b"\n")
        first, rest = text.split(b"\nTEXT\n", 1)
        # As the damage that found it: its handle, its owner and its layer are lost.
        path.write_bytes(first + b"\nNOTHING\n" + rest[rest.index(b"\n100\nAcDbText") + 1 :])
        found = read_drawing(path, layers=["cut"])
        assert found.area == pytest.approx(AREA, rel=1e-3)
        assert "left out: 2 entities on layer 'dim'" not in caplog.text

    def test_the_area_converges_with_the_chord_deviation(self, tmp_path):
        path = saved(tmp_path / "plate.dxf", plate())
        misses = []
        for chord in (1e-2, 1e-3, 1e-4):
            found = read_drawing(path, layers="cut", chord_deviation=chord)
            misses.append(abs(found.area - AREA))
            assert misses[-1] < chord * 60.0  # along the curves: 6 pi + 4 pi + 15 mm
            radius = np.hypot(*(found.holes[0] - [6, 6]).T)
            np.testing.assert_allclose(radius, 2.0, rtol=3e-4)  # ezdxf: cubics for arcs
        assert misses[0] > misses[1] > misses[2]

    def test_a_stated_unit_is_applied_and_none_must_be_given(self, tmp_path, caplog):
        for units, mm in ((1, 25.4), (5, 10.0), (6, 1000.0), (13, 1e-3)):
            path = saved(tmp_path / "plate.dxf", plate(units, 1.0 / mm))
            assert read_drawing(path, layers=["cut"]).area == pytest.approx(AREA, rel=1e-3)
            assert "converted to mm: the drawing is 26 mm across" in caplog.messages[-1]
        path = saved(tmp_path / "small.dxf", plate(0, 1 / 25.4))
        with pytest.raises(FileError, match="unit must be given, because the drawing is 1"):
            read_drawing(path, layers=["cut"])
        assert read_drawing(path, layers=["cut"], unit="inch").area == pytest.approx(AREA, rel=1e-3)

    def test_polylines_with_bulges_splines_and_blocks(self, tmp_path):
        document = ezdxf.new(units=4)
        space = document.modelspace()
        # two straight sides and two half circles
        stadium = [(0, 0, 0), (10, 0, 1), (10, 6, 0), (0, 6, 1)]
        space.add_lwpolyline(stadium, format="xyb", close=True)
        hole = document.blocks.new("hole")
        hole.add_circle((0, 0), 1)
        space.add_blockref("hole", (2, 3))
        space.add_blockref("hole", (8, 3), dxfattribs={"xscale": 0.5, "yscale": 0.5})
        space.add_spline(degree=3).set_closed([(4, 2, 0), (6, 2, 0), (6, 4, 0), (4, 4, 0)])
        found = read_drawing(saved(tmp_path / "a.dxf", document), chord_deviation=1e-4)
        assert len(found.holes) == 3
        large, small, spline = (hole_area(hole) for hole in found.holes)
        assert (large, small) == pytest.approx((pi, pi / 4), rel=1e-3)
        # the periodic cubic through the thirds of a square of 2 mm, by Gauss integration
        corners = np.array([[4, 2], [6, 2], [6, 4], [4, 4]] * 2)
        assert spline == pytest.approx(periodic_area(corners), abs=6e-4)  # 6 mm of chords
        assert found.area == pytest.approx(60 + 9 * pi - large - small - spline, rel=1e-4)


def periodic_area(corners):
    """Area within a uniform cubic B-spline over the corners of a square, given twice."""
    basis = np.array([[1, -3, 3, -1], [4, 0, -6, 3], [1, 3, 3, -3], [0, 0, 0, 1]]) / 6.0
    at, weight = np.polynomial.legendre.leggauss(4)
    t, area = 0.5 * (at + 1.0), 0.0
    for k in range(4):
        x, y = corners[k : k + 4].T @ basis
        dx, dy = x[1:] * [1, 2, 3], y[1:] * [1, 2, 3]
        values = [np.polynomial.polynomial.polyval(t, c) for c in (x, y, dx, dy)]
        area += 0.25 * weight @ (values[0] * values[3] - values[1] * values[2])
    return area


def hole_area(points):
    x, y = points.T
    return 0.5 * abs(x @ np.roll(y, -1) - y @ np.roll(x, -1))


def box(x, y, width, height):
    return [(x, y), (x + width, y), (x + width, y + height), (x, y + height)]


def opened(tmp_path, gap):
    lines = ((0, 0), (10, 0)), ((10, gap), (10, 8)), ((10, 8), (0, 8)), ((0, 8), (0, 0))
    document = ezdxf.new(units=4)
    for line in lines:
        document.modelspace().add_line(*line)
    return saved(tmp_path / "open.dxf", document)


class TestLoops:
    def test_a_gap_is_named_and_closed_on_demand(self, tmp_path):
        path = opened(tmp_path, 0.02)
        with pytest.raises(FileError) as caught:
            read_drawing(path)
        assert "LINE on layer '0' at (10, 0) meets no other, 0.02 mm from the end" in str(
            caught.value
        )
        assert "at (10, 0.02) of LINE on layer '0'" in str(caught.value)
        (join,) = re.findall(r"; join=([\d.]+) \(mm\) closes gaps$", str(caught.value))
        assert read_drawing(path, join=float(join)).area == pytest.approx(80.0, rel=0.01)
        with pytest.raises(FileError, match=r"2 mm from .*; a curve is missing, or lies on a lay"):
            read_drawing(opened(tmp_path, 2.0))

    def test_curves_drawn_twice(self, tmp_path):
        document = ezdxf.readfile(opened(tmp_path, 0.0))
        document.modelspace().add_line((10, 8), (0, 8))
        with pytest.raises(FileError, match=r"more than two ends meet at \(10, 8\): .* twice"):
            read_drawing(saved(tmp_path / "twice.dxf", document))
        document = ezdxf.new(units=4)
        document.modelspace().add_circle((0, 0), 5)
        document.modelspace().add_arc((0, 0), 5, 10, 150)
        document.modelspace().add_arc((0, 0), 5, 150, 10)
        with pytest.raises(FileError, match=r"78\.5. mm² around .* is drawn twice"):
            read_drawing(saved(tmp_path / "twice.dxf", document))

    @pytest.mark.parametrize(
        ("loops", "words"),
        [
            ([box(50, 5, 20, 10)], r"largest, of 1600 .* 200 .* \(60, 10\) lies outside"),
            ([box(35, 5, 20, 10)], r"1600 .* crosses the loop of 200 .* at \(40, 5\)"),
            ([box(0, 5, 9, 9)], r"touches \(or lies within .* 81 .* at \(0, 5\)"),
            ([box(5, 5, 9, 9), box(14, 14, 9, 9)], r"touches .* at \(14, 14\)"),
            ([box(5, 5, 20, 20), box(8, 8, 4, 4)], "of 16 mm² .* lies in a hole"),
            ([box(40, 40, -40, -40)], "1600 .* is drawn twice; choose the layers"),
            ([[(1, 1), (9, 1), (9, 9), (12, 12), (9, 9), (1, 9)]], r"touches itself at \(9, 9\)"),
            ([[(1, 1), (9, 9), (9, 1), (1, 9)]], r"crosses itself at \(5, 5\)"),
        ],
    )
    def test_loops_that_make_no_film(self, tmp_path, loops, words):
        document = ezdxf.new(units=4)
        for corners in (box(0, 0, 40, 40), *loops):
            document.modelspace().add_lwpolyline(corners, close=True)
        with pytest.raises(FileError, match=words):
            read_drawing(saved(tmp_path / "loops.dxf", document))

    def test_drawings_on_paper_and_in_space(self, tmp_path):
        document = ezdxf.new(units=4)
        document.layout("Layout1").add_circle((0, 0), 5)
        with pytest.raises(FileError, match="got none; left out: 1 entities in paper space 'Layo"):
            read_drawing(saved(tmp_path / "paper.dxf", document))
        document = plate()
        document.modelspace().add_line((0, 0, 0), (1, 1, 3))
        with pytest.raises(FileError, match="must be flat, got heights z of 0 to 3"):
            read_drawing(saved(tmp_path / "space.dxf", document))


def unfolding(space, document, *, rows=1):
    """Blocks of two blocks each, 2^30 in all, and without curves; or copies in rows."""
    inner = document.blocks.new("b0")
    for k in range(1, 31 if rows == 1 else 1):
        inner = document.blocks.new(f"b{k}")
        inner.add_blockref(f"b{k - 1}", (0, 0))
        inner.add_blockref(f"b{k - 1}", (1, 0))
    space.add_blockref(inner.name, (0, 0), dxfattribs={"row_count": rows, "column_count": rows})


class TestRefusals:
    def test_copies_of_copies_are_counted(self, tmp_path, monkeypatch):
        monkeypatch.setitem(LIMITS, "elements drawn", 500)
        for rows, got in ((1, "501"), (30_000, "900,000,000")):
            document = ezdxf.new(units=4)
            unfolding(document.modelspace(), document, rows=rows)
            with pytest.raises(FileError, match=f"500 elements drawn at most, got {got}: choose"):
                read_drawing(saved(tmp_path / "a.dxf", document))
        document = ezdxf.new(units=4)
        document.blocks.new("b").add_blockref("b", (1, 0))
        document.modelspace().add_blockref("b", (0, 0))
        with pytest.raises(FileError, match="blocks must nest to 50 levels at most"):
            read_drawing(saved(tmp_path / "a.dxf", document))

    def test_a_deviation_beyond_round_off(self, tmp_path):
        path = saved(tmp_path / "plate.dxf", plate())
        with pytest.raises(FileError, match=r"chord_deviation must be .* or more .* got 1e-14"):
            read_drawing(path, layers=["cut"], chord_deviation=1e-14)

    @pytest.mark.parametrize(
        ("name", "content", "words"),
        [
            ("a.dwg", b"AC1027", r"must end in \.dxf; save the drawing as DXF"),
            ("a.dxf", b"", "the file is empty"),
            ("a.dxf", b"AC1027" + bytes(50), "this is a DWG file under another name"),
            ("a.dxf", b"  0\nSECTION\n  2\nENTIT", "ezdxf cannot read it"),
        ],
    )
    def test_what_is_no_drawing(self, tmp_path, name, content, words):
        (tmp_path / name).write_bytes(content)
        with pytest.raises(FileError, match=words):
            read_drawing(tmp_path / name)

    @pytest.mark.parametrize("package", ["ezdxf", "shapely"])
    def test_a_missing_package_is_named(self, tmp_path, monkeypatch, package):
        path = saved(tmp_path / "plate.dxf", plate())
        for loaded in [key for key in sys.modules if key.split(".")[0] == package]:
            monkeypatch.setitem(sys.modules, loaded, None)
        with pytest.raises(ImportError, match=rf"needs? {package}.*pip install"):
            read_drawing(path, layers=["cut"])


def test_quads_within_the_outline_by_python_and_by_a_model_file(tmp_path):
    pytest.importorskip("gmsh", exc_type=ImportError)
    path = saved(tmp_path / "plate.dxf", plate())
    mesh = mesh_from_drawing(path, size=0.8, layers=["cut"])
    assert sorted(mesh.node_sets) == ["hole_1", "hole_2", "outline", "rim"]
    assert mesh.quad_areas().sum() == pytest.approx(AREA, rel=5e-3)  # chords of 0.8 mm
    assert mesh.scaled_jacobian().min() > 0.3
    (tmp_path / "cut.toml").write_text(
        'model = "free"\n[membrane]\ndrawing = "plate.dxf"\nlayers = "cut"\nsize = 0.8\n'
        "[motion]\ndirection = [1.0, 0.0, 0.0]\nspeed = 6000.0\nduration = 1e-3\n"
    )
    model = read_model(tmp_path / "cut.toml")
    assert [Path(path).name for path in model.files()] == ["plate.dxf"]
    np.testing.assert_array_equal(model.parts().mesh.nodes, mesh.nodes)
