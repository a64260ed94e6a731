"""``run``: run a model.

Run a model file, or a model of the package by its name.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from shellcut.recording.run_log import RunLog

from .exit_code import DONE, refuse
from .run_model import run_model
from .shared_arguments import add_settings_to, named, settings_of


def add_to(parser: argparse.ArgumentParser) -> None:
    """Add its arguments to the parser."""
    parser.add_argument("model", metavar="MODEL", nargs="?", help="a TOML file, or a name")
    parser.add_argument("-o", "--out", metavar="OUT", type=named, help="folder for the results")
    add_settings_to(parser)
    parser.add_argument("--frames", metavar="N", type=int, help="frames of the result file")
    parser.add_argument(
        "--no-pictures", action="store_true", help="no pictures of the film during the run"
    )
    parser.add_argument(
        "--overwrite",
        action="store_true",
        help="replace the run in the folder: only files written by that run are removed",
    )
    parser.add_argument(
        "--force",
        action="store_true",
        help="run a model that a check refuses, where that can make sense",
    )
    parser.add_argument("--list", action="store_true", help="list the models of the package")
    parser.add_argument(
        "--write-model", metavar="FILE", type=named, help="write a model file to edit; run nothing"
    )


def run(arguments: argparse.Namespace) -> int:
    """Read, check, run."""
    from shellcut.files.file_list import files_there, refuse_input
    from shellcut.files.folder_lock import refuse_if_in_use
    from shellcut.model_file import ModelFileError, read_model, shipped_models

    if arguments.list:
        for name, text in shipped_models().items():
            print(f"{name:<12} {text.splitlines()[1].lstrip('# ')}")
        return DONE
    if arguments.model is None:
        return refuse("give a MODEL: a file, or one of " + ", ".join(shipped_models()))
    if arguments.write_model is not None:
        return _write_model(arguments.model, arguments.write_model)
    if arguments.out is None:
        return refuse("give a folder for the results: -o OUT")
    try:
        settings = settings_of(arguments)
        if arguments.frames is not None:
            settings["output.frames"] = arguments.frames
        if arguments.no_pictures:
            settings["output.snapshots"] = 0
        model = read_model(arguments.model, settings)
    except ModelFileError as problem:
        return refuse(problem)
    folder: Path = arguments.out
    if folder.exists() and not folder.is_dir():
        return refuse(f"{folder} is a file: -o must name a folder")
    earlier = files_there(folder)
    try:
        refuse_if_in_use(folder)
        if arguments.overwrite:
            for name in earlier:
                refuse_input(folder / name, [arguments.model, *model.files()])
    except OSError as problem:
        return refuse(problem)
    if earlier and not arguments.overwrite:
        return refuse(
            f"{folder} holds a run ({earlier[0]}): --overwrite replaces it, "
            f"shellcut resume {folder} continues it"
        )
    return run_model(model, folder, RunLog(), overwrite=arguments.overwrite, force=arguments.force)


def _write_model(name: str, path: Path) -> int:
    from shellcut.files.whole_file import exclusive
    from shellcut.model_file import shipped_models

    shipped = shipped_models()
    if name not in shipped:
        return refuse(f"{name}: the models that can be written are {', '.join(shipped)}")
    try:
        with open(path, "wb", opener=exclusive) as file:
            file.write(shipped[name].encode())
    except FileExistsError:
        return refuse(f"{path} already exists: choose another name")
    except OSError as problem:
        return refuse(problem)
    print(f"wrote {path}; run it with: shellcut run {path} -o OUT")
    print("so that editors check its keys: shellcut keys --schema > shellcut.schema.json")
    return DONE
