"""The parser, made of the subcommands, and what a run of the command ends with."""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from . import compare, doctor, preview, report, resume, run, warmup

_COMMANDS = (run, resume, preview, compare, report, doctor, warmup)


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command with the given arguments, or with those of the process.

    Returns
    -------
    int
        Exit code: 0 done, 2 bad input (argparse leaves with it by itself), 3 stopped by a guard,
        130 interrupted.
    """
    arguments = parser_of_all().parse_args(argv)
    code: int = arguments.run(arguments)
    return code


def parser_of_all() -> argparse.ArgumentParser:
    """Return the parser with all subcommands."""
    parser = argparse.ArgumentParser(
        prog="shellcut", description="Explicit dynamics of thin shells cut by a sharp rigid blade."
    )
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for command in _COMMANDS:
        command.add_to(commands)
    return parser
