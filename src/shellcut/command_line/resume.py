"""``resume``: continue an interrupted run.

Continue an interrupted run, bit for bit, appending to its files.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from shellcut.files.run_folder import USED
from shellcut.recording.run_log import RunLog

from .run_model import run_model, stored_model
from .shared import Arguments, Parser, add_verbose_to, named, refuse


def add_to(parser: Parser) -> None:
    """Add its arguments to the parser."""
    parser.add_argument("out", metavar="OUT", type=named, help="the folder of the run")
    add_verbose_to(parser)
    parser.add_argument("--set", action="append", dest="settings", help=argparse.SUPPRESS)


def run(arguments: Arguments) -> int:
    """Build the model stored in the folder and continue from its checkpoint."""
    folder: Path = arguments.out
    if arguments.settings:
        settings = " ".join(f"--set {setting}" for setting in arguments.settings)
        return refuse(
            f"resume continues with the model of the run's start, without {settings}; for another "
            f"value start a new run: shellcut run {folder / USED} {settings} -o OTHER"
        )
    model = stored_model(folder)
    log = RunLog(words=model.words, verbose=arguments.verbose)
    return run_model(model, folder, log, resume=True)
