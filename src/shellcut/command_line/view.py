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
from shellcut.scene_page import spread, view_html
from shellcut.view import FIELDS, PARTS, Look, draw_movie, draw_scene

from .exit_code import DONE, refuse
from .shared_arguments import named

_LOOK = Look()


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
        epilog="example: shellcut view out --movie cut.mp4 --field thickness --camera 25 -60 1.3 "
        "--hide mesh",
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
        "--movie",
        metavar="FILE",
        type=named,
        help="draw all frames: .mp4, .webp or .gif",
    )
    parser.add_argument(
        "-o",
        "--output",
        metavar="FILE",
        type=named,
        help="draw a frame, the last one without --frame, to this picture [OUT/frame_N.png]",
    )
    _add_look(parser)
    _add_page_options(parser)
    parser.add_argument("--fps", type=float, default=12.0, help="frames per second of the movie")
    parser.set_defaults(run=run)


def _add_look(parser: argparse.ArgumentParser) -> None:
    look = parser.add_argument_group("look of page, picture and movie")
    look.add_argument(
        "--field",
        metavar="NAME",
        action="append",
        help=f"what colours the film: {', '.join(FIELDS)}, or a history number of the material; in "
        f"a page several to choose from [{_LOOK.field}; in a page all]",
    )
    look.add_argument(
        "--limits",
        nargs=2,
        type=float,
        metavar=("LOW", "HIGH"),
        help="ends of the colour scale of the first field [from the frames]",
    )
    look.add_argument(
        "--colormap",
        metavar="NAME",
        default=_LOOK.colormap,
        help="colour map, any of Matplotlib: cividis, inferno, turbo, coolwarm, ...",
    )
    look.add_argument(
        "--flat", action="store_true", help="one colour for each quad, not smooth from node to node"
    )
    look.add_argument(
        "--hide", metavar="PART", action="append", choices=PARTS, help=f"hide {', '.join(PARTS)}"
    )
    look.add_argument(
        "--camera",
        nargs=3,
        type=float,
        default=_LOOK.camera,
        metavar=("ELEVATION", "AZIMUTH", "ZOOM"),
        help="elevation over the x-y plane and azimuth from the x axis [deg], and zoom",
    )
    parser.add_argument(
        "--size",
        nargs=2,
        type=int,
        metavar=("WIDTH", "HEIGHT"),
        help="of a picture or movie [pixel] [1280 800; of an MP4 1920 1080, of others 960 540]",
    )


def _add_page_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--frames", metavar="N", type=int, help="most frames in page or movie, evenly spread [all]"
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
        look = Look(
            field=arguments.field[0] if arguments.field else _LOOK.field,
            limits=tuple(arguments.limits) if arguments.limits else None,
            colormap=arguments.colormap,
            smooth=not arguments.flat,
            hide=tuple(arguments.hide or ()),
            camera=tuple(arguments.camera),
        )
        if _is_drawn(arguments):
            path = _drawn(arguments, results, look)
            print(f"{path} ({path.stat().st_size / 1e6:.1f} MB)")
        else:
            page = view_html(
                results,
                target(arguments.html, arguments.out / "view.html"),
                frames=arguments.frames,
                fields=arguments.field,
                max_mb=arguments.max_mb,
                look=look,
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
    if arguments.frames is not None and drawn and not arguments.movie:
        problems.append("--frames belongs to page and movie; --frame N draws one frame")
    if drawn and arguments.field and len(arguments.field) > 1:
        problems.append(f"a picture shows one --field, got {', '.join(arguments.field)}")
    if arguments.size and not drawn:
        problems.append("--size belongs to pictures and movies: the page fills its window")
    if problems:
        raise ValueError("; ".join(problems))


def _drawn(arguments: argparse.Namespace, results: Results, look: Look) -> Path:
    """Draw a frame or the movie; return the file."""
    size: dict[str, Any] = {"size": tuple(arguments.size)} if arguments.size else {}
    frames = list(results.frames())
    if arguments.movie is not None:
        movie = target(arguments.movie, arguments.movie)
        frames = [frames[k] for k in spread(len(frames), arguments.frames or len(frames))]
        draw_movie(movie, frames, fps=arguments.fps, look=look, **size)
        return movie
    number = -1 if arguments.frame is None else arguments.frame
    frame = results.frame(number)  # raises if there is none
    beside = arguments.out / f"frame_{number % results.n_frame:04d}.png"
    path = target(arguments.output, beside)
    draw_scene(path, frame, together_with=frames, look=look, **size)
    return path
