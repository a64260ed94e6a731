"""tests/verification/report.py writes the overview and a page for each chapter of cases."""

import importlib.util
import json
import re

import pytest

from page_tables import ROOT, cells, tables


@pytest.fixture
def report():
    path = ROOT / "tests" / "verification" / "report.py"
    spec = importlib.util.spec_from_file_location("verification_report", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_overview_is_that_of_the_chapters(report):
    cases = []
    for page, _ in report.CHAPTERS.values():
        text = (report.DOCS / "verification" / page).read_text(encoding="utf-8")
        for section in re.split(r"^## ", text, flags=re.MULTILINE)[1:]:
            ((_, rows),) = tables(section)
            verdicts = [cells(row)[-2] for row in rows[2:]]
            passed, failed = verdicts.count("pass"), verdicts.count("FAIL")
            seconds = re.search(r"^(?:passes|FAILS), (\S+) s$", section, re.MULTILINE)[1]
            cases.append((section.partition("\n")[0], passed, passed + failed, seconds))
    page = (report.DOCS / "verification.md").read_text(encoding="utf-8")
    assert page.endswith("\n".join(report.overview(cases)))


def test_pages_of_two_cases(report, monkeypatch, tmp_path):
    monkeypatch.setattr(report, "DOCS", tmp_path)
    check = {"quantity": "force [N]", "reference": 2.0, "ours": 2.01, "error": 0.005, "band": 0.01}
    check |= {"reason": "same element", "gate": True, "passed": True, "absolute": False}
    told = check | {"gate": False, "passed": False}
    case = {"title": "Two strips", "seconds": 1.25, "passed": True, "curves": {}}
    results = [
        {"id": "F09", **case, "checks": [check, told]},
        {"id": "X07", **case, "checks": [told]},
    ]
    (tmp_path / "r.json").write_text(json.dumps(results))
    (tmp_path / "verification.md").write_text(f"# By hand\n\nKept.\n\n{report.MARKER}\n\nold\n")
    report.main(tmp_path / "r.json")
    overview = (tmp_path / "verification.md").read_text(encoding="utf-8")
    assert overview.startswith(f"# By hand\n\nKept.\n\n{report.MARKER}\n")
    assert "old" not in overview
    assert "| [F09 Two strips](verification/cutting.md#f09-two-strips) | 1 of 1 | 1.2 |" in overview
    assert "(verification/convergence-and-locking.md#x07-two-strips) | – | 1.2 |" in overview
    pages = {path.name: path.read_text("utf-8") for path in (tmp_path / "verification").iterdir()}
    assert set(pages) == {"cutting.md", "convergence-and-locking.md"}
    row = "| force [N] | 2 | 2.01 | +0.5 % | 1 % | pass | same element |\n"
    assert "\n## F09 Two strips\n\npasses, 1.2 s\n\n| quantity |" in pages["cutting.md"]
    assert row in pages["cutting.md"]
