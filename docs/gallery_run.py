"""The gallery runs every example with quick settings and shows the pictures of its run."""

import shutil
import tempfile
from pathlib import Path

from sphinx_gallery.scrapers import figure_rst

QUICK = {
    "opening_test": ["--mesh", "quick", "--angle", "40", "--duration", "2.5e-3"],
    "guillotine": ["--size", "0.8", "--length", "14"],
    "in_a_notebook": [],
    "trouser": ["--size", "0.75", "--length", "15"],
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
        "45",
        "--jobs=1",
    ],
    "shape_of_the_law": ["--angle", "40", "--laws", "2"],
    "fit_a_curve": ["--travel", "2", "--jobs=1"],
}
"""Arguments by example, in the order of the gallery: seconds each instead of minutes. An example
that is missing is an error."""

OWN_PICTURES = {
    "in_a_notebook": [],
    "own_tooth": ["torque.png"],
    "cut_quality": ["quality.png"],
    "compare_with_measured": ["comparison.png"],
    "reading_hook": ["force.png"],
    "stretched_cut": ["work.png"],
    "laminate": ["stress.png"],
    "vibration_modes": ["modes.png"],
    "yielding_film": ["edge.png"],
    "torque_of_teeth": ["torque_of_teeth.png"],
    "shape_of_the_law": ["shape_of_the_law.png"],
    "fit_a_curve": ["fit.png"],
}
"""What an example shows; else the last snapshot and the curves of its run."""


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


class PicturesOfRun:
    """Shows the pictures of an example's run; the first is the thumbnail too."""

    def __repr__(self):
        """Stay the same from build to build."""
        return f"PicturesOfRun({OWN_PICTURES})"

    def __call__(self, block, block_vars, gallery_conf):
        """Copy the pictures and return the text that shows them."""
        example = Path(block_vars["src_file"])
        places = zip(_pictures_of(example), block_vars["image_path_iterator"], strict=False)
        # one figure each, over the whole width
        return "\n".join(
            figure_rst([shutil.copy(*copy)], gallery_conf["src_dir"]) for copy in places
        )


def _pictures_of(example):
    folder = _results_of(example)
    if example.stem in OWN_PICTURES:
        return [folder / name for name in OWN_PICTURES[example.stem]]
    curves = [folder / name for name in ("torque.png", "force.png", "energy.png")]
    return [max(folder.glob("snapshot_*.png")), *(path for path in curves if path.exists())]


def _results_of(example):
    return Path(tempfile.gettempdir()) / "shellcut-gallery" / example.stem
