"""Model files: messages with lines, all at once; overrides; units; the way out and back."""

import contextlib
import functools
import hashlib
import re
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest

import shellcut
from free_model import FREE
from known_film import write_deck
from shellcut import (
    Mesh,
    ModelFileError,
    guillotine,
    opening_test,
    oscillating,
    read_model,
    trouser,
)
from shellcut.material.orthotropic import turned_moduli
from shellcut.mesh.structured import rectangle
from shellcut.model_file import shipped_models
from shellcut.model_file.material_keys import HARDENINGS, RATES
from shellcut.model_file.model import is_as_written, model_text
from shellcut.model_file.section_table import HEAD, LISTS, SECTIONS
from shellcut.model_file.source import parse
from shellcut.tool.shapes import tooth_ring

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def write(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)

    def write(text, name="x.toml"):
        Path(name).write_text(text)
        return name

    return write


def refusal(name, overrides=None):
    with pytest.raises(ModelFileError) as found:
        read_model(name, overrides)
    return str(found.value).splitlines()


def test_words_of_python_are_told_as_keys():
    assert read_model("opening").words("cut the mesh, Mesh.cut") == "cut the mesh, membrane.notch"
    said = 'young 1.678e+06 MPa: young is in MPa unless a unit is given: 1.678 GPa is 1678; or "x"'
    model = read_model("opening", {"material.young": "1678 GPa"})
    assert model.words(said) == (
        'young 1.678e+06 MPa: you gave 1678 GPa; did you mean 1.678 GPa?; or "x"'
    )
    assert read_model("opening", {"material.young": 1678e3}).words(said) == said


def test_all_problems_at_once_each_with_its_line(write):
    name = write(
        """model = "opening"
naem = "x"
[tool]
teehs = 4
radius = "3 MPa"
[motion]
pitch = [1,
  2]
angle = 3
[COHESIV]
strength = 1
[cohesive]
plateau = 30
[contact]
penalty = -2
[material]
density = "1 g/cm2"
pitch = 3
[[supports]]
nodes = "rim"
[[loads]]
kind = "wind"
[[loads]]
following = true
[time]
safety = true
"""
    )
    assert refusal(name) == [
        "x.toml:2: unknown key naem; did you mean name?",
        "x.toml:4: unknown key [tool].teehs; did you mean teeth?",
        "x.toml:5: [tool].radius must be a number in mm, got '3 MPa', which is in N/mm^2",
        "x.toml:7: [motion].pitch must be a number in mm, got [1, 2]",
        "x.toml:9: unknown key [motion].angle; did you mean angle_deg?",
        "x.toml:10: unknown section [COHESIV]; did you mean cohesive?",
        "x.toml:13: [cohesive]: the law must decrease: 0 < plateau <= strength, got plateau "
        "30.0 MPa, strength 18.0 MPa",
        "x.toml:15: [contact].penalty must be positive, got -2.0 N/mm^3",
        "x.toml:17: [material].density must be a number in t/mm^3, got '1 g/cm2', which is in "
        "N s^2/mm^3",
        "x.toml:18: unknown key [material].pitch; there is [motion].pitch",
        'x.toml:19: [[supports]] belongs to model = "free"; the opening model has its own supports',
        "x.toml:22: [loads.0].kind 'wind' is unknown; there are gravity, pressure, force, "
        "moment, traction",
        "x.toml:23: [loads.1].kind must be given: one of gravity, pressure, force, moment, "
        "traction",
        "x.toml:26: [time].safety must be a number, got True",
    ]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("model = 3", "model must be one of"),
        ("[tool]\nteeth = 3", "model must be given"),
        ("model = 'opening'\nmodel = 'free'", "value, model in line 2, first in line 1"),
        ("a = 1\nat = [1,\n\n  2\nkind = 'b'", "x.toml:5: is not a model file (TOML): Unclosed"),
        ("model = 'opening'\n[temperature]", "unknown section [temperature]; there are membrane,"),
        ("model = 'opening'\n[[tool]]\nteeth = 3", "x.toml:2: [tool] can occur only once"),
        ("model = 'opening'\n[loads]\nvalue = 3", "x.toml:2: [[loads]] must be written with doub"),
        ("model = 'opening'\n[tool]\nfile='a.stl'\nstl='a.stl'", "x.toml:4: [tool].stl repeats"),
        ("model = 'opening'\n[tool]\nfile='gone.stl'", "x.toml:3: [tool].file: there is no file /"),
        (
            "model = 'free'\n[tool]\nedge_angle_deg = 90\nedge_inclination_deg = 60",
            'x.toml:4: key [tool].edge_inclination_deg belongs to kind = "teeth", not to kind =',
        ),
        ("model = 'free'\n[motion]\npitch = 3", "x.toml:2: [motion].duration must be given"),
        ("model = 'opening'\nname = '../x'", "x.toml:2: name must be letters"),
        ("model = 'opening'\n[material]\nlayers = 3", "must be an array of tables, got 3"),
        ("model = 'opening'\nthreads = 1.5", "x.toml:2: threads must be a whole number, got 1.5"),
        ("model = 'opening'\n[tool]\nshift = [1, 2]", "[tool].shift must be an array of 3 numbers"),
    ],
)
def test_refusals(write, text, said):
    assert any(said in line for line in refusal(write(text)))


