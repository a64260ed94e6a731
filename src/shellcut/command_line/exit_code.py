"""Exit codes of the command."""

from __future__ import annotations

import sys
import textwrap

DONE, BUG, BAD_INPUT, STOPPED, FAILED, INTERRUPTED = 0, 1, 2, 3, 4, 130

MEANINGS = {
    DONE: "done",
    BUG: "an error of shellcut itself, with a traceback; please report it",
    BAD_INPUT: "nothing was run: an argument, model, file or folder is wrong, or another run uses "
    "the folder. Standard error lists everything wrong at once",
    STOPPED: "a guard stopped the run because its numbers were no longer right; the output so far "
    "is saved",
    FAILED: "the run failed: disk full, folder gone, an error in a hook. The output is "
    "saved as far as possible; remove the cause (such as a full disk), then `shellcut resume`",
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


def refuse(problem: object) -> int:
    """Print the problem with the input on standard error; return its exit code."""
    print(problem, file=sys.stderr)
    return BAD_INPUT
