"""Sections with pictures: crack map, film strip, snapshots."""

from __future__ import annotations

import base64
import tempfile
from collections.abc import Callable
from html import escape
from pathlib import Path

import numpy as np

from shellcut import run_folder
from shellcut.view import draw_crack_map, draw_film_strip

from .gathered import Gathered
from .markup import missing, pretty

_N_MAP = 100  # frames that the crack map takes its times from
_N_STRIP = 6  # frames in the film strip


def crack_map(run: Gathered) -> str:
    """Return the crack on the uncut film."""
    frames = run.frames(_N_MAP)
    if not frames:
        return missing("No crack map: there are no frames.")
    places = {}
    if run.splits:
        where = np.stack([run.splits[axis] for axis in "XYZ"], axis=1)
        kinds = run.splits["kind"]
        places = {str(kind): where[kinds == kind] for kind in np.unique(kinds)}
    picture = _picture(lambda path: draw_crack_map(path, frames, splits=places, width=8.0))
    name = frames[-1].coordinate_name
    return _figure(
        picture,
        f"Plan of the film with the crack edges coloured by the {name} they opened at",
        f"The crack on the uncut film. An edge is dated by the first frame that has it open; of "
        f"{run.results.n_frame if run.results else 0} frames {len(frames)} were looked at.",
    )


def film_strip(run: Gathered) -> str:
    """Return a few frames beside each other."""
    frames = run.frames(_N_STRIP)
    if not frames:
        return missing("No film strip: there are no frames.")
    picture = _picture(lambda path: draw_film_strip(path, frames))
    way = f"{frames[0].coordinate_name} {frames[0].coordinate:.3g} to {frames[-1].coordinate:.3g}"
    return _figure(
        picture,
        f"{len(frames)} views of the film being cut, {way} {pretty(frames[0].coordinate_unit)}",
        "All by one camera and on one stress scale.",
    )


def snapshots(run: Gathered) -> str:
    """Return the run's own snapshots, behind a slider where there is JavaScript."""
    pictures = run_folder.snapshots(run.folder)
    images = [
        _image(path.read_bytes(), f"Snapshot {k + 1} of {len(pictures)}: whole film and one tooth")
        for k, path in enumerate(pictures)
    ]
    if not images:
        return ""
    slider = (
        f'<p class="turn"><label for="slide">Picture</label><input id="slide" type="range" min="0" '
        f'max="{len(images) - 1}" value="{len(images) // 2}"><output for="slide"></output></p>'
    )
    return f'<figure class="slides">{slider}<div class="wide">{"".join(images)}</div></figure>'


def _picture(draw: Callable[[Path], None]) -> bytes | None:
    # Bytes of a PNG; None where Matplotlib is missing.
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "picture.png"
        try:
            draw(path)
        except ImportError:
            return None
        return path.read_bytes()


def _figure(picture: bytes | None, alt: str, caption: str) -> str:
    if picture is None:
        return missing("Not drawn: pictures need Matplotlib (pip install shellcut[plot]).")
    words = f'<figcaption class="caption">{escape(caption)}</figcaption>'
    return f'<figure><div class="wide">{_image(picture, alt)}</div>{words}</figure>'


def _image(png: bytes, alt: str) -> str:
    data = base64.b64encode(png).decode("ascii")
    return f'<img alt="{escape(alt)}" src="data:image/png;base64,{data}">'