def test_text_that_is_no_utf_8_is_refused(write):
    Path("x.toml").write_bytes("model = 'opening'  # Öffnung".encode("latin-1"))
    with pytest.raises(ModelFileError, match="must be text in UTF-8"):
        read_model("x.toml")


def remembered(constructor):
    """Return a constructor that makes equal things once; films and tools are read-only."""
    cached = functools.cache(constructor)

    @functools.wraps(constructor)
    def made(**arguments):
        try:
            hash(tuple(arguments.values()))
        except TypeError:
            return constructor(**arguments)
        return cached(**arguments)

    return made


KINDS = {kind for sections in SECTIONS.values() for kinds in sections.values() for kind in kinds}
REMEMBERED = {kind: remembered(kind.constructor) for kind in KINDS if kind.constructor is not None}
JUNK = ["3", "-1.5", "nan", "'x'", "''", "true", "[]", "[[]]", "['x',1]", "{a=1}", "1979-05-27"]


@pytest.mark.parametrize(
    "fail",
    [
        lambda: np.linalg.inv(np.zeros((2, 2))),  # raised in NumPy's Python
        lambda: turned_moduli(np.zeros((2, 2)), 0.0),  # in its C, called by shellcut
    ],
)
def test_a_failure_inside_a_library_is_no_fault_of_the_file(write, monkeypatch, fail):
    (kind,) = (kind for kind in SECTIONS["opening"]["time"] if kind.constructor)
    with pytest.raises(ValueError) as own:  # noqa: PT011
        fail()
    monkeypatch.setattr(kind, "constructor", lambda **_: fail())
    with pytest.raises(type(own.value), match=re.escape(str(own.value))) as told:
        read_model(write("model = 'opening'"))
    assert not isinstance(told.value, ModelFileError)


@pytest.mark.parametrize("junk", JUNK)
def test_junk_ends_in_no_other_error(write, monkeypatch, junk):
    for kind, constructor in REMEMBERED.items():  # spares most of the time
        monkeypatch.setattr(kind, "constructor", constructor)
    seen = set()
    for model, sections in SECTIONS.items():
        for title, kinds in [*sections.items(), *LISTS[model].items()]:
            head = f"[{title}]" if title in sections else f"[[{title}]]"
            for kind in set(kinds) - seen:
                seen.add(kind)
                lines = [f"{name} = {junk}" for name in kind.keys]
                lines += [f"kind = '{kind.name}'"] if kind.name else []
                with contextlib.suppress(ModelFileError):  # 3 is a damping
                    read_model(write("\n".join([f"model = '{model}'", head, *lines])))
            assert refusal(write(f"model = '{model}'\n{head}\nkind = {junk}\n"))
            if title in sections:
                name = next(iter(kinds[0].keys))
                text = f"model = '{model}'\n{title} = {junk}\n"
                assert refusal(write(text), {f"{title}.{name}": "z"})
    for name, kinds in (("hardening", HARDENINGS), ("rate", RATES)):
        for kind in kinds:
            keys = ", ".join(f"{key} = {junk}" for key in kind.keys)
            table = f"[material]\n{name} = {{kind = '{kind.name}', {keys}}}\n"
            with contextlib.suppress(ModelFileError):
                read_model(write(f"model = 'opening'\n{table}"))
    for name in HEAD.keys:
        others = "" if name == "model" else "model = 'opening'\n"
        with contextlib.suppress(ModelFileError):  # name = "x", threads = 3
            read_model(write(f"{others}{name} = {junk}\n"))


