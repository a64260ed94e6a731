"""The gallery runs every example with quick settings, cell by cell.

An example is a flat script: what it is about, then cells for the model, the run, the picture and
the check, each with its text, its code and what comes of it. Pictures are the figures of Matplotlib
that a cell leaves open; a check that fails stops the build.
"""

import tempfile
from pathlib import Path

import shellcut
from shellcut.recording.frame_capture import frame_of
from shellcut.view import Look, png_of

QUICK = {
    "opening_test": ["--mesh", "quick", "--angle", "56", "--duration", "3.5e-3"],
    "guillotine": ["--size", "0.8", "--length", "14"],
    "in_a_notebook": [],
    "trouser": ["--size", "0.75", "--length", "24"],
    "own_tooth": [],
    "cut_quality": [],
    "compare_with_measured": [],
    "reading_hook": [],
    "tool_of_triangles": [],
    "stretched_cut": [],
    "laminate": [],
    "vibration_modes": [],
    "yielding_film": ["--size", "0.8", "--length", "12", "--angle", "30"],
    "torque_of_teeth": [
        "--inclinations",
        "50,70",
        "--pitches",
        "12,20",
        "--angle",
        "64",
        "--jobs=1",
    ],
    "response_surface": ["--runs", "8", "--jobs=1"],
    "shape_of_the_law": ["--angle", "56", "--laws", "2"],
    "glued_opening": ["--angle", "30"],
    "which_tooth": ["--size", "0.8", "--film", "elastic", "--angle", "56"],
    "fit_a_curve": ["--travel", "2", "--jobs=1"],
}
"""Arguments by example, in the order of the gallery: seconds each instead of minutes. An example
that is missing is an error."""


class InOrder:
    """Puts the examples in the order above."""

    def __init__(self, src_dir):
        pass

    def __call__(self, filename):
        """Return the place of one example."""
        return list(QUICK).index(Path(filename).stem)


class QuickSettings:
    """Gives an example its arguments; its results go to a folder of their own."""

    def __repr__(self):
        """Stay the same from build to build: Sphinx compares settings to see what has changed."""
        return f"QuickSettings({QUICK})"

    def __call__(self, gallery_conf, script_vars):
        """Return the arguments of one example."""
        example = Path(script_vars["src_file"])
        return [*QUICK[example.stem], "--out", str(_results_of(example))]


def _results_of(example):
    return Path(tempfile.gettempdir()) / "shellcut-gallery" / example.stem


def draw_thumbnail(block, block_vars, gallery_conf):
    """Draw the film at the end of the run; only the gallery's overview shows this picture.

    It is the first picture of an example, of which the gallery makes the thumbnail. An example
    without a run has one of its own pictures there.
    """
    pictures = block_vars["image_path_iterator"]
    if len(pictures) == 0 and (frame := _last_frame(block_vars)) is not None:
        Path(next(pictures)).write_bytes(png_of(frame, Look(zoom=1.15), (560, 800)))
    return ""  # nothing in the page


def _last_frame(block_vars):
    """Return that of the last run in the results folder, else of a simulation that has moved."""
    ended = _results_of(Path(block_vars["src_file"])).rglob("summary.json")
    for summary in sorted(ended, key=lambda path: path.stat().st_mtime, reverse=True):
        run = shellcut.read(summary.parent)
        if run.n_frame:
            return run.frame(-1)
    for value in block_vars["example_globals"].values():
        if isinstance(value, shellcut.Simulation) and value.state.time > 0.0:
            return frame_of(value, coordinate=0.0, coordinate_name="", coordinate_unit="")
    return None
