"""``converge``: error bars: run a model on other meshes, slower, and from other small shapes.

Run a model and others like it: on a coarser and a finer mesh, with nodes elsewhere under the path,
at half the speed and from two other small shapes of the film, ten times its time in all, and print
its values with error bars. Runs that are done are not repeated, interrupted runs continue.

example: shellcut converge opening --set mesh=quick -o bars
"""

from __future__ import annotations

from pathlib import Path

from shellcut.results.error_bars import CONVERGED, ERROR_BARS
from shellcut.study.converge import converge

from .shared import (
    Arguments,
    Parser,
    add_engine_to,
    add_settings_to,
    keys_with_values,
    named,
    print_found,
    refuse,
)


def add_to(parser: Parser) -> None:
    """Add its arguments to the parser."""
    parser.add_argument("model", metavar="MODEL", help="a model file, a name, or a run's folder")
    parser.add_argument(
        "-o",
        "--out",
        metavar="OUT",
        type=named,
        help="folder [RUN/converge for a run without --set]",
    )
    parser.add_argument(
        "--figures", metavar="NAMES", default="", help="names in summary.json, joined by commas"
    )
    add_settings_to(parser)
    add_engine_to(parser)


def run(arguments: Arguments) -> int:
    """Run what is not done yet, print the table."""
    model, out = Path(arguments.model), arguments.out
    if model.is_dir():
        if out is None and arguments.settings:
            return refuse(
                f"--set makes another model than that of {model}, whose error bars these would not "
                "be: give a folder of their own, -o OUT"
            )
        model, out = model / "used.toml", out or model / CONVERGED
    if out is None:
        return refuse("give a folder for the runs: -o OUT")
    return print_found(
        arguments,
        lambda executor: converge(
            model,
            out,
            figures=[name.strip() for name in arguments.figures.split(",") if name.strip()],
            settings=keys_with_values("--set", arguments.settings),
            executor=executor,
        ),
        f"in {out}: {ERROR_BARS}; shellcut report {out} shows it",
    )
