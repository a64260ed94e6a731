"""No key of a model file is silently ignored: each is varied, and what is built must differ.

The builders are replaced by ones that keep their arguments, and the readers of files by ones that
keep theirs, so that nothing but the way from the file to them is looked at.
"""

import dataclasses
import functools
import inspect
import sys

import numpy as np
import pytest

from known_film import write_deck
from shellcut import FilmOutline, Simulation, oscillating, read_drawing, read_model
from shellcut.mesh.structured import opening_disc, rectangle
from shellcut.model_file import build, shipped_models
from shellcut.model_file.key import written
from shellcut.model_file.material_keys import (
    HARDENINGS,
    HOMOGENEOUS,
    LAMINATE,
    PLY,
    RATES,
    read_hardening,
)
from shellcut.model_file.schema import schema
from shellcut.model_file.section_table import HEAD, LISTS, OUTPUT, SECTIONS, SUPPORT
from shellcut.recording.run_options import RunOptions
from shellcut.study.plan import study_schema
from shellcut.tool.shapes import straight_blade, tooth_ring
from shellcut.tool_shapes import round_bar

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

SQUARE = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]]
BILINEAR = {"strength": 18.0, "knee_opening": 0.5, "knee_traction": 3.0}
# What a kind needs to be there at all.
GIVEN = {
    ("membrane", "opening"): {"mesh": "quick"},
    ("membrane", "rectangle"): {"length": 4.0, "width": 4.0, "size": 1.0},
    ("membrane", "disc"): {"radius": 5.0, "n_side": 4},
    ("membrane", "file"): {"file": "film.inp"},
    ("membrane", "outline"): {"outline": SQUARE, "size": 1.0},
    ("membrane", "drawing"): {"drawing": "plate.dxf", "size": 1.0},
    ("tool", "file"): {"file": "cap.stl"},
    ("motion", "screw"): {"angle_deg": 20.0, "duration": 1e-3},
    ("motion", "straight"): {"direction": [1.0, 0.0, 0.0], "speed": 100.0, "duration": 1e-3},
    ("motion", "table"): {"file": "motion.csv"},
    ("loads", "gravity"): {"acceleration": [0.0, 0.0, 1.0]},
    ("cohesive", "linear"): {"strength": 18.0, "opening_u": 4.0},
    ("cohesive", "bilinear"): {**BILINEAR, "opening_u": 4.0},
    ("cohesive", "exponential"): {"strength": 18.0, "fracture_energy": 5.0},
    ("cohesive", "table"): {"openings": [0.0, 1.0, 4.0], "tractions": [18.0, 9.0, 0.0]},
    ("loads", "pressure"): {"value": 1.0},
    ("loads", "force"): {"nodes": "rim", "force": [0.0, 0.0, 1.0]},
    ("loads", "moment"): {"nodes": "rim", "moment": [0.0, 1.0, 0.0]},
    ("loads", "traction"): {"nodes": "rim", "traction": [0.0, 0.0, 1.0]},
    ("supports", ""): {"nodes": "rim"},
}
GIVEN_TO_STRIPS = {("motion", "straight"): {"speed": 100.0}}
LAYER = {"young": 1000.0, "poisson": 0.3, "density": 1e-9, "thickness": 0.03}
AXES = {"young_across": 900.0, "shear": 400.0}
YIELDS = {"kind": "linear", "yield_stress": 10.0}
# What a key of a material needs beside it.
BESIDE = {
    **dict.fromkeys(("young_across", "shear", "angle_deg"), AXES),
    **dict.fromkeys(("shear_through", "shear_through_across"), AXES),
    "r_values": {"hardening": YIELDS},
}
# What a key of another section needs beside it.
NEEDED_BY = {
    "joint_friction": {"joint": "slip", "joint_friction": 0.3},
    "severing_pressure": {"cutting_energy": 2.9},
    "self_friction": {"self_contact": True},
}
# Tables of a material, by kind.
INNER = {
    "linear": {"yield_stress": 10.0},
    "voce": {"yield_stress": 10.0, "gain": 2.0, "strain": 0.1},
    "swift": {"strength": 30.0, "start": 0.01, "exponent": 0.2},
    "table": {"plastic_strain": [0.0, 1.0], "stress": [1.0, 4.0]},
    "file": {"file": "curve.csv"},
    "cowper_symonds": {"rate": 5.0, "exponent": 5.0},
    "johnson_cook": {"rate": 5.0, "factor": 0.1},
}
# Other values where a tenth more, one more, or the other choice would not do.
VARIED = {
    "edge_angle_deg": 80.0,
    "mesh": "M1",
    "clamp": ["other"],
    "unit": 2.0,
    "axis": [0.0, 1.0, 0.0],  # a strip along x stays one
    "outline": [[0.0, 0.0], [5.0, 0.0], [5.0, 4.0], [0.0, 4.0]],
    "holes": [[[1.0, 1.0], [2.0, 1.0], [2.0, 2.0], [1.0, 2.0]]],
    "ring_radii": [4.0],
    "leave_out": ["C3D8"],
    "not_cutting": [1],
    "merge": 1e-3,
    "n_arc": 40,
    "n_layer": 3,
    "points_per_layer": 3,
    "fixed": 1e-8,
    "threads": 2,
    "name": "other",
    "nodes": [1, 2],
    "quads": "chosen",
    "translation": "xy",
    "rotation": "",
    "velocity": {"x": 2.0},
    "spin": {"z": 2.0},
    "advance": [0.0, 1.0, 0.0],
    "travel": 3.0,
    "duration": 1.5e-3,
    "safety": 0.9,
    "poisson": 0.2,
    "density": 2e-9,
    "file": "other",
    "drawing": "other.dxf",
    "length": 4.4,
    "width": 7.2,
    "notch": 1.0,
    "opening_a": 0.04,
    "knee_opening": 0.7,
    "openings": [0.0, 1.0, 5.0],
    "tractions": [18.0, 8.0, 0.0],
    "ramp": 1e-4,
    "model": None,
    "cutting_energy": 2.9,
    "preset": "pet",
    "law": "hencky",
    "plastic_strain": [0.0, 0.5],
    "stress": [1.0, 5.0],
    "exponent": 1.0,
    "machine_direction": [0.0, 1.0, 0.0],
}


