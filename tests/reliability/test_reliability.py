"""A few trials of each kind: of the proof that `python tests/reliability/run.py` makes."""

import os
import tempfile
from itertools import islice
from pathlib import Path

import pytest

from reliability import bits, faults, fuzz, guards, invariants, kills, supply, table, tiny

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")


@pytest.fixture(scope="module", autouse=True)
def _kernels():
    tiny.warm(["guillotine"])


def first(kind, *rows, n=1):
    """Return the first trials of some rows of a kind, of all by default."""
    found = {row: [] for row in rows or kind.ROWS}
    for trial in islice(kind.trials(), 200):
        if len(found.get(trial.row, [None] * n)) < n:
            found[trial.row].append(trial)
    return [trial for trials in found.values() for trial in trials]


SAMPLES = [
    *islice(kills.trials(), 12, 14),
    *first(faults, *list(faults.ROWS)[:-1]),
    *first(fuzz, n=5),
    *first(invariants, *invariants.CHANGED),
    *first(bits, "threads", "output", "verify"),
    *first(guards, *list(guards.ROWS)[:-1]),
    *first(supply, "licences", "network"),
]


@pytest.mark.parametrize("trial", SAMPLES, ids=lambda trial: f"{trial.row}, {trial.what}")
def test_a_promise_is_kept(trial):
    with tempfile.TemporaryDirectory() as folder:  # which another user may enter
        trial.do(Path(folder))


def test_what_is_lost_is_found(tmp_path):
    """Trials can fail: of a run with a changed row, of a damage that is not noticed."""
    out = tiny.whole("run")
    part = tmp_path / "out"
    part.mkdir()
    for path in out.iterdir():
        (part / path.name).write_bytes(path.read_bytes())
    tiny.assert_same(part, "run")
    faults.a_row_changed(part / "history.csv")
    with pytest.raises(AssertionError):
        tiny.assert_same(part, "run")
    sim, sound = fuzz._strip_at_work()
    with pytest.raises(AssertionError, match="it was loaded"):
        fuzz.damaged_checkpoint(sim, sound, tmp_path / "c.h5")


def test_a_page_names_every_promise_and_what_failed():
    row = {"tried": 2, "kept": 1, "failed": 1, "failures": ["trial 7: lost"], "not_possible": []}
    record = {"kills": {"rows": {"run, killed": row}, "seconds": 60.0, "date": "2026-11-29"}}
    assert "not tried" in table.of(record, {"kills": kills})
    assert "| 2 | 1 | 1 | 2026-11-29 |" in table.of(record, {"kills": kills})
    assert "| kills | 2 | 300 | 1 | 1 | 1.0 |" in table.totals(record, {"kills": kills})
    assert table.listed(record, "failures", "") == "- `trial 7: lost`"
