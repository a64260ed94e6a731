"""``compare``: compare a run with a measured curve.

Compare a run with a measured curve on their common range: difference, peaks, work. Writes
OUT/comparison.json and, with Matplotlib, OUT/comparison.png.

example: shellcut compare out cap.csv --x angle=Winkel --y torque=Drehmoment --units "deg, N*cm"
"""

from __future__ import annotations

import sys
from pathlib import Path

from shellcut.files.file_list import target
from shellcut.results.comparison import Comparison, compare

from .shared import BAD_INPUT, DONE, Arguments, Parser, named


def add_to(parser: Parser) -> None:
    """Add its arguments to the parser."""
    parser.add_argument("out", metavar="OUT", help="folder of the run")
    parser.add_argument("measured", metavar="FILE", help="text table with the measured curve")
    add_columns_to(parser)
    parser.add_argument(
        "--json", metavar="FILE", type=named, help="output file instead of OUT/comparison.json"
    )
    parser.add_argument(
        "--picture", metavar="FILE", type=named, help="output file instead of OUT/comparison.png"
    )


def add_columns_to(parser: Parser) -> None:
    """Add the options that select columns and set the comparison."""
    for option, what in (("--x", "coordinate"), ("--y", "quantity")):
        parser.add_argument(
            option,
            metavar="NAME[=COLUMN]",
            default="",
            help=f"the {what} by its name in the run's history; after '=' the file's column, by "
            "heading or number, if its name differs",
        )
    parser.add_argument("--units", help='units of the file\'s columns, as "deg, N*mm"')
    parser.add_argument(
        "--window", type=float, help="average the simulated curve over this width, in the unit of x"
    )


def compared(arguments: Arguments, out: str | Path) -> Comparison:
    """Compare a run with the measured curve that the arguments give, as ``compare`` does."""
    (x, x_column), (y, y_column) = parted(arguments.x), parted(arguments.y)
    return compare(
        out,
        arguments.measured,
        x=x,
        y=y,
        columns=(x_column, y_column),
        units=arguments.units,
        window=arguments.window,
    )


def run(arguments: Arguments) -> int:
    """Compare, print a table, write the values and the picture."""
    comparison = compared(arguments, arguments.out)
    print(comparison)
    out = Path(arguments.out)
    folder = out if out.is_dir() else out.parent
    measured = [arguments.measured]
    figures = target(arguments.json, folder / "comparison.json", measured)
    picture = target(arguments.picture, folder / "comparison.png", measured)
    written = [comparison.to_json(figures)]
    try:
        written.append(comparison.plot(picture))
    except ImportError as missing:
        print(f"no picture: {missing}", file=sys.stderr)
        # A missing picture is an error only if one was asked for.
        if arguments.picture:
            return BAD_INPUT
    print("written: " + ", ".join(map(str, written)))
    return DONE


def parted(text: str) -> tuple[str | None, str | None]:
    """Split ``angle=Winkel`` into the history's name and the file's."""
    name, _, column = text.partition("=")
    return name or None, column or None
