"""Damaged files, and arguments at random: each is refused in words, or used and right.

An input is damaged as :mod:`damaged.mutations` does. A traceback, another error than the one that
is documented, a process that dies, no end, or a wrong value that nobody notices is a failure. Each
input has a process of its own, with a limit of memory and of time.
"""

import functools
import os
import random
import resource
import shutil
import signal
import string
import traceback
import warnings
from contextlib import suppress
from pathlib import Path

import numpy as np

import model_numbers
import shellcut as sc
from damaged.mutations import mutated
from damaged.samples import FILMS, TOOLS
from shellcut import meshing, tool_shapes
from shellcut.command_line import main
from shellcut.recording.checkpoint import CheckpointError
from shellcut.study.study_file import read_study

from . import tiny
from .trial import Batch, Child, Trial

SHARE = 8
COUNT = None
SECONDS, MEMORY = 20.0, 3 << 30
BATCH = {"results": 30, "command lines": 4, "model files": 25, "numbers of models": 25}
MANY = 80  # inputs that one process tries, of the kinds that are not in BATCH
REFUSED = "is refused in words, or read"
_MESH = "`fuzz.py`; `tests/damaged`"
ROWS = {
    "model files": (f"a damaged model file {REFUSED} and built", "`fuzz.py`"),
    "numbers of models": (
        "a number that nobody means is refused in words, or makes a model that steps",
        "`tests/model_numbers.py`",
    ),
    "study files": (f"a damaged study file {REFUSED}", "`fuzz.py`; `tests/damaged`"),
    "films": (f"a damaged mesh file {REFUSED}; what declares its counts is whole", _MESH),
    "tools": (f"a damaged surface file {REFUSED}; what declares its counts is whole", _MESH),
    "drawings": (f"a damaged DXF file {REFUSED}", _MESH),
    "curves": (f"a damaged table of a measured curve or motion {REFUSED}", _MESH),
    "checkpoints": ("every damage of a checkpoint is noticed", _MESH),
    "results": (f"a damaged file of a run {REFUSED}; a damaged frame is noticed", _MESH),
    "command lines": ("a damaged command line ends with its exit code, without traceback", _MESH),
    "arguments": ("an argument at random raises ValueError or TypeError; NaN is refused", _MESH),
}
KINDS = [*ROWS]
COUNTED = [name for name in FILMS | TOOLS if name.split()[0] in ("Gmsh", "VTU", "VTK", "PLY")]


def trial(number):
    """Return a trial: some inputs of a kind, damaged."""
    row = KINDS[number % len(KINDS)]
    return Trial(row, f"damaged {row}", functools.partial(_apart, row, number))


def _apart(row, number, folder):
    """Try some inputs in a process of their own, command lines each in its own."""
    _prepared(row)
    n = BATCH.get(row, MANY)
    if row == "command lines":
        for k in range(n):
            _command_line(np.random.default_rng([60, number, k]), folder)
        return Batch(n, [])
    record = folder / "record"
    do = functools.partial(_inputs, row, number, n, folder, record)
    Child(do, folder / "said").wait(SECONDS * n)
    *ended, last = record.read_text().split("\0")
    failures = [text for text in ended if text]
    if len(ended) < n:  # the process died
        failures.append(f"input {len(ended)}: the process died; {last}")
    return Batch(min(len(ended) + 1, n), failures)


def _inputs(row, number, n, folder, record):
    """Try the inputs of a batch; write of each why it failed, empty if it did not."""
    used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (used + MEMORY, used + MEMORY))
    warnings.simplefilter("ignore")
    signal.signal(signal.SIGALRM, _too_long)
    with record.open("w") as file:
        for k in range(n):
            mine = folder / str(k)
            mine.mkdir()
            signal.alarm(int(SECONDS))
            try:
                OF[row](np.random.default_rng([60, number, k]), mine)
            except Exception:
                file.write(f"input {k}: {traceback.format_exc()}")
            signal.alarm(0)
            shutil.rmtree(mine)
            file.write("\0")
            file.flush()


def _too_long(*_):
    raise TimeoutError(f"no end within {SECONDS:.0f} s")


@functools.cache
def _prepared(row):
    """Load here what every process of a kind needs."""
    if row == "drawings":
        _drawing()
    if row in ("results", "checkpoints", "command lines"):
        tiny.whole("run", "guillotine")
        _strip_at_work()


