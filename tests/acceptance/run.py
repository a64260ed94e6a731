"""Acceptance: the first fifteen minutes of a user, in a fresh environment without a display.

    python tests/acceptance/run.py                   # four to six minutes; 1 GB on disk
    python tests/acceptance/run.py --only 7 8        # some rows, with what they need
    python tests/acceptance/run.py --keep DIR        # leave everything in DIR to be looked at

Needs Python and an index of packages, nothing else: it builds the wheel, installs it with the extra
``plot`` into a virtual environment of its own, and goes through what a user does, row by row, each
against its limits. Ends with 1 if a row fails.

What ``DIR/commands.log`` holds: every command, what it said, its exit code and its time.
"""

import argparse
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

from rows import ROWS
from user import User


def main():
    """Go through the rows and print the table."""
    arguments = _arguments()
    start = time.perf_counter()
    with tempfile.TemporaryDirectory(prefix="shellcut-acceptance-") as scratch:
        folder = arguments.keep.resolve() if arguments.keep else Path(scratch)
        folder.mkdir(parents=True, exist_ok=True)
        if any(folder.iterdir()):
            print(f"--keep {folder} must be empty or not there yet", file=sys.stderr)
            return 2
        user = User(folder)
        outcomes = {}
        for number, row in enumerate(ROWS, 1):
            if arguments.only and number not in arguments.only:
                continue
            print(f"{number:>2}  {row.what} ...", file=sys.stderr, flush=True)
            outcomes[number] = row.outcome(user)
            if outcomes[number].reason:
                print(outcomes[number].reason, file=sys.stderr, flush=True)
    print(_table(outcomes))
    n_failed = sum(outcome.verdict == "FAILED" for outcome in outcomes.values())
    print(
        f"\n{len(outcomes) - n_failed} passed, {n_failed} failed, "
        f"in {time.perf_counter() - start:.0f} s"
    )
    return 1 if n_failed else 0


def _arguments():
    parser = argparse.ArgumentParser(description="The first fifteen minutes of a user, checked.")
    parser.add_argument("--keep", metavar="DIR", type=Path, help="leave everything there")
    parser.add_argument("--only", metavar="N", type=int, nargs="+", help="numbers of rows")
    arguments = parser.parse_args()
    for number in arguments.only or ():
        if not 1 <= number <= len(ROWS):
            parser.error(f"--only: rows are 1 to {len(ROWS)}, got {number}")
    return arguments


def _table(outcomes):
    lines = ["| row | minute | what | limit | measured | verdict |", "|---|---|---|---|---|---|"]
    for number, outcome in outcomes.items():
        row = ROWS[number - 1]
        limits = "; ".join(filter(None, [f"{row.seconds:g} s" if row.seconds else "", row.limit]))
        cells = (str(number), row.minute, row.what, limits, outcome.measured, outcome.verdict)
        lines.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    return "\n".join(lines)


if __name__ == "__main__":
    sys.exit(main())