def test_lines_are_found_past_strings_arrays_and_comments():
    text = '''a = "x # [no]"   # [neither]
b = """
[not] = here
key = 1
"""
c = [ # a list
  [1, 2],
  "]",
]
[one.two]
"quoted key" = 3
d.e = 4
[[many]]
k = { l = 1, m = [2] }
[[many]]
k = 2
'''
    found = parse(text, "x", Path()).lines
    lines = {"a": 1, "b": 2, "c": 6, "one": 10, "one.two": 10, "one.two.quoted key": 11}
    lines |= {"one.two.d": 12, "one.two.d.e": 12, "many": 13, "many.0": 13, "many.0.k": 14}
    assert {".".join(map(str, key)): line for key, line in found.items()} == lines | {
        "many.1": 15,
        "many.1.k": 16,
    }


# --- names and overrides -------------------------------------------------------------------------


def test_shipped_models_are_package_data_and_told():
    shipped = shipped_models()
    assert set(shipped) == {"free", "guillotine", "opening", "oscillating", "trouser"}
    for name, text in shipped.items():
        assert text == files("shellcut.models").joinpath(f"{name}.toml").read_text("utf-8")
        assert all(len(line) <= 90 for line in text.splitlines())
    (line,) = refusal("openign")
    assert "free, guillotine, opening, oscillating, trouser; did you mean opening?" in line


@pytest.mark.parametrize("builder", [opening_test, guillotine, trouser, oscillating])
def test_a_shipped_model_is_the_builder_with_its_defaults(builder):
    name = builder.__name__.removesuffix("_test")
    length = 30.0 if name == "oscillating" else 8.0
    keys = {"size": 1.0, "membrane.length": length} if name != "opening" else {"mesh": "quick"}
    case = read_model(name, keys).build()
    same = builder("quick") if name == "opening" else builder(1.0, length=length)
    assert (case.name, case.duration) == (same.name, same.duration)
    ours, theirs = case.simulation, same.simulation
    np.testing.assert_array_equal(ours.mesh.nodes, theirs.mesh.nodes)
    if name != "trouser":
        np.testing.assert_array_equal(ours.tool.vertices, theirs.tool.vertices)
    for part in ("material", "law", "motion", "fracture", "dt"):
        assert getattr(ours, part) == getattr(theirs, part), part


def test_overrides_by_dotted_and_bare_keys_may_change_the_kind(tmp_path, monkeypatch):
    model = read_model("opening", {"mesh": "quick", "tool.teeth": 3, "strength": "20 MPa"})
    assert model.sections["membrane"].mesh == "quick"
    assert model.sections["tool"].teeth == 3
    assert model.sections["cohesive"].strength == 20.0
    tooth_ring().write(tmp_path / "cap.stl")
    monkeypatch.chdir(tmp_path)
    tool = read_model("opening", {"tool.stl": "cap.stl"}).sections["tool"]
    assert tool.file == str(tmp_path / "cap.stl")  # relative to where the user is
    assert tool.kind == "file"


