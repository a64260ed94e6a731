"""Ten short runs whose digests are in docs/same-bits.md; without names, write its table anew.

``python tests/regression/digest_cases.py [NAME ...]`` prints the digests of some of them as JSON.
"""

import json
import platform
import sys
import tempfile
from importlib.metadata import version
from pathlib import Path

PAGE = Path(__file__).parents[2] / "docs" / "same-bits.md"

_SHORT = {"membrane.length": "12 mm", "membrane.width": "6.4 mm", "travel": "4 mm"}
_TORN = {"membrane.length": "14 mm", "travel": "4 mm"}
CASES = {
    "opening": ("opening", {"mesh": "quick", "motion.angle_deg": 12.0, "duration": "0.8 ms"}),
    "opening on M1": ("opening", {"motion.angle_deg": 3.0, "duration": "0.2 ms"}),
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
}
"""Model, or the file below, and the keys that differ from it."""

DISC = """model = "free"
threads = 2
[membrane]
radius = "8 mm"
n_side = 8
clamp = "rim"
[tool]
kind = "blade"
edge_angle_deg = 60
length = "4 mm"
shift = [-6.0, 0.0, 3.1]
[motion]
direction = [1, 0, -0.5]
speed = "6 m/s"
duration = "1 ms"
[contact]
self_contact = true
"""


def digest_of(name, folder):
    """Run a case into a folder; return its digest and its number of steps and of splits."""
    from shellcut import read_model

    model, keys = CASES[name]
    if model.endswith(".toml"):
        (folder / model).write_text(DISC)
        model = folder / model
    case = read_model(model, keys).build()
    case.run(folder / "out", n_frame=2, n_snapshot=0, curves=False, progress=False)
    summary = json.loads((folder / "out" / "summary.json").read_text())
    return summary["digest"], summary["n_step"], len(case.simulation.state.split_log)


def digests_of(names):
    """Return the digest, steps and splits of some cases by name."""
    found = {}
    for name in names:
        with tempfile.TemporaryDirectory() as folder:
            found[name] = digest_of(name, Path(folder))
    return found


def versions():
    """Return what the digests depend on beside the inputs, as one text."""
    names = ("shellcut", "numpy", "scipy", "numba", "llvmlite")
    libraries = ", ".join(f"{name} {version(name)}" for name in names)
    return f"{libraries}, {' '.join(platform.libc_ver())}, {platform.machine()}"


def published():
    """Return the versions on the page and its digests by name."""
    text = PAGE.read_text(encoding="utf-8")
    rows = [line.split(" | ") for line in text.splitlines() if line.startswith("| ")]
    said = next(line for line in text.splitlines() if line.startswith("Versions: "))
    return said, {row[0].strip("| "): row[-1].strip("` |") for row in rows[2:]}


def _write_page():
    rows = ["| case | `shellcut run` | steps | splits | digest |", "|---|---|---|---|---|"]
    for name, (digest, n_step, n_split) in digests_of(CASES).items():
        model, keys = CASES[name]
        settings = " ".join(f"--set {key}={value!r}" for key, value in keys.items())
        rows.append(f"| {name} | `{model} {settings}` | {n_step:,} | {n_split} | `{digest[:16]}` |")
    head, _ = PAGE.read_text(encoding="utf-8").split("\nVersions: ")
    table = "\n".join(rows)
    PAGE.write_text(f"{head}\nVersions: {versions()}.\n\n{table}\n", encoding="utf-8")


if __name__ == "__main__":
    if sys.argv[1:]:
        print(json.dumps(digests_of(sys.argv[1:])))
    else:
        _write_page()
