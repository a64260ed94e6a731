"""The last result of the slow tests, a section of docs/verification.md.

    .ci/nightly                                                        # runs them, then this:
    python tests/verification/nightly.py build/nightly.xml             # prints the table
    python tests/verification/nightly.py build/nightly.xml --write     # and writes the section

The result is stored beside this file, in ``nightly.json``. The section is part of the page's head,
which report.py keeps.
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
PAGE = Path(__file__).resolve().parents[2] / "docs" / "verification.md"
HEADING = "## The nightly tests"
WORDS = ("passed", "failed", "skipped")


def result_of(xml):
    """Return what pytest's ``--junitxml`` file tells, a row a file of tests."""
    suite = ElementTree.parse(xml).getroot().find("testsuite")
    assert suite is not None, f"{xml} is no result of pytest"
    files = defaultdict(lambda: dict.fromkeys((*WORDS, "seconds"), 0))
    for case in suite.iter("testcase"):
        parts = case.get("classname", "").split(".")
        last = next((k for k, part in enumerate(parts) if part.startswith("test_")), len(parts) - 1)
        row = files["/".join(parts[: last + 1]) + ".py"]
        row[_outcome(case)] += 1
        row["seconds"] += float(case.get("time", 0.0))
    return {
        "date": suite.get("timestamp", "")[:10],
        "seconds": float(suite.get("time", 0.0)),
        "machine": f"{platform.system()} {platform.machine()}",
        "versions": {
            "shellcut": version("shellcut-fem"),
            "Python": platform.python_version(),
            **{name: version(name.lower()) for name in ("NumPy", "Numba", "SciPy")},
        },
        "files": dict(sorted(files.items())),
    }


def _outcome(case):
    if case.find("failure") is not None or case.find("error") is not None:
        return "failed"
    return "passed" if case.find("skipped") is None else "skipped"


def section(result):
    """Return the lines of the section."""
    lines = [HEADING, ""]
    if result is None:
        return [*lines, "`.ci/nightly` runs them. No result is stored yet.", ""]
    files = result["files"]
    total = {word: sum(row[word] for row in files.values()) for word in WORDS}
    versions = ", ".join(f"{name} {number}" for name, number in result["versions"].items())
    return [
        *lines,
        f"`.ci/nightly` runs all tests marked *slow* in a fresh environment. On {result['date']}: "
        + ", ".join(f"{total[word]} {word}" for word in WORDS)
        + f", in {result['seconds'] / 3600:.1f} h. {versions}; {result['machine']}. The minutes of "
        "a row are the sum over its tests, some of which ran at the same time.",
        "",
        f"| file of tests | {' | '.join(WORDS)} | minutes |",
        "|---|" + "---:|" * 4,
        *(
            f"| `{name}` | {' | '.join(str(row[word]) for word in WORDS)} | "
            f"{row['seconds'] / 60:.1f} |"
            for name, row in files.items()
        ),
        "",
    ]


def stored():
    """Return the last result, None before the first."""
    return json.loads(STORED.read_text(encoding="utf-8")) if STORED.exists() else None


def with_section(page, result):
    """Return the page with the section in the place of the one that it has."""
    before, heading, after = page.partition(HEADING + "\n")
    assert heading, f"the page has no section {HEADING!r}"
    follows = re.search(r"^(?:## |<!-- )", after, re.M)
    rest = after[follows.start() :] if follows else ""
    return before + "\n".join([*section(result), rest])


def main():
    """Print the table; store it and write the section if asked to."""
    parser = argparse.ArgumentParser(description="The result of the slow tests.")
    parser.add_argument("xml", type=Path, help="what pytest --junitxml has written")
    parser.add_argument("--write", action="store_true", help="store it, and write the page")
    arguments = parser.parse_args()
    result = result_of(arguments.xml)
    print("\n".join(section(result)))
    if arguments.write:
        STORED.write_text(json.dumps(result, indent=2) + "\n", encoding="utf-8")
        page = PAGE.read_text(encoding="utf-8")
        PAGE.write_text(with_section(page, result), encoding="utf-8")


if __name__ == "__main__":
    main()
