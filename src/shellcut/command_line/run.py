"""``run``: run a model.

Run a model file, or a model of the package by its name.
"""

from __future__ import annotations

from pathlib import Path

from shellcut.files.file_list import FileList, refuse_input
from shellcut.files.folder_lock import refuse_if_in_use
from shellcut.files.whole_file import exclusive
from shellcut.model_file import Model, read_model, shipped_models
from shellcut.model_file.model import model_text
from shellcut.recording.run_log import RunLog

from .run_model import run_model
from .shared import (
    DONE,
    Arguments,
    Parser,
    add_settings_to,
    add_verbose_to,
    keys_with_values,
    named,
    refuse,
)


def add_to(parser: Parser) -> None:
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
        help="run a model although a check refuses it, where this can make sense",
    )
    add_verbose_to(parser)
    parser.add_argument("--list", action="store_true", help="list the models of the package")
    parser.add_argument(
        "--write-model",
        metavar="FILE",
        type=named,
        help="write a model file to edit, with --set a file that lists every key; run nothing",
    )


def run(arguments: Arguments) -> int:
    """Read, check, run."""
    if arguments.list:
        for name, text in shipped_models().items():
            print(f"{name:<12} {text.splitlines()[1].lstrip('# ')}")
        return DONE
    if arguments.model is None:
        return refuse("give a MODEL: a file, or one of " + ", ".join(shipped_models()))
    try:
        model = _read(arguments)
        problems = []
    except ValueError as problem:
        model, problems = None, [str(problem)]
    if arguments.write_model is not None:
        return _write_model(arguments, model) if model else refuse(problems[0])
    problems += _wrong_with_folder(arguments, model)
    if problems or model is None:
        return refuse("\n".join(problems))
    options = {name: getattr(arguments, name) for name in ("overwrite", "force")}
    log = RunLog(words=model.words, verbose=arguments.verbose)
    return run_model(model, arguments.out, log, **options)


def _read(arguments: Arguments) -> Model:
    """Return the model with the keys that are set; a ModelFileError lists all problems."""
    settings = keys_with_values("--set", arguments.settings)
    if arguments.frames is not None:
        settings["output.frames"] = arguments.frames
    if arguments.no_pictures:
        settings["output.snapshots"] = 0
    return read_model(arguments.model, settings)


def _wrong_with_folder(arguments: Arguments, model: Model | None) -> list[str]:
    """Return why the run cannot have its folder; none if it can."""
    folder: Path | None = arguments.out
    if folder is None:
        return ["give a folder for the results: -o OUT"]
    if folder.exists() and not folder.is_dir():
        return [f"{folder} is a file: -o must name a folder"]
    earlier = FileList(folder).there()
    try:
        refuse_if_in_use(folder)
        if arguments.overwrite:
            for name in earlier:
                refuse_input(folder / name, [arguments.model, *(model.files() if model else ())])
    except OSError as problem:
        return [str(problem)]
    if not earlier or arguments.overwrite:
        return []
    return [
        f"{folder} holds a run ({earlier[0]}): --overwrite replaces it, "
        f"shellcut resume {folder} continues it"
    ]


def _write_model(arguments: Arguments, model: Model) -> int:
    """Write a model of the package as it is, or with every key where some are set."""
    path: Path = arguments.write_model
    is_set = arguments.settings or arguments.frames is not None or arguments.no_pictures
    shipped = {} if is_set else shipped_models()
    text = shipped.get(arguments.model) or model_text(model)
    try:
        with open(path, "wb", opener=exclusive) as file:
            file.write(text.encode())
    except FileExistsError:
        return refuse(f"{path} already exists: choose another name")
    print(f"wrote {path}; run it with: shellcut run {path} -o OUT")
    print("so that editors check its keys: shellcut keys --schema > shellcut.schema.json")
    return DONE
