"""The fast verification cases, one test each; all of them by ``run.py``.

docs/verification/ shows their values, which must be the present ones.
"""

import json

import pytest

from harness import as_json, load_cases, run_case
from page_tables import ROOT, cells, tables

SIBLINGS = {"B09": "B03", "C03": "C01", "C04": "C05", "C13": "C15", "D04": "D07"}
"""Cases of some seconds, each with a quick one of the same kind that is in the default tests."""
CASES = [
    pytest.param(case, id=case.ID, marks=[pytest.mark.slow] if case.ID in SIBLINGS else [])
    for case in load_cases(fast_only=True)
]


@pytest.mark.parametrize("case", CASES)
def test_case(case):
    result = run_case(case)
    assert result.checks
    assert json.loads(as_json([result]))[0]["passed"] == result.passed
    failed = [
        f"{c.quantity}: {c.ours:.6g} instead of {c.reference:.6g}, error {c.error:+.3g}, "
        f"band {c.band:.3g} ({c.reason})"
        for c in result.checks
        if c.gate and not c.passed
    ]
    assert not failed, failed
    told = on_the_page(result)
    assert [one[0] for one in told] == [check.quantity for check in result.checks]
    for check, (_, reference, ours, *_) in zip(result.checks, told, strict=True):
        assert reference == f"{check.reference:.6g}"
        if check.reference == 0.0:
            continue  # what is left is round-off, another on each processor; its gate bounds it
        unit = 1.0 if check.absolute else abs(check.reference)
        # By round-off and chance; a tenth of what is allowed is no other result. Six digits shown.
        close = 0.1 * check.band * unit + 5e-6 * abs(check.ours)
        assert abs(float(ours) - check.ours) <= close, check.quantity


def on_the_page(result):
    """Return the rows of a case in its page of docs/verification/, as cells."""
    pages = sorted((ROOT / "docs" / "verification").glob("*.md"))
    texts = (page.read_text(encoding="utf-8") for page in pages)
    (text,) = (text for text in texts if f"\n## {result.id} " in text)
    section = text.split(f"\n## {result.id} ")[1].partition("\n## ")[0]
    ((_, rows),) = tables(section)
    return [cells(row) for row in rows[2:]]
