"""The last result of each file of slow tests, a section of docs/verification.md.

    .ci/nightly                                              # runs them, then this:
    python tests/verification/nightly.py build/nightly.xml   # renews the section

A run of some files renews their rows of the section's table and leaves the others. The section is
part of the page's head, which report.py keeps.
"""

import platform
import re
import sys
import xml.etree.ElementTree as ElementTree
from collections import Counter, defaultdict
from importlib.metadata import version
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from page_tables import ROOT, cells, tables

PAGE = ROOT / "docs" / "verification.md"
HEADING = "## The nightly tests"
WORDS = ("passed", "failed", "skipped")


def rows_of(xml):
    """Return the cells that pytest's ``--junitxml`` file gives for each file of tests."""
    suite = ElementTree.parse(xml).getroot().find("testsuite")
    assert suite is not None, f"{xml} is no result of pytest"
    used = f"shellcut {version('shellcut-fem')}, Python {platform.python_version()}, "
    used += f"Numba {version('numba')}, {platform.system()} {platform.machine()}"
    found, seconds = defaultdict(Counter), Counter()
    for case in suite.iter("testcase"):
        parts = case.get("classname", "").split(".")
        last = next((k for k, part in enumerate(parts) if part.startswith("test_")), len(parts) - 1)
        name = "/".join(parts[: last + 1]) + ".py"
        found[name][_outcome(case)] += 1
        seconds[name] += float(case.get("time", 0.0))
    date = suite.get("timestamp", "")[:10]
    return {
        name: [*(str(n[word]) for word in WORDS), f"{seconds[name] / 60:.1f}", date, used]
        for name, n in found.items()
    }


def _outcome(case):
    if case.find("failure") is not None or case.find("error") is not None:
        return "failed"
    return "passed" if case.find("skipped") is None else "skipped"


def section(rows):
    """Return the lines of the section."""
    total = ", ".join(
        f"{sum(int(row[k]) for row in rows.values())} {word}" for k, word in enumerate(WORDS)
    )
    return [
        HEADING,
        "",
        "`.ci/nightly` runs the tests marked *slow*, or those of the files that are named, in a "
        f"fresh environment. The last result of each file: {total}. "
        "A file that is not in the table has no result yet. The minutes of a row are the sum "
        "over its tests, some of which ran at the same time.",
        "",
        f"| file of tests | {' | '.join(WORDS)} | minutes | on | with |",
        "|---|" + "---:|" * 4 + "---|---|",
        *(f"| `{name}` | {' | '.join(row)} |" for name, row in sorted(rows.items())),
        "",
    ]


def renewed(page, rows):
    """Return the page with the section renewed by some rows."""
    before, heading, after = page.partition(HEADING + "\n")
    assert heading, f"the page has no section {HEADING!r}"
    follows = re.search(r"^(?:## |<!-- )", after, re.M)
    end = follows.start() if follows else len(after)
    known = [cells(row) for _, table in tables(after[:end]) for row in table[2:]]
    rows = {name.strip("`"): row for name, *row in known} | rows
    there = {name: row for name, row in rows.items() if (ROOT / name).exists()}
    return before + "\n".join([*section(there), after[end:]])


if __name__ == "__main__":
    page = PAGE.read_text(encoding="utf-8")
    PAGE.write_text(renewed(page, rows_of(sys.argv[1])), encoding="utf-8")
