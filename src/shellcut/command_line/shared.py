"""What several commands share: exit codes, refusals, arguments."""

from __future__ import annotations

import argparse
import contextlib
import sys
import textwrap
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, TypeAlias, TypeVar, get_args, get_origin

from shellcut.arguments import declared
from shellcut.files.distribution import optional
from shellcut.model_file.source import ModelFileError, Problem, parse_value
from shellcut.model_file.spelling import in_keys
from shellcut.numerics.threads import available_cores
from shellcut.signals import INTERRUPTED
from shellcut.unit import showing

T = TypeVar("T")
Parser: TypeAlias = argparse.ArgumentParser
Arguments: TypeAlias = argparse.Namespace

# --- exit codes -----------------------------------------------------------------------------------

DONE, BUG, BAD_INPUT, STOPPED, FAILED = 0, 1, 2, 3, 4

MEANINGS = {
    DONE: "done",
    BUG: "an error of shellcut itself, with a traceback; please report it",
    BAD_INPUT: "nothing was run: an argument, model, file or folder is wrong, or another run uses "
    "the folder. Standard error says `refused:` with the reason; for a model it lists everything "
    "that is wrong",
    STOPPED: "a guard stopped the run because its numbers were no longer right; the output so far "
    "is saved",
    FAILED: "the run failed: disk full, folder gone, an error in a hook. The output is "
    "saved as far as possible; remove the cause (such as a full disk), then `shellcut resume`. Or "
    "runs of a study failed, no run of a search keeps its limits, or `verify` found a difference",
    INTERRUPTED: "interrupted by Ctrl-C; `shellcut resume` continues. After SIGTERM the same "
    "happens, but a shell reports 143",
}
"""Meaning of each exit code."""


def in_lines() -> str:
    """Return all codes with their meanings, formatted for a terminal."""
    lines = ["exit codes:"]
    for code, meaning in MEANINGS.items():
        lines += textwrap.wrap(
            meaning, 79, initial_indent=f"  {code:>3}  ", subsequent_indent=" " * 7
        )
    return "\n".join(lines)


def refused(problem: object) -> str:
    """Return the message on wrong input: a line, or one for each of its problems."""
    text = str(problem)
    if isinstance(problem, OSError) and problem.filename and problem.strerror:
        text = f"{problem.filename}: {problem.strerror}"
    text = in_keys(text)
    return f"refused:\n{text}" if "\n" in text else f"refused: {text}"


def refuse(problem: object) -> int:
    """Print the problem with the input on standard error; return its exit code."""
    print(refused(problem), file=sys.stderr)
    return BAD_INPUT


# --- arguments ------------------------------------------------------------------------------------


def named(text: str) -> Path:
    """Return the path of an argument, for ``type=named``; an empty one is no name."""
    if not text:
        raise argparse.ArgumentTypeError("must have a name, got an empty one")
    return Path(text)


def add_settings_to(parser: Parser, more: str = "") -> None:
    """Add ``--set``, and say what more it can do than set a key."""
    parser.add_argument(
        "--set",
        metavar="KEY=VALUE",
        action="append",
        default=[],
        dest="settings",
        help=f"replace a key, e.g. membrane.mesh=quick or mesh=quick{more}; any number of times",
    )


def keys_with_values(
    flag: str, texts: Sequence[str], read: Callable[[str], object] = parse_value
) -> dict[str, object]:
    """Return the keys of an option, with their values read, by default as TOML.

    Bare words are strings. ModelFileError lists texts that are not of the form key=value.
    """
    split = [text.partition("=") for text in texts]
    wrong = [
        Problem(f"{flag} {text}", "must be KEY=VALUE")
        for text, (key, equals, _) in zip(texts, split, strict=True)
        if not equals or not key.strip()
    ]
    if wrong:
        raise ModelFileError(wrong)
    return {key.strip(): read(value.strip()) for key, _, value in split}