@pytest.mark.parametrize(
    ("overrides", "said"),
    [
        ({"file": "x"}, "several sections have this key: write one of membrane.file, tool.file"),
        ({"mseh": "quick"}, "set mseh=quick: no section has this key; did you mean mesh?"),
        ({"tool.teehs": 3}, "set tool.teehs=3: unknown key [tool].teehs; did you mean teeth?"),
        ({"tol.teeth": 3}, "set tol.teeth=3: there is no section [tol]; did you mean tool?"),
        ({"tool.teeth": 0}, "set tool.teeth=0: [tool].teeth must be 1 or more, got 0"),
        ({"tool.step": "x.step"}, "unknown key [tool].step; did you mean file?"),
        ({"tool.teeth": 3, "tool.file": "x.stl"}, "[tool].file and [tool].teeth exclude"),
        ({"density": 1000}, "set density=1000: [material]: density must be in t/mm³, got 1000.0"),
        ({"loads.value": 3}, "choose one by its number from 0 on, loads.0.value"),
    ],
)
def test_an_override_that_fits_not_is_named(overrides, said):
    assert any(said in line for line in refusal("opening", overrides))


def test_paths_in_a_file_are_relative_to_it(tmp_path, monkeypatch):
    (tmp_path / "parts").mkdir()
    tooth_ring().write(tmp_path / "parts" / "cap.stl")
    path = tmp_path / "x.toml"
    path.write_text('model = "opening"\n[tool]\nstl = "parts/cap.stl"\nscale = 1\n')
    monkeypatch.chdir("/")
    tool = read_model(path).sections["tool"]
    assert tool.file == str(tmp_path / "parts" / "cap.stl")
    assert tool.unit == 1.0


# --- used.toml -----------------------------------------------------------------------------------


def test_what_is_written_has_every_key_its_unit_and_a_digest(tmp_path):
    model = read_model("opening", {"mesh": "quick"})
    model.write(tmp_path / "used.toml")
    text = (tmp_path / "used.toml").read_text()
    schema, digest, body = text.split("\n", 2)
    assert schema == "#:schema ./shellcut.schema.json"
    assert digest == f"# sha256 of all below: {hashlib.sha256(body.encode()).hexdigest()}"
    assert f"# shellcut {shellcut.__version__}" in body
    assert re.search(r"^young = 1678.0 +# \[MPa\] Young's modulus$", text, re.M)
    for section in model.sections.values():
        for key in section.of.keys:
            assert re.search(rf"^(# )?{key} =", text, re.M), key
    again = read_model(tmp_path / "used.toml")
    assert again == model
    assert model_text(again) == text
    assert is_as_written(text)
    assert not is_as_written(text.replace("1678", "1679"))
    assert not is_as_written(text.partition("\n")[2])


# --- what the parts refuse -----------------------------------------------------------------------


def test_a_free_model_cuts_as_the_guillotine_does(write):
    # Free models are damped by a share of critical, strips of the guillotine by a time.
    case = read_model(write(FREE), {"damping.beta": 5e-8}).build()
    same = guillotine(0.5, length=6.0, width=4.0, notch=1.0, travel=2.7)
    mine, other = (one.simulation.cracks.tips for one in (case, same))
    assert [tip.ends for tip in mine] == [tip.ends for tip in other]
    case.simulation.run(5e-4)
    same.simulation.run(5e-4)
    ours, theirs = case.simulation, same.simulation
    np.testing.assert_allclose(ours.state.node.x, theirs.state.node.x, rtol=0, atol=1e-9)
    assert ours.state.crack_length == pytest.approx(theirs.state.crack_length)
    assert ours.state.n_cable == theirs.state.n_cable >= 1


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('["bottom", "top"]', '["bottom", "tpo"]', "x.toml:6: [membrane]: "),
        ("notch = 1.0", "notch = 0.1", "notch of 0.1 mm must be at least one quad side"),
        ("[motion]", '[fracture]\npath = "imprint"\n[motion]', "got 'imprint'; cracks run through"),
        ('model = "', 'precision = "single"\nmodel = "', "precision; leave it out: all is"),
        ("[motion]", "[output]\npvd = true\n[motion]", "[output].pvd; leave it out: ParaView"),
        ("[motion]", '[fracture]\ncandidates = "all"\n[motion]', "[fracture].candidates; leave it"),
        ("0.0, 0.0]", '0.2, 0.0]\n[fracture]\npath = "edges"', "quad sides needs a row of them"),
        ("notch = 1.0", "imprint = false", '[fracture] path = "free" cuts through the quads'),
        ("-0.05", "3.0", "tool"),
        ("[motion]", '[[supports]]\nnodes = "lfet"\n[motion]', "x.toml:13: [supports.0]: "),
        ("[motion]", '[[loads]]\nvalue = 1\nquads = "all"\n[motion]', "x.toml:13: [loads.0]: "),
        ("length = 6.0\nwidth", "outline = [[0,0],[1,1],[1,0],[0,1]]\nsize=1\n[a]\nwidth", "[a]"),
        ("[1, 0, 0]", "[0, 0, 0]", "x.toml:14: [motion]: direction must"),
    ],
)
def test_what_the_parts_refuse_names_its_section(write, old, new, said):
    assert old in FREE
    with pytest.raises(ModelFileError) as refused:
        read_model(write(FREE.replace(old, new, 1))).build()
    assert said in str(refused.value)


