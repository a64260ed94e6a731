"""``shellcut preview``: draw and check a model before its run."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .exit_code import BAD_INPUT, DONE, refuse
from .run import add_settings_to, settings_of

if TYPE_CHECKING:
    from shellcut.model_file import Model


def add_to(commands: Any) -> None:
    """Add the subcommand to the parser."""
    parser = commands.add_parser(
        "preview",
        help="draw a model before its run",
        description="Draw film, held nodes, tool and cutting edges of a model and check it, "
        "without running it. If the model is refused, its valid parts are drawn.",
    )
    parser.add_argument("model", metavar="MODEL", help="a TOML file, or a name")
    parser.add_argument(
        "-o", "--out", metavar="PICTURE", type=Path, default=Path("model.png"), help="output file"
    )
    add_settings_to(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Build the model, draw it, print its contents."""
    from shellcut.model_file import ModelFileError, read_model
    from shellcut.models.preview import preview

    model = None
    try:
        model = read_model(arguments.model, settings_of(arguments))
        case = model.build()
    except ModelFileError as problem:
        return _draw_refused(model or problem.partial, arguments.out, problem)
    try:
        report = preview(case.simulation, arguments.out, time=case.duration, check=case.check)
    except (ValueError, ImportError, OSError) as problem:
        return refuse(problem)
    print(f"{report}\nwrote {arguments.out}")
    return BAD_INPUT if case.check.of("refuse") else DONE


def _draw_refused(model: Model | None, path: Path, problem: ValueError) -> int:
    """Draw the valid parts of a model, print its errors; return the code for bad input."""
    from shellcut.models.preview import preview_parts

    parts = None if model is None else model.parts()
    if parts is not None and not (parts.mesh is None and parts.tool is None):
        try:
            print(f"{preview_parts(parts, path)}\nwrote {path}: the valid parts of the model")
        except (ValueError, ImportError, OSError) as other:
            print(f"it cannot be drawn: {other}", file=sys.stderr)
    return refuse(problem)
