"""The last result of each file of slow tests, a section of docs/verification.md.

    .ci/nightly                                              # runs them, then this:
    python tests/verification/nightly.py build/nightly.xml   # stores the result, writes the section

The results are stored beside this file, in ``nightly.json``. A run of some files renews their rows
and leaves the others. The section is part of the page's head, which report.py keeps.
"""

import argparse
import json
import platform
import re
import xml.etree.ElementTree as ElementTree
from collections import defaultdict
from importlib.metadata import version
from pathlib import Path

STORED = Path(__file__).with_name("nightly.json")
ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "verification.md"
HEADING = "## The nightly tests"
WORDS = ("passed", "failed", "skipped")


def rows_of(xml):
    """Return what pytest's ``--junitxml`` file tells, a row a file of tests."""
    suite = ElementTree.parse(xml).getroot().find("testsuite")
    assert suite is not None, f"{xml} is no result of pytest"
    empty = {
        **dict.fromkeys((*WORDS, "seconds"), 0),
        "date": suite.get("timestamp", "")[:10],
        "with": f"shellcut {version('shellcut-fem')}, Python {platform.python_version()}, "
        f"Numba {version('numba')}, {platform.system()} {platform.machine()}",
    }
    rows = defaultdict(lambda: dict(empty))
    for case in suite.iter("testcase"):
        parts = case.get("classname", "").split(".")
        last = next((k for k, part in enumerate(parts) if part.startswith("test_")), len(parts) - 1)
        row = rows["/".join(parts[: last + 1]) + ".py"]
        row[_outcome(case)] += 1
        row["seconds"] += float(case.get("time", 0.0))
    return dict(rows)


def _outcome(case):
    if case.find("failure") is not None or case.find("error") is not None:
        return "failed"
    return "passed" if case.find("skipped") is None else "skipped"


def section(rows):
    """Return the lines of the section."""
    total = {word: sum(row[word] for row in rows.values()) for word in WORDS}
    return [
        HEADING,
        "",
        "`.ci/nightly` runs the tests marked *slow*, or those of the files that are named, in a "
        "fresh environment. The last result of each file: "
        + ", ".join(f"{total[word]} {word}" for word in WORDS)
        + ". A file that is not in the table has no result yet. The minutes of a row are the sum "
        "over its tests, some of which ran at the same time.",
        "",
        f"| file of tests | {' | '.join(WORDS)} | minutes | on | with |",
        "|---|" + "---:|" * 4 + "---|---|",
        *(
            f"| `{name}` | {' | '.join(str(row[word]) for word in WORDS)} | "
            f"{row['seconds'] / 60:.1f} | {row['date']} | {row['with']} |"
            for name, row in sorted(rows.items())
        ),
        "",
    ]


def stored():
    """Return the last row of each file."""
    return json.loads(STORED.read_text(encoding="utf-8")) if STORED.exists() else {}


def with_section(page, rows):
    """Return the page with the section in the place of the one that it has."""
    before, heading, after = page.partition(HEADING + "\n")
    assert heading, f"the page has no section {HEADING!r}"
    follows = re.search(r"^(?:## |<!-- )", after, re.M)
    rest = after[follows.start() :] if follows else ""
    return before + "\n".join([*section(rows), rest])


def main():
    """Store the rows, print the section and write it."""
    parser = argparse.ArgumentParser(description="The result of the slow tests.")
    parser.add_argument("xml", type=Path, help="what pytest --junitxml has written")
    rows = stored() | rows_of(parser.parse_args().xml)
    rows = {name: row for name, row in sorted(rows.items()) if (ROOT / name).exists()}
    STORED.write_text(json.dumps(rows, indent=2) + "\n", encoding="utf-8")
    print("\n".join(section(rows)))
    page = PAGE.read_text(encoding="utf-8")
    PAGE.write_text(with_section(page, rows), encoding="utf-8")


if __name__ == "__main__":
    main()
