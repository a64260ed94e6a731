"""Every reader takes text as other programs write it: byte order marks, UTF-16, line ends, a tail.

What a way of writing does to a file is no part of its content: the reader must find the same.
"""

import unicodedata

import numpy as np
import pytest

from damaged.samples import DATA, FILMS, TOOLS
from shellcut import (
    TableMotion,
    read_drawing,
    read_film,
    read_measured_curve,
    read_model,
    read_tool,
)
from shellcut.formats.errors import FileError
from shellcut.results.history import read_history
from shellcut.study.plan import read_study


def _film(path):
    film = read_film(path, unit="mm")
    sets = [*film.node_sets.items(), *film.quad_sets.items()]
    return [film.nodes, film.quads, *(ids for _, ids in sets)], [name for name, _ in sets]


def _tool(path, **options):
    tool = read_tool(path, sharp_angle_deg=90.0, **{"unit": "mm", **options})
    return [tool.vertices, tool.triangles, tool.edges], []


def _curve(path):
    curve = read_measured_curve(path, "Déplacement", "Force")
    return [curve.x, curve.y], [curve.x_name, curve.x_unit]


def _motion(path):
    motion = TableMotion.read_csv(path)
    return [np.array([motion.pose(t).translation for t in (0.0, 1e-3, 2e-3)])], []


CURVE = "# Ø 3\nDéplacement (mm);Force (N)\n0,0;0,00\n0,5;1,32\n1,0;2,10\n1,5;2,60\n2,0;2,9\n"
R12 = "  0\nSECTION\n  2\nENTITIES\n{}  0\nENDSEC\n  0\nEOF\n"


def lines(*ends):
    """Return an R12 drawing of lines, without a header."""
    each = "  0\nLINE\n  8\nDécoupe\n 10\n{}\n 20\n{}\n 11\n{}\n 21\n{}\n"
    return R12.format("".join(each.format(*one) for one in ends))


def box(x0, y0, x1, y1):
    return [(x0, y0, x1, y0), (x1, y0, x1, y1), (x1, y1, x0, y1), (x0, y1, x0, y0)]


def drawing_of(path):
    pytest.importorskip("ezdxf", reason="needs shellcut-fem[outline]")
    return [read_drawing(path, unit="mm").outline], []


def _cad(path):
    pytest.importorskip("gmsh", reason="needs shellcut-fem[mesh]")
    return _tool(path, unit=None)


READ = {name: (file, content_of, _film) for name, (file, content_of, _) in FILMS.items()}
READ |= {name: (file, content_of, _tool) for name, (file, content_of, _) in TOOLS.items()}
TEXTS = {name: one for name, one in READ.items() if (FILMS | TOOLS)[name][2]}
TEXTS |= {
    "DXF": ("plate.dxf", lambda: lines(*box(0, 0, 40, 30)).encode(), drawing_of),
    "STEP": ("teeth.step", (DATA / "two_teeth_inch.step").read_bytes, _cad),
    "IGES": ("teeth.iges", (DATA / "two_teeth_inch.iges").read_bytes, _cad),
    "curve": ("curve.csv", CURVE.encode, _curve),
    "model": (
        "model.toml",
        'model = "trouser" # é\n[membrane]\nlength = 19\n'.encode,
        lambda p: ([], [repr(read_model(p).sections["membrane"])]),
    ),
    "study": (
        "study.toml",
        'model = "trouser"\n[factors]\n"cohesive.strength" = [6, 7] # é\n'.encode,
        lambda p: ([], [repr(read_study(p))]),
    ),
}
TEXTS["motion"] = ("motion.csv", lambda: b"time [ms];z [mm]\n0;0\n1;-1\n2;-2\n", _motion)

MARK = b"\xef\xbb\xbf"
WAYS = {
    "UTF-8 with a mark": lambda text: MARK + text,
    "CR LF": lambda text: text.replace(b"\n", b"\r\n"),
    "a mark and CR LF": lambda text: MARK + text.replace(b"\n", b"\r\n"),
    "CR alone": lambda text: text.replace(b"\n", b"\r"),
    "UTF-16": lambda text: text.decode().encode("utf-16"),
    "UTF-16, big end first": lambda text: b"\xfe\xff" + text.decode().encode("utf-16-be"),
    "UTF-16 without a mark": lambda text: text.decode().encode("utf-16-le"),
    "UTF-16, a byte more": lambda text: text.decode().encode("utf-16") + b"\x1a",
    "Ctrl-Z at the end": lambda text: text + b"\x1a",
    "a zero at the end": lambda text: text + b"\0",
    "a line end more": lambda text: text + b"\n",
}


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("name", TEXTS)
def test_text_in_any_way_of_writing_is_read_alike(tmp_path, name):
    file, content_of, read = TEXTS[name]
    content, path = content_of().replace(b"\r\n", b"\n"), tmp_path / file
    path.write_bytes(content)
    arrays, words = read(path)
    assert arrays or words
    # each of STEP and IGES takes a process of its own
    ways = WAYS if name not in ("STEP", "IGES") else ("a mark and CR LF", "UTF-16")
    for way in ways:
        path.write_bytes(WAYS[way](content))
        found, said = read(path)
        assert said == words, way
        for one, other in zip(arrays, found, strict=True):
            np.testing.assert_array_equal(one, other, err_msg=way)


@pytest.mark.parametrize("content", [b"", MARK, b"\xff\xfe", bytes(200)])
@pytest.mark.parametrize("name", [name for name in TEXTS if name not in ("model", "study")])
def test_a_file_without_content_is_refused_as_such(tmp_path, name, content):
    file, _, read = TEXTS[name]
    (tmp_path / file).write_bytes(content)
    with pytest.raises(FileError, match="the file is empty"):
        read(tmp_path / file)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("name", ["STL binary", "PLY binary", "Gmsh 2.2 binary", "Gmsh 4.1 binary"])
