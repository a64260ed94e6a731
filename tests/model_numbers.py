"""Every number of a model file, set to what nobody means: zero, negative, nan, far off.

Models are small. What comes of each: refused in words, built with a step that is a time, or (which
must not be) another error, a warning of NumPy, minutes of work.
"""

import json
import random
import warnings

import numpy as np

from shellcut.model_file import ModelFileError
from shellcut.model_file.build import build
from shellcut.model_file.reader import model_of_text
from shellcut.model_file.section_table import HEAD
from shellcut.recording.resistance import resistance_of
from shellcut.recording.status_line import start_lines
from shellcut.simulation.instability import UnstableStep

NAN, INF = float("nan"), float("inf")
NUMBERS = (
    *(0, -1, NAN, INF, -INF, 5e-324, 1.7e308, 1e-300, 1e300, 1e-30, 1e30, -1e-30, -1e30),
    *(1e-17, 1e17, 1e-9, 1e9, 1e-3, 1e3, 1e6),
)
WHOLE = (0, -1, 1, 2, 3, 10**6, 10**9, 10**18, -(10**18))

SQUARE = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]]
_STRIP = {"length": 6.0, "width": 4.0, "size": 1.0, "notch": 1.0}
_WAY = {"direction": [1.0, 0.0, 0.0], "speed": 6000.0, "duration": 2e-4}


def _blade(x, y=0.0):
    return {"edge_angle_deg": 90.0, "length": 8.0, "shift": [x, y, 0.0]}


MODELS = {
    "strip": ("guillotine", {"membrane": _STRIP, "motion": {"travel": 1.5}}),
    "sheet": (
        "free",
        {"membrane": _STRIP | {"clamp": ["top", "bottom"]}, "tool": _blade(-0.05), "motion": _WAY},
    ),
    "disc": (
        "free",
        {
            "membrane": {"radius": 5.0, "n_side": 4, "clamp": ["rim"]},
            "tool": _blade(-5.1),
            "motion": _WAY,
        },
    ),
    "screw": (
        "free",
        {
            "membrane": {"mesh": "quick", "clamp": ["rim"]},
            "tool": {"kind": "teeth"},
            "motion": {"angle_deg": 10.0, "duration": 1e-3},
        },
    ),
    "opening": ("opening", {"membrane": {"mesh": "quick"}, "motion": {"angle_deg": 10.0}}),
    "outline": (
        "free",
        {
            "membrane": {"outline": SQUARE, "size": 1.0, "clamp": ["outline"]},
            "tool": _blade(-0.05, 2.0),
            "motion": _WAY,
        },
    ),
}
"""By name: the model, and its sections."""

LISTS = (
    ("loads", {"kind": "gravity", "acceleration": [0.0, 0.0, 1.0]}),
    ("loads", {"kind": "pressure", "value": 1.0, "ramp": 1.0}),
    ("loads", {"kind": "force", "nodes": "top", "force": [0.0, 0.0, 1.0]}),
    ("loads", {"kind": "moment", "nodes": "top", "moment": [0.0, 1.0, 0.0]}),
    ("loads", {"kind": "traction", "nodes": "top", "traction": [0.0, 0.0, 1.0]}),
    ("supports", {"nodes": "left", "velocity": {"x": 1.0}, "spin": {"y": 1.0}}),
)

OF_MATERIAL = {
    "voce": {"yield_stress": 10.0, "gain": 2.0, "strain": 0.1, "modulus": 3.0},
    "swift": {"strength": 30.0, "start": 0.01, "exponent": 0.2},
    "table": {"plastic_strain": [0.0, 1.0], "stress": [10.0, 14.0]},
    "cowper_symonds": {"rate": 5.0, "exponent": 5.0},
    "johnson_cook": {"rate": 5.0, "factor": 0.1},
}
"""Tables of [material], by kind; a rate has a hardening beside it."""