def in_words(refusal, path=""):
    """Fail unless a refusal has words; return them without the path."""
    said = str(refusal).removeprefix(str(path))
    assert len(said.split()) > 3, "words, not the bare name of an error"
    return said


# ---------------------------------------------------------------- model and study files


def model_file(rng, folder):
    model, sections = list(model_numbers.MODELS.values())[rng.integers(len(model_numbers.MODELS))]
    damaged, _ = mutated(rng, model_numbers._toml(model, sections).encode(), text=True)
    path = folder / "model.toml"
    path.write_bytes(damaged)
    with suppress(MemoryError):  # the command says so
        model_numbers.outcome_of(lambda: sc.read_model(path))


def number_of_model(rng, folder):
    every = _numbers()
    _, text = every[rng.integers(len(every))]
    assert model_numbers.outcome(text) in ("refused", "built", "blew up")


@functools.cache
def _numbers():
    return list(model_numbers.cases(("strip", "sheet", "disc", "outline")))


def study_file(rng, folder):
    text = (Path(__file__).parents[2] / "examples/study.toml").read_bytes()
    path = folder / "study.toml"
    path.write_bytes(mutated(rng, text, text=True)[0])
    try:
        read_study(path).plan()
    except ValueError as refusal:
        in_words(refusal)


# ---------------------------------------------------------------- meshes, drawings, curves


def cells_of(path, name):
    """Return the cells of a film or a tool."""
    if name in FILMS:
        return sc.read_film(path, unit="mm").quads
    return sc.read_tool(path, unit="mm", sharp_angle_deg=90.0).triangles


@functools.cache
def sound(name):
    """Return the name of a file, its bytes, whether it is text, and the number of its cells."""
    file, content_of, text = (FILMS | TOOLS)[name]
    path = tiny.folder() / f"{name} {file}"
    path.write_bytes(content_of())
    return file, path.read_bytes(), text, len(cells_of(path, name))


def mesh_file(name, rng, folder):
    """Damage a film or a tool; return the refusal, empty if it is read."""
    file, content, text, n_cell = sound(name)
    damaged, damage = mutated(rng, content, text=text)
    path = folder / file
    path.write_bytes(damaged)
    try:
        cells = cells_of(path, name)
    except ValueError as refusal:  # FileError, MeshError
        return in_words(refusal, path)
    assert name not in COUNTED or len(cells) == n_cell, damage
    return ""


def one_of(samples, rng, folder):
    mesh_file([*samples][rng.integers(len(samples))], rng, folder)


@functools.cache
def _drawing():
    from test_drawing import plate, saved

    return saved(tiny.folder() / "plate.dxf", plate()).read_bytes()


def drawing(rng, folder):
    path = folder / "plate.dxf"
    path.write_bytes(mutated(rng, _drawing(), text=True)[0])
    try:
        found = sc.read_drawing(path)
        assert np.isfinite(found.area)
    except ValueError as refusal:
        in_words(refusal)


CURVE = "path [mm]; force [N]; note\n" + "".join(
    f"{0.1 * k:.1f}; {k % 7},5; a\n" for k in range(40)
)
MOTION = "time [ms], x [mm], rotation_z [deg]\n" + "".join(f"{k}, {k}, {2 * k}\n" for k in range(9))


def curve(rng, folder):
    path = folder / "curve.csv"
    text = (CURVE, MOTION)[rng.integers(2)]
    path.write_bytes(mutated(rng, text.encode(), text=True)[0])
    try:
        if text == CURVE:
            found = sc.read_measured_curve(path)
            assert np.isfinite([found.x, found.y]).all()
        else:
            sc.TableMotion.read_csv(path)
    except ValueError as refusal:
        in_words(refusal)


# ---------------------------------------------------------------- what runs have written


@functools.cache
def _strip_at_work():
    from notched_strip import cutting

    sim = cutting()
    sim.run(2e-5)
    path = tiny.folder() / "checkpoint.h5"
    sc.save_checkpoint(sim, path)
    return cutting(), path.read_bytes()


def checkpoint(rng, folder):
    sim, content = _strip_at_work()
    damaged_checkpoint(sim, mutated(rng, content, text=False)[0], folder / "c.h5")