def test_a_byte_after_binary_content_is_said(tmp_path, caplog, name):
    file, content_of, read = READ[name]
    path = tmp_path / file
    path.write_bytes(content_of())
    arrays, _ = read(path)
    assert "after its" not in caplog.text
    for tail in (b"\0", b"\x1a", b"x"):
        caplog.clear()
        path.write_bytes(content_of() + tail)
        for one, other in zip(arrays, read(path)[0], strict=True):
            np.testing.assert_array_equal(one, other)
        assert caplog.text.count("1 byte after its") == 1


def test_a_history_saved_by_an_editor(tmp_path):
    path = tmp_path / "history.csv"
    for way in ("UTF-8 with a mark", "a mark and CR LF", "UTF-16"):
        path.write_bytes(WAYS[way](b"time [s],force [N]\n0.0,1.5\n1.0,2.5\n"))
        assert read_history(path)[0]["force"].tolist() == [1.5, 2.5]


@pytest.mark.parametrize(("encoding", "form"), [("cp1252", "NFC"), ("utf-8", "NFD")])
def test_headings_with_accents(tmp_path, encoding, form):
    path = tmp_path / "curve.csv"
    path.write_bytes(unicodedata.normalize(form, CURVE).encode(encoding))
    for given in ("NFC", "NFD"):
        curve = read_measured_curve(path, unicodedata.normalize(given, "déplacement"), "force")
        assert curve.y.tolist() == [0.0, 1.32, 2.1, 2.6, 2.9]


def test_set_names_of_decks_in_the_western_code_page(tmp_path):
    deck = "*NODE\n1,0,0\n2,3,0\n3,3,2\n4,0,2\n*ELEMENT,TYPE=S4\n1,1,2,3,4\n"
    deck += "*NSET,NSET=Côté\n1,4\n*NSET,NSET=Côtè\n2,3\n"
    for encoding in ("utf-8", "cp1252"):
        (tmp_path / "film.inp").write_bytes(deck.encode(encoding))
        film = read_film(tmp_path / "film.inp", unit="mm")
        assert sorted(name.casefold() for name in film.node_sets) == sorted(["côté", "côtè"])


class TestDxf:
    @pytest.fixture(autouse=True)
    def _ezdxf(self):
        pytest.importorskip("ezdxf", reason="needs shellcut-fem[outline]")

    def saved(self, tmp_path, text):
        path = tmp_path / "plate.dxf"
        path.write_text(text)
        return path

    def test_names_of_layers_are_those_of_the_marked_text(self, tmp_path):
        text = lines(*box(0, 0, 40, 30))
        for encoding in ("cp1252", "utf-8-sig", "utf-16"):  # the first is that of R12
            (tmp_path / "plate.dxf").write_bytes(text.encode(encoding))
            assert read_drawing(tmp_path / "plate.dxf", layers=["découpe"]).area == 1200.0

    def test_without_a_header_it_states_no_unit(self, tmp_path, caplog):
        path = self.saved(tmp_path, lines(*box(0, 0, 40, 30)))
        assert read_drawing(path).area == pytest.approx(1200.0)
        assert "no unit given: taken as mm" in caplog.text

    @pytest.mark.parametrize(
        "slit",
        [
            [(10, 10, 20, 20), (10, 10, 20, 20)],
            [(10, 10, 20, 20), (20, 20, 10, 10)],
            [(10, 10, 15, 15), (15, 15, 20, 20), (10, 10, 20, 20)],
            [(10, 10, 20, 15), (20, 15, 30, 10)] * 2,
        ],
    )
    def test_a_slit_drawn_twice_does_not_vanish(self, tmp_path, slit):
        path = self.saved(tmp_path, lines(*box(0, 0, 40, 30), *slit))
        with pytest.raises(FileError, match=r"there and back at|crosses itself at|ends meet"):
            read_drawing(path, unit="mm")

    @pytest.mark.parametrize(
        ("inner", "outer"),
        [((1, 1, 1), (1, 1, 0)), ((1, 1, 0), (1, 1, 1)), ((-1, 1, 0), (3, 3, 0)), ((2, 1, 0),) * 2],
    )
    def test_blocks_that_are_flattened(self, tmp_path, inner, outer):
        import ezdxf

        document = ezdxf.new(units=4)
        space = document.modelspace()
        space.add_lwpolyline([(0, 0), (60, 0), (60, 60), (0, 60)], close=True)
        block = document.blocks.new("hole")
        block.add_lwpolyline([(0, 0), (2, 0), (2, 3), (0, 3)], close=True)
        around = document.blocks.new("around")
        scales = [f"{k}.{k}25" for k in range(1, 7)]  # replaced: ezdxf itself writes no zero
        axes = ("xscale", "yscale", "zscale")
        given = [dict(zip(axes, map(float, scales[k : k + 3]), strict=True)) for k in (0, 3)]
        around.add_blockref("hole", (1, 1), dxfattribs=given[0])
        space.add_blockref("around", (20, 20), dxfattribs=given[1])
        document.saveas(tmp_path / "plate.dxf")
        text = (tmp_path / "plate.dxf").read_text()
        for scale, factor in zip(scales, (*inner, *outer), strict=True):
            assert text.count(f"\n{scale}\n") == 1
            text = text.replace(f"\n{scale}\n", f"\n{float(factor)}\n")
        found = read_drawing(self.saved(tmp_path, text))
        hole = 6.0 * abs(np.prod(inner[:2])) * np.prod(outer[:2])
        assert found.area == pytest.approx(3600.0 - hole)
