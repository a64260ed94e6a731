"""``shellcut view``: one frame of a run as a 3-D picture, or all frames as a movie."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from shellcut.results.run_results import read
from shellcut.view import STRESSES, draw_movie, draw_scene

from .exit_code import DONE, refuse


def add_to(commands: Any) -> None:
    """Add the subcommand to the parser."""
    parser = commands.add_parser(
        "view",
        help="draw a frame of a run in 3-D, or all frames as a movie",
        description="Draw a frame of a run in 3-D, or all frames as a movie, with the same camera "
        "and stress scale: a picture matches its frame in the movie. PyVista draws if installed "
        "(shellcut[view]), otherwise Matplotlib. An MP4 needs shellcut[movie], a GIF does not.",
        epilog="example: shellcut view out --movie out/cut.gif",
    )
    parser.add_argument("out", metavar="OUT", type=Path, help="folder of the run")
    what = parser.add_mutually_exclusive_group()
    what.add_argument(
        "--frame",
        metavar="N",
        type=int,
        default=-1,
        help="frame number, counted from 0, or from the end: -1 [the last]",
    )
    what.add_argument(
        "--movie", metavar="FILE", type=Path, help="all frames, .mp4 or .gif, instead of a picture"
    )
    parser.add_argument(
        "-o", "--output", metavar="FILE", type=Path, help="the picture [OUT/frame_N.png]"
    )
    parser.add_argument("--fps", type=float, default=12.0, help="frames per second of the movie")
    parser.add_argument(
        "--stress",
        default="largest principal",
        help=f"stress shown as colour: {', '.join(STRESSES)}",
    )
    parser.add_argument(
        "--limits",
        nargs=2,
        type=float,
        metavar=("LOW", "HIGH"),
        help="limits of the colour scale in MPa [from the frames]",
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Draw, with progress on standard error, and print the path of the picture or movie."""
    limits = tuple(arguments.limits) if arguments.limits else None
    try:
        results = read(arguments.out)
        if arguments.movie is None:
            frame = results.frame(arguments.frame)  # raises if there is none
            number = arguments.frame % results.n_frame
            path = arguments.output or arguments.out / f"frame_{number:04d}.png"
            draw_scene(
                path,
                frame,
                stress=arguments.stress,
                stress_limits=limits,
                together_with=list(results.frames()),
            )
        elif arguments.output is not None:
            raise ValueError("--output names a picture, --movie names its own file: give only one")
        else:
            path = arguments.movie
            draw_movie(
                path,
                list(results.frames()),
                fps=arguments.fps,
                stress=arguments.stress,
                stress_limits=limits,
            )
    except (ValueError, IndexError, ImportError, OSError) as problem:
        return refuse(problem)
    print(f"{path} ({path.stat().st_size / 1e6:.1f} MB)")
    return DONE
