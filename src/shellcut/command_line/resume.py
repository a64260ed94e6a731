"""``resume``: continue an interrupted run.

Continue an interrupted run, bit for bit, appending to its files.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from shellcut.files.run_folder import USED
from shellcut.recording.run_log import RunLog

from .exit_code import refuse
from .run_model import run_model
from .shared_arguments import add_verbose_to, named


def add_to(parser: argparse.ArgumentParser) -> None:
    """Add its arguments to the parser."""
    parser.add_argument("out", metavar="OUT", type=named, help="the folder of the run")
    add_verbose_to(parser)
    parser.add_argument("--set", action="append", dest="settings", help=argparse.SUPPRESS)


def run(arguments: argparse.Namespace) -> int:
    """Build the model stored in the folder and continue from its checkpoint."""
    from shellcut.files.folder_lock import refuse_if_in_use
    from shellcut.model_file import read_model
    from shellcut.model_file.writer import is_as_written

    folder: Path = arguments.out
    used = folder / USED
    if not folder.is_dir():
        return refuse(f"{folder}: there is no such folder")
    if not used.is_file():
        return refuse(f"{folder} holds no {USED}: it is not a folder of shellcut run")
    if arguments.settings:
        settings = " ".join(f"--set {setting}" for setting in arguments.settings)
        return refuse(
            f"resume continues with the model of the run's start, without {settings}; for another "
            f"value start a new run: shellcut run {used} {settings} -o OTHER"
        )
    refuse_if_in_use(folder)
    model = read_model(used)
    wrong = []
    if not is_as_written(used.read_text(encoding="utf-8")):
        wrong.append(f"{used} has been changed")
    wrong += [f"{path} is gone or has been changed" for path in model.changed_files()]
    if wrong:
        return refuse(
            "\n".join(f"{text} since the run began" for text in wrong)
            + "\nput it back, or run the model again into another folder"
        )
    log = RunLog(words=model.words, verbose=arguments.verbose)
    return run_model(model, folder, log, resume=True)
