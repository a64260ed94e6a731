"""The parser with all subcommands, and the exit code of a command."""

from __future__ import annotations

import argparse
import os
import re
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, redirect_stdout, suppress
from io import TextIOWrapper
from typing import Any, NoReturn, TextIO, cast

from shellcut.files.distribution import VERSION, another_project
from shellcut.model_file import ModelFileError
from shellcut.signals import (
    INTERRUPTED,
    RaisedAgain,
    answer_deferred,
    ignore_ctrl_c,
    is_of_interrupt,
)
from shellcut.unit import showing

from . import (
    compare,
    converge,
    doctor,
    fit,
    keys,
    optimise,
    preview,
    report,
    resume,
    run,
    sweep,
    tensile,
    verify,
    view,
    warmup,
)
from .shared import DONE, add_shown_in_to, in_lines, refuse

_COMMANDS = (
    *(run, resume, verify, sweep, converge, fit, optimise, preview),
    *(keys, compare, tensile, report, view, doctor, warmup),
)
"""A file each, whose text is the help: in one line, at length, and an example."""
_RUNS = ("run", "resume")
_OPTION = re.compile(r"-{1,2}[A-Za-z]|$")
_SHOWING = ("run", "resume", "converge", "fit", "optimise", "preview", "compare", "report", "view")
"""Commands that show values in units of the user's choice."""


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        """End as argparse does, and name the option for a key without one."""
        words = message.split()
        keys = [word for word in words if "=" in word and not word.startswith("-")]
        if message.startswith("unrecognized arguments") and "--set" in words:
            message += "; only commands that run or draw a model set its keys"
        elif message.startswith("unrecognized arguments") and keys:
            message += f"; keys of the model are set by --set {' --set '.join(keys)}"
        super().error(message)

    def refuse_parted_settings(self, words: Sequence[str]) -> None:
        """End with how to write a setting that has a blank in the place of its sign."""
        for flag, key, *rest in (words[k : k + 4] for k in range(len(words) - 1)):
            if flag not in ("--set", "--confirm") or "=" in key or key.startswith("-"):
                continue
            value = next((word for word in rest if word != "="), "")
            if not _OPTION.match(value):
                self.error(f"{flag} {key}: must be KEY=VALUE, write {flag} {key}={value}")


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command with the given arguments, or with those of the process.

    Returns its exit code, one of :data:`.shared.MEANINGS`; argparse exits by itself, with the
    code for bad input.
    """
    arguments = argparse.Namespace()
    try:
        with RaisedAgain():
            answer_deferred()
            for name in ("stdout", "stderr"):
                stream = getattr(sys, name)
                if stream is None:  # it was closed before the process began
                    setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: SIM115
                elif isinstance(stream, TextIOWrapper):  # a file's name may hold bytes, no text
                    stream.reconfigure(errors="backslashreplace")
            if beside := another_project():
                return refuse(beside)
            parser = parser_of_all()
            parser.refuse_parted_settings(sys.argv[1:] if argv is None else argv)
            arguments = parser.parse_args(argv)
            return _done(arguments)
    except KeyboardInterrupt:
        ignore_ctrl_c()
        is_study = hasattr(arguments, "jobs")
        print("interrupted" + ("; to continue, call it again" if is_study else ""), file=sys.stderr)
        return INTERRUPTED
    finally:
        ignore_ctrl_c()


def _done(arguments: argparse.Namespace) -> int:
    """Run the command; return its exit code, that for bad input where it is wrong."""
    try:
        with ignore_closed_pipe(), showing(getattr(arguments, "shown_in", "")):
            return int(arguments.run(arguments) or DONE)
    except Exception as problem:
        if is_of_interrupt(problem):
            raise KeyboardInterrupt from problem
        if isinstance(problem, MemoryError):
            return refuse(
                f"this machine does not have enough memory: {problem}; use a coarser mesh"
            )
        # What a run raises after its checks is no fault of what it was given.
        of_input: tuple[type[Exception], ...] = OSError, ModelFileError
        if arguments.command not in _RUNS:
            of_input += (ValueError, IndexError, ImportError)
        if not isinstance(problem, of_input):
            raise
        return refuse(problem)


def parser_of_all() -> _Parser:
    """Return the parser with all subcommands."""
    parser = _Parser(
        prog="shellcut",
        description="Explicit dynamics of thin shells cut by a sharp rigid blade.",
        epilog=in_lines(),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="version", version=f"%(prog)s {VERSION}")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for command in _COMMANDS:
        said, *more = [" ".join(part.split()) for part in str(command.__doc__).split("\n\n")]
        _, _, name = command.__name__.rpartition(".")
        texts: dict[str, Any] = dict(zip(("description", "epilog"), more, strict=False))
        of = commands.add_parser(name, help=said.partition(": ")[2].removesuffix("."), **texts)
        command.add_to(of)
        of.set_defaults(run=command.run)
        if name in _SHOWING:
            add_shown_in_to(of)
    return parser


@contextmanager
def ignore_closed_pipe() -> Iterator[None]:
    """Drop printed text once the pipe behind standard output is closed.

    ``shellcut compare ... | head -1`` closes it after the first line; the files are still written.
    """
    output = _Output(sys.stdout)
    with redirect_stdout(cast("TextIO", output)):
        try:
            yield
        finally:
            output.flush()


class _Output:
    """A stream that drops its text once its pipe is closed."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream

    def write(self, text: str) -> int:
        self._tried(self._stream.write, text)
        return len(text)

    def flush(self) -> None:
        self._tried(self._stream.flush)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    def _tried(self, do: Callable[..., object], *what: str) -> None:
        try:
            do(*what)
        except BrokenPipeError:
            # Redirect the file descriptor: the stream still flushes its own lines at exit.
            with suppress(OSError):
                nothing = os.open(os.devnull, os.O_WRONLY)
                os.dup2(nothing, self._stream.fileno())
                os.close(nothing)
