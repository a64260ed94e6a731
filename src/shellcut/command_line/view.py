"""``shellcut view``: a run in a window or as an HTML page, a frame as a picture, a movie."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from shellcut.files.file_list import target
from shellcut.results.run_results import Results, read
from shellcut.scene_page import view_html
from shellcut.view import STRESSES, draw_movie, draw_scene, why_no_window

from .exit_code import DONE, refuse
from .named_path import named

_STRESS = "largest principal"


def add_to(commands: Any) -> None:
    """Add the subcommand to the parser."""
    parser = commands.add_parser(
        "view",
        help="turn a run in 3-D, in a window or as an HTML page; draw a frame or a movie",
        description="Without options, open a window to turn the run, move through its frames and "
        "read values (shellcut[view] and a screen). --html writes the same as one page for any "
        "browser, which needs neither and loads nothing from the network. --frame or --output "
        "draws a picture of a frame, --movie all frames, with the same camera and scale: a "
        "picture matches its frame in the movie. Both need shellcut[plot], an MP4 shellcut[movie].",
        epilog="example: shellcut view out --html out/cut.html --frames 50 --field displacement",
    )
    parser.add_argument("out", metavar="OUT", type=named, help="folder of the run")
    what = parser.add_mutually_exclusive_group()
    what.add_argument("--html", metavar="FILE", type=named, help="write the run as one HTML page")
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
        help="limits of the colour scale of window, picture or movie [from the frames]",
    )
    parser.set_defaults(run=run)


def _add_scene_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--field",
        metavar="NAME",
        action="append",
        help="field that colours the film in the window or page: a stress as for --stress, "
        "thickness, displacement, displacement z, speed, or a history number of the material; "
        "several for a page to choose from [all, the first one shown]",
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
    """Open the window, or write what is asked for and print its path and size."""
    try:
        _check(arguments)
        results = read(arguments.out)
        if arguments.html is not None:
            page = view_html(
                results,
                target(arguments.html, arguments.html),
                frames=arguments.frames,
                fields=arguments.field,
                max_mb=arguments.max_mb,
            )
            print(page)
        elif arguments.movie is not None or arguments.frame is not None or arguments.output:
            path = _drawn(arguments, results)
            print(f"{path} ({path.stat().st_size / 1e6:.1f} MB)")
        else:
            _open(arguments, results)
    except (ValueError, IndexError, ImportError, OSError) as problem:
        return refuse(problem)
    return DONE


def _check(arguments: argparse.Namespace) -> None:
    drawn = arguments.movie or arguments.output or arguments.frame is not None
    problems = []
    if arguments.output is not None and (arguments.movie or arguments.html):
        other = "--movie" if arguments.movie else "--html"
        problems.append(f"--output names a picture, {other} names its own file: give only one")
    if arguments.frames is not None and arguments.html is None:
        problems.append("--frames belongs to --html; --frame N draws one frame")
    if arguments.field and drawn:
        problems.append("--field belongs to the window and to --html; a picture takes --stress")
    if arguments.stress is not None and not drawn:
        problems.append("--stress belongs to pictures and movies; window and page take --field")
    if arguments.limits and arguments.html:
        problems.append("--limits must not be given with --html: one changes them in the page")
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


def _open(arguments: argparse.Namespace, results: Results) -> None:
    """Open the window and wait until it is closed."""
    reason = why_no_window()
    if reason is not None:
        raise ValueError(
            f"a window needs PyVista (pip install shellcut[view]) and a screen: {reason}. "
            "--html FILE writes a page for the browser, --frame -1 draws the last frame"
        )
    if arguments.field and len(arguments.field) > 1:
        raise ValueError(f"a window starts with one --field, got {len(arguments.field)}")
    from shellcut.view.window import Window

    limits = tuple(arguments.limits) if arguments.limits else None
    field = arguments.field[0] if arguments.field else _STRESS
    Window(results, field, limits=limits).show()
