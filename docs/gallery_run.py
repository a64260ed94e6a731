"""The gallery runs every example with quick settings and shows the pictures of its run."""

import shutil
import tempfile
from pathlib import Path

from sphinx_gallery.scrapers import figure_rst

QUICK = {
    "opening_test": ["--mesh", "quick", "--angle", "40", "--duration", "2.5e-3"],
    "guillotine": ["--size", "0.8", "--length", "14"],
}
"""Arguments by example: seconds each instead of minutes. An example that is missing is an error."""


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
    """Shows the last snapshot, which is the thumbnail too, and the curves of an example's run."""

    def __repr__(self):
        """Stay the same from build to build."""
        return "PicturesOfRun()"

    def __call__(self, block, block_vars, gallery_conf):
        """Copy the pictures and return the text that shows them."""
        folder = _results_of(Path(block_vars["src_file"]))
        pictures = sorted(folder.glob("snapshot_*.png"))[-1:]
        pictures += [folder / n for n in ("torque.png", "force.png") if (folder / n).exists()]
        pictures += folder.glob("energy.png")
        places = zip(pictures, block_vars["image_path_iterator"], strict=False)
        # one figure each, over the whole width
        return "\n".join(
            figure_rst([shutil.copy(*copy)], gallery_conf["src_dir"]) for copy in places
        )


def _results_of(example):
    return Path(tempfile.gettempdir()) / "shellcut-gallery" / example.stem
