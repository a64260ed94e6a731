"""Exit codes of the command."""

from __future__ import annotations

import sys
import textwrap

from shellcut.model_file.spelling import in_keys
from shellcut.signals import INTERRUPTED

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
