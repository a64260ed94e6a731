"""``shellcut movie``: the frames of a run as a movie."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from shellcut.results.run_results import read
from shellcut.view import STRESSES, draw_movie

from .exit_code import DONE, refuse


def add_to(commands: Any) -> None:
    """Add the subcommand to the parser's."""
    parser = commands.add_parser(
        "movie",
        help="draw the frames of a run as a movie",
        description="Draw the frames of a run as a movie, by one camera and on one stress scale. "
        "An MP4 needs shellcut[movie], a GIF does not.",
    )
    parser.add_argument("out", metavar="OUT", type=Path, help="folder of the run")
    parser.add_argument(
        "-o", "--output", metavar="FILE", type=Path, help=".mp4 or .gif [OUT/movie.mp4]"
    )
    parser.add_argument("--fps", type=float, default=12.0, help="frames a second")
    parser.add_argument(
        "--stress",
        default="largest principal",
        help=f"what the film is coloured by: {', '.join(STRESSES)}",
    )
    parser.add_argument(
        "--limits",
        nargs=2,
        type=float,
        metavar=("LOW", "HIGH"),
        help="ends of the colour scale in MPa; those of the frames by default",
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Draw, with progress on standard error, and say where the movie is."""
    path = arguments.output or arguments.out / "movie.mp4"
    try:
        draw_movie(
            path,
            list(read(arguments.out).frames()),
            fps=arguments.fps,
            stress=arguments.stress,
            stress_limits=tuple(arguments.limits) if arguments.limits else None,
        )
    except (ValueError, ImportError, OSError) as problem:
        return refuse(problem)
    print(f"{path} ({path.stat().st_size / 1e6:.1f} MB)")
    return DONE
