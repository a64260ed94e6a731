"""The section on the slow tests is that of the last result of .ci/nightly."""

import json

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
    rows = nightly.rows_of(tmp_path / "n.xml")
    text = "\n".join(nightly.section(rows))
    assert "of each file: 1 passed, 2 failed, 1 skipped. " in text
    assert "| `tests/regression/test_opening.py` | 0 | 2 | 0 | 60.1 | 2026-11-29 | shellcut" in text
    assert "| `tests/unit/test_mesh.py` | 1 | 0 | 1 | 1.5 | 2026-11-29 | shellcut" in text
    page = nightly.with_section("# A\n\n## The nightly tests\n\nold\n\n## B\n\nb\n", rows)
    assert page == "# A\n\n" + text + "\n## B\n\nb\n"
    assert nightly.with_section(page, rows) == page


def test_some_files_renew_their_rows(tmp_path, monkeypatch):
    page, store = tmp_path / "page.md", tmp_path / "nightly.json"
    page.write_text("# A\n\n## The nightly tests\n")
    (tmp_path / "n.xml").write_text(XML)
    old = {**dict.fromkeys((*nightly.WORDS, "seconds"), 7), "date": "2026-01-01", "with": "-"}
    names = "tests/unit/test_mesh.py", "tests/unit/test_state.py", "tests/unit/test_gone.py"
    store.write_text(json.dumps(dict.fromkeys(names, old)))
    monkeypatch.setattr(nightly, "PAGE", page)
    monkeypatch.setattr(nightly, "STORED", store)
    monkeypatch.setattr("sys.argv", ["nightly.py", str(tmp_path / "n.xml")])
    nightly.main()
    dates = {name.rpartition("/")[2]: row["date"] for name, row in nightly.stored().items()}
    assert dates == {
        "test_opening.py": "2026-11-29",
        "test_mesh.py": "2026-11-29",
        "test_state.py": "2026-01-01",
    }
    assert "| `tests/unit/test_state.py` | 7 |" in page.read_text()


def test_the_page_has_the_stored_result():
    page = (ROOT / "docs" / "verification.md").read_text(encoding="utf-8")
    # else: python tests/verification/nightly.py build/nightly.xml
    assert nightly.with_section(page, nightly.stored()) == page
