"""Short runs whose digests are in docs/same-bits.md; without names, write its table anew.

``python tests/regression/digest_cases.py [NAME ...]`` prints the digests of some of them as JSON.
"""

import json
import platform
import sys
import tempfile
from contextlib import closing
from importlib.metadata import version
from pathlib import Path

import numpy as np

import random_cuts
import shellcut
from shellcut.recording.recorder import Recorder

PAGE = Path(__file__).parents[2] / "docs" / "same-bits.md"
FILES = Path(__file__).with_name("digests")

_SHORT = {"membrane.length": "12 mm", "membrane.width": "6.4 mm", "travel": "4 mm"}
_TORN = {"membrane.length": "14 mm", "travel": "4 mm"}
CASES = {
    "opening": ("opening", {"mesh": "quick", "motion.angle_deg": 12.0, "duration": "0.8 ms"}),
    "opening on M1": ("opening", {"motion.angle_deg": 7.0, "duration": "0.45 ms"}),
    "guillotine": ("guillotine", _SHORT),
    "through quads": ("guillotine", {**_SHORT, "path": "free"}),
    "slicing": (
        "guillotine",
        {
            **_SHORT,
            "edge_angle_deg": 70.0,
            "slice_ratio": 0.5,
            "tool.height": "9 mm",
            "friction": 0.2,
            "joint": "slip",
            "joint_friction": 0.2,
        },
    ),
    "yielding": ("guillotine", {**_SHORT, "preset": "aluminium_foil", "travel": "3 mm"}),
    "oscillating": ("oscillating", {"size": "1 mm", "travel": "12 mm"}),
    "trouser": ("trouser", _TORN),
    "orthotropic trouser": (
        "trouser",
        {
            "membrane.length": "14 mm",
            "travel": "4 mm",
            "young_across": "1200 MPa",
            "shear": "500 MPa",
        },
    ),
    "disc": ("disc.toml", {}),
    "pierced": ("pierced.toml", {}),
    "moved": ("moved.toml", {}),
    "laminate": ("laminate.toml", {}),
    "stress": (
        "guillotine",
        {
            **_SHORT,
            "travel": "3 mm",
            "quasi_static": 0.008,
            "criterion": "stress",
            "equilibrium_start": True,
            "edge_radius": "0.01 mm",
            "cutting_energy": "20 N/mm",
            "severing_pressure": "30 MPa",
            "film_edges": True,
            "self_contact": True,
        },
    ),
    "crossing": ("random_cuts.py", {"kind": "crossing", "seed": 2}),
    "tight": ("random_cuts.py", {"kind": "tight", "seed": 3}),
}
"""Model, or a file of the folder ``digests``, and the keys that differ from it; or a random cut."""

OPTIONS = {"n_frame": 2, "n_snapshot": 0, "curves": False, "progress": False}


def model_of(name):
    """Read the model of a case."""
    model, keys = CASES[name]
    return shellcut.read_model(FILES / model if model.endswith(".toml") else model, keys)


def digest_of(name, folder):
    """Run a case, return digest, steps and number of splits.

    A model goes on with the run in the folder, if there is one.
    """
    out, (model, keys) = folder / "out", CASES[name]
    if model == "random_cuts.py":
        rng = np.random.default_rng(keys["seed"])
        sim, until, *_ = random_cuts.KINDS[keys["kind"]](rng)
        with closing(Recorder(sim, out, until=until, name=name, n_row=200, **OPTIONS)) as record:
            sim.run(until, [record])
    else:
        case = model_of(name).build()
        sim = case.simulation
        case.run(out, resume=out.exists(), **OPTIONS)
    summary = json.loads((out / "summary.json").read_text())
    return summary["digest"], summary["n_step"], len(sim.state.split_log)


def digests_of(names):
    """Return the digest, steps and splits of some cases by name."""
    found = {}
    for name in names:
        with tempfile.TemporaryDirectory() as folder:
            found[name] = digest_of(name, Path(folder))
    return found


def versions():
    """Return what the digests depend on beside the inputs, as one text."""
    names = ("numpy", "scipy", "numba", "llvmlite")
    libraries = ", ".join(f"{name} {version(name)}" for name in names)
    system = f"{' '.join(platform.libc_ver())}, {platform.machine()}"
    return f"shellcut {shellcut.__version__}, {libraries}, {system}"


def published():
    """Return the versions on the page, and its digests by name."""
    rows = [row.split(" | ") for row in PAGE.read_text(encoding="utf-8").splitlines()]
    said = next(row[0] for row in rows if row[0].startswith("Versions: "))
    return said, {
        row[0].strip("| "): row[-1].strip("` |") for row in rows if len(row) == 5 and "`" in row[-1]
    }


def _write_page():
    rows = ["| case | `shellcut run` | steps | splits | digest |", "|---|---|--:|--:|---|"]
    for name, (digest, n_step, n_split) in digests_of(CASES).items():
        model, keys = CASES[name]
        form = "{}={}" if model == "random_cuts.py" else "--set {}={}"
        settings = " ".join(form.format(key, json.dumps(value)) for key, value in keys.items())
        command = f"{model} {settings}".strip()
        rows.append(f"| {name} | `{command}` | {n_step:,} | {n_split} | `{digest[:16]}` |")
    head, _ = PAGE.read_text(encoding="utf-8").split("\nVersions: ")
    table = "\n".join(rows)
    PAGE.write_text(f"{head}\nVersions: {versions()}.\n\n{table}\n", encoding="utf-8")


if __name__ == "__main__":
    if sys.argv[1:]:
        print(json.dumps(digests_of(sys.argv[1:])))
    else:
        _write_page()