FILMS = {kind for layout in SECTIONS.values() for kind in layout["material"]} - {LAMINATE}


# The next tests vary these; those of test_path_film.py the tools.
ELSEWHERE_VARIED = {"hardening", "rate", "layers", "n_x", "n_y", "quads", "tools"}


def cases():
    """Every key of each kind in one model; in other models that have the kind, its first key."""
    seen = set()
    for layout in (SECTIONS, LISTS):
        for model, sections in layout.items():
            for title, kinds in sections.items():
                for kind in kinds:
                    keys = [key for key in kind.keys if key not in ELSEWHERE_VARIED]
                    if kind is LAMINATE:
                        keys.remove("preset")  # test_material_keys.py
                    elif kind in FILMS and kind is not HOMOGENEOUS:
                        keys = [key for key in keys if key not in BESIDE]  # those of HOMOGENEOUS
                    for key in keys[:1] if kind in seen else keys:
                        name = f"{model}-{title}-{kind.name}-{key}"
                        yield pytest.param(model, title, kind, key, id=name)
                    seen.add(kind)
    for model in SECTIONS:
        for key in ("name", "directional", "threads"):
            yield pytest.param(model, "", HEAD, key, id=f"{model}-{key}")
    for key in PLY.keys:
        if not PLY.keys[key].kinds:
            yield pytest.param("opening", "material.layers", PLY, key, id=f"layers-{key}")
    for title in ("material", "material.layers"):
        for name, kinds in (("hardening", HARDENINGS), ("rate", RATES)):
            for kind in kinds:
                for key in kind.keys:
                    where = f"{title}.{name}"
                    yield pytest.param("opening", where, kind, key, id=f"{where}-{kind.name}-{key}")


