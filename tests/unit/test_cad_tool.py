"""Tools from STEP and IGES, written by Gmsh's OpenCASCADE here and by CadQuery in data."""

from contextlib import contextmanager
from math import pi, radians, tan
from pathlib import Path

import numpy as np
import pytest

from damaged.mutations import mutated
from other_script import run_instead
from shellcut import read_tool
from shellcut.formats import cad_surface, own_process
from shellcut.formats.errors import FileError
from shellcut.tool.shapes import straight_blade

DATA = Path(__file__).parent / "data"
# Of data/two_teeth_inch, as CadQuery prints them in make_cad_files.py.
TEETH_VOLUME, TEETH_AREA = 27.24247719318988, 83.40479060760168

pytest.importorskip("gmsh", exc_type=ImportError)


@contextmanager
def kernel():
    """An empty model of Gmsh's OpenCASCADE."""
    import gmsh

    gmsh.initialize(readConfigFiles=False, interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.model.add("cad")
        yield gmsh
    finally:
        gmsh.finalize()


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """Write shapes, made by a function that takes Gmsh's kernel, under a name."""
    folder = tmp_path_factory.mktemp("cad")

    def write(name, shape):
        path = folder / name
        with kernel() as gmsh:
            shape(gmsh.model.occ)
            gmsh.model.occ.synchronize()
            gmsh.write(str(path))
        return path

    return write


def wedge(occ, length=6.0, height=6.0):
    """The package's straight blade as a solid."""
    back = 0.3 / tan(radians(10.0))
    profile = [(0, 0), (-back, -0.3), (-length, -0.3), (-length, 0.3), (-back, 0.3)]
    corners = [occ.addPoint(x, y, -0.5 * height) for x, y in profile]
    sides = [occ.addLine(a, b) for a, b in zip(corners, corners[1:] + corners[:1], strict=True)]
    face = occ.addPlaneSurface([occ.addCurveLoop(sides)])
    return [part for part in occ.extrude([(2, face)], 0.0, 0.0, height) if part[0] == 3]


def ring(occ):
    """Four teeth around the z axis."""
    for k in range(4):
        tooth = wedge(occ)
        occ.translate(tooth, 0.0, 10.0, 0.0)
        occ.rotate(tooth, 0, 0, 0, 0, 0, 1, 0.5 * pi * k)


def area(tool):
    a, b, c = (tool.vertices[tool.triangles[:, k]] for k in range(3))
    return 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()


@pytest.mark.parametrize("name", ["cylinder.step", "cylinder.igs"])
def test_volume_and_area_converge_with_the_chord_deviation(written, name):
    path = written(name, lambda occ: occ.addCylinder(0, 0, 0, 0, 0, 10.0, 5.0))
    missing = []
    for chord in (0.05, 1e-3):
        tool = read_tool(path, chord_deviation=chord, sharp_angle_deg=80.0)
        assert tool.n_body == 1
        # closed edges; the seam of the cylinder is none
        assert [chain.closed for chain in tool.chains()] == [True, True]
        assert tool.chains()[0].length == pytest.approx(10.0 * pi, rel=chord)
        missing.append(1.0 - tool.volume().sum() / (250.0 * pi))
        # chords cut off two thirds of their height, at most the deviation: 4 d / 3 r
        assert 0.0 < missing[-1] < 4.0 * chord / 15.0
        assert 0.0 < 1.0 - area(tool) / (150.0 * pi) < 4.0 * chord / 15.0
        radius = np.hypot(*tool.vertices[:, :2].T)
        np.testing.assert_allclose(radius, 5.0, atol=1e-5)  # sewn within a tenth of the deviation
    assert missing[0] > 20.0 * missing[1]


@pytest.mark.parametrize("suffix", [".stp", ".iges"])
def test_wedges_are_bodies_with_their_edges(written, suffix, caplog):
    tool = read_tool(written(f"ring{suffix}", ring))
    assert tool.n_body == 4
    assert [chain.length for chain in tool.chains()] == pytest.approx([6.0] * 4, rel=1e-9)
    for chain in tool.chains():
        assert chain.turn_deg == pytest.approx((160.0, 160.0))
    assert tool.volume() == pytest.approx(straight_blade(length=6.0).volume().repeat(4), rel=1e-9)
    assert "the file states the unit mm: the tool is 2" in caplog.text
    assert "4 cutting edges found by angle, 24 mm in all, of 4 bodies" in caplog.text


class TestUnits:
    @pytest.mark.parametrize("name", ["two_teeth_inch.step", "two_teeth_inch.iges"])
    def test_inches_of_another_program(self, name, caplog):
        tool = read_tool(DATA / name, chord_deviation=2e-4)
        assert tool.n_body == 2
        assert tool.volume().sum() == pytest.approx(TEETH_VOLUME, rel=3e-4)  # 4 d / 3 r
        assert area(tool) == pytest.approx(TEETH_AREA, rel=3e-4)
        assert [chain.length for chain in tool.chains()] == pytest.approx([4.0, 4.0], rel=1e-6)
        assert "states the unit inch, converted to mm: the tool is 11.8 mm across" in caplog.text

    def test_each_unit_is_applied_once(self, written, caplog):
        path = written("cm.step", lambda occ: occ.addBox(0, 0, 0, 0.3, 0.4, 0.5))
        mm, cm = "SI_UNIT(.MILLI.,.METRE.)", "CONVERSION_BASED_UNIT('CENTIMETRE',#901)"
        text = path.read_text().replace(
            f"LENGTH_UNIT() NAMED_UNIT(*) {mm}", f"{cm} LENGTH_UNIT() NAMED_UNIT(#903)"
        )
        more = "#901=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(10.),#902);\n"
        more += f"#902=(LENGTH_UNIT()NAMED_UNIT(*){mm});\n"
        more += "#903=DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.);"
        path.write_text(text.replace("\nENDSEC;\nEND-ISO", f"\n{more}\nENDSEC;\nEND-ISO"))
        for unit in (None, "cm"):
            tool = read_tool(path, sharp_angle_deg=80.0, unit=unit)
            assert tool.volume().sum() == pytest.approx(60.0)
        assert "states the unit cm, converted to mm: the tool is 5 mm across" in caplog.text

    def test_a_given_unit_goes_before(self, caplog):
        tool = read_tool(DATA / "two_teeth_inch.step", unit="mm", chord_deviation=1e-3)
        assert "at most 0.001 mm off a curved face" in caplog.text
        assert tool.n_triangle < 200  # of 0.46 mm: as coarse as 0.0254 mm on 11.8 mm
        assert tool.volume().sum() == pytest.approx(TEETH_VOLUME / 25.4**3, rel=0.02)
        assert "the file states the unit inch, but is read in mm as given" in caplog.text

    def test_an_unlikely_size_is_a_wrong_unit(self, written):
        path = written("wide.step", lambda occ: occ.addBox(0, 0, 0, 2540, 10, 10))
        with pytest.raises(FileError, match=r"0\.1 to 2000 mm across, got 2540 mm.* give unit="):
            read_tool(path, sharp_angle_deg=80.0)
        assert read_tool(path, sharp_angle_deg=80.0, unit="mm").n_body == 1

    def test_several_units_become_mm(self, monkeypatch, caplog):
        monkeypatch.setattr(cad_surface, "stated_unit", lambda path, content: [1.0, 25.4])
        assert read_tool(DATA / "two_teeth_inch.step").volume().sum() == pytest.approx(
            27.2, rel=0.01
        )
        assert "units of 1 and 25.4 mm: all lengths are converted to mm" in caplog.text
        with pytest.raises(FileError, match=r"unit= must not be given, got 10 mm"):
            read_tool(DATA / "two_teeth_inch.step", unit="cm")


def hollow(occ):
    occ.cut([(3, occ.addBox(0, 0, 0, 5, 5, 5))], [(3, occ.addSphere(2.5, 2.5, 2.5, 1))])


def touching(occ, x=1.0):
    occ.addBox(0, 0, 0, 1, 1, 1)
    occ.addBox(x, 0.2, 0.2, 0.4, 0.4, 0.4)
    occ.addBox(5, 0, 0, 1, 1, 1)


def within(occ):
    touching(occ, 0.2)


def opened(occ):
    occ.addBox(0, 0, 0, 3, 4, 5)
    occ.remove([(3, 1)])
    occ.remove([(2, 6)])


def sketch(occ):
    occ.addCircle(0, 0, 0, 3)


class TestRefusals:
    @pytest.mark.parametrize(
        ("shape", "suffix", "words"),
        [
            (hollow, ".step", "solid 1 has a cavity: fill it"),
            (touching, ".step", "bodies touch or overlap: 1 and 2 near .*; unite them"),
            (within, ".step", "bodies touch or overlap: 1 and 2 near .*; unite them"),
            (opened, ".step", r"open edges: the surface has a hole around \(1.5, 2, 5\)"),
            (opened, ".iges", r"open edges: the surface has a hole around \(1.5, 2, 5\)"),
            (sketch, ".step", "there must be surfaces, got none"),
        ],
    )
    def test_shapes_that_are_no_tool(self, written, shape, suffix, words):
        with pytest.raises(ValueError, match=words):
            read_tool(written(f"{shape.__name__}{suffix}", shape), sharp_angle_deg=80.0)

    @pytest.mark.parametrize(
        ("name", "content", "words"),
        [
            ("a.step", b"solid cap\nendsolid", "must begin with ISO-10303-21"),
            ("a.iges", b"solid cap\nendsolid", "an S in column 73"),
            ("a.step", b"ISO-10303-21;\nHEADER;\nENDSEC;\n", "Gmsh cannot read it"),
        ],
    )
    def test_what_is_no_cad_file(self, tmp_path, name, content, words):
        (tmp_path / name).write_bytes(content)
        with pytest.raises(FileError, match=words):
            read_tool(tmp_path / name)

    @pytest.mark.parametrize(
        ("chord", "words"),
        [
            (-1.0, "must be a finite length above 0"),
            (50.0, r"must be 0\.00013 to 1\.3 mm for a tool with a diagonal of 12\.56"),
        ],
    )
    def test_deviations(self, tmp_path, chord, words):
        with pytest.raises(ValueError, match=words):
            read_tool(DATA / "two_teeth_inch.step", chord_deviation=chord)
        straight_blade().write(tmp_path / "a.stl")
        with pytest.raises(FileError, match="chord_deviation is for STEP and IGES"):
            read_tool(tmp_path / "a.stl", unit="mm", chord_deviation=0.1)

    @pytest.mark.parametrize(
        ("script", "error", "words"),
        [
            ("import os; os.abort()", FileError, r"Gmsh broke down on it \(code -6\)"),
            ("raise OSError('libGLU.so.1')", ImportError, "cannot be loaded: OSError: libGLU"),
            ("raise ValueError('odd')", FileError, "cannot read it: ValueError: odd"),
            ("import time; time.sleep(60)", FileError, "did not finish within 0.5 s"),
        ],
    )
    def test_a_kernel_that_breaks_down(self, tmp_path, monkeypatch, script, error, words):
        # OpenCASCADE ends the process, or never ends, on one damaged file in ten
        run_instead(monkeypatch, tmp_path, script)
        if "sleep" in script:
            monkeypatch.setattr(own_process, "LONGEST", 0.5)
        with pytest.raises(error, match=words):
            read_tool(DATA / "two_teeth_inch.step")


def test_a_solid_that_is_lost_is_told(tmp_path, caplog):
    content = (DATA / "two_teeth_inch.step").read_bytes()
    first = content.index(b"CLOSED_SHELL(")
    path = tmp_path / "lost.step"
    path.write_bytes(content[:first] + b"CLOSED_SHELX(" + content[first + 13 :])
    assert read_tool(path).n_body == 1
    assert "2 solids are in the file, 1 could be read: is it damaged?" in caplog.text


def test_damaged_files_are_refused_or_whole(tmp_path, caplog):
    rng = np.random.default_rng(3)
    content = (DATA / "two_teeth_inch.step").read_bytes()
    path = tmp_path / "damaged.step"
    n_refused = 0
    for k in range(4):
        cut = content[: int(rng.integers(len(content)))]
        path.write_bytes(mutated(rng, content, text=True)[0] if k % 2 else cut)
        caplog.clear()
        try:
            tool = read_tool(path)
        except ValueError:
            n_refused += 1
            continue
        assert tool.n_body == 2 or "could be read: is it damaged?" in caplog.text
    assert n_refused >= 2
