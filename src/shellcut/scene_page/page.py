"""Write a run as one HTML page to turn, play and read values from."""

from __future__ import annotations

import functools
import importlib.resources
import os
import string
from collections.abc import Mapping
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any

import numpy as np

from shellcut.files.distribution import VERSION
from shellcut.files.whole_file import write_text
from shellcut.results.run_results import Results, read
from shellcut.view import Look
from shellcut.view.look import fields_of

from .packed_run import as_json, packed

_ROOM = "shellcut.scene_page"
_SCRIPTS = ("tables.js", "film.js", "scene.js", "panel.js")
_LOOK = Look()
_MB = 1_000_000
# Frames in memory may hold this many bytes for every byte of a page; packing saves less.
_MOST_PACKED = 16
_LARGEST = 60_000_000  # bytes of a page


@dataclass(frozen=True)
class ScenePage:
    """A page that was written."""

    path: Path
    n_byte: int
    """Its size."""
    frames: list[int]
    """Numbers of the frames in it."""
    n_frame: int
    """Frames of the run."""
    dropped: str
    """Why there are fewer frames than asked for; "" if there are not."""

    def __str__(self) -> str:
        said = f"{self.path} ({_size(self.n_byte)}), {len(self.frames)} of {self.n_frame} frames"
        return f"{said}; {self.dropped}" if self.dropped else said


def view_html(
    run: Results | str | os.PathLike[str],
    path: str | os.PathLike[str],
    *,
    frames: int | None = None,
    look: Look = _LOOK,
) -> ScenePage:
    """Write one self-contained HTML page with a run in three dimensions.

    A browser turns it, plays its frames, colours the film by a field and reads values where one
    clicks. Nothing is loaded from the network; no package but shellcut is needed.

    Parameters
    ----------
    run : Results, str or Path
        The results, or the run's folder.
    path : str or Path
        The page, replaced if it exists.
    frames : int, optional
        Most frames in the page, spread evenly over the run with its first and last; by default
        all. A page larger than 60 MB gets fewer, and :attr:`ScenePage.dropped` says so.
    look : shellcut.view.Look
        Field, colours, camera and hidden parts at the start.

    Returns
    -------
    ScenePage
        Path, size, frames and fields; printed, it is one line about them.

    Raises
    ------
    FileNotFoundError
        If there is no run in the folder.
    ValueError
        If the run has no frame, the field is unknown, or two frames need more than 60 MB.
    OSError
        If the page cannot be written.

    Examples
    --------
    >>> import shellcut
    >>> page = shellcut.view_html("out", "cut.html", frames=50)  # doctest: +SKIP
    >>> print(page)  # doctest: +SKIP
    cut.html (3.1 MB), 50 of 101 frames
    """
    results = run if isinstance(run, Results) else read(run)
    scripts = scene_scripts()
    scene, numbers, dropped = packed_scene(results, frames, _LARGEST - len(scripts), look)
    html = string.Template(part(_ROOM, "page.html")).substitute(
        title=escape(f"{results.name} - the run in three dimensions"),
        heading=escape(results.name),
        style=part(_ROOM, "page.css") + part(_ROOM, "scene.css"),
        scene=scene,
        scripts=scripts,
        footer=escape(
            f"{len(numbers)} of {results.n_frame} frames of {results.folder.resolve()}"
            f"{f' ({dropped})' if dropped else ''}. Written by "
            f"shellcut {VERSION} with three.js."
        ),
    )
    write_text(Path(path), html, errors="backslashreplace")
    size = Path(path).stat().st_size
    return ScenePage(Path(path), size, numbers, results.n_frame, dropped)


def packed_scene(
    results: Results, frames: int | None, room: int, look: Look = _LOOK
) -> tuple[str, list[int], str]:
    """Return the scene of a run in at most ``room`` bytes, of fewer frames if need be.

    Its HTML, the numbers of its frames, and why there are fewer than asked for; "" if there are
    not.
    """
    if frames is not None and frames < 1:
        raise ValueError(f"a page must have at least one frame, got frames={frames}")
    if not results.n_frame:
        raise ValueError(
            f"a page needs at least one frame, the run in {results.folder} has written none"
        )
    last = results.frame(-1)
    look.field_of(last)  # raises if there is none
    chosen = list(fields_of(last).values())
    wanted = spread(results.n_frame, results.n_frame if frames is None else frames)
    raw = 4 * (3 * len(last.points) + last.quads.size + len(chosen) * len(last.quads))  # in memory
    held = max(2, _MOST_PACKED * room // max(raw, 1))
    numbers = [wanted[k] for k in spread(len(wanted), held)]
    html = _figure(*packed(results, numbers, chosen, look))
    whole = len(html) * len(wanted) / len(numbers)
    while len(html) > room and (n := len(numbers)) > 2:
        fewer = spread(n, max(2, min(n - 1, int(0.97 * n * room / len(html)))))
        numbers = [numbers[k] for k in fewer]
        html = _figure(*packed(results, numbers, chosen, look))
    n = len(numbers)
    if len(html) > room:
        raise ValueError(f"{n} frames must fit into {_size(room)}, they take {_size(len(html))}")
    dropped = ""
    if n < len(wanted):
        dropped = f"all {len(wanted)} frames would need {_size(whole)}, the limit is {_size(room)}"
    return html, numbers, dropped


@functools.cache
def scene_scripts() -> str:
    """Return the script elements of a scene: three.js with its licence, and ours."""
    licence, library = part(_ROOM, "three/LICENSE"), part(_ROOM, "three/three.min.js")
    own = "\n".join(part(_ROOM, name) for name in _SCRIPTS)
    return (
        f"<script>\n/*\n{licence}*/\n{library}\n</script>\n"
        f'<script>\n(() => {{\n"use strict";\n{own}}})();\n</script>'
    )


def spread(n: int, most: int) -> list[int]:
    """Return up to ``most`` numbers from 0 to n - 1, evenly spread, with the last one.

    Examples
    --------
    >>> spread(101, 5), spread(3, 5), spread(9, 1)
    ([0, 25, 50, 75, 100], [0, 1, 2], [8])
    """
    if most == 1:
        return [n - 1]
    wanted = np.linspace(0, n - 1, min(n, most)).round().astype(int)
    return [int(k) for k in np.unique(wanted)]


def _figure(described: Mapping[str, Any], data: Mapping[str, str]) -> str:
    tables = "\n".join(
        f'<script type="text/plain" data-table="{name}">{text}</script>'
        for name, text in data.items()
    )
    return string.Template(part(_ROOM, "scene.html")).substitute(
        content=as_json(described), tables=tables
    )


def _size(n_byte: float) -> str:
    digits = 1 if n_byte >= 0.1 * _MB else 3
    return f"{n_byte / _MB:.{digits}f} MB"


def part(room: str, name: str) -> str:
    """Return the text of a file beside the modules of a package."""
    return (importlib.resources.files(room) / name).read_text(encoding="utf-8")