def other_value(kind, key):
    wants = kind.keys[key].form.wants
    default = kind.keys[key].default
    if key in VARIED:
        return VARIED[key]
    if wants.startswith('"'):
        return next(c for c in wants.replace('"', "").split(", ") if c != default)
    if isinstance(default, bool):
        return not default
    if isinstance(default, tuple) or wants == "array of 3 numbers":
        return [0.5, 0.25, 2.0]
    base = default if type(default) in (int, float) else 4
    if wants.startswith("whole number"):
        return base + 2
    return 1.1 * base if base else 0.1


def described(thing):
    """Everything about a thing in text: arrays by their bytes, dataclasses by their fields."""
    if isinstance(thing, np.ndarray):
        return thing.shape, thing.tobytes()
    if dataclasses.is_dataclass(thing):
        fields = {f.name: described(getattr(thing, f.name)) for f in dataclasses.fields(thing)}
        return type(thing).__name__, tuple(fields.items())
    if hasattr(thing, "items"):
        return tuple((name, described(value)) for name, value in thing.items())
    if isinstance(thing, tuple | list):
        return tuple(described(one) for one in thing)
    return repr(thing)


MIRRORS = {
    kind: f"{title}-{kind.name}"
    for layout in (SECTIONS, LISTS)
    for sections in layout.values()
    for title, kinds in sections.items()
    for kind in kinds
    if kind.constructor is not None
} | {PLY: "layers", **{kind: kind.name for kind in (*HARDENINGS, *RATES)}}
# Tools and discs are the same in nearly all of these models.
ONCE = {real: functools.cache(real) for real in (tooth_ring, straight_blade, opening_disc)}
BAR_ONCE = functools.cache(round_bar)


@dataclasses.dataclass(frozen=True)
class Made:
    """In the place of a case: with what a builder was called."""

    name: str
    simulation: tuple


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    tmp_path = tmp_path_factory.mktemp("model")
    sheet = rectangle(4.0, 4.0, size=1.0)
    sets = {"rim": sheet.boundary_nodes(), "other": sheet.node_set("left")}
    sheet = sheet.with_sets(node_sets=sets, quad_sets={"chosen": [0, 1]})
    for name in ("film.inp", "other.inp"):
        write_deck(tmp_path / name, sheet)
    tooth_ring().write(tmp_path / "cap.stl")
    tooth_ring(n_teeth=2).write(tmp_path / "other.stl")
    for name in ("plate.dxf", "other.dxf"):
        (tmp_path / name).write_text("read by nothing but the digest")
    for name, end in (("curve", 20), ("other_curve", 30)):
        (tmp_path / f"{name}.csv").write_text(f"strain [-],stress [MPa]\n0,10\n1,{end}\n")
    for name, z in (("motion", -1.0), ("other", -2.0)):
        (tmp_path / f"{name}.csv").write_text(f"time [ms], z [mm]\n0, 0\n1, {z}\n2, {2 * z}\n")
    return tmp_path


def model_text(model, title, kind, values):
    """A model file with one section of this kind and the least of others."""
    texts = {"": {"model": model}}
    if model == "free":
        texts["membrane"] = {"kind": "opening", "mesh": "quick"}
        texts["motion"] = {"kind": "screw", "angle_deg": 20.0, "duration": 1e-3}
    elif model == "opening":
        texts["membrane"] = {"mesh": "quick"}
    elif model == "oscillating":
        texts["membrane"] = {"size": 2.0}
    there = {"guillotine": "top", "trouser": "up", "oscillating": "top"}.get(model)
    if title == "loads" and there and values.get("nodes") == "rim":
        values = {**values, "nodes": there}
    if title == "material.rate":
        texts["material.hardening"] = YIELDS
    if title.startswith("material.layers"):
        texts["material"] = {}
    elif kind.name:
        texts[title] = {"kind": kind.name, **values}
    else:
        texts[title] = {**texts.get(title, {}), **values}
    lines = []
    for section, content in texts.items():
        if section in LISTS["free"]:
            lines.append(f"[[{section}]]")
        elif section:
            lines.append(f"[{section}]")
        lines += [f"{name} = {written(value)}" for name, value in content.items()]
    if title.startswith("material.layers") or kind.sign == "layers":
        for ply in (LAYER, values if title == "material.layers" else LAYER):
            lines.append("[[material.layers]]")
            lines += [f"{name} = {written(value)}" for name, value in ply.items()]
    if title.startswith("material.layers."):
        inner = {title: {"kind": kind.name, **values}}
        if title.endswith("rate"):
            inner["material.layers.hardening"] = YIELDS
        for section, content in inner.items():
            lines.append(f"[{section}]")
            lines += [f"{name} = {written(value)}" for name, value in content.items()]
    return "\n".join(lines) + "\n"