def cases(names):
    """Yield what is set, and the text of the model, for every number of some models."""
    for name in names:
        model, sections = MODELS[name]
        made = model_of_text(_toml(model, sections), "model.toml")
        for title, section in made.sections.items():
            for key_name, key in section.of.keys.items():
                for value in _values(key.form.wants, getattr(section, key_name)):
                    varied = {t: dict(s) for t, s in sections.items()}
                    varied.setdefault(title, {})[key_name] = value
                    yield f"{name}: [{title}].{key_name} = {value}", _toml(model, varied)
        for key_name, key in HEAD.keys.items():
            for value in _values(key.form.wants, None):
                text = f"{key_name} = {_written(value)}\n{_toml(model, sections)}"
                yield f"{name}: {key_name} = {value}", text
    if "sheet" in names:
        yield from _of_lists(*MODELS["sheet"])
        yield from _of_material(*MODELS["sheet"])


def _of_lists(model, sections):
    for title, entry in LISTS:
        for name, value in entry.items():
            if isinstance(value, str):
                continue
            for new in _values("table" if isinstance(value, dict) else "number", value):
                varied = {**entry, name: new}
                text = "\n".join(f"{k} = {_written(v)}" for k, v in varied.items())
                yield (
                    f"[[{title}]].{name} = {new}",
                    f"{_toml(model, sections)}[[{title}]]\n{text}\n",
                )


def _of_material(model, sections):
    for kind, table in OF_MATERIAL.items():
        name = "rate" if "rate" in table else "hardening"
        for key, value in table.items():
            for new in _values("number", value):
                varied = {"hardening": {"yield_stress": 9.0}}
                varied[name] = {"kind": kind, **table, key: new}
                text = _toml(model, {**sections, "material": varied})
                yield f"[material.{name}].{key} = {new}", text


def _values(wants, now):
    if isinstance(now, dict):
        return [dict.fromkeys(now, x) for x in NUMBERS]
    if "polygons" in wants:
        return [[[[x, 1.0], [2.0, 1.0], [2.0, 2.0]]] for x in NUMBERS]
    if "[x, y]" in wants:
        return [[[x, 0.0], *SQUARE[1:]] for x in NUMBERS] + [
            [[x * a, x * b] for a, b in SQUARE] for x in NUMBERS if np.isfinite(x)
        ]
    if wants.startswith("whole number"):
        return list(WHOLE)
    if wants == "array of whole numbers":
        return [[n] for n in WHOLE]
    if isinstance(now, list | tuple) and now and not isinstance(now[0], str):
        row = list(now)
        return [[x, *row[1:]] for x in NUMBERS] + [[x] * len(row) for x in NUMBERS]
    if wants == "number" or "unit" in wants:
        return list(NUMBERS)
    return [[x, 0.0, 0.0] for x in NUMBERS] if wants.startswith("array of") else []


def _toml(model, sections):
    lines = [f'model = "{model}"']
    for title, section in sections.items():
        lines += [f"[{title}]", *(f"{k} = {_written(v)}" for k, v in section.items())]
    return "\n".join(lines) + "\n"


def _written(value):
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{k} = {_written(v)}" for k, v in value.items()) + " }"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(_written, value)) + "]"
    return json.dumps(value) if isinstance(value, bool | str) else repr(value)


def sample(n, names=tuple(MODELS), seed=20261122):
    """Return n of all cases, seeded."""
    every = list(cases(names))
    return random.Random(seed).sample(every, min(n, len(every)))


def outcome(text):
    """Return "refused", "blew up" or "built"; raise what should not be."""
    return outcome_of(lambda: model_of_text(text, "model.toml"))


def outcome_of(read):
    """Return the same of a function that reads a model."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            case = build(read())
        except ModelFileError:
            return "refused"
        sim = case.simulation
        list(start_lines(sim, resistance_of(sim, case.duration), case.duration))
        try:
            for _ in range(3):
                sim.step()
        except UnstableStep:
            return "blew up"
        assert np.isfinite(sim.state.node.x[: sim.mesh.n_node]).all()
    return "built"
