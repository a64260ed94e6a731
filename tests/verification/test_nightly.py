"""The section on the slow tests is that of the last result of .ci/nightly."""

import nightly
from page_tables import ROOT

XML = """<?xml version="1.0" encoding="utf-8"?><testsuites><testsuite name="pytest" errors="1"
failures="1" skipped="1" tests="4" time="7200.5" timestamp="2026-11-29T01:02:03.4+00:00">
<testcase classname="tests.unit.test_mesh" name="test_a[1]" time="60.0"/>
<testcase classname="tests.unit.test_mesh" name="test_a[2]" time="30.0"><skipped message="no"/>
</testcase><testcase classname="tests.regression.test_opening.TestPath" name="test_b" time="3600">
<failure message="wrong">E</failure></testcase>
<testcase classname="tests.regression.test_opening" name="test_c" time="6"><error>E</error>
</testcase>
</testsuite></testsuites>"""


def test_a_result_of_pytest_becomes_a_table(tmp_path):
    (tmp_path / "n.xml").write_text(XML)
    result = nightly.result_of(tmp_path / "n.xml")
    text = "\n".join(nightly.section(result))
    assert "On 2026-11-29: 1 passed, 2 failed, 1 skipped, in 2.0 h. shellcut " in text
    assert "| `tests/regression/test_opening.py` | 0 | 2 | 0 | 60.1 |" in text
    assert "| `tests/unit/test_mesh.py` | 1 | 0 | 1 | 1.5 |" in text
    page = nightly.with_section("# A\n\n## The nightly tests\n\nold\n\n## B\n\nb\n", result)
    assert page == "# A\n\n" + text + "\n## B\n\nb\n"
    assert nightly.with_section(page, result) == page


def test_the_page_has_the_stored_result():
    page = (ROOT / "docs" / "verification.md").read_text(encoding="utf-8")
    # else: python tests/verification/nightly.py build/nightly.xml --write
    assert nightly.with_section(page, nightly.stored()) == page
