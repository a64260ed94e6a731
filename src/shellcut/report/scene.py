"""The section with the run in three dimensions."""

from __future__ import annotations

import shlex
from html import escape

from shellcut.scene_page import packed_scene

from .gathered import Gathered
from .markup import missing

MARK = 'class="scene3d"'
"""What a page with a scene contains."""

_LARGEST = 15_000_000  # bytes that the scene may add to a report


def scene(run: Gathered) -> str:
    """Return the scene, of fewer frames if all need too much room, or why there is none."""
    if run.results is None or not run.results.n_frame:
        return missing("No scene: there are no frames.")
    command = f"<code>shellcut view {escape(shlex.quote(str(run.folder)))} -o FILE.html</code>"
    try:
        packed = packed_scene(run.results, None, _LARGEST)
    except ValueError as error:
        return missing(f"No scene: {error}.") + f"<p>{command} writes a page with it alone.</p>"
    said = f"<p>Every frame is in the page that {command} writes.</p>" if packed.dropped else ""
    return packed.html + said
