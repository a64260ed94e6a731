"""What the command ends with."""

from __future__ import annotations

import sys
import textwrap

DONE, BUG, BAD_INPUT, STOPPED, FAILED, INTERRUPTED = 0, 1, 2, 3, 4, 130

MEANINGS = {
    DONE: "done",
    BUG: "an error of shellcut itself, with a traceback; please report it",
    BAD_INPUT: "nothing was run: a wrong argument, model, file or folder, or a folder that another "
    "run writes in. All that is wrong is told at once, on standard error",
    STOPPED: "a guard stopped the run, because its numbers were no longer right; what was there is "
    "saved",
    FAILED: "the run failed on the way: disk full, folder gone, an error in a hook. What was there "
    "is saved as far as possible; remove the cause, as by freeing space, then `shellcut resume`",
    INTERRUPTED: "interrupted by Ctrl-C; `shellcut resume` goes on. After SIGTERM, which does the "
    "same, a shell counts 143",
}
"""What each exit code means."""


def in_lines() -> str:
    """Return all codes with their meanings, for a terminal."""
    lines = ["exit codes:"]
    for code, meaning in MEANINGS.items():
        lines += textwrap.wrap(
            meaning, 79, initial_indent=f"  {code:>3}  ", subsequent_indent=" " * 7
        )
    return "\n".join(lines)


def refuse(problem: object) -> int:
    """Say on standard error what is wrong with the input; return the code for it."""
    print(problem, file=sys.stderr)
    return BAD_INPUT