def test_a_film_of_ones_own_is_clamped_by_its_set(write):
    sheet, sets = rectangle(8.0, 8.0, size=1.0), {"held": [0, 1, 2], "rim": [3]}
    at_origin = sheet.nodes - np.array([4.0, 0.0, 0.0])
    write_deck(Path("film.inp"), Mesh.from_arrays(at_origin, sheet.quads, node_sets=sets))
    name = write(
        'model = "opening"\n[membrane]\nfile = "film.inp"\nunit = "mm"\nclamp = "held"\n'
        "[fracture]\npath = 'edges'\n[tool]\nradius = 3.0\nteeth = 2\nheight = 1.0\n"
    )
    sim = read_model(name).build().simulation
    assert np.flatnonzero(sim.state.node.supported[: sim.mesh.n_node]).tolist() == [0, 1, 2]
    with pytest.raises(ModelFileError, match=r"x.toml:5: \[membrane\]: .*'hedl'.*held"):
        read_model(write(Path("x.toml").read_text().replace('"held"', '"hedl"'))).build()


def test_the_model_on_the_page_reads(write):
    page = (ROOT / "docs" / "howto" / "model-file.md").read_text()
    for name in ("disc.msh", "cap.stl"):
        write("", name)
    model = read_model(write(re.search(r"```toml\n(.*?)```", page, re.S)[1]))
    assert model.sections["membrane"].clamp == ("rim",)
    assert model.sections["motion"].duration == 6e-3


@pytest.mark.parametrize(
    ("model", "file", "key", "drop"),
    [
        ("opening", "disc.msh", "[membrane].mesh", "mesh"),
        ("opening", "cap.stl", "[tool].teeth", "teeth, radius, edge_inclination_deg, "),
        ("free", "film.msh", "[membrane].length", "length, width, size"),
        ("free", "knife.step", "[tool].edge_angle_deg", "kind, edge_angle_deg, wedge_half_angle"),
        ("free", "motion.csv", "[motion].direction", "kind, direction, speed"),
    ],
)
def test_a_line_of_a_template_that_is_switched_on_says_what_to_drop(write, model, file, key, drop):
    text, line = shipped_models()[model], f'file = "{file}"'
    assert f"# {line}" in text
    (said,) = refusal(write(text.replace(f"# {line}", line)))
    assert f"{key} exclude each other: leave out file, or {drop}" in said


def test_an_override_says_which_keys_of_the_file_give_way(write, caplog):
    path = write('model = "opening"\n[membrane]\nfile = "gone.msh"\nunit = "mm"\nclamp = "rim"')
    assert read_model(path, {"mesh": "quick"}).sections["membrane"].mesh == "quick"
    (said,) = caplog.messages
    assert "set mesh=quick: replaces file, unit, clamp in [membrane] (" in said
    assert "x.toml:3)" in said
    caplog.clear()
    read_model("free", {"membrane.mesh": "quick"})  # of the package: no file of the user's
    disc = {"membrane.radius": 5.0, "membrane.n_side": 8}  # the sheet's size gives way, too
    assert read_model("free", disc).sections["membrane"].values["size"] is None
    assert caplog.messages == []
