"""The fast verification cases, one test each; all of them by ``run.py``."""

import pytest

from harness import load_cases, run_case


@pytest.mark.parametrize("module", load_cases(fast_only=True), ids=lambda m: m.ID)
def test_case(module):
    result = run_case(module)
    assert result.checks
    failed = [
        f"{c.quantity}: {c.ours:.6g} instead of {c.reference:.6g}, error {c.error:+.3g}, "
        f"band {c.band:.3g} ({c.reason})"
        for c in result.checks
        if c.gate and not c.passed
    ]
    assert not failed, failed
