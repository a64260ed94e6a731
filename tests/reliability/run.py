"""Try every promise for some minutes; print the table, and write docs/reliability.md.

``python tests/reliability/run.py --minutes 90 --json r.json`` tries all kinds, each in two
processes, or ``--jobs``, that share its trials. With ``--json`` the rows of kinds that were not
tried are taken from that file. ``--only kills fuzz`` tries some kinds, and writes the page if there
is such a file. ``--only kills --trial 37`` makes one trial again, as a failure names it.
"""

import argparse
import json
import os
import shutil
import sys
import tempfile
import time
import traceback
from concurrent.futures import ProcessPoolExecutor
from itertools import islice
from multiprocessing import get_context
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from reliability import (
    bits,
    faults,
    fuzz,
    guards,
    invariants,
    kills,
    mutation,
    supply,
    table,
    tiny,
)

# Those with an end first: the time that they leave is for the others.
KINDS = {
    "guards": guards,
    "supply": supply,
    "faults": faults,
    "bits": bits,
    "invariants": invariants,
    "fuzz": fuzz,
    "kills": kills,
    "mutants": mutation,
}
MOST = {kind: table.WANTED[kind] for kind in ("fuzz", "kills")}  # of those without an end
MOST_SURVIVORS = 0.1  # of the mutants
MOST_SHOWN = 20  # failures of a row whose texts are kept


def empty_row():
    """Return a row before its first trial."""
    return {"tried": 0, "kept": 0, "failures": [], "not_possible": []}


def made(kind, number, trial, rows):
    """Make one trial and count it in its row."""
    row = rows.setdefault(trial.row, empty_row())
    folder = Path(tempfile.mkdtemp(prefix=f"shellcut-{kind}-"))
    try:
        trial.do(folder)
        row["kept"] += 1
    except pytest.skip.Exception as reason:
        row["not_possible"].append(f"{trial.what}: {reason}")
        return
    except Exception as problem:
        failure = "".join(traceback.format_exception_only(problem)).strip()[-1500:]
        row["failures"].append(f"--only {kind} --trial {number}: {trial.what}: {failure}")
        print(f"FAILED {row['failures'][-1]}", flush=True)
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    row["tried"] += 1


def tried(kind, seconds, process=0, jobs=1):
    """Make one process's share of the trials of a kind until the time is up; return its rows."""
    rows, end = {}, time.monotonic() + seconds
    mutation.PROCESS = process
    for number, trial in islice(enumerate(KINDS[kind].trials()), process, MOST.get(kind), jobs):
        made(kind, number, trial, rows)
        if time.monotonic() > end:
            break
    return rows


def together(parts):
    """Return the rows of several processes as one, in the order of the kind's own rows."""
    rows = {}
    for part in parts:
        for name, found in part.items():
            row = rows.setdefault(name, empty_row())
            for key, value in found.items():
                row[key] += value
    for row in rows.values():
        row["failed"] = len(row["failures"])
        row["failures"] = row["failures"][:MOST_SHOWN]
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--minutes", type=float, default=90.0)
    parser.add_argument("--json", type=Path, help="rows of all kinds, renewed")
    parser.add_argument("--only", nargs="+", choices=KINDS, default=[*KINDS], metavar="KIND")
    parser.add_argument("--jobs", type=int, default=2, help="processes")
    parser.add_argument("--trial", type=int, help="make this one trial of the kinds")
    given = parser.parse_args()
    end = time.monotonic() + 60.0 * given.minutes
    tiny.warm()
    if given.trial is not None:
        for kind in given.only:
            rows = {}
            trial = next(islice(KINDS[kind].trials(), given.trial, None))
            made(kind, given.trial, trial, rows)
            print(json.dumps(rows, indent=1))
        return
    record = json.loads(given.json.read_text()) if given.json and given.json.exists() else {}
    rest = list(given.only)
    with ProcessPoolExecutor(given.jobs, get_context("fork"), tiny.apart) as pool:
        while rest:
            kind = rest.pop(0)
            left, share = end - time.monotonic(), KINDS[kind].SHARE
            seconds = left * share / (share + sum(KINDS[other].SHARE for other in rest))
            began = time.monotonic()
            asked = ([one] * given.jobs for one in (kind, seconds))
            parts = pool.map(tried, *asked, range(given.jobs), [given.jobs] * given.jobs)
            rows = together(parts)
            record[kind] = {"rows": rows, "seconds": time.monotonic() - began, **table.stamp()}
            n = [sum(row[name] for row in rows.values()) for name in ("tried", "kept", "failed")]
            print(f"{kind}: {n[0]} tried, {n[1]} kept, {n[2]} failed", flush=True)
            if given.json:
                given.json.write_text(json.dumps(record, indent=1))
    print(table.of(record, KINDS))
    if given.json or len(given.only) == len(KINDS):
        table.write_page(record, KINDS)
        print(f"wrote {table.PAGE}")
    sys.exit(not all(enough(kind, found["rows"].values()) for kind, found in record.items()))


def enough(kind, rows):
    """Return whether a kind is as promised: without a failure, of mutants without every tenth."""
    tried, _, failed = table.sums(rows)
    return failed <= (MOST_SURVIVORS * tried if kind == "mutants" else 0)


if __name__ == "__main__":
    main()
