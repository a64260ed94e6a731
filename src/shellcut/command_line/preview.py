"""``shellcut preview``: look at a model before its run."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from .exit_code import DONE, refuse
from .run import add_settings_to, settings_of


def add_to(commands: Any) -> None:
    """Add the subcommand to the parser's."""
    parser = commands.add_parser(
        "preview",
        help="draw a model before its run",
        description="Draw film, held nodes, tool and cutting edges of a model; run nothing.",
    )
    parser.add_argument("model", metavar="MODEL", help="a file in TOML, or a name")
    parser.add_argument(
        "-o", "--out", metavar="PICTURE", type=Path, default=Path("model.png"), help="what to write"
    )
    add_settings_to(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Build the model, draw it, print what it has."""
    from shellcut.model_file import read_model
    from shellcut.preview import preview

    try:
        case = read_model(arguments.model, settings_of(arguments)).build()
        report = preview(case.simulation, arguments.out, time=case.duration)
    except (ValueError, ImportError, OSError) as problem:
        return refuse(problem)
    if case.imprint is not None:
        report += f"\n{case.imprint.report()}"
    print(f"{report}\nwrote {arguments.out}")
    return DONE
