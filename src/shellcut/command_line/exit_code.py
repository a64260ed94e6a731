"""What the command ends with."""

from __future__ import annotations

import sys

DONE, BAD_INPUT, STOPPED, INTERRUPTED = 0, 2, 3, 130
"""Done; bad arguments or model; a guard stopped the run; Ctrl-C, as shells count it."""


def refuse(problem: object) -> int:
    """Say on standard error what is wrong with the input; return the code for it."""
    print(problem, file=sys.stderr)
    return BAD_INPUT
