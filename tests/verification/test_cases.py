"""The fast verification cases, one test each; all of them by ``run.py``."""

import json

import pytest

from harness import as_json, load_cases, run_case

SIBLINGS = {"B09": "B03", "C03": "C01", "C04": "C05", "C13": "C15", "D04": "D07"}
"""Cases of some seconds, each with a quick one of the same kind that is in the default tests."""
CASES = [
    pytest.param(module, id=module.ID, marks=[pytest.mark.slow] if module.ID in SIBLINGS else [])
    for module in load_cases(fast_only=True)
]


@pytest.mark.parametrize("module", CASES)
def test_case(module):
    result = run_case(module)
    assert result.checks
    assert json.loads(as_json([result]))[0]["passed"] == result.passed
    failed = [
        f"{c.quantity}: {c.ours:.6g} instead of {c.reference:.6g}, error {c.error:+.3g}, "
        f"band {c.band:.3g} ({c.reason})"
        for c in result.checks
        if c.gate and not c.passed
    ]
    assert not failed, failed
