"""``shellcut view``: a run as a page to turn, a frame as a picture, a movie."""

from __future__ import annotations

import argparse
import os
import sys
import webbrowser
from pathlib import Path
from typing import Any

from shellcut.files.file_list import target
from shellcut.results.run_results import Results, read
from shellcut.scene_page import view_html
from shellcut.view import STRESSES, draw_movie, draw_scene

from .exit_code import DONE, refuse
from .shared_arguments import named

_STRESS = "largest principal"


def add_to(commands: Any) -> None:
    """Add the subcommand to the parser."""
    parser = commands.add_parser(
        "view",
        help="turn a run in 3-D in the browser; draw a frame or a movie",
        description="Without options, write a page to turn the run, move through its frames and "
        "read values, and open it in the browser; it loads nothing from the network. --html writes "
        "it to a file of your own. --frame or --output "
        "draws a picture of a frame, --movie all frames, with the same camera and scale: a "
        "picture matches its frame in the movie. Both need shellcut[plot], an MP4 shellcut[movie].",
        epilog="example: shellcut view out --html out/cut.html --frames 50 --field displacement",
    )
    parser.add_argument("out", metavar="OUT", type=named, help="folder of the run")
    what = parser.add_mutually_exclusive_group()
    what.add_argument(
        "--html", metavar="FILE", type=named, help="write the page to turn the run here"
    )
    what.add_argument(
        "--frame",
        metavar="N",
        type=int,
        help="draw this frame, counted from 0, or from the end: -1 is the last",
    )
    what.add_argument(
        "--movie", metavar="FILE", type=named, help="draw all frames as a movie, .mp4 or .gif"
    )
    parser.add_argument(
        "-o",
        "--output",
        metavar="FILE",
        type=named,
        help="draw a frame, the last one without --frame, to this picture [OUT/frame_N.png]",
    )
    _add_scene_options(parser)
    parser.add_argument("--fps", type=float, default=12.0, help="frames per second of the movie")
    parser.add_argument(
        "--stress",
        help=f"stress shown as colour in a picture or movie: {', '.join(STRESSES)} [{_STRESS}]",
    )
    parser.add_argument(
        "--limits",
        nargs=2,
        type=float,
        metavar=("LOW", "HIGH"),
        help="limits of the colour scale of picture or movie [from the frames]",
    )
    parser.set_defaults(run=run)


def _add_scene_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--field",
        metavar="NAME",
        action="append",
        help="field that colours the film in the page: a stress as for --stress, "
        "thickness, displacement, displacement z, speed, or a history number of the material; "
        "several to choose from [all, the first one shown]",
    )
    parser.add_argument(
        "--frames", metavar="N", type=int, help="most frames in the page, evenly spread [all]"
    )
    parser.add_argument(
        "--max-mb",
        metavar="MB",
        type=float,
        default=60.0,
        help="largest size of the page; above it the page gets fewer frames",
    )


def run(arguments: argparse.Namespace) -> int:
    """Write what is asked for, print its path and size, and open a page that has no name."""
    try:
        _check(arguments)
        results = read(arguments.out)
        if _is_drawn(arguments):
            path = _drawn(arguments, results)
            print(f"{path} ({path.stat().st_size / 1e6:.1f} MB)")
        else:
            page = view_html(
                results,
                target(arguments.html, arguments.out / "view.html"),
                frames=arguments.frames,
                fields=arguments.field,
                max_mb=arguments.max_mb,
            )
            print(page)
            if arguments.html is None and _has_screen():
                webbrowser.open(page.path.resolve().as_uri())
    except (ValueError, IndexError, ImportError, OSError) as problem:
        return refuse(problem)
    return DONE


def _is_drawn(arguments: argparse.Namespace) -> bool:
    return bool(arguments.movie or arguments.output or arguments.frame is not None)


def _has_screen() -> bool:
    """Whether a browser would have a window; on Linux one of text would take the terminal."""
    is_plain = sys.platform not in ("darwin", "win32")
    return not is_plain or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


def _check(arguments: argparse.Namespace) -> None:
    drawn = _is_drawn(arguments)
    problems = []
    if arguments.output is not None and (arguments.movie or arguments.html):
        other = "--movie" if arguments.movie else "--html"
        problems.append(f"--output names a picture, {other} names its own file: give only one")
    if arguments.frames is not None and drawn:
        problems.append("--frames belongs to the page; --frame N draws one frame")
    if arguments.field and drawn:
        problems.append("--field belongs to the page; a picture takes --stress")
    if arguments.stress is not None and not drawn:
        problems.append("--stress belongs to pictures and movies; the page takes --field")
    if arguments.limits and not drawn:
        problems.append("--limits belongs to pictures and movies: one changes them in the page")
    if problems:
        raise ValueError("; ".join(problems))


def _drawn(arguments: argparse.Namespace, results: Results) -> Path:
    """Draw a frame or the movie; return the file."""
    look: dict[str, Any] = {
        "stress": _STRESS if arguments.stress is None else arguments.stress,
        "stress_limits": tuple(arguments.limits) if arguments.limits else None,
    }
    if arguments.movie is not None:
        movie = target(arguments.movie, arguments.movie)
        draw_movie(movie, list(results.frames()), fps=arguments.fps, **look)
        return movie
    number = -1 if arguments.frame is None else arguments.frame
    frame = results.frame(number)  # raises if there is none
    beside = arguments.out / f"frame_{number % results.n_frame:04d}.png"
    path = target(arguments.output, beside)
    draw_scene(path, frame, together_with=list(results.frames()), **look)
    return path