@pytest.fixture
def built(monkeypatch, files):
    """Read a text, check that it survives being written, and return all that is built of it."""
    read = []
    monkeypatch.setattr(sys.modules[oscillating.__module__], "round_bar", BAR_ONCE)
    for kind in MIRRORS:
        if kind.constructor in ONCE:
            monkeypatch.setattr(kind, "constructor", ONCE[kind.constructor])
        if kind.deferred:
            real = kind.constructor

            def reader(real=real):
                @functools.wraps(real)
                def spy(**arguments):
                    read.append(described(arguments))
                    if real is read_drawing:
                        return FilmOutline(np.array(SQUARE), ())
                    plain = {k: v for k, v in arguments.items() if k in ("path", "unit")}
                    if "unit" in plain:
                        plain["unit"] = "mm"
                    return real(**plain)

                return spy

            monkeypatch.setattr(kind, "constructor", reader())

    def meshed(outline, **arguments):  # by Gmsh
        sizes = {k: v for k, v in arguments.items() if k in ("holes", "size", "size_at_path")}
        read.append(described([np.array(outline), sizes]))
        sheet = rectangle(4.0, 4.0, size=1.0)
        rim = sheet.boundary_nodes()
        sets = {"outline": rim, "rim": rim, "other": sheet.node_set("left")}
        return sheet.with_sets(node_sets=sets)

    for name in ("mesh_from_outline", "film_along_path"):
        monkeypatch.setattr(build, name, meshed)
    for name in SECTIONS:

        def keep(*positional, _name=name, **named):
            return Made(_name, (positional, named))

        monkeypatch.setitem(build.BUILDERS, name, keep)

    def make(text):
        read.clear()
        (files / "model.toml").write_text(text)
        model = read_model(files / "model.toml")
        model.write(files / "used.toml")
        assert read_model(files / "used.toml") == model
        case = model.build()
        return described([case.name, list(case.simulation), model.run_options(), list(read)])

    return make


@pytest.fixture(scope="module")
def unvaried():
    """What is built of a text, by that; of the same files."""
    return {}


def with_sets_of(kind, title, model, values):
    """Give a set name that the mesh of this model has."""
    if "clamp" in values and kind.name in ("opening", "disc"):
        return {**values, "clamp": ["rim"] if model == "free" else ["centre"]}
    if "clamp" in values and kind.name == "rectangle":
        return {**values, "clamp": ["left"]}
    return values


@pytest.mark.parametrize(("model", "title", "kind", "key"), list(cases()))
def test_every_key_reaches_what_is_built(built, unvaried, model, title, kind, key):
    given = {**GIVEN.get((title, kind.name), {})}
    if model in ("guillotine", "trouser", "oscillating"):
        given = GIVEN_TO_STRIPS.get((title, kind.name), given)
    if model == "opening" and (title, kind.name) == ("motion", "screw"):
        given = {}
    if title == "material.layers":
        given = dict(LAYER)
    if title in ("material", "material.layers") and key not in LAYER:
        given = {**given, **BESIDE.get(key, {})}
    if kind in (*HARDENINGS, *RATES):
        given = INNER[kind.name]
    given = {**given, **NEEDED_BY.get(key, {})}
    if key in ("size_at_path", "size", "holes"):  # of discs by Gmsh
        given = {"opening": {"mesh": "path"}, "disc": {"radius": 5.0}}.get(kind.name, given)
    other = other_value(kind, key)
    if title.startswith("material") and key == "angle_deg":
        other = 30.0
    if key == "film_edges":
        other = model != "opening"  # the default depends on the model
    if key == "joint":
        other = "free"  # slip needs a friction
    if key == "file":
        other = "other" + given["file"][given["file"].rindex(".") :]
    if kind.constructor is read_hardening:
        other = "other_curve.csv"
    if key == "width" and model == "oscillating":
        other = 30.0  # more than its band
    varied = with_sets_of(kind, title, model, {**given, key: other})
    text = model_text(model, title, kind, given)
    if text not in unvaried:  # that of many keys
        unvaried[text] = built(text)
    assert built(model_text(model, title, kind, varied)) != unvaried[text]