def damaged_checkpoint(sim, content, path):
    """Fail unless a damaged checkpoint is refused, and the simulation is as before."""
    path.write_bytes(content)
    try:
        sc.load_checkpoint(sim, path)
    except CheckpointError as refusal:
        said = in_words(refusal)
    else:
        raise AssertionError("it was loaded")
    assert f"{path.name} is damaged, or not a checkpoint" in said or "format" in said
    assert sim.state.step == 0


def results(rng, folder):
    reference = tiny.whole("run", "guillotine")
    out = shutil.copytree(reference, folder / "out")
    names = ["history.csv", "splits.csv", "summary.json", "guillotine.vtkhdf", "run.files"]
    name = [*names, "used.toml", "run.log"][rng.integers(7)]
    content = (out / name).read_bytes()
    (out / name).write_bytes(mutated(rng, content, text=not name.endswith("hdf"))[0])
    good = [frame.points for frame in sc.read(reference).frames()]
    try:
        found = sc.read(out)
        found.summary, found.history["time"]
        frames = list(found.frames())
    except (ValueError, OSError, KeyError) as refusal:
        in_words(refusal)
    else:
        same = [np.array_equal(a.points, b) for a, b in zip(frames, good, strict=False)]
        assert all(same), "a damaged frame was read"
    if rng.integers(8):  # it takes a second
        return
    try:
        sc.report_run(out)
    except (ValueError, OSError) as refusal:
        in_words(refusal)


# ---------------------------------------------------------------- command lines and arguments


def _command_lines():
    out = str(tiny.whole("run", "guillotine"))
    strip = tiny.words("run", "guillotine")[2:]
    lines = [[*tiny.words(kind), "-o", "o"] for kind in ("sweep", "fit", "optimise")]
    lines += [["run", "guillotine", *strip, "-o", "o"], ["resume", out], ["verify", out]]
    lines += [["sweep", "guillotine", *strip, "--set=size=1,2", "--dry-run"], ["keys", "angle"]]
    lines += [["preview", "guillotine", *strip, "-o", "m.png"], ["report", out, "-o", "r.html"]]
    lines += [["compare", out, str(tiny.measured()), "--json", "c.json", "--picture", "c.png"]]
    lines += [["view", out, "--frame", "0", "-o", "f.png", "--size", "300", "200"]]
    lines += [["view", out, "-o", "v.html"], ["run", "guillotine", "--write-model", "m.toml"]]
    measured = str(tiny.measured())
    lines += [["tensile", measured, "--columns", "1", "2", "--units", "mm", "N"]]
    return lines


WORDS = ["", "-", "--", "-o", "--set", "--set==", "--set=a=b", "--set=size=", "--set=size=nan", "."]
WORDS += [
    "--jobs=0",
    "--jobs=-1",
    "--shown-in=in",
    "--shown-in=",
    "--force",
    "--help",
    "-1",
    "1e400",
]
WORDS += [
    "--set=tool.edge_angle_deg=1e9",
    "/nowhere/x",
    "/dev/null",
    "\0",
    "é",
    "\udcff",
    "{",
    "%s",
]


def damaged_words(chance, words):
    """Return a command line with one to three damages."""
    words = list(words)
    for _ in range(chance.choice([1, 1, 2, 3])):
        k = chance.randrange(len(words)) if words else 0
        damage = chance.randrange(6)
        if damage == 0 and words:
            del words[k]
        elif damage == 1 and words:
            words.insert(k, words[k])
        elif damage == 2 and words:
            at = chance.randrange(len(words[k]) + 1)
            words[k] = words[k][:at] + chance.choice(string.printable) + words[k][at + 1 :]
        elif damage == 3 and len(words) > 1:
            other = chance.randrange(len(words))
            words[k], words[other] = words[other], words[k]
        elif damage == 4 and words:
            words[k] = chance.choice(WORDS)
        else:
            words.insert(k, chance.choice(WORDS))
    return words


def _command_line(rng, folder):
    chance = random.Random(int(rng.integers(1 << 60)))
    words = damaged_words(chance, chance.choice(_command_lines()))

    def do():
        os.chdir(folder)
        warnings.simplefilter("ignore")
        return main(words)

    child = Child(do, folder / "said")
    try:
        done = child.wait(0.5 * SECONDS, end=signal.SIGINT)
    except TimeoutError as problem:
        raise AssertionError(f"{words}: {problem}") from None
    assert done.code in (0, 2, 3, 4, 130), f"{words}: {done}"
    assert "Traceback" not in done.error, f"{words}: {done.error[-1500:]}"


