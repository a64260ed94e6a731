"""``view``: turn a run in 3-D in the browser; draw a frame or a movie.

Without options, write a page to turn the run, move through its frames and read values, and open it
in the browser; it loads nothing from the network. The suffix of --output selects the page, a
picture of a frame, or a movie of all frames, with the same camera and scale. Pictures need
shellcut-fem[plot], an MP4 shellcut-fem[movie].

example: shellcut view out -o cut.mp4 --field thickness --elevation 25 --hide mesh
"""

from __future__ import annotations

import os
import sys
import webbrowser
from pathlib import Path
from typing import Any

from shellcut.files.file_list import target
from shellcut.results.run_results import Results, read
from shellcut.scene_page import spread, view_html
from shellcut.view import MOVIES, Look, draw_movie, draw_scene

from .shared import Arguments, Parser, add_options, made_of, named

PICTURES = ".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp", ".pdf"
"""Suffixes of pictures that Pillow writes."""


def add_to(parser: Parser) -> None:
    """Add its arguments to the parser."""
    parser.add_argument("out", metavar="OUT", type=named, help="folder of the run")
    parser.add_argument(
        "-o",
        "--output",
        metavar="FILE",
        type=named,
        help=f"page (.html), movie ({', '.join(MOVIES)}) or picture (.png, .jpg, ...) "
        "[OUT/view.html; with --frame OUT/frame_N.png]",
    )
    parser.add_argument(
        "--frame",
        metavar="N",
        type=int,
        help="draw this frame, counted from 0, or from the end [-1, the last]",
    )
    parser.add_argument(
        "--frames", metavar="N", type=int, help="number of frames in page or movie, at most [all]"
    )
    parser.add_argument("--fps", type=float, default=12.0, help="frames per second of the movie")
    parser.add_argument(
        "--size",
        nargs=2,
        type=int,
        metavar=("WIDTH", "HEIGHT"),
        help="size of picture or movie [pixel] [1280 800; an MP4 1920 1080, other movies 960 540]",
    )
    names = ("field", "low", "high", "colormap", "flat", "hide", "elevation", "azimuth", "zoom")
    add_options(parser, Look, **{name: f"--{name}" for name in names})


def run(arguments: Arguments) -> None:
    """Write the file, print its path and size, and open a page that has no given name."""
    output, number = arguments.output, arguments.frame
    suffix = "" if output is None else output.suffix.lower()
    page = suffix == ".html" or (output is None and number is None)
    movie = suffix in MOVIES
    problems = []
    if arguments.frames is not None and not (page or movie):
        problems.append("--frames belongs to page and movie; --frame N draws one frame")
    if number is not None and (page or movie):
        problems.append("--frame belongs to a picture: give it a name such as film.png")
    if arguments.size and page:
        problems.append("--size belongs to pictures and movies: the page fills its window")
    known = (".html", *MOVIES, *PICTURES)
    if suffix not in ("", *known):
        problems.append(f"-o must end with one of {', '.join(known)}, got {output}")
    if problems:
        raise ValueError("; ".join(problems))
    results = read(arguments.out)
    look = made_of(arguments, Look)
    if not page:
        path = _drawn(arguments, results, look, movie=movie)
        print(f"{path} ({path.stat().st_size / 1e6:.1f} MB)")
        return
    path = target(output, arguments.out / "view.html")
    page = view_html(results, path, frames=arguments.frames, look=look)
    print(page)
    # A browser would have a window; on Linux one of text would take the terminal.
    is_plain = sys.platform not in ("darwin", "win32")
    screen = os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    if output is None and (screen or not is_plain):
        webbrowser.open(page.path.resolve().as_uri())


def _drawn(arguments: Arguments, results: Results, look: Look, *, movie: bool) -> Path:
    """Draw a frame or the movie; return the file."""
    size: dict[str, Any] = {"size": tuple(arguments.size)} if arguments.size else {}
    frames = list(results.frames())
    if movie:
        path = target(arguments.output, arguments.output)
        frames = [frames[k] for k in spread(len(frames), arguments.frames or len(frames))]
        draw_movie(path, frames, fps=arguments.fps, look=look, **size)
        return path
    number = -1 if arguments.frame is None else arguments.frame
    frame = results.frame(number)  # raises if there is none
    beside = arguments.out / f"frame_{number % results.n_frame:04d}.png"
    path = target(arguments.output, beside)
    draw_scene(path, frame, together_with=frames, look=look, **size)
    return path