def test_quads_and_divisions_reach_what_is_built(built):
    motion = '[motion]\nfile = "motion.csv"\n'
    text = f'model = "free"\n[membrane]\nfile = "film.inp"\n{motion}[[loads]]\nvalue = 1.0\n'
    assert built(text + 'quads = "chosen"\n') != built(text)
    text = f'model = "free"\n{motion}[membrane]\nlength = 4.0\nwidth = 3.0\n'
    divided = {built(f"{text}n_x = {n_x}\nn_y = {n_y}\n") for n_x, n_y in ((4, 2), (4, 4), (8, 2))}
    assert len(divided) == 3


# What else a constructor takes comes from other sections, or is no value.
ELSEWHERE = {"self", "folder", "factor", "layers"}
ELSEWHERE |= {"progress", "log", "resume", "force", "replace"}  # how it is run
ELSEWHERE |= {"law"}  # what cards say of a table
ELSEWHERE |= {"cables"}  # what the makers of a cohesive law hand on
ELSEWHERE |= {"anisotropy"}  # of cracks without a tool, which a model file has
ELSEWHERE |= {"material", "direction"}  # of a layer, of a film: [material] has own keys for it
ELSEWHERE |= {"near", "size_near", "band"}  # of the path of the tool
NOT_IN_FILES = {"velocity": "an array, a row a node", "terms": "classes of a user's own"}


@pytest.mark.parametrize("kind", [k for k in MIRRORS if not (k.fixed or k.spread)], ids=MIRRORS.get)
def test_every_parameter_has_a_key(kind):
    parameters = inspect.signature(kind.constructor).parameters
    assert set(parameters) - ELSEWHERE <= {*kind.keys, *(k.parameter for k in kind.keys.values())}


def test_every_option_of_a_simulation_and_output_is_in_some_section():
    taken = {"mesh", "material", "supports", "loads", "tool", "motion", "law"}
    taken |= {"contact", "fracture", "stepping"}  # sections
    taken |= {"directional", "quasi_static", "imperfection", "threads"}  # at the top
    taken |= {"damping_alpha", "damping_beta", "damping_share"}  # [damping]
    assert set(inspect.signature(Simulation).parameters) - taken == set(NOT_IN_FILES)
    assert set(OUTPUT().arguments()) <= set(inspect.signature(RunOptions).parameters)


def test_rates_and_ramps_are_made(tmp_path):
    support = SUPPORT(nodes="rim", velocity={"x": 2.0}, spin={"z": 3.0}).made()
    assert support.velocity["x"](0.1) == 2.0
    assert support.spin["z"](7.0) == 3.0
    path = tmp_path / "x.toml"
    path.write_text('model = "opening"\n[[loads]]\nvalue = 1.0\nramp = "2 ms"\n')
    factor = read_model(path).lists["loads"][0].made().factor
    assert [factor(t) for t in (0.0, 1e-3, 2e-3, 9.0)] == [0.0, 0.5, 1.0, 1.0]


@pytest.mark.parametrize("name", sorted(shipped_models()))
def test_the_schema_takes_what_is_read(name, tmp_path):
    jsonschema = pytest.importorskip("jsonschema")
    jsonschema.Draft7Validator.check_schema(schema())
    valid = jsonschema.Draft7Validator(schema()).is_valid
    text = shipped_models()[name]
    read_model(name).write(tmp_path / "used.toml")
    assert valid(tomllib.loads(text))
    assert valid(tomllib.loads((tmp_path / "used.toml").read_text()))


