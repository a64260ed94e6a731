"""The section on the slow tests is that of the last result of .ci/nightly."""

import nightly

XML = """<?xml version="1.0" encoding="utf-8"?><testsuites><testsuite name="pytest" errors="1"
failures="1" skipped="1" tests="4" time="7200.5" timestamp="2026-11-29T01:02:03.4+00:00">
<testcase classname="tests.unit.test_mesh" name="test_a[1]" time="60.0"/>
<testcase classname="tests.unit.test_mesh" name="test_a[2]" time="30.0"><skipped message="no"/>
</testcase><testcase classname="tests.regression.test_opening.TestPath" name="test_b" time="3600">
<failure message="wrong">E</failure></testcase>
<testcase classname="tests.regression.test_opening" name="test_c" time="6"><error>E</error>
</testcase>
</testsuite></testsuites>"""
OLD = """# A

## The nightly tests

| file of tests | passed | failed | skipped | minutes | on | with |
|---|---:|---:|---:|---:|---|---|
| `tests/unit/test_gone.py` | 7 | 0 | 0 | 0.1 | 2026-01-01 | - |
| `tests/unit/test_mesh.py` | 7 | 0 | 0 | 0.1 | 2026-01-01 | - |
| `tests/unit/test_state.py` | 7 | 0 | 0 | 0.1 | 2026-01-01 | - |

## B

b
"""


def test_a_result_of_pytest_renews_the_rows_of_its_files(tmp_path):
    (tmp_path / "n.xml").write_text(XML)
    rows = nightly.rows_of(tmp_path / "n.xml")
    page = nightly.renewed(OLD, rows)
    assert "of each file: 8 passed, 2 failed, 1 skipped. " in page
    opening, mesh, state = (line for line in page.splitlines() if line.startswith("| `"))
    assert "`tests/regression/test_opening.py` | 0 | 2 | 0 | 60.1 | 2026-11-29 | shell" in opening
    assert "`tests/unit/test_mesh.py` | 1 | 0 | 1 | 1.5 | 2026-11-29 | shell" in mesh
    assert state == "| `tests/unit/test_state.py` | 7 | 0 | 0 | 0.1 | 2026-01-01 | - |"
    assert page.startswith("# A\n\n## The nightly tests\n\n`.ci/nightly` runs")
    assert page.endswith(f"{state}\n\n## B\n\nb\n")
    assert nightly.renewed(page, rows) == page


def test_the_page_sums_its_rows():
    page = nightly.PAGE.read_text(encoding="utf-8")
    assert nightly.renewed(page, {}) == page
