"""``verify``: run a model again and compare it with its results.

Run the model stored in the folder of a finished run again, in a temporary folder, and compare
digest, history.csv and splits.csv, byte for byte. Print "the same", or the first difference (exit
code 4). The folder is only read. The second run takes as long as the first one.

example: shellcut verify out
"""

from __future__ import annotations

import re
import tempfile
from contextlib import closing
from itertools import zip_longest
from pathlib import Path

from shellcut.files.distribution import VERSION
from shellcut.files.regular_file import read_regular
from shellcut.files.run_folder import HISTORY, SPLITS, USED
from shellcut.model_file import Model
from shellcut.recording.run_log import RunLog
from shellcut.results.run_results import summary_in
from shellcut.simulation.instability import UnstableStep
from shellcut.study.one_run import outcome_in

from .run_model import built, stored_model
from .shared import DONE, FAILED, Arguments, Parser, named

_SHOWN = 60  # characters of a cell that are quoted
_WRITTEN_BY = re.compile(r"^# shellcut (\S+), model ", re.M)


def add_to(parser: Parser) -> None:
    """Add its arguments to the parser."""
    parser.add_argument("out", metavar="OUT", type=named, help="the folder of the run")


def run(arguments: Arguments) -> int:
    """Run the stored model again, compare, and say the first difference."""
    folder: Path = arguments.out
    model = stored_model(folder)
    digest = _digest_of(folder)
    kept = {name: read_regular(folder / name) for name in (HISTORY, SPLITS)}
    print(f"running the model in {folder} again ...", flush=True)
    with tempfile.TemporaryDirectory(prefix="shellcut-verify-") as temporary:
        try:
            again = _digest_of_new_run(model, Path(temporary))
            new = {name: read_regular(Path(temporary) / name) for name in kept}
            found = [_first_difference(name, kept[name], new[name]) for name in kept]
            if digest != again:
                found.append(f"digest: {digest} before, {again} in the new run")
        except UnstableStep as stop:
            found = [f"{folder} has a whole run, but the new run stopped: {stop}"]
    if any(found):
        print("different: " + "\n".join(text for text in found if text))
        print(
            "another processor, or other versions of NumPy, Numba or the C library, "
            "can be the cause: see docs/same-bits.md"
        )
        return FAILED
    print(f"the same: {HISTORY}, {SPLITS} and digest {digest}")
    return DONE


def _digest_of(folder: Path) -> str:
    """Return the digest of a run; ValueError if another version wrote it, or it has not ended."""
    written_by = _WRITTEN_BY.search(read_regular(folder / USED).decode())
    version = written_by[1] if written_by else "unknown"
    if version != VERSION:
        raise ValueError(
            f"{folder} must be verified with the version of shellcut that wrote it, {version}; "
            f"this is {VERSION}"
        )
    if (outcome := outcome_in(folder)) is None:
        raise ValueError(
            f"{folder} must have a run that has ended; shellcut resume {folder} continues it"
        )
    return str(outcome.figures.get("digest", "none"))


def _digest_of_new_run(model: Model, folder: Path) -> str:
    """Run a model to its end into a folder, without pictures; return the digest."""
    log = RunLog(shown=False, words=model.words)
    with log.library_said(), closing(log):
        case, _ = built(model, log, {"resume": False, "force": True})  # it has run before
        options = {"n_frame": 1, "n_snapshot": 0, "curves": False, "checkpoint_every": None}
        case.go(case.recorder(folder, **{**model.run_options(), **options}, force=True))
    return str(summary_in(folder).get("digest", "none"))


def _first_difference(name: str, before: bytes, after: bytes) -> str:
    """Return the first difference between the tables of two runs; empty if they are the same."""
    tables = [content.decode("latin-1").split("\n") for content in (before, after)]
    headings = tables[1][0].rstrip("\r").split(",")
    for line, rows in enumerate(zip_longest(*tables), start=1):
        if rows[0] == rows[1]:
            continue
        cells = [[] if row is None else row.split(",") for row in rows]
        for heading, was, now in zip_longest(headings, *cells, fillvalue=""):
            if was != now:
                values = f"{_shown(was)} before, {_shown(now)} in the new run"
                return f"{name}, line {line}, {heading}: {values}"
    return ""


def _shown(cell: str) -> str:
    """Return a cell as a message quotes it; ends of lines are visible."""
    return cell.encode("unicode_escape").decode()[:_SHOWN] or "nothing"