def problems(of, whole):
    """Return what a validator says of each key, by its place."""
    jsonschema = pytest.importorskip("jsonschema")
    jsonschema.Draft7Validator.check_schema(of)
    found = jsonschema.Draft7Validator(of).iter_errors(whole)
    return {".".join(map(str, one.path)): one.message for one in found}


@pytest.mark.parametrize(
    ("wrong", "place", "said"),
    [
        ({"models": 3}, "", "'models' was unexpected"),
        ({"model": "closing"}, "model", "'closing' is not one of"),
        ({"cohesive": {"strength": -3.0}}, "cohesive.strength", "-3.0 is less than"),
        ({"loads": [{"value": "much", "kind": "gust"}]}, "loads.0.kind", "'gust' is not one of"),
        ({"tool": {"teehs": 4}}, "tool", "'teehs' was unexpected"),
        ({"tool": {"kind": "file", "teeth": 4}}, "tool", "'teeth' was unexpected"),
        ({"tool": {"kind": "blade"}}, "tool.kind", "'blade' is not one of ['teeth', 'file']"),
        ({"tool": {"half_thickness": "0.3 kg"}}, "tool.half_thickness", "'0.3 kg' does not match"),
        ({"tool": {"shift": [0, 0, "3 s"]}}, "tool.shift.2", "'3 s' does not match"),
        ({"material": {"layers": [{"yung": 3}]}}, "material.layers.0", "'yung' was unexpected"),
        ({"material": "pett"}, "material", "'pett' is not one of"),
        ({"material": {"hardening": {"kind": "vocee"}}}, "material.hardening.kind", "'vocee' is n"),
        ({"material": {"rate": {"factor": "x"}}}, "material.rate.factor", "'x' does not match"),
    ],
)
def test_the_schema_names_the_key_that_is_wrong(wrong, place, said):
    found = problems(schema(), tomllib.loads(shipped_models()["opening"]) | wrong)
    assert said in found[place]


@pytest.mark.parametrize(
    "good",
    [
        {"tool": {"half_thickness": "300 µm", "radius": "0.37 Inch", "shift": [0, "1 mm", 3]}},
        {"tool": {"kind": "file", "stl": "x.stl", "unit": "mm"}},
        {"material": {"density": "0.92 g/cm³", "young": "1.7e3 mpa"}},
        {"material": {"hardening": {"yield_stress": "9 MPa"}, "rate": {"rate": 4, "exponent": 5}}},
        {"material": {"preset": "mild_steel", "hardening": {"exponent": 0.2}}},
        {"material": "pet"},
    ],
)
def test_the_schema_takes_units_as_the_reader_does(good):
    assert problems(schema(), tomllib.loads(shipped_models()["opening"]) | good) == {}


def test_the_schema_of_studies_knows_the_keys_of_models():
    study = {
        "model": "opening",
        "set": {"mesh": "quick", "membrane.clamp": "rim", "material": "pet", "threads": 1},
        "factors": {
            "tool.teeth": [3, 4],
            "motion.pitch": "12 mm : 20 mm",
            "tool.file": "caps/*.stl",
            "material.hardening.yield_stress": [10, "20 MPa"],
            "material.layers.1.thickness": [0.02, "30 um"],
            "loads.0.value": [1, 2],
            "cohesive.plateau, cohesive.strength": [[12, 18], [10, 15]],
        },
    }
    assert problems(study_schema(), study) == {}
    for where, wrong, said in (
        ("set", {"loads.value": 3}, "'loads.value' does not match"),
        ("set", {"material.layers.hardening.gain": 3}, "gain' does not match"),
        ("factors", {"tool.teehs": [3]}, "'tool.teehs' does not match"),
        ("set", {"tool.teeth": "four"}, "'four' is not of type 'integer'"),
        ("factors", {"tool.half_thickness": [0.2, "3 kg"]}, "'3 kg' does not match"),
    ):
        found = problems(study_schema(), study | {where: wrong})
        assert any(said in text for text in found.values()), (wrong, found)
