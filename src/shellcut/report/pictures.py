"""Sections with pictures: crack map, snapshots of the run."""

from __future__ import annotations

import tempfile
from html import escape
from pathlib import Path

import numpy as np

from shellcut.card import image
from shellcut.files import run_folder
from shellcut.view import draw_crack_map

from .gathered import Gathered
from .markup import missing

_N_MAP = 100  # frames read for the crack map
_MISSING = "Not drawn: pictures need Matplotlib (pip install shellcut[plot])."


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

    try:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "map.png"
            draw_crack_map(path, frames, splits=places, width=6.5, dpi=130.0)
            png = path.read_bytes()
    except ImportError:
        return missing(_MISSING)
    name = frames[-1].coordinate_name
    alt = f"Plan of the film with the crack edges coloured by the {name} they opened at"
    caption = (
        f"The crack on the uncut film. Each edge is dated by the first frame in which it is "
        f"open; {len(frames)} of {run.results.n_frame if run.results else 0} frames were read."
    )
    return (
        f'<figure>{image(png, alt)}<figcaption class="caption">{escape(caption)}</figcaption>'
        "</figure>"
    )


def snapshots(run: Gathered) -> str:
    """Return the pictures that the run has drawn, side by side, large enough to be read."""
    pictures = [path.read_bytes() for path in run_folder.snapshots(run.folder)]
    if not pictures:
        return missing("No pictures: the run has drawn none. shellcut view draws them.")
    shown = "".join(
        f"<figure>{image(png, f'Film and tool, picture {k} of {len(pictures)}')}</figure>"
        for k, png in enumerate(pictures, 1)
    )
    said = f"{len(pictures)} pictures, side by side: scroll to the right for the next."
    return f'<div class="strip" tabindex="0">{shown}</div><p class="caption">{said}</p>'