NASTY = [
    float("nan"),
    float("inf"),
    -float("inf"),
    0,
    -1,
    1e-300,
    1e300,
    5e-324,
    10**30,
    True,
    None,
]
NASTY += ["", "x", "nan", [], [1.0], [float("nan")] * 3, (1, 2, 3), [[1.0, 2.0], [3.0]], {}, b"x"]
NASTY += [
    np.zeros(0),
    np.full((4, 3), np.nan),
    np.arange(9).reshape(3, 3),
    object(),
    1 + 2j,
    "ü" * 99,
]

_POINTS = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]
CALLS = {
    "Elastic": (sc.Elastic, {"young": 1000.0, "poisson": 0.3, "density": 1e-9}),
    "Orthotropic": (sc.Orthotropic, {"young": (1e3, 2e3), "poisson": 0.3, "shear": 400.0}),
    "homogeneous": (sc.ShellMaterial.homogeneous, {"thickness": 0.1, "young": 1000.0}),
    "CohesiveLaw": (sc.CohesiveLaw, {"strength": 18.0, "opening_u": 8.0, "plateau": 6.0}),
    "Contact": (sc.Contact, {"friction": 0.1}),
    "Fracture": (sc.Fracture, {"check_every": 5, "path": "edges"}),
    "Stepping": (sc.Stepping, {"safety": 0.9}),
    "Pressure": (sc.Pressure, {"value": 1.0}),
    "Gravity": (sc.Gravity, {"acceleration": (0.0, 0.0, 1.0)}),
    "StraightMotion": (sc.StraightMotion, {"direction": (1, 0, 0), "speed": 1.0, "ramp": 0.1}),
    "ScrewMotion": (sc.ScrewMotion, {"angular_speed": 1.0, "axis": (0, 0, 1), "pitch": 1.0}),
    "TableMotion": (sc.TableMotion, {"times": [0.0, 1.0], "translations": [[0, 0, 0], [1, 0, 0]]}),
    "Support": (sc.Support, {"nodes": [0, 1]}),
    "Swift": (sc.Swift, {"strength": 30.0, "start": 0.01, "exponent": 0.2}),
    "Voce": (sc.Voce, {"yield_stress": 10.0, "gain": 2.0, "strain": 0.1}),
    "Mesh": (sc.Mesh.from_arrays, {"nodes": _POINTS, "quads": [[0, 1, 2, 3]]}),
    "rectangle": (meshing.rectangle, {"length": 4.0, "width": 2.0, "n_x": 4, "n_y": 2}),
    "disc": (meshing.disc, {"radius": 5.0, "n_side": 4, "n_layer": 3}),
    "blade": (tool_shapes.straight_blade, {"half_thickness": 0.1, "length": 2.0, "height": 2.0}),
    "ring": (tool_shapes.tooth_ring, {"n_teeth": 1, "n_arc": 9, "length": 0.8, "height": 3.0}),
    "guillotine": (sc.guillotine, {"size": 1.0, "length": 6.0, "width": 4.0, "travel": 1.5}),
    "tensile": (
        sc.evaluate_tensile,
        {"strain": np.linspace(0, 0.1, 40), "stress": np.linspace(0, 10, 40), "offset": 0.002},
    ),
}


def argument(rng, folder):
    name = [*CALLS][rng.integers(len(CALLS))]
    call, good = CALLS[name]
    given = dict(good)
    key, value = [*good][rng.integers(len(good))], NASTY[rng.integers(len(NASTY))]
    given[key] = value
    try:
        call(**given)
    except (ValueError, TypeError, MemoryError) as refusal:
        in_words(refusal)
    except Exception as problem:
        raise AssertionError(f"{name}({key}={value!r}): {problem!r}") from problem
    else:
        is_nan = isinstance(value, float) and value != value
        assert not is_nan, f"{name}({key}=nan) is accepted"


OF = {
    "model files": model_file,
    "numbers of models": number_of_model,
    "study files": study_file,
    "films": functools.partial(one_of, FILMS),
    "tools": functools.partial(one_of, TOOLS),
    "drawings": drawing,
    "curves": curve,
    "checkpoints": checkpoint,
    "results": results,
    "arguments": argument,
}
