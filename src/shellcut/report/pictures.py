"""Sections with pictures: crack map, snapshots of the run, the run in three dimensions."""

from __future__ import annotations

import shlex
import tempfile
from html import escape
from pathlib import Path

import numpy as np

from shellcut.card import image
from shellcut.files import run_folder
from shellcut.scene_page import packed_scene
from shellcut.view import draw_crack_map

from .gathered import Gathered
from .markup import missing

_LARGEST = 15_000_000  # bytes that the scene may add to a report
_N_MAP = 100  # frames read for the crack map


def crack_map(run: Gathered) -> str:
    """Return the crack on the uncut film."""
    frames = run.frames(_N_MAP)
    if not frames:
        return missing("No crack map: there are no frames.")
    places = {}
    if splits := run.results.splits:
        where = np.stack([splits[axis] for axis in "XYZ"], axis=1)
        kinds = splits["kind"]
        places = {str(kind): where[kinds == kind] for kind in np.unique(kinds)}

    try:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "map.png"
            draw_crack_map(path, frames, splits=places, width=6.5, dpi=130.0)
            png = path.read_bytes()
    except ImportError:
        return missing("Not drawn: pictures need Matplotlib (pip install shellcut[plot]).")
    name = frames[-1].coordinate_name
    alt = f"Plan of the film with the crack edges coloured by the {name} they opened at"
    caption = (
        f"The crack on the uncut film. Each edge is dated by the first frame in which it is "
        f"open; {len(frames)} of {run.results.n_frame} frames were read."
    )
    return (
        f'<figure>{image(png, alt)}<figcaption class="caption">{escape(caption)}</figcaption>'
        "</figure>"
    )


def snapshots(run: Gathered) -> str:
    """Return the pictures that the run has drawn, side by side, large enough to be read."""
    pictures = [path.read_bytes() for path in run_folder.snapshots(run.results.folder)]
    if not pictures:
        return missing("No pictures: the run has drawn none. shellcut view draws them.")
    shown = "".join(
        f"<figure>{image(png, f'Film and tool, picture {k} of {len(pictures)}')}</figure>"
        for k, png in enumerate(pictures, 1)
    )
    said = f"{len(pictures)} pictures, side by side: scroll to the right for the next."
    return f'<div class="strip" tabindex="0">{shown}</div><p class="caption">{said}</p>'


def scene(run: Gathered) -> str:
    """Return the scene, of fewer frames if all need too much room, or why there is none."""
    if not run.results.n_frame:
        return missing("No scene: there are no frames.")
    folder = escape(shlex.quote(str(run.results.folder)))
    command = f"<code>shellcut view {folder} -o FILE.html</code>"
    try:
        packed = packed_scene(run.results, None, _LARGEST)
    except ValueError as error:
        return missing(f"No scene: {error}.") + f"<p>{command} writes a page with it alone.</p>"
    said = f"<p>Every frame is in the page that {command} writes.</p>" if packed.dropped else ""
    return packed.html + said
