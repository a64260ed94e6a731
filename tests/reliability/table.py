"""The table of all promises, and its page."""

import datetime
import platform
import re
from pathlib import Path

import shellcut

PAGE = Path(__file__).parents[2] / "docs" / "reliability.md"
WANTED = {"kills": 300, "faults": 40, "fuzz": 20_000, "mutants": 300}
"""Numbers that a whole proof has."""


def stamp():
    """Return date, machine and versions of a trial."""
    info = Path("/proc/cpuinfo")
    found = re.search(r"model name\s*: (.+)", info.read_text() if info.exists() else "")
    cpu = found[1] if found else platform.processor() or platform.machine()
    versions = f"shellcut {shellcut.__version__}, Python {platform.python_version()}"
    date = datetime.date.today().isoformat()
    return {"date": date, "machine": f"{cpu}, {platform.system()}", "versions": versions}


def sums(rows):
    """Return how many were tried, kept and failed in some rows."""
    return tuple(sum(row[name] for row in rows) for name in ("tried", "kept", "failed"))


def of(record, kinds):
    """Return the table as Markdown."""
    lines = [
        "| promise | test behind it | tried | kept | failed | date |",
        "|---|---|--:|--:|--:|---|",
    ]
    for kind, module in kinds.items():
        found = record.get(kind, {"rows": {}, "date": ""})
        for name, (promise, test) in module.ROWS.items():
            tried, kept, failed = sums([found["rows"][name]] if name in found["rows"] else [])
            numbers = f"{tried:,} | {kept:,} | {failed:,} | {found['date']}"
            numbers = numbers if tried else "not tried | | |"
            lines.append(f"| **{name}**: {promise} | {test} | {numbers} |")
    return "\n".join(lines)


def totals(record, kinds):
    """Return what was tried of what a whole proof has, as rows."""
    lines = ["| kind | tried | of a whole proof | kept | failed | minutes |"]
    lines += ["|---|--:|--:|--:|--:|--:|"]
    for kind in kinds:
        found = record.get(kind, {"rows": {}, "seconds": 0.0})
        tried, kept, failed = sums(found["rows"].values())
        wanted = f"{WANTED[kind]:,}" if kind in WANTED else "–"
        minutes = f"{found['seconds'] / 60:.1f}"
        lines.append(f"| {kind} | {tried:,} | {wanted} | {kept:,} | {failed:,} | {minutes} |")
    return "\n".join(lines)


def listed(record, of_row, none):
    """Return failures, or what was not possible, as a list; a sentence if there is none."""
    found = [
        f"- `{' '.join(text.split())[:300].replace('`', chr(39))}`"
        for kind in record.values()
        for row in kind["rows"].values()
        for text in row[of_row]
    ]
    return "\n".join(found) or none


def write_page(record, kinds):
    """Write the page anew."""
    machines = sorted({f"{kind['machine']}; {kind['versions']}" for kind in record.values()})
    template = (Path(__file__).parent / "page.md").read_text(encoding="utf-8")
    text = template.format(
        table=of(record, kinds),
        totals=totals(record, kinds),
        failures=listed(record, "failures", "There is none."),
        not_possible=listed(record, "not_possible", "There is none."),
        machines=". ".join(machines),
    )
    PAGE.write_text(text, encoding="utf-8")