def add_verbose_to(parser: Parser) -> None:
    """Add ``--verbose``."""
    parser.add_argument(
        "--verbose", action="store_true", help="list the checks that passed, too, at the end"
    )


def add_options(parser: Parser, owner: Callable[..., Any], **flags: str) -> None:
    """Add arguments of a class, by the names of its parameters: type, choices, default, help."""
    for name, flag in flags.items():
        kind, option, default = declared(owner)[name]
        is_list = get_origin(kind) is Sequence
        kind = get_args(kind)[0] if is_list else kind
        first = (get_args(kind) or (kind,))[0]
        given: dict[str, Any] = {"dest": f"{owner.__name__}.{name}", "default": None}
        unless = "" if default in (None, False, ()) else f" [{default}]"
        if kind is bool:
            given["action"] = "store_true"
        elif isinstance(first, str):
            given |= {"choices": get_args(kind), "metavar": f"{{{','.join(get_args(kind))}}}"}
        else:
            given |= {"type": first, "metavar": "NAME" if first is str else "N"}
        if is_list:
            given["action"] = "append"
        parser.add_argument(flag, help=f"{option.text}{unless}", **given)


def made_of(arguments: Arguments, owner: Callable[..., T]) -> T:
    """Return the class called with the arguments that are given."""
    own = f"{owner.__name__}."
    given = {n.removeprefix(own): v for n, v in vars(arguments).items() if n.startswith(own)}
    return owner(**{name: v for name, v in given.items() if v is not None})


def add_shown_in_to(parser: Parser) -> None:
    """Add ``--shown-in``."""
    parser.add_argument(
        "--shown-in",
        metavar="UNITS",
        type=_units,
        default="",
        help='show values, curves and pictures in these units, as "in, lbf"; sentences, written '
        "files and the keys of a model stay in mm, N and s",
    )


def _units(text: str) -> str:
    try:
        with showing(text):
            return text
    except ValueError as problem:
        raise argparse.ArgumentTypeError(str(problem)) from None


def add_engine_to(parser: Parser) -> None:
    """Add ``--jobs`` and ``--dask``."""
    engine = parser.add_mutually_exclusive_group()
    engine.add_argument("--jobs", metavar="N", type=int, help="processes, by default one per core")
    engine.add_argument(
        "--dask",
        metavar="ADDRESS",
        help="a Dask scheduler such as tcp://host:8786, whose workers see OUT; or local",
    )


def print_found(
    arguments: Arguments,
    find: Callable[[Any], T],
    where: str,
    is_found: Callable[[T], bool] = lambda _: True,
) -> int:
    """Print what runs on the engine given find, and where it is; return the exit code."""
    try:
        with engine_given(arguments) as executor:
            found = find(executor)
        print(found)
    except RuntimeError as problem:
        print(in_keys(f"failed: {problem}"), file=sys.stderr)
        return FAILED
    print(where)
    return DONE if is_found(found) else FAILED


@contextlib.contextmanager
def engine_given(arguments: Arguments) -> Iterator[Any]:
    """Give the number of processes, or a Dask client, with a cluster of its own if asked for.

    ImportError or ConnectionError if there is no Dask, or no scheduler.
    """
    if arguments.dask is None:
        yield arguments.jobs
        return
    dask = optional("distributed", "--dask needs Dask", "sweep")
    with contextlib.ExitStack() as close:
        where: Any = arguments.dask
        if where == "local":
            size = {"n_workers": available_cores(), "threads_per_worker": 1}
            where = close.enter_context(dask.LocalCluster(**size, dashboard_address=None))
        try:
            client = close.enter_context(dask.Client(where, timeout=10.0))
        except (OSError, TimeoutError, ValueError) as problem:
            said = f"{type(problem).__name__}: {problem}"
            raise ConnectionError(f"there is no Dask scheduler at {where}: {said}") from None
        yield client
