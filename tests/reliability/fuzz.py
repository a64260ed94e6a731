"""Damaged files, and arguments at random: each is refused in words, or used and right.

An input is damaged as :mod:`damaged.mutations` does. A traceback, another error than the one that
is documented, a process that dies, no end, or a wrong value that nobody notices is a failure. Each
input has a process of its own, with limits of memory and time.
"""

import functools
import logging.handlers
import os
import resource
import shutil
import signal
import sys
import warnings
from contextlib import contextmanager, suppress
from itertools import count
from pathlib import Path

import numpy as np

import model_numbers
import shellcut as sc
from damaged.mutations import mutated
from damaged.samples import FILMS, TOOLS
from shellcut import meshing, tool_shapes
from shellcut.command_line import main
from shellcut.recording.checkpoint import CheckpointError
from shellcut.study.plan import read_study

from . import tiny
from .trial import Child, Trial

SHARE = 6
SECONDS, MEMORY = 20, 3 << 30
STUDY = Path(__file__).parents[2] / "examples" / "study.toml"
REFUSED = "is refused in words, or read"
DAMAGED = "`fuzz.py`; `tests/damaged`"
ROWS = {
    "model files": (f"a damaged model file {REFUSED} and built", "`fuzz.py`"),
    "numbers of models": (
        "a number that nobody means is refused in words, or makes a model that steps",
        "`tests/model_numbers.py`",
    ),
    "study files": (f"a damaged study file {REFUSED}", DAMAGED),
    "meshes": (f"a damaged film or tool {REFUSED}; what declares its counts is whole", DAMAGED),
    "drawings": (f"a damaged DXF file {REFUSED}", DAMAGED),
    "curves": (f"a damaged table of a measured curve or motion {REFUSED}", DAMAGED),
    "checkpoints": ("every damage of a checkpoint is noticed", DAMAGED),
    "results": (f"a damaged file of a run {REFUSED}; a damaged frame is noticed", DAMAGED),
    "command lines": ("a damaged command line ends with its exit code, without traceback", DAMAGED),
    "arguments": ("an argument at random raises ValueError or TypeError; NaN is refused", DAMAGED),
}
COUNTED = [name for name in FILMS | TOOLS if name.split()[0] in ("Gmsh", "VTU", "VTK", "PLY")]
RARE = {"command lines": 1, "results": 2, "model files": 6, "numbers of models": 6}
OFTEN = 20
"""How many inputs of a kind are tried in turn: the fewer, the longer one takes."""


def trials():
    for turn in count():
        for row in ROWS:
            n = RARE.get(row, OFTEN)
            for number in range(n * turn, n * (turn + 1)):
                yield Trial(row, f"damaged {row}", functools.partial(_apart, row, number))


def _apart(row, number, folder):
    """Try an input in a process of its own."""
    _made_for_all()

    def do():
        used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        resource.setrlimit(resource.RLIMIT_AS, (used + MEMORY, used + MEMORY))
        # Some command lines are runs of hours: they are interrupted.
        signal.signal(signal.SIGALRM, lambda *_: os.kill(os.getpid(), signal.SIGINT))
        signal.alarm(SECONDS)
        warnings.simplefilter("ignore")
        return OF[row](np.random.default_rng([60, number]), folder)

    codes = (0, 2, 3, 4, 130) if row == "command lines" else (0,)
    Child(do, folder / "said").wait(2.0 * SECONDS).expect(*codes)


@functools.cache
def _made_for_all():
    """Make here what inputs are made of, and import what readers need, once for all processes."""
    read_study(STUDY).plan()
    _drawing()
    _numbers()
    _strip_at_work()
    tiny.measured()
    for name in FILMS | TOOLS:
        sound(name)


@contextmanager
def refusing_in_words(errors=ValueError):
    """Let what is within end, or refuse its input in words."""
    try:
        yield
    except errors as refusal:
        in_words(refusal)


def in_words(refusal, path=""):
    """Fail unless a refusal has words; return them without the path."""
    said = str(refusal).removeprefix(str(path))
    assert len(said.split()) > 2, "words, not the bare name of an error"
    return said


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
    said = logging.handlers.BufferingHandler(1000)
    logging.getLogger("shellcut").addHandler(said)
    try:
        assert model_numbers.outcome(text) in ("refused", "built", "blew up")
    except KeyboardInterrupt:  # of a film that takes longer, which is said
        assert any("minutes to check" in record.getMessage() for record in said.buffer)


@functools.cache
def _numbers():
    return list(model_numbers.cases(("strip", "sheet", "disc")))


def study_file(rng, folder):
    path = folder / "study.toml"
    path.write_bytes(mutated(rng, STUDY.read_bytes(), text=True)[0])
    with refusing_in_words():
        read_study(path).plan()


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


def a_mesh(rng, folder):
    names = [*FILMS, *TOOLS]
    mesh_file(names[rng.integers(len(names))], rng, folder)


@functools.cache
def _drawing():
    from test_drawing import plate, saved

    return saved(tiny.folder() / "plate.dxf", plate()).read_bytes()


def drawing(rng, folder):
    path = folder / "plate.dxf"
    path.write_bytes(mutated(rng, _drawing(), text=True)[0])
    with refusing_in_words():
        assert np.isfinite(sc.read_drawing(path).area)


CURVE = "path [mm]; force [N]; note\n" + "".join(
    f"{0.1 * k:.1f}; {k % 7},5; a\n" for k in range(40)
)
MOTION = "time [ms], x [mm], rotation_z [deg]\n" + "".join(f"{k}, {k}, {2 * k}\n" for k in range(9))


