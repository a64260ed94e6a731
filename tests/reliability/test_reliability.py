"""A few trials of each kind: of the proof that `python tests/reliability/run.py` makes."""

import os
import tempfile
from pathlib import Path

import pytest

from reliability import bits, faults, fuzz, guards, invariants, kills, supply, table, tiny
from reliability.trial import Impossible

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")


@pytest.fixture(scope="module", autouse=True)
def _kernels():
    tiny.warm(["guillotine"])


def of(module, *rows):
    """Return the numbers of the first trials of some rows."""
    numbers = range(60 if module.COUNT is None else module.COUNT)
    found = {module.trial(number).row: number for number in reversed(numbers)}
    return [found[row] for row in rows or module.ROWS if row in found]


SAMPLES = [(kills, number) for number in (12, 13)]
SAMPLES += [(faults, number) for number in of(faults, *list(faults.ROWS)[:-1])]
SAMPLES += [(fuzz, number) for number in of(fuzz)]
SAMPLES += [(invariants, number) for number in of(invariants)]
SAMPLES += [(bits, number) for number in of(bits, "threads", "output", "verify")]
SAMPLES += [(guards, number) for number in of(guards, *list(guards.ROWS)[:-1])]
SAMPLES += [(supply, number) for number in of(supply, "licences", "network")]


@pytest.mark.parametrize(
    ("module", "number"), SAMPLES, ids=lambda value: getattr(value, "__name__", value)
)
def test_a_promise_is_kept(module, number, monkeypatch):
    monkeypatch.setattr(fuzz, "BATCH", {"command lines": 1})
    monkeypatch.setattr(fuzz, "MANY", 3)
    try:
        with tempfile.TemporaryDirectory() as folder:  # which another user may enter
            batch = module.trial(number).do(Path(folder))
    except Impossible as reason:
        pytest.skip(str(reason))
    assert batch is None or batch.failures == []


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
