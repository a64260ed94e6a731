"""Small faults in the mechanics are found by the tests: tests/mutants.py, a mutant a trial.

A mutant that was killed stays killed as long as no source changes, so the record spares it.
"""

import functools
import json

import mutants
from shellcut.numerics.source_digest import source_digest

from .trial import Trial

SHARE = 3
COUNT = 300
SEED = 54
RECORD = mutants.ROOT / "build/mutants.jsonl"
PROCESS = 0
"""Which of several processes this is: each has a copy of the tree."""
ROWS = {"mutants": ("a test fails where a line of the method is broken", "`tests/mutants.py`")}


@functools.cache
def copy():
    return mutants.Copy(mutants.ROOT / f"build/mutants-{PROCESS}")


def trials():
    for mutant in mutants.draw(COUNT, SEED)[0]:
        what = {"sources": source_digest(), **mutants.described(*mutant)}
        text = ", ".join(f"{name} {what[name]!r}" for name in mutants.ID)
        yield Trial("mutants", text, functools.partial(_killed, mutant, what))


def _killed(mutant, what, folder):
    """Fail if no test of its package fails; keep it in the record."""
    lines = RECORD.read_text().splitlines() if RECORD.exists() else []
    if any(row["by"] and what.items() <= row.items() for row in map(json.loads, lines)):
        return
    by = copy().run(mutants.tests_for(mutant[0]), *mutant)
    RECORD.parent.mkdir(exist_ok=True)
    with RECORD.open("a") as file:
        file.write(json.dumps({**what, "by": by}) + "\n")
    assert by, "it survived"