def curve(rng, folder):
    path = folder / "curve.csv"
    text = (CURVE, MOTION)[rng.integers(2)]
    path.write_bytes(mutated(rng, text.encode(), text=True)[0])
    with refusing_in_words():
        if text == CURVE:
            found = sc.read_measured_curve(path)
            assert np.isfinite([found.x, found.y]).all()
        else:
            sc.TableMotion.read_csv(path)


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
    with refusing_in_words((ValueError, OSError, KeyError)):
        found = sc.read(out)
        found.summary, found.history["time"]
        same = [np.array_equal(a.points, b) for a, b in zip(found.frames(), good, strict=False)]
        assert all(same), "a damaged frame was read"
    if rng.integers(8) == 0:  # it takes a second
        with refusing_in_words((ValueError, OSError)):
            sc.report_run(out)


def _command_lines():
    out, measured, strip = str(tiny.whole("run")), str(tiny.measured()), tiny.words("run")[2:]
    lines = [[*tiny.words(kind), "-o", "o"] for kind in ("run", "sweep", "fit", "optimise")]
    lines += [["resume", out], ["verify", out], ["report", out, "-o", "r.html"], ["keys", "angle"]]
    lines += [["sweep", "guillotine", *strip, "--set=size=1,2", "--dry-run"]]
    lines += [["preview", "guillotine", *strip, "-o", "m.png"]]
    lines += [["compare", out, measured, "--json", "c.json", "--picture", "c.png"]]
    lines += [["view", out, "--frame", "0", "-o", "f.png", "--size", "300", "200"]]
    lines += [["view", out, "-o", "v.html"], ["run", "guillotine", "--write-model", "m.toml"]]
    return [*lines, ["tensile", measured, "--columns", "1", "2", "--units", "mm", "N"]]


def command_line(rng, folder):
    """Damage the words of a command as if each were a line."""
    every = _command_lines()
    text = "\n".join(every[rng.integers(len(every))]).encode()
    for _ in range(rng.integers(1, 4)):
        text, _ = mutated(rng, text, text=True)
    words = [os.fsdecode(word) for word in text.split(b"\n")]
    print(words, file=sys.stderr)
    os.chdir(folder)
    return main(words)


_NAN = float("nan")
NASTY = [_NAN, float("inf"), -float("inf"), 0, -1, 1e-300, 1e300, 5e-324, 10**30, True, None, {}]
NASTY += ["", "x", "nan", "ü" * 99, b"x", object(), 1 + 2j, [], [1.0], [_NAN] * 3, [[1.0], [2, 3]]]
NASTY += [np.zeros(0), np.full((4, 3), _NAN), np.arange(9).reshape(3, 3)]
_POINTS = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]
_CURVE = {"strain": np.linspace(0, 0.1, 40), "stress": np.linspace(0, 10, 40), "offset": 0.002}
CALLS = [
    (sc.Elastic, {"young": 1000.0, "poisson": 0.3, "density": 1e-9}),
    (sc.ShellMaterial.homogeneous, {"thickness": 0.1, "young": 1000.0}),
    (sc.CohesiveLaw, {"strength": 18.0, "opening_u": 8.0, "plateau": 6.0}),
    (sc.Contact, {"friction": 0.1}),
    (sc.Fracture, {"check_every": 5, "path": "edges"}),
    (sc.Stepping, {"safety": 0.9}),
    (sc.Pressure, {"value": 1.0}),
    (sc.Gravity, {"acceleration": (0.0, 0.0, 1.0)}),
    (sc.StraightMotion, {"direction": (1, 0, 0), "speed": 1.0, "ramp": 0.1}),
    (sc.ScrewMotion, {"angular_speed": 1.0, "axis": (0, 0, 1), "pitch": 1.0}),
    (sc.TableMotion, {"times": [0.0, 1.0], "translations": [[0, 0, 0], [1, 0, 0]]}),
    (sc.Support, {"nodes": [0, 1]}),
    (sc.Swift, {"strength": 30.0, "start": 0.01, "exponent": 0.2}),
    (sc.Voce, {"yield_stress": 10.0, "gain": 2.0, "strain": 0.1}),
    (sc.Mesh.from_arrays, {"nodes": _POINTS, "quads": [[0, 1, 2, 3]]}),
    (meshing.rectangle, {"length": 4.0, "width": 2.0, "n_x": 4, "n_y": 2}),
    (meshing.disc, {"radius": 5.0, "n_side": 4, "n_layer": 3}),
    (tool_shapes.straight_blade, {"half_thickness": 0.1, "length": 2.0, "height": 2.0}),
    (tool_shapes.tooth_ring, {"n_teeth": 1, "n_arc": 9, "length": 0.8, "height": 3.0}),
    (sc.guillotine, {"size": 1.0, "length": 6.0, "width": 4.0, "travel": 1.5}),
    (sc.evaluate_tensile, _CURVE),
]


def argument(rng, folder):
    call, good = CALLS[rng.integers(len(CALLS))]
    key, value = [*good][rng.integers(len(good))], NASTY[rng.integers(len(NASTY))]
    try:
        call(**{**good, key: value})
    except (ValueError, TypeError, MemoryError) as refusal:
        in_words(refusal)
        return
    except Exception as problem:
        raise AssertionError(f"{call.__name__}({key}={value!r})") from problem
    assert not isinstance(value, float) or not np.isnan(value), f"{call.__name__}({key}=nan)"


OF = {
    "model files": model_file,
    "numbers of models": number_of_model,
    "study files": study_file,
    "meshes": a_mesh,
    "drawings": drawing,
    "curves": curve,
    "checkpoints": checkpoint,
    "results": results,
    "command lines": command_line,
    "arguments": argument,
}
