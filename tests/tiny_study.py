"""A study whose runs take a second each."""

from shellcut.study.one_run import outcome_in

SETTINGS = {
    "membrane.length": 6,
    "membrane.width": 4,
    "membrane.size": 0.5,
    "notch": 1,
    "travel": 2.0,
    # Said, or each study would make sure that the kernels of the other path are there, too.
    "fracture.path": "edges",
    "output.frames": 2,
    "output.rows": 300,
    # As long as the run itself, and a process of its own loads Matplotlib for it.
    "output.curves": False,
}
ANGLES = {"wedge_half_angle_deg": "10,14,18,22"}


def in_words(values):
    """Return values as the command takes them."""
    return [f"--set={key}={str(value).lower()}" for key, value in values.items()]


def done_at(out):
    """Return the times at which the runs of a study were done, by their files."""
    there = out.rglob("summary.json")
    return {path: path.stat().st_mtime_ns for path in there if outcome_in(path.parent)}
