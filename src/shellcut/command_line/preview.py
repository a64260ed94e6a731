"""``preview``: draw a model before its run.

Draw film, supported nodes, tool and cutting edges of a model and check it, without running it. If
the model is refused, its valid parts are drawn.
"""

from __future__ import annotations

import sys
from pathlib import Path

from shellcut.files.file_list import target
from shellcut.model_file import Model, ModelFileError, read_model
from shellcut.model_file.spelling import in_keys
from shellcut.models.preview import preview, preview_parts
from shellcut.recording.run_log import RunLog

from .shared import (
    BAD_INPUT,
    DONE,
    Arguments,
    Parser,
    add_settings_to,
    keys_with_values,
    named,
    refuse,
)


def add_to(parser: Parser) -> None:
    """Add its arguments to the parser."""
    parser.add_argument("model", metavar="MODEL", help="a TOML file, or a name")
    parser.add_argument(
        "-o", "--out", metavar="PICTURE", type=named, help="output file [model.png]"
    )
    add_settings_to(parser)


def run(arguments: Arguments) -> int:
    """Build the model, draw it, print its contents."""
    model = None
    with RunLog(words=in_keys).library_said():
        try:
            model = read_model(arguments.model, keys_with_values("--set", arguments.settings))
            case = model.build()
        except ModelFileError as problem:
            return _draw_refused(model or problem.partial, arguments, problem)
        picture = _picture(arguments, model)
        report = preview(case.simulation, picture, time=case.duration, check=case.check)
        print(f"{model.words(report)}\nwrote {picture}")
        return BAD_INPUT if case.check.of("refuse") else DONE


def _picture(arguments: Arguments, model: Model) -> Path:
    """Return the file of the picture; a name without a suffix becomes a PNG."""
    named = arguments.out
    if named is not None and not named.suffix:
        named = named.with_name(f"{named.name}.png")
    return target(named, Path("model.png"), [arguments.model, *model.files()])


def _draw_refused(model: Model | None, arguments: Arguments, problem: ValueError) -> int:
    """Draw the valid parts of a model, print its errors; return the code for bad input."""
    parts = None if model is None else model.parts()
    if model and parts is not None and not (parts.mesh is None and parts.tool is None):
        try:
            path = _picture(arguments, model)
            print(f"{preview_parts(parts, path)}\nwrote {path}: the valid parts of the model")
        except (ValueError, ImportError, OSError) as other:
            print(f"it cannot be drawn: {other}", file=sys.stderr)
    return refuse(problem)
